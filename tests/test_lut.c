#include "core/lut.h"

#include "alloc_count.h"
#include "core/direct.h"
#include "core/spectrum.h"
#include "core/units.h"
#include "rough.h"

enum { N_LAMBDA = 5 };
static const double LAMBDA_UM[N_LAMBDA] = {0.42, 0.48, 0.54, 0.6, 0.66};
static const double ALL[1] = {1.0};

static dif_lut_opts small_opts(void)
{
    dif_lut_opts opts = dif_lut_opts_default();
    opts.n_azimuth = 256;
    opts.n_radius = 40;
    return opts;
}

static dif_lut create(const dif_field *field, const dif_window *window, double tol, const dif_lut_opts *opts)
{
    dif_lut lut;
    dif_error err = {DIF_OK, ""};
    if (dif_lut_create(field, 1, window, ALL, N_LAMBDA, LAMBDA_UM, tol, opts, &lut, &err) != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(err.status, DIF_OK);
    return lut;
}

/* Full spectral sampling by the direct sum. */
static void truth(const dif_field *field, const dif_window *window, double u, double v, double w, double xyz[3])
{
    double weight[N_LAMBDA][3], amp[N_LAMBDA][2];
    dif_vec3 kappa[N_LAMBDA];
    assert_int_equal(dif_spectrum_weights(N_LAMBDA, LAMBDA_UM, weight, NULL), DIF_OK);
    for (int i = 0; i < N_LAMBDA; i++) {
        const double k = DIF_TWO_PI / LAMBDA_UM[i];
        kappa[i] = (dif_vec3){k * u, k * v, k * w};
    }
    assert_int_equal(dif_direct_amplitudes(field, window, N_LAMBDA, kappa, amp, NULL), DIF_OK);
    xyz[0] = xyz[1] = xyz[2] = 0.0;
    for (int i = 0; i < N_LAMBDA; i++)
        for (int c = 0; c < 3; c++)
            xyz[c] += weight[i][c] * (amp[i][0] * amp[i][0] + amp[i][1] * amp[i][1]);
}

/* Largest error at the table's own rows and columns, any w: the maps alone, without interpolation. */
static double error_at_texels(const dif_lut *lut, const dif_field *field, const dif_window *window)
{
    uint64_t random = 5;
    double worst = 0.0;
    for (int i = 0; i < 150; i++) {
        const int row = (int)test_random(&random, 0.0, lut->n_radius - 1.0);
        const int column = (int)test_random(&random, 0.0, lut->n_azimuth);
        const double s = dif_lut_radius(lut, row), turn = DIF_TWO_PI * column / lut->n_azimuth;
        const double u = s * cos(turn), v = s * sin(turn), w = -test_random(&random, 0.0, sqrt(4.0 - s * s));
        double got[3], want[3];
        dif_lut_eval(lut, u, v, w, got);
        truth(field, window, u, v, w, want);
        for (int c = 0; c < 3; c++)
            worst = fmax(worst, fabs(got[c] - want[c]));
    }
    return worst;
}

static void test_create__maps_meet_the_tolerance_at_the_texels(void **state)
{
    (void)state;
    dif_field field = test_rough_field(50, 41, 0.05, 0.06, 0.3, 3);
    const dif_window window = {DIF_WINDOW_GAUSS, 0.8, 0.0, 0.0};
    const dif_lut_opts opts = small_opts();
    int n_map_before = 0;
    for (double tol = 1e-2; tol > 5e-6; tol *= 0.1) {
        dif_lut lut = create(&field, &window, tol, &opts);
        const double worst = error_at_texels(&lut, &field, &window);
        print_message("tol %.0e: %d maps, error %.1e\n", tol, lut.n_map, worst);
        assert_at_most(worst, tol);
        assert_true(lut.n_map >= n_map_before);
        n_map_before = lut.n_map;
        dif_lut_free(&lut);
    }
    dif_field_free(&field);
}

static void test_create__finer_tables_interpolate_better(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 40, 0.05, 0.05, 0.2, 3);
    const dif_window window = {DIF_WINDOW_GAUSS, 0.6, 0.0, 0.0};
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
        dif_lut_opts opts = small_opts();
        uint64_t random = 9;
        opts.n_azimuth = fine ? 512 : 128;
        opts.n_radius = fine ? 120 : 30;
        dif_lut lut = create(&field, &window, 1e-5, &opts);
        error[fine] = 0.0;
        for (int i = 0; i < 150; i++) {
            const double s = test_random(&random, 0.0, 1.5), turn = test_random(&random, 0.0, DIF_TWO_PI);
            const double u = s * cos(turn), v = s * sin(turn), w = -test_random(&random, 0.0, sqrt(4.0 - s * s));
            double got[3], want[3];
            dif_lut_eval(&lut, u, v, w, got);
            truth(&field, &window, u, v, w, want);
            error[fine] += fabs(got[1] - want[1]) / 150.0;
        }
        dif_lut_free(&lut);
    }
    /* four times finer, linear interpolation: sixteen times better, but for rounding and the tolerance */
    print_message("mean error %.1e coarse, %.1e fine\n", error[0], error[1]);
    assert_at_most(error[1], error[0] / 8.0);
    dif_field_free(&field);
}

static void test_eval__mirror_is_white_at_the_mirror_direction(void **state)
{
    (void)state;
    dif_field field;
    const dif_window window = {DIF_WINDOW_GAUSS, 0.8, 0.0, 0.0};
    const dif_lut_opts opts = small_opts();
    double xyz[3], white[3];
    assert_int_equal(dif_field_create(48, 48, 0.05, 0.05, &field, NULL), DIF_OK);
    dif_lut lut = create(&field, &window, 1e-4, &opts);
    dif_spectrum_white(white);
    assert_int_equal(lut.n_map, 1);
    for (double w = 0.1; w < 2.0; w += 0.3) {
        dif_lut_eval(&lut, 0.0, 0.0, -w, xyz);
        for (int c = 0; c < 3; c++)
            assert_near(xyz[c], white[c], 1e-4, 0.0);
    }
    dif_lut_free(&lut);
    dif_field_free(&field);
}

static void test_create__source_blurs_and_keeps_the_sum(void **state)
{
    (void)state;
    dif_field field;
    const dif_window window = {DIF_WINDOW_GAUSS, 3.0, 0.0, 0.0};
    dif_lut_opts opts = small_opts();
    double sum[2] = {0.0, 0.0}, peak[2];
    opts.n_radius = 160;
    assert_int_equal(dif_field_create(400, 400, 0.05, 0.05, &field, NULL), DIF_OK);
    for (int disc = 0; disc < 2; disc++) {
        double xyz[3];
        opts.source_diameter_rad = disc ? 0.06 : 0.0;
        dif_lut lut = create(&field, &window, 1e-3, &opts);
        dif_lut_eval(&lut, 0.0, 0.0, -1.0, xyz);
        peak[disc] = xyz[1];
        for (int i = -100; i <= 100; i++)
            for (int j = -100; j <= 100; j++) {
                dif_lut_eval(&lut, i * 1e-3, j * 1e-3, -1.0, xyz);
                sum[disc] += xyz[1];
            }
        dif_lut_free(&lut);
    }
    assert_at_most(peak[1], 0.9 * peak[0]);
    /* a three-ring cubature and linear texels */
    assert_near(sum[1], sum[0], 0.01, 0.0);
    dif_field_free(&field);
}

static void test_create__windows_average(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 40, 0.05, 0.05, 0.2, 3);
    const dif_window windows[2] = {{DIF_WINDOW_GAUSS, 0.4, -0.3, 0.0}, {DIF_WINDOW_GAUSS, 0.4, 0.4, 0.1}};
    const double share[2] = {0.25, 0.75};
    const dif_lut_opts opts = small_opts();
    dif_lut lut;
    double got[3], a[3], b[3];
    assert_int_equal(dif_lut_create(&field, 2, windows, share, N_LAMBDA, LAMBDA_UM, 1e-5, &opts, &lut, NULL), DIF_OK);
    const double s = dif_lut_radius(&lut, 30);
    dif_lut_eval(&lut, s, 0.0, -0.9, got);
    truth(&field, windows, s, 0.0, -0.9, a);
    truth(&field, windows + 1, s, 0.0, -0.9, b);
    for (int c = 0; c < 3; c++)
        assert_near(got[c], 0.25 * a[c] + 0.75 * b[c], 0.0, 1e-5);
    dif_lut_free(&lut);
    dif_field_free(&field);
}

static void test_create__bad_arguments_have_their_codes(void **state)
{
    (void)state;
    dif_field field = test_rough_field(8, 8, 0.05, 0.05, 0.2, 3);
    const dif_window window = {.kind = DIF_WINDOW_FLAT};
    dif_lut_opts opts = small_opts(), bad = opts;
    dif_lut lut;
    dif_error err;
    assert_int_equal(dif_lut_create(&field, 1, &window, ALL, N_LAMBDA, LAMBDA_UM, 1e-9, &opts, &lut, &err),
                     DIF_ERR_TOL);
    assert_null(lut.coef);
    bad.n_azimuth = 8;
    assert_int_equal(dif_lut_create(&field, 1, &window, ALL, N_LAMBDA, LAMBDA_UM, 1e-3, &bad, &lut, &err), DIF_ERR_ARG);
    bad = opts;
    bad.n_map = 0;
    assert_int_equal(dif_lut_create(&field, 1, &window, ALL, N_LAMBDA, LAMBDA_UM, 1e-3, &bad, &lut, &err), DIF_ERR_ARG);
    bad = opts;
    bad.source_diameter_rad = -1.0;
    assert_int_equal(dif_lut_create(&field, 1, &window, ALL, N_LAMBDA, LAMBDA_UM, 1e-3, &bad, &lut, &err), DIF_ERR_ARG);
    assert_int_equal(dif_lut_create(&field, 0, &window, ALL, N_LAMBDA, LAMBDA_UM, 1e-3, &opts, &lut, &err),
                     DIF_ERR_ARG);
    dif_field_free(&field);
}

static void test_create__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field = test_rough_field(12, 12, 0.05, 0.05, 0.2, 4);
    const dif_window window = {.kind = DIF_WINDOW_FLAT};
    dif_lut_opts opts = dif_lut_opts_default();
    const int live = test_alloc_live();
    int n_failed = 0;
    opts.n_azimuth = 16;
    opts.n_radius = 8;
    opts.source_diameter_rad = 0.01;
    for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; n_failed++) {
        dif_lut lut = {0};
        test_alloc_fail_from(n_failed + 1);
        status = dif_lut_create(&field, 1, &window, ALL, N_LAMBDA, LAMBDA_UM, 1e-2, &opts, &lut, NULL);
        test_alloc_fail_from(0);
        assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
        dif_lut_free(&lut);
        assert_int_equal(test_alloc_live(), live);
    }
    assert_true(n_failed > 20);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_create__maps_meet_the_tolerance_at_the_texels),
        cmocka_unit_test(test_create__finer_tables_interpolate_better),
        cmocka_unit_test(test_eval__mirror_is_white_at_the_mirror_direction),
        cmocka_unit_test(test_create__source_blurs_and_keeps_the_sum),
        cmocka_unit_test(test_create__windows_average),
        cmocka_unit_test(test_create__bad_arguments_have_their_codes),
        cmocka_unit_test(test_create__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
