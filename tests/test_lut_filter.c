/* core/lut_filter: against dense sums of the table itself. */
#include "core/lut_filter.h"

#include "core/alloc.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "tests/alloc_count.h"
#include "tests/near.h"

static void make_table(dif_lut *lut)
{
    dif_surface surface = dif_surface_default(DIF_SURFACE_XENOPELTIS);
    dif_window window = {.kind = DIF_WINDOW_GAUSS, .sigma_um = 4.0};
    dif_lut_opts opts = dif_lut_opts_default();
    dif_field field;
    double lambda_um[17];
    const double share = 1.0;
    surface.nx = surface.ny = 192;
    surface.pitch_um = 0.1;
    opts.n_azimuth = 512;
    opts.n_radius = 128;
    for (int i = 0; i < 17; i++)
        lambda_um[i] = 0.38 + 0.025 * i;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    assert_int_equal(dif_lut_create(&field, 1, &window, &share, 17, lambda_um, 1e-4, &opts, lut, NULL), DIF_OK);
    dif_field_free(&field);
}

/* The Gaussian's mean by a grid of 161 x 161 over +- 4 standard deviations. */
static void dense(const dif_lut *lut, double u, double v, double w, const double cov[3], double xyz[3])
{
    enum { SIDE = 161 };
    const double l = sqrt(cov[0]), m = cov[2] / l, k = sqrt(fmax(cov[1] - m * m, 0.0)); /* Cholesky */
    double sum = 0.0;
    xyz[0] = xyz[1] = xyz[2] = 0.0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double a = 8.0 * (i % SIDE) / (SIDE - 1.0) - 4.0, b = 8.0 * (i / SIDE) / (SIDE - 1.0) - 4.0;
        const double weight = exp(-0.5 * (a * a + b * b));
        double here[3];
        dif_lut_eval(lut, u + l * a, v + m * a + k * b, w, here);
        for (int c = 0; c < 3; c++)
            xyz[c] += weight * here[c];
        sum += weight;
    }
    for (int c = 0; c < 3; c++)
        xyz[c] /= sum;
}

static void test_eval__narrow_gaussians_read_the_table(void **state)
{
    const dif_lut *lut = *state;
    dif_lut_filter filter;
    uint64_t random = 3;
    assert_int_equal(dif_lut_filter_create(lut, 256, &filter, NULL), DIF_OK);
    for (int k = 0; k < 50; k++) {
        const double u = test_random(&random, -1.0, 1.0), v = test_random(&random, -1.0, 1.0), w = -1.2;
        const double cov[3] = {1e-12, 1e-12, 0.0}, zero[3] = {0.0, 0.0, 0.0};
        double got[3], want[3];
        dif_lut_eval(lut, u, v, w, want);
        assert_int_equal(dif_lut_filter_eval(&filter, u, v, w, cov, got), 1);
        for (int c = 0; c < 3; c++)
            assert_near(got[c], want[c], 1e-12, 0.0);
        assert_int_equal(dif_lut_filter_eval(&filter, u, v, w, zero, got), 1);
        for (int c = 0; c < 3; c++)
            assert_near(got[c], want[c], 1e-12, 0.0);
    }
    dif_lut_filter_free(&filter);
}

static void test_eval__agrees_with_dense_sums(void **state)
{
    const dif_lut *lut = *state;
    dif_lut_filter filter;
    uint64_t random = 17;
    double mean_error = 0.0, mean_unfiltered = 0.0, worst = 0.0;
    const int n = 200;
    assert_int_equal(dif_lut_filter_create(lut, 512, &filter, NULL), DIF_OK);
    for (int k = 0; k < n; k++) {
        const double s = test_random(&random, 0.0, 1.2), turn = test_random(&random, 0.0, DIF_TWO_PI);
        const double u = s * cos(turn), v = s * sin(turn), w = -test_random(&random, 0.9, 1.5);
        const double major = exp(test_random(&random, log(0.01), log(0.2)));
        const double minor = major * test_random(&random, 0.3, 1.0), angle = test_random(&random, 0.0, DIF_PI);
        const double c = cos(angle), d = sin(angle), a2 = major * major, b2 = minor * minor;
        const double cov[3] = {c * c * a2 + d * d * b2, d * d * a2 + c * c * b2, c * d * (a2 - b2)};
        double got[3], want[3], plain[3];
        dense(lut, u, v, w, cov, want);
        assert_at_most(1, dif_lut_filter_eval(&filter, u, v, w, cov, got));
        dif_lut_eval(lut, u, v, w, plain);
        const double error = fabs(got[1] - want[1]) / want[1];
        mean_error += error / n;
        mean_unfiltered += fabs(plain[1] - want[1]) / want[1] / n;
        worst = fmax(worst, error);
    }
    print_message("spot: radius %.4f, width %.4f; ", filter.spot_radius, sqrt(filter.spot_variance));
    print_message("mean relative error %.3f (unfiltered %.3f), worst %.3f\n", mean_error, mean_unfiltered, worst);
    /* what probes and texels do to the tails of Gaussians beside the mirror's spot, which is 1e4 times brighter */
    assert_at_most(mean_error, 0.08);
    assert_at_most(worst, 1.5); /* between table and pyramid, where probes may meet the spot or miss it */
    assert_at_most(4.0 * mean_error, mean_unfiltered);
    dif_lut_filter_free(&filter);
}

static void test_probes__have_the_variance(void **state)
{
    (void)state;
    uint64_t random = 23;
    for (int k = 0; k < 500; k++) {
        const double major = 0.2, minor = test_random(&random, 0.06, 0.2), angle = test_random(&random, -2.0, 2.0);
        const double c = cos(angle), d = sin(angle), a2 = major * major, b2 = minor * minor;
        const double cov[3] = {c * c * a2 + d * d * b2, d * d * a2 + c * c * b2, c * d * (a2 - b2)};
        dif_lut_probes p;
        double sum = 0.0, along = 0.0, across = 0.0;
        dif_lut_filter_probes(512, cov, &p);
        for (int i = 0; i < p.n; i++) {
            const double x = c * p.offset[i][0] + d * p.offset[i][1], y = -d * p.offset[i][0] + c * p.offset[i][1];
            sum += p.weight[i];
            along += p.weight[i] * x * x;
            across += p.weight[i] * y * y;
        }
        assert_near(sum, 1.0, 1e-12, 0.0);
        assert_near(across, 0.0, 0.0, 1e-12);
        if (p.n > 1)
            assert_near(along, a2 - b2, 1e-9, 1e-12);
        assert_near(pow(2.0, p.level) * 4.0 / 512.0, 2.0 * minor, 1e-9, 0.0);
    }
}

static void test_eval__a_constant_table_stays_constant(void **state)
{
    (void)state;
    dif_lut lut = {.n_azimuth = 16, .n_radius = 8, .n_map = 2, .s0 = 0.1};
    dif_lut_filter filter;
    uint64_t random = 29;
    lut.coef = dif_alloc(16 * 8 * 2 * 3, sizeof *lut.coef);
    for (int i = 0; i < 16 * 8; i++)
        for (int c = 0; c < 3; c++)
            lut.coef[6 * i + c] = 0.5F + (float)c;
    assert_int_equal(dif_lut_filter_create(&lut, 32, &filter, NULL), DIF_OK);
    for (int k = 0; k < 100; k++) {
        const double a = exp(test_random(&random, -12.0, 2.0)), b = exp(test_random(&random, -12.0, 2.0));
        const double cov[3] = {a, b, test_random(&random, -0.99, 0.99) * sqrt(a * b)};
        double xyz[3];
        dif_lut_filter_eval(&filter, test_random(&random, -2.0, 2.0), test_random(&random, -2.0, 2.0), -0.3, cov, xyz);
        for (int c = 0; c < 3; c++)
            assert_near(xyz[c], 0.5 + c, 1e-6, 0.0);
    }
    dif_lut_filter_free(&filter);
    dif_lut_free(&lut);
}

static void test_create__refuses_and_gives_back(void **state)
{
    const dif_lut *lut = *state;
    dif_lut_filter filter;
    dif_error err;
    assert_int_equal(dif_lut_filter_create(lut, 100, &filter, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "a pyramid of side 100, want a power of two of 16 ... 2048");
    const int live = test_alloc_live();
    test_alloc_fail_from(1);
    assert_int_equal(dif_lut_filter_create(lut, 64, &filter, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    assert_int_equal(test_alloc_live(), live);
    assert_null(filter.coef[0]);
}

static dif_lut table;

static int set_up(void **state)
{
    make_table(&table);
    *state = &table;
    return 0;
}

static int tear_down(void **state)
{
    dif_lut_free(*state);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_eval__narrow_gaussians_read_the_table),
        cmocka_unit_test(test_eval__agrees_with_dense_sums),
        cmocka_unit_test(test_probes__have_the_variance),
        cmocka_unit_test(test_eval__a_constant_table_stays_constant),
        cmocka_unit_test(test_create__refuses_and_gives_back),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
