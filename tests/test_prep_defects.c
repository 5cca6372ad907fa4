/* Preparation sample by sample: lines, spikes, scars, crop. */
#include "core/prep.h"
#include "prep_field.h"
#include "rough.h"

static void test_lines__offsets_go_and_the_sine_stays(void **state)
{
    (void)state;
    for (int method = DIF_LINES_MEDIAN; method <= DIF_LINES_DIFF; method++) {
        const dif_field want = sine();
        dif_field field = copy(&want);
        uint64_t random = 5;
        double mean = 0.0;
        for (int iy = 0; iy < NY; iy++) {
            const double offset = test_random(&random, -0.5, 0.5);
            mean += offset / NY;
            for (int ix = 0; ix < NX; ix++)
                *at(&field, ix, iy) += offset;
        }
        assert_int_equal(dif_prep_lines(&field, (dif_prep_lines_method)method, NULL), DIF_OK);
        for (size_t i = 0; i < dif_field_n(&field); i++) /* rounding alone */
            assert_near(field.z_um[i] - mean, want.z_um[i], 0.0, 1e-14);
        dif_field_free(&field);
        dif_field_free(&(dif_field){.z_um = want.z_um});
    }
}

static void test_lines__steps_keep_what_a_median_flattens(void **state)
{
    (void)state;
    dif_field field = blank(NX, NY, 0.05, 0.04); /* in each row, a step that covers more columns from row to row */
    for (int iy = 0; iy < NY; iy++)
        for (int ix = 0; ix < NX; ix++)
            *at(&field, ix, iy) = ix < iy ? 1.0 : 0.0;
    dif_field by_median = copy(&field), by_steps = copy(&field);
    assert_int_equal(dif_prep_lines(&by_steps, DIF_LINES_DIFF, NULL), DIF_OK);
    assert_true(is_same(&by_steps, &field));
    assert_int_equal(dif_prep_lines(&by_median, DIF_LINES_MEDIAN, NULL), DIF_OK);
    assert_near(*at(&by_median, 60, 45) - *at(&by_median, 60, 5), -1.0, 1e-12, 0.0);
    dif_field_free(&field);
    dif_field_free(&by_median);
    dif_field_free(&by_steps);
}

static void test_lines__missing_rows_are_passed_over(void **state)
{
    (void)state;
    for (int method = DIF_LINES_MEDIAN; method <= DIF_LINES_DIFF; method++) {
        dif_field field = sine();
        const double before = *at(&field, 7, 30) - *at(&field, 7, 0);
        for (int iy = 11; iy < NY; iy++)
            for (int ix = 0; ix < NX; ix++)
                *at(&field, ix, iy) = iy == 11 ? (double)NAN : *at(&field, ix, iy) + 0.25;
        assert_int_equal(dif_prep_lines(&field, (dif_prep_lines_method)method, NULL), DIF_OK);
        assert_near(*at(&field, 7, 30) - *at(&field, 7, 0), before, 0.0, 1e-14);
        assert_int_equal(dif_prep_state_of(&field).n_missing, NX);
        dif_field_free(&field);
    }
}

static void test_despike__the_spike_is_gone_and_the_rest_untouched(void **state)
{
    (void)state;
    const dif_prep_limit limits[] = {{false, 0.05}, {true, 8.0}};
    for (int k = 0; k < 2; k++) {
        dif_field want = sine(), field = copy(&want);
        size_t n = 99;
        *at(&field, 20, 20) += 0.4;
        *at(&field, 21, 20) += 0.3;
        *at(&field, 40, 1) -= 0.5;
        *at(&field, 0, 9) += 0.5; /* at an edge */
        assert_int_equal(dif_prep_despike(&field, limits[k], &n, NULL), DIF_OK);
        assert_int_equal(n, 4);
        for (int iy = 0; iy < NY; iy++)
            for (int ix = 0; ix < NX; ix++) {
                const bool was_spike =
                    (iy == 20 && (ix == 20 || ix == 21)) || (iy == 1 && ix == 40) || (iy == 9 && ix == 0);
                /* 14 samples a period: the curvature of 4 samples, at the edge of 1 */
                assert_near(*at(&field, ix, iy), *at(&want, ix, iy), 0.0, was_spike ? 0.01 : 0.0);
            }
        dif_field_free(&want);
        dif_field_free(&field);
    }
}

static void test_despike__a_slope_and_a_wall_are_no_spikes(void **state)
{
    (void)state;
    dif_field field = blank(NX, NY, 0.05, 0.04);
    size_t n = 99;
    for (int iy = 0; iy < NY; iy++)
        for (int ix = 0; ix < NX; ix++)
            *at(&field, ix, iy) = 0.25 * ix + 0.5 * iy + (ix > 30 ? 8.0 : 0.0); /* binary fractions: exact medians */
    const dif_field want = copy(&field);
    /* a wall hides at most two steps of the slope from the median */
    assert_int_equal(dif_prep_despike(&field, (dif_prep_limit){false, 2.1}, &n, NULL), DIF_OK);
    assert_int_equal(n, 0);
    assert_true(is_same(&field, &want));
    dif_field_free(&field);
    dif_field_free(&(dif_field){.z_um = want.z_um});
}

static void test_despike__missing_points_stay_missing(void **state)
{
    (void)state;
    dif_field field = sine();
    size_t n;
    *at(&field, 20, 20) += 0.4;
    *at(&field, 21, 20) = (double)NAN;
    assert_int_equal(dif_prep_despike(&field, (dif_prep_limit){true, 8.0}, &n, NULL), DIF_OK);
    assert_int_equal(n, 1);
    assert_true(isnan(*at(&field, 21, 20)));
    assert_int_equal(dif_prep_state_of(&field).n_missing, 1);
    dif_field_free(&field);
}

static void test_scars__strokes_go_short_ones_stay(void **state)
{
    (void)state;
    dif_field want = sine(), field = copy(&want);
    size_t n = 0;
    uint64_t random = 7;
    for (size_t i = 0; i < dif_field_n(&want); i++)
        field.z_um[i] = want.z_um[i] += test_random(&random, -1e-3, 1e-3);
    for (int ix = 10; ix < 30; ix++)
        *at(&field, ix, 12) += 0.05;
    for (int ix = 35; ix < 55; ix++)
        for (int iy = 20; iy < 23; iy++)
            *at(&field, ix, iy) -= 0.05;
    for (int ix = 10; ix < 10 + DIF_SCAR_SAMPLES_MIN - 1; ix++)
        *at(&field, ix, 30) += 0.05;
    assert_int_equal(dif_prep_scars(&field, (dif_prep_limit){true, 10.0}, &n, NULL), DIF_OK);
    assert_int_equal(n, 20 + 3 * 20);
    for (int iy = 0; iy < NY; iy++)
        for (int ix = 0; ix < NX; ix++) {
            const bool was_scar = (iy == 12 && ix >= 10 && ix < 30) || (iy >= 20 && iy < 23 && ix >= 35 && ix < 55);
            const bool is_short = iy == 30 && ix >= 10 && ix < 10 + DIF_SCAR_SAMPLES_MIN - 1;
            const double left = is_short ? 0.05 : 0.0; /* noise of both sides under a filled scar */
            assert_near(*at(&field, ix, iy), *at(&want, ix, iy) + left, 0.0, was_scar ? 4e-3 : 0.0);
        }
    dif_field_free(&want);
    dif_field_free(&field);
}

static void test_crop__keeps_the_samples_inside_from_the_lower_left(void **state)
{
    (void)state;
    dif_field field = test_rough_field(NX, NY, 0.05, 0.04, 0.2, 3), whole = copy(&field);
    /* samples 10 ... 19 from the left, 5 ... 11 from the bottom */
    const dif_prep_box box = {0.5, 1.0, 0.2, 0.48};
    assert_int_equal(dif_prep_crop(&field, &box, NULL), DIF_OK);
    assert_int_equal(field.nx, 10);
    assert_int_equal(field.ny, 7);
    for (int iy = 0; iy < 7; iy++)
        for (int ix = 0; ix < 10; ix++)
            assert_near(*at(&field, ix, iy), *at(&whole, 10 + ix, NY - 12 + iy), 0.0, 0.0);
    dif_field_free(&field);
    field = copy(&whole);
    assert_int_equal(dif_prep_crop(&field, &(dif_prep_box){0.0, NX * 0.05, 0.0, NY * 0.04}, NULL), DIF_OK);
    assert_true(is_same(&field, &whole));
    dif_field_free(&field);
    dif_field_free(&whole);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lines__offsets_go_and_the_sine_stays),
        cmocka_unit_test(test_lines__steps_keep_what_a_median_flattens),
        cmocka_unit_test(test_lines__missing_rows_are_passed_over),
        cmocka_unit_test(test_despike__the_spike_is_gone_and_the_rest_untouched),
        cmocka_unit_test(test_despike__a_slope_and_a_wall_are_no_spikes),
        cmocka_unit_test(test_despike__missing_points_stay_missing),
        cmocka_unit_test(test_scars__strokes_go_short_ones_stay),
        cmocka_unit_test(test_crop__keeps_the_samples_inside_from_the_lower_left),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
