#include "bench/lut_check.h"

#include "alloc_count.h"
#include "core/units.h"
#include "rough.h"

enum { N_LAMBDA = 5 };
static const double LAMBDA_UM[N_LAMBDA] = {0.42, 0.48, 0.54, 0.6, 0.66};

static dif_measure_opts make_opts(dif_average average)
{
    dif_measure_opts opts = dif_measure_opts_default();
    opts.sigma_um = 0.7;
    opts.average = average;
    return opts;
}

static dif_lut_check check(const dif_field *field, int fine, double source_rad, const dif_measure_opts *opts)
{
    dif_lut_opts how = dif_lut_opts_default();
    dif_lut_check out;
    dif_lut lut;
    int n_window = 0;
    how.n_azimuth = 128 * fine;
    how.n_radius = 48 * fine;
    how.source_diameter_rad = source_rad;
    assert_int_equal(dif_lut_measure(field, N_LAMBDA, LAMBDA_UM, 1e-5, opts, &how, &lut, &n_window, NULL), DIF_OK);
    assert_int_equal(n_window > 1, opts->average == DIF_AVERAGE_WELCH);
    assert_int_equal(dif_lut_check_random(field, &lut, N_LAMBDA, LAMBDA_UM, source_rad, opts, 200, 1, &out, NULL),
                     DIF_OK);
    dif_lut_free(&lut);
    return out;
}

/* Interpolation is linear: four times finer is sixteen times better, but for tol. Also with several windows and with a
 * source of 3 degrees, whose blur the table makes of other points than the check does. */
static void test_check__finer_tables_come_nearer(void **state)
{
    (void)state;
    dif_field field = test_rough_field(80, 70, 0.05, 0.06, 0.2, 3);
    static const dif_average AVERAGES[] = {DIF_AVERAGE_NONE, DIF_AVERAGE_WELCH, DIF_AVERAGE_NONE};
    static const double SOURCES_DEG[] = {0.0, 0.0, 3.0};
    for (int i = 0; i < 3; i++) {
        const dif_measure_opts opts = make_opts(AVERAGES[i]);
        const double source_rad = dif_rad_from_deg(SOURCES_DEG[i]);
        const dif_lut_check coarse = check(&field, 1, source_rad, &opts), fine = check(&field, 4, source_rad, &opts);
        print_message("of the brightest: median %.1e coarse, %.1e fine; CIEDE2000 p95 %.2f, %.2f\n",
                      coarse.of_peak.median, fine.of_peak.median, coarse.de.p95, fine.de.p95);
        assert_at_most(fine.of_peak.median, coarse.of_peak.median / 5.0);
        assert_at_most(fine.of_peak.worst, 0.02);
        assert_at_most(fine.de.p95, 1.0);
        assert_true(fine.de.median <= fine.de.p95 && fine.de.p95 <= fine.de.worst);
    }
    dif_field_free(&field);
}

/* The check must see a table that is wrong: one of another surface. */
static void test_check__another_surface_is_seen(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 40, 0.05, 0.05, 0.2, 3),
              other = test_rough_field(40, 40, 0.05, 0.05, 0.2, 4);
    const dif_measure_opts opts = make_opts(DIF_AVERAGE_NONE);
    dif_lut_opts how = dif_lut_opts_default();
    dif_lut_check out;
    dif_lut lut;
    int n_window = 0;
    how.n_azimuth = 256;
    how.n_radius = 64;
    assert_int_equal(dif_lut_measure(&other, N_LAMBDA, LAMBDA_UM, 1e-4, &opts, &how, &lut, &n_window, NULL), DIF_OK);
    assert_int_equal(dif_lut_check_random(&field, &lut, N_LAMBDA, LAMBDA_UM, 0.0, &opts, 100, 1, &out, NULL), DIF_OK);
    print_message("another surface: CIEDE2000 p95 %.1f, relative median %.2f\n", out.de.p95, out.relative.median);
    assert_true(out.de.p95 > 5.0 && out.relative.median > 0.2);
    assert_int_equal(dif_lut_check_random(&field, &lut, N_LAMBDA, LAMBDA_UM, 0.0, &opts, 0, 1, &out, NULL),
                     DIF_ERR_ARG);
    dif_lut_free(&lut);
    dif_field_free(&field);
    dif_field_free(&other);
}

static void test_check__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field = test_rough_field(12, 12, 0.05, 0.05, 0.2, 4);
    const dif_measure_opts opts = make_opts(DIF_AVERAGE_NONE);
    dif_lut_opts how = dif_lut_opts_default();
    dif_lut lut;
    int n_window = 0, n_failed = 0;
    how.n_azimuth = 16;
    how.n_radius = 8;
    assert_int_equal(dif_lut_measure(&field, N_LAMBDA, LAMBDA_UM, 1e-2, &opts, &how, &lut, &n_window, NULL), DIF_OK);
    const int live = test_alloc_live();
    for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; n_failed++) {
        dif_lut_check out;
        test_alloc_fail_from(n_failed + 1);
        status = dif_lut_check_random(&field, &lut, N_LAMBDA, LAMBDA_UM, 0.0, &opts, 5, 1, &out, NULL);
        test_alloc_fail_from(0);
        assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
        assert_int_equal(test_alloc_live(), live);
    }
    assert_true(n_failed > 10);
    dif_lut_free(&lut);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_check__finer_tables_come_nearer),
        cmocka_unit_test(test_check__another_surface_is_seen),
        cmocka_unit_test(test_check__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
