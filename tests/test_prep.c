/* Preparation: levelling, what is refused, allocations that fail. */
#include "core/prep.h"

#include "alloc_count.h"
#include "prep_field.h"
#include "rough.h"

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
        cmocka_unit_test(test_prep__bad_input_is_refused_and_the_field_stays),
        cmocka_unit_test(test_prep__missing_points_are_named_where_they_matter),
        cmocka_unit_test(test_prep__any_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
