#include "bench/regress.h"

#include "alloc_count.h"
#include "bench/scan.h"
#include "core/colour.h"
#include "core/units.h"
#include "near.h"

static void test_values__known_errors_have_their_quantiles_and_place(void **state)
{
    (void)state;
    enum { N = 200 };
    double a[N], b[N];
    dif_regress r;
    for (int i = 0; i < N; i++) {
        b[i] = 2.0;
        a[i] = 2.0 + 1e-3 * (i + 1);
    }
    assert_int_equal(dif_regress_values(N, a, b, 1e-5, &r, NULL), DIF_OK);
    assert_int_equal(r.n, N);
    assert_int_equal(r.n_one_sided, 0);
    assert_near(r.maximum, 2.2, 1e-15, 0.0);
    assert_near(r.floor, 2.2e-5, 1e-15, 0.0);
    assert_near(r.absolute.median, 0.1, 1e-12, 0.0); /* the 100th of 200 */
    assert_near(r.absolute.p95, 0.19, 1e-12, 0.0);
    assert_near(r.absolute.p99, 0.198, 1e-12, 0.0);
    assert_near(r.absolute.worst, 0.2, 1e-12, 0.0);
    assert_int_equal(r.absolute.worst_at, N - 1);
    assert_near(r.absolute.worst_a, 2.2, 1e-15, 0.0);
    assert_near(r.absolute.worst_b, 2.0, 1e-15, 0.0);
    assert_near(r.of_max.worst, 0.2 / 2.2, 1e-12, 0.0);
    assert_near(r.relative.worst, 0.2 / 2.2, 1e-12, 0.0);
    assert_near(r.relative.median, 0.1 / 2.1, 1e-12, 0.0);
}

static void test_values__relative_error_is_symmetric_and_floored(void **state)
{
    (void)state;
    double a[] = {1.0, 1e-9, 0.0, -0.5}, b[] = {1.0, 3e-9, 0.0, -0.25};
    dif_regress ab, ba;
    assert_int_equal(dif_regress_values(4, a, b, 1e-5, &ab, NULL), DIF_OK);
    assert_int_equal(dif_regress_values(4, b, a, 1e-5, &ba, NULL), DIF_OK);
    assert_near(ab.relative.worst, 0.5, 1e-15, 0.0);
    assert_int_equal(ab.relative.worst_at, 3);
    assert_near(ab.relative.median, 0.0, 0.0, 0.0);
    assert_near(ab.relative.p95, ba.relative.p95, 0.0, 0.0);
    assert_near(ab.relative.worst, ba.relative.worst, 0.0, 0.0);
    assert_near(ab.relative.worst_a, ba.relative.worst_b, 0.0, 0.0);
    /* 2e-9 over the floor of 1e-5, not over 3e-9 */
    a[3] = b[3];
    assert_int_equal(dif_regress_values(4, a, b, 1e-5, &ab, NULL), DIF_OK);
    assert_near(ab.relative.worst, 2e-4, 1e-12, 0.0);
}

static void test_values__nan_on_one_side_is_counted_on_both_left_out(void **state)
{
    (void)state;
    const double nan = (double)NAN, inf = (double)INFINITY;
    const double a[] = {1.0, nan, nan, 1.0, inf, inf}, b[] = {1.0, nan, 1.0, nan, 1.0, inf};
    dif_regress r;
    assert_int_equal(dif_regress_values(6, a, b, 1e-5, &r, NULL), DIF_OK);
    assert_int_equal(r.n, 1);
    assert_int_equal(r.n_one_sided, 4); /* two infinities have no difference either */
    assert_int_equal(r.one_sided_at, 2);
    assert_near(r.relative.worst, 0.0, 0.0, 0.0);
    assert_int_equal(dif_regress_values(1, a + 1, b + 1, 1e-5, &r, NULL), DIF_OK);
    assert_int_equal(r.n, 0);
    assert_int_equal(r.n_one_sided, 0);
}

static dif_table make_table(const char *angle_deg, double shift_rad)
{
    dif_range angle, lambda;
    dif_plan plan;
    dif_table table;
    assert_int_equal(dif_range_parse(angle_deg, &angle, NULL), DIF_OK);
    assert_int_equal(dif_range_parse("400:500:50", &lambda, NULL), DIF_OK);
    assert_int_equal(dif_scan_plan(false, 30.0, 0.0, &angle, &lambda, &plan, NULL), DIF_OK);
    assert_int_equal(dif_table_create(&plan, DIF_QUANTITY_RHO, &table, NULL), DIF_OK);
    for (int il = 0; il < plan.n_lambda; il++)
        for (int ia = 0; ia < plan.n_angle; ia++) {
            const double at = plan.angle_rad[ia] - shift_rad, x1 = (at - 0.1 - plan.lambda_um[il]) / 0.03;
            const double x2 = (at + 0.4) / 0.03;
            table.value[il * plan.n_angle + ia] = exp(-x1 * x1) + 0.2 * exp(-x2 * x2);
        }
    dif_plan_free(&plan);
    return table;
}

static void test_tables__a_mismatch_is_an_error(void **state)
{
    (void)state;
    dif_table a = make_table("-60:60:0.5", 0.0), b = make_table("-60:60:0.5", 0.0), c = make_table("-60:60:1", 0.0);
    dif_regress r;
    dif_error err;
    assert_int_equal(dif_regress_tables(&a, &b, 1e-5, &r, &err), DIF_OK);
    assert_near(r.absolute.worst, 0.0, 0.0, 0.0);
    assert_int_equal(dif_regress_tables(&a, &c, 1e-5, &r, &err), DIF_ERR_SIZE);
    assert_string_equal(err.text, "tables of 241 x 3 and 121 x 3 cells");
    b.plan.angle_rad[7] += 1e-6;
    assert_int_equal(dif_regress_tables(&a, &b, 1e-5, &r, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "tables differ in their axes: angle 7 is -56.5 and -56.4999427");
    b.plan.angle_rad[7] -= 1e-6;
    b.plan.lambda_um[2] = 0.6;
    assert_int_equal(dif_regress_tables(&a, &b, 1e-5, &r, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "tables differ in their axes: wavelength 2 is 500 and 600");
    b.plan.lambda_um[2] = 0.5;
    b.plan.fixed_rad = 0.1;
    assert_int_equal(dif_regress_tables(&a, &b, 1e-5, &r, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "tables differ in their planes of incidence or fixed angles");
    b.quantity = DIF_QUANTITY_POWER;
    assert_int_equal(dif_regress_tables(&a, &b, 1e-5, &r, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "tables of rho and power");
    assert_int_equal(dif_regress_values(0, a.value, a.value, 1e-5, &r, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "nothing to compare");
    assert_int_equal(dif_regress_values(1, a.value, a.value, 0.0, &r, &err), DIF_ERR_ARG);
    dif_table_free(&a);
    dif_table_free(&b);
    dif_table_free(&c);
}

static void test_peaks__a_shift_is_found_and_a_lost_one_counted(void **state)
{
    (void)state;
    const double shift_rad = 1e-4;
    dif_table b = make_table("-60:60:0.5", 0.0), a = make_table("-60:60:0.5", shift_rad);
    dif_regress_peaks peaks;
    assert_int_equal(dif_regress_peaks_of(&a, &b, 0.01, &peaks, NULL), DIF_OK);
    assert_int_equal(peaks.n, 6);
    assert_int_equal(peaks.n_lost, 0);
    /* the parabola through three samples of a Gaussian 3.4 steps wide is off by a tenth of a shift */
    assert_near(peaks.worst_shift_rad, shift_rad, 0.15, 0.0);
    assert_near(fabs(peaks.angle_a_rad - peaks.angle_b_rad), peaks.worst_shift_rad, 1e-9, 0.0);
    for (int ia = 0; ia < a.plan.n_angle; ia++) /* the second wavelength's main peak goes */
        a.value[a.plan.n_angle + ia] = a.plan.angle_rad[ia] > 0.0 ? 0.0 : a.value[a.plan.n_angle + ia];
    assert_int_equal(dif_regress_peaks_of(&a, &b, 0.01, &peaks, NULL), DIF_OK);
    assert_int_equal(peaks.n_lost, 1);
    assert_int_equal(dif_regress_peaks_of(&a, &a, 0.01, &peaks, NULL), DIF_OK);
    assert_near(peaks.worst_shift_rad, 0.0, 0.0, 0.0);
    dif_table_free(&a);
    dif_table_free(&b);
}

static void test_colours__difference_is_that_of_exposed_colours(void **state)
{
    (void)state;
    enum { N = 100 };
    double a[N][3], b[N][3], lab_a[3], lab_b[3], xyz_a[3], xyz_b[3];
    const double exposure = 0.7;
    dif_regress_stat de;
    dif_error err;
    for (int i = 0; i < N; i++)
        for (int c = 0; c < 3; c++)
            a[i][c] = b[i][c] = 0.01 * (i + 1);
    a[40][0] *= 1.1;
    assert_int_equal(dif_regress_colours(N, a, b, exposure, &de, NULL), DIF_OK);
    for (int c = 0; c < 3; c++) {
        xyz_a[c] = a[40][c] * exposure;
        xyz_b[c] = b[40][c] * exposure;
    }
    dif_colour_lab_from_xyz(xyz_a, lab_a);
    dif_colour_lab_from_xyz(xyz_b, lab_b);
    assert_near(de.worst, dif_colour_difference_2000(lab_a, lab_b), 1e-12, 0.0);
    assert_int_equal(de.worst_at, 40);
    assert_near(de.p95, 0.0, 0.0, 0.0);
    a[3][1] = (double)NAN;
    assert_int_equal(dif_regress_colours(N, a, b, exposure, &de, NULL), DIF_OK);
    assert_true(isinf(de.worst));
    assert_int_equal(de.worst_at, 3);
    b[3][1] = (double)NAN;
    assert_int_equal(dif_regress_colours(N, a, b, exposure, &de, NULL), DIF_OK);
    assert_int_equal(de.worst_at, 40);
    assert_int_equal(dif_regress_colours(1, a + 3, b + 3, exposure, &de, NULL), DIF_OK);
    assert_near(de.worst, 0.0, 0.0, 0.0);
    assert_int_equal(dif_regress_colours(0, a, b, exposure, &de, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "nothing to compare");
    assert_int_equal(dif_regress_colours(N, a, b, 0.0, &de, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "an exposure of 0, want > 0");
}

static void test_difference__light_beyond_white_is_dimmed_to_it(void **state)
{
    (void)state;
    const double a[3] = {0.9, 1.0, 1.1}, b[3] = {0.95, 0.9, 1.1};
    double bright_a[3], bright_b[3];
    const double want = dif_regress_difference(a, b, 1.0);
    assert_true(want > 5.0);
    for (int c = 0; c < 3; c++) {
        bright_a[c] = 1e4 * a[c];
        bright_b[c] = 1e4 * b[c];
    }
    assert_near(dif_regress_difference(bright_a, bright_b, 1.0), want, 1e-12, 0.0);
    assert_near(dif_regress_difference(bright_b, bright_a, 1e-4), want, 1e-9, 0.0);
    assert_at_most(dif_regress_difference(a, b, 1e-3), 0.2 * want); /* in the dark */
}

static void test_regress__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_table a = make_table("-60:60:5", 0.0);
    double xyz[2][3] = {{1.0, 1.0, 1.0}, {0.5, 0.5, 0.5}};
    const int live = test_alloc_live();
    for (int form = 0; form < 3; form++)
        for (int k = 1; k <= 3; k++) {
            dif_regress r;
            dif_regress_peaks peaks;
            dif_regress_stat de;
            test_alloc_fail_from(k);
            const dif_status status = form == 0   ? dif_regress_tables(&a, &a, 1e-5, &r, NULL)
                                      : form == 1 ? dif_regress_peaks_of(&a, &a, 0.01, &peaks, NULL)
                                                  : dif_regress_colours(2, xyz, xyz, 1.0, &de, NULL);
            const int n_call = test_alloc_calls();
            test_alloc_fail_from(0);
            assert_int_equal(status, n_call >= k ? DIF_ERR_NOMEM : DIF_OK);
            assert_int_equal(test_alloc_live(), live);
        }
    dif_table_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values__known_errors_have_their_quantiles_and_place),
        cmocka_unit_test(test_values__relative_error_is_symmetric_and_floored),
        cmocka_unit_test(test_values__nan_on_one_side_is_counted_on_both_left_out),
        cmocka_unit_test(test_tables__a_mismatch_is_an_error),
        cmocka_unit_test(test_peaks__a_shift_is_found_and_a_lost_one_counted),
        cmocka_unit_test(test_colours__difference_is_that_of_exposed_colours),
        cmocka_unit_test(test_difference__light_beyond_white_is_dimmed_to_it),
        cmocka_unit_test(test_regress__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
