/* Preparation, closed forms: levelling, lines, spikes, scars, crop, and what is refused. */
#include "core/prep.h"

#include <string.h>

#include "alloc_count.h"
#include "core/units.h"
#include "near.h"
#include "rough.h"

enum { NX = 61, NY = 47 };

static double *at(const dif_field *field, int ix, int iy)
{
    return field->z_um + (size_t)iy * (size_t)field->nx + (size_t)ix;
}

static dif_field blank(int nx, int ny, double pitch_x_um, double pitch_y_um)
{
    dif_field field;
    assert_int_equal(dif_field_create(nx, ny, pitch_x_um, pitch_y_um, &field, NULL), DIF_OK);
    return field;
}

static dif_field copy(const dif_field *field)
{
    dif_field out = blank(field->nx, field->ny, field->pitch_x_um, field->pitch_y_um);
    memcpy(out.z_um, field->z_um, dif_field_n(field) * sizeof *out.z_um);
    return out;
}

static bool is_same(const dif_field *a, const dif_field *b)
{
    return a->nx == b->nx && a->ny == b->ny && memcmp(a->z_um, b->z_um, dif_field_n(a) * sizeof *a->z_um) == 0;
}

/* A sine of period 0.7 um along x and 0.1 um amplitude, sampled at whole periods' distance from nothing. */
static dif_field sine(void)
{
    dif_field field = blank(NX, NY, 0.05, 0.04);
    for (int iy = 0; iy < NY; iy++)
        for (int ix = 0; ix < NX; ix++)
            *at(&field, ix, iy) = 0.1 * sin(DIF_TWO_PI * dif_field_x_um(&field, ix) / 0.7 + 0.3);
    return field;
}

/* x and y in um, any total degree. */
static double polynomial(int degree, double x, double y)
{
    double sum = 3.0;
    for (int total = 1; total <= degree; total++)
        for (int b = 0; b <= total; b++)
            sum += 0.3 * (1 + b) / (1.0 + total) * pow(x, total - b) * pow(y, b);
    return sum;
}

static double largest(const dif_field *field)
{
    double most = 0.0;
    for (size_t i = 0; i < dif_field_n(field); i++)
        most = isfinite(field->z_um[i]) ? fmax(most, fabs(field->z_um[i])) : most;
    return most;
}

static void test_level__removes_a_polynomial_of_its_degree_exactly(void **state)
{
    (void)state;
    for (int degree = 0; degree <= DIF_LEVEL_DEGREE_MAX; degree++) {
        for (int missing = 0; missing < 2; missing++) {
            dif_field field = blank(NX, NY, 0.05, 0.04);
            for (int iy = 0; iy < NY; iy++)
                for (int ix = 0; ix < NX; ix++)
                    *at(&field, ix, iy) = polynomial(degree, dif_field_x_um(&field, ix), dif_field_y_um(&field, iy));
            for (int i = 0; missing && i < 400; i++) /* a corner is not there */
                *at(&field, i % 20, i / 20) = (double)NAN;
            const double size = largest(&field);
            assert_int_equal(dif_prep_level(&field, degree, NULL), DIF_OK);
            /* rounding of sums over 2867 heights; the gap in the corner costs condition */
            assert_near(largest(&field), 0.0, 0.0, 1e-13 * size);
            assert_int_equal(dif_prep_state_of(&field).n_missing, missing ? 400 : 0);
            dif_field_free(&field);
        }
    }
}

static void test_level__is_idempotent_and_leaves_what_is_orthogonal(void **state)
{
    (void)state;
    dif_field field = test_rough_field(NX, NY, 0.05, 0.04, 0.2, 3);
    assert_int_equal(dif_prep_level(&field, 3, NULL), DIF_OK);
    dif_field again = copy(&field);
    assert_int_equal(dif_prep_level(&again, 3, NULL), DIF_OK);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        assert_near(again.z_um[i], field.z_um[i], 0.0, 1e-15);
    dif_field_free(&again);
    dif_field_free(&field);
}

static void test_level__a_single_row_determines_its_own_terms_only(void **state)
{
    (void)state;
    dif_field field = blank(9, 1, 1.0, 1.0);
    for (int ix = 0; ix < 9; ix++)
        *at(&field, ix, 0) = 2.0 + 0.5 * ix;
    assert_int_equal(dif_prep_level(&field, 4, NULL), DIF_OK);
    assert_near(largest(&field), 0.0, 0.0, 1e-14);
    dif_field_free(&field);
}

static void test_level_auto__takes_the_bow_and_no_more(void **state)
{
    (void)state;
    for (int degree = 1; degree <= DIF_LEVEL_AUTO_MAX; degree++) {
        dif_field field = sine();
        int found = 0;
        for (int iy = 0; iy < NY; iy++)
            for (int ix = 0; ix < NX; ix++)
                *at(&field, ix, iy) += polynomial(degree, dif_field_x_um(&field, ix), dif_field_y_um(&field, iy));
        assert_int_equal(dif_prep_level_auto(&field, &found, NULL), DIF_OK);
        assert_int_equal(found, degree);
        /* the sine is 4.4 periods long and shares a little with a cubic */
        assert_near(dif_prep_state_of(&field).rms_um, 0.1 / sqrt(2.0), 0.03, 0.0);
        dif_field_free(&field);
    }
}

static void test_tilt__of_a_plane_and_of_a_sine(void **state)
{
    (void)state;
    dif_prep_tilt tilt;
    dif_field field = blank(NX, NY, 0.05, 0.04);
    assert_int_equal(dif_prep_tilt_of(&field, &tilt, NULL), DIF_OK);
    assert_near(tilt.share, 0.0, 0.0, 0.0);
    for (int iy = 0; iy < NY; iy++)
        for (int ix = 0; ix < NX; ix++)
            *at(&field, ix, iy) = 5.0 + 0.02 * dif_field_x_um(&field, ix) - 0.01 * dif_field_y_um(&field, iy);
    assert_int_equal(dif_prep_tilt_of(&field, &tilt, NULL), DIF_OK);
    assert_near(tilt.slope_x, 0.02, 1e-12, 0.0);
    assert_near(tilt.slope_y, -0.01, 1e-12, 0.0);
    assert_near(tilt.share, 1.0, 1e-10, 0.0);
    dif_field_free(&field);
    field = sine();
    assert_int_equal(dif_prep_tilt_of(&field, &tilt, NULL), DIF_OK);
    assert_at_most(tilt.share, 0.05); /* 6 / (pi n)^2 at most for n periods, here n = 4.4 */
    dif_field_free(&field);
}

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

static void expect(dif_status got, dif_status want, const dif_error *err, const char *text)
{
    assert_int_equal(got, want);
    assert_string_equal(err->text, text);
}

static void test_prep__bad_input_is_refused_and_the_field_stays(void **state)
{
    (void)state;
    dif_field field = sine(), want = copy(&field);
    dif_error e;
    dif_prep_filled filled;
    expect(dif_prep_level(&field, 9, &e), DIF_ERR_ARG, &e, "polynomial of degree 9, want 0 to 8");
    expect(dif_prep_level(&field, -1, &e), DIF_ERR_ARG, &e, "polynomial of degree -1, want 0 to 8");
    expect(dif_prep_lines(&field, (dif_prep_lines_method)7, &e), DIF_ERR_ARG, &e,
           "line correction 7, want median or diff");
    expect(dif_prep_despike(&field, (dif_prep_limit){false, 0.0}, NULL, &e), DIF_ERR_ARG, &e,
           "limit 0 um, want a finite number > 0");
    expect(dif_prep_scars(&field, (dif_prep_limit){true, (double)NAN}, NULL, &e), DIF_ERR_ARG, &e,
           "limit nan sigma, want a finite number > 0");
    expect(dif_prep_fill(&field, (dif_prep_fill_method)5, &filled, &e), DIF_ERR_ARG, &e,
           "filling 5, want plate or laplace");
    expect(dif_prep_crop(&field, &(dif_prep_box){-0.1, 1.0, 0.0, 1.0}, &e), DIF_ERR_ARG, &e,
           "crop from x = -0.1 to 1 um, want a part of 0 to 3.05 um");
    expect(dif_prep_crop(&field, &(dif_prep_box){0.0, 1.0, 1.0, 2.0}, &e), DIF_ERR_ARG, &e,
           "crop from y = 1 to 2 um, want a part of 0 to 1.88 um");
    expect(dif_prep_crop(&field, &(dif_prep_box){0.0, 0.05, 0.0, 1.0}, &e), DIF_ERR_ARG, &e,
           "crop to 1 x 25 samples, want at least 2 x 2");
    expect(dif_prep_resample(&field, 0.0, 1.0, &e), DIF_ERR_ARG, &e, "new pitch 0 x 1 um, want finite numbers > 0");
    expect(dif_prep_resample(&field, 2.0, 0.1, &e), DIF_ERR_ARG, &e,
           "new pitch 2 x 0.1 um leaves 1 x 18 samples, want at least 2 x 2");
    expect(dif_prep_resample(&field, 1e-9, 0.1, &e), DIF_ERR_SIZE, &e,
           "field of 1000000000 x 18 samples, want at most 32768 a side");
    expect(dif_prep_rotate(&field, (double)NAN, &e), DIF_ERR_ARG, &e, "rotation by nan rad, want a finite angle");
    expect(dif_prep_highpass(&field, 0.1, &e), DIF_ERR_ARG, &e, "cut-off 0.1 um, want more than two pitches (0.1 um)");
    expect(dif_prep_whole_periods(&field, &(dif_prep_lattice){0.0, 0.0, (double)NAN}, NULL, &e), DIF_ERR_ARG, &e,
           "lattice of period 0 um at 0 rad, want a finite length > 0 and an angle");
    expect(dif_prep_whole_periods(&field, &(dif_prep_lattice){0.7, 0.0, 0.0}, NULL, &e), DIF_ERR_ARG, &e,
           "period 0 um across, want a finite length > 0 or none");
    expect(dif_prep_whole_periods(&field, &(dif_prep_lattice){4.0, 0.0, (double)NAN}, NULL, &e), DIF_ERR_SIZE, &e,
           "not one period of 4 um inside 3.05 x 1.88 um");
    assert_true(is_same(&field, &want));
    dif_field_free(&field);
    dif_field_free(&want);
}

static void test_prep__missing_points_are_named_where_they_matter(void **state)
{
    (void)state;
    dif_field field = sine();
    dif_error e;
    *at(&field, 3, 3) = (double)INFINITY;
    expect(dif_prep_resample(&field, 0.02, 0.02, &e), DIF_ERR_NONFINITE, &e,
           "resampling needs every height, and 1 of 2867 are missing: fill them first");
    assert_int_equal(dif_prep_rotate(&field, 0.1, &e), DIF_ERR_NONFINITE);
    assert_int_equal(dif_prep_highpass(&field, 1.0, &e), DIF_ERR_NONFINITE);
    assert_int_equal(dif_prep_whole_periods(&field, &(dif_prep_lattice){0.7, 0.0, (double)NAN}, NULL, &e),
                     DIF_ERR_NONFINITE);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        field.z_um[i] = (double)NAN;
    expect(dif_prep_level(&field, 1, &e), DIF_ERR_NONFINITE, &e, "all 2867 heights are missing");
    expect(dif_prep_fill(&field, DIF_FILL_PLATE, NULL, &e), DIF_ERR_NONFINITE, &e,
           "all 2867 heights are missing: nothing to fill from");
    assert_int_equal(dif_prep_lines(&field, DIF_LINES_DIFF, NULL), DIF_OK);
    assert_int_equal(dif_prep_despike(&field, (dif_prep_limit){true, 3.0}, NULL, NULL), DIF_OK);
    dif_field_free(&field);
}

/* Every step by number, on a field with a spike, a scar and (where it may) a hole. */
static dif_status run_step(int step, dif_field *field)
{
    int degree;
    switch (step) {
    case 0:
        return dif_prep_level(field, 2, NULL);
    case 1:
        return dif_prep_level_auto(field, &degree, NULL);
    case 2:
        return dif_prep_lines(field, DIF_LINES_MEDIAN, NULL);
    case 3:
        return dif_prep_despike(field, (dif_prep_limit){true, 8.0}, NULL, NULL);
    case 4:
        return dif_prep_scars(field, (dif_prep_limit){false, 0.05}, NULL, NULL);
    case 5:
        *at(field, 8, 8) = (double)NAN;
        return dif_prep_fill(field, DIF_FILL_PLATE, NULL, NULL);
    case 6:
        return dif_prep_crop(field, &(dif_prep_box){0.0, 1.0, 0.0, 1.0}, NULL);
    case 7:
        return dif_prep_resample(field, 0.08, 0.07, NULL);
    case 8:
        return dif_prep_rotate(field, 0.3, NULL);
    case 9:
        return dif_prep_rotate(field, 0.5 * DIF_PI, NULL);
    case 10:
        return dif_prep_highpass(field, 1.0, NULL);
    default:
        return dif_prep_whole_periods(field, &(dif_prep_lattice){0.7, 0.1, (double)NAN}, NULL, NULL);
    }
}

static void test_prep__any_allocation_may_fail(void **state)
{
    (void)state;
    for (int step = 0; step <= 11; step++) {
        for (int k = 1;; k++) {
            dif_field field = sine();
            *at(&field, 20, 20) += 0.4;
            for (int ix = 30; ix < 50; ix++)
                *at(&field, ix, 30) += 0.4;
            const int live = test_alloc_live();
            const dif_field want = field;
            test_alloc_fail_from(k);
            const dif_status status = run_step(step, &field);
            test_alloc_fail_from(0);
            assert_int_equal(test_alloc_live(), live);
            if (status == DIF_OK) {
                assert_true(k > 1);
                dif_field_free(&field);
                break;
            }
            assert_int_equal(status, DIF_ERR_NOMEM);
            assert_ptr_equal(field.z_um, want.z_um); /* the field is still the old one */
            assert_int_equal(field.nx, want.nx);
            dif_field_free(&field);
            assert_true(k < 100);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_level__removes_a_polynomial_of_its_degree_exactly),
        cmocka_unit_test(test_level__is_idempotent_and_leaves_what_is_orthogonal),
        cmocka_unit_test(test_level__a_single_row_determines_its_own_terms_only),
        cmocka_unit_test(test_level_auto__takes_the_bow_and_no_more),
        cmocka_unit_test(test_tilt__of_a_plane_and_of_a_sine),
        cmocka_unit_test(test_lines__offsets_go_and_the_sine_stays),
        cmocka_unit_test(test_lines__steps_keep_what_a_median_flattens),
        cmocka_unit_test(test_lines__missing_rows_are_passed_over),
        cmocka_unit_test(test_despike__the_spike_is_gone_and_the_rest_untouched),
        cmocka_unit_test(test_despike__a_slope_and_a_wall_are_no_spikes),
        cmocka_unit_test(test_despike__missing_points_stay_missing),
        cmocka_unit_test(test_scars__strokes_go_short_ones_stay),
        cmocka_unit_test(test_crop__keeps_the_samples_inside_from_the_lower_left),
        cmocka_unit_test(test_prep__bad_input_is_refused_and_the_field_stays),
        cmocka_unit_test(test_prep__missing_points_are_named_where_they_matter),
        cmocka_unit_test(test_prep__any_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
