/* core/meso: slopes of tiles and their moments. */
#include "core/meso.h"

#include "core/units.h"
#include "tests/alloc_count.h"
#include "tests/near.h"

enum { N = 128 };

/* z = sum of two sines that repeat; slopes a cos and b cos. */
static void make_waves(double a, double b, int periods_x, int periods_y, dif_field *field)
{
    assert_int_equal(dif_field_create(N, N, 0.5, 0.5, field, NULL), DIF_OK);
    const double kx = DIF_TWO_PI * periods_x / (N * 0.5), ky = DIF_TWO_PI * periods_y / (N * 0.5);
    for (int iy = 0; iy < N; iy++)
        for (int ix = 0; ix < N; ix++)
            field->z_um[iy * N + ix] =
                a / kx * sin(kx * dif_field_x_um(field, ix)) + b / ky * sin(ky * dif_field_y_um(field, iy));
}

static dif_footprint square(double side)
{
    return (dif_footprint){.w1 = {side, 0.0}, .w2 = {0.0, side}};
}

static void test_moments__of_waves_seen_from_afar(void **state)
{
    (void)state;
    dif_field field;
    dif_meso meso;
    dif_slope_gauss g;
    make_waves(0.2, 0.1, 4, 8, &field);
    assert_int_equal(dif_meso_create(&field, 1.0, 3.0, &meso, NULL), DIF_OK);
    assert_int_equal(meso.nx, N);
    const double uv[2] = {0.37, -4.2};
    const dif_footprint wide = square(1.0); /* three tiles */
    assert_int_equal(dif_meso_moments(&meso, uv, &wide, &g), 1);
    /* a chord over two cells, linear between: at 16 samples a wave 7 % below the wave's own; and a seam */
    assert_near(g.mean_x, 0.0, 0.0, 2e-3);
    assert_near(g.var_x, 0.5 * 0.2 * 0.2, 0.03, 0.0);
    assert_near(g.var_y, 0.5 * 0.1 * 0.1, 0.08, 0.0);
    assert_near(g.cov_xy, 0.0, 0.0, 2e-4);
    dif_meso_free(&meso);
    dif_field_free(&field);
}

static void test_moments__of_small_footprints_are_the_slope(void **state)
{
    (void)state;
    dif_field field;
    dif_meso meso;
    uint64_t random = 5;
    make_waves(0.2, 0.1, 2, 3, &field);
    assert_int_equal(dif_meso_create(&field, 2.0, 3.0, &meso, NULL), DIF_OK);
    for (int k = 0; k < 200; k++) {
        dif_slope_gauss g;
        const double uv[2] = {test_random(&random, -2.0, 2.0), test_random(&random, -2.0, 2.0)};
        const dif_footprint tiny = square(0.2 / (3.0 * N));
        double s[2];
        dif_meso_slope(&meso, uv, s);
        dif_meso_moments(&meso, uv, &tiny, &g);
        assert_near(g.mean_x, s[0], 0.0, 1e-12);
        assert_near(g.mean_y, s[1], 0.0, 1e-12);
        assert_at_most(g.var_x, 5.3e-6); /* steepest: 0.4 2 pi 2 / N a texel, over 0.2 texels, squared, / 12 */
        /* and the slope is the wave's, x from the tile's left edge, y up from its bottom */
        const double x = 3.0 * uv[0], y = 3.0 * uv[1];
        if (fabs(x - rint(x)) > 0.02 && fabs(y - rint(y)) > 0.02) { /* the seam goes on as it was */
            assert_near(s[0], 0.4 * cos(DIF_TWO_PI * 2.0 * (x - 0.5)), 0.0, 4e-3);
            assert_near(s[1], 0.2 * cos(DIF_TWO_PI * 3.0 * (y - 0.5)), 0.0, 4e-3);
        }
    }
    dif_meso_free(&meso);
    dif_field_free(&field);
}

/* What 400 samples of a footprint have: mean and variance of the slope along x. */
static void sample_slopes(const dif_meso *meso, const double uv[2], const dif_footprint *f, uint64_t *random,
                          double *mean, double *variance)
{
    double sum = 0.0, square = 0.0;
    for (int k = 0; k < 400; k++) {
        const double x = (k % 20 + test_random(random, 0.0, 1.0)) / 20.0 - 0.5;
        const double y = (k / 20 + test_random(random, 0.0, 1.0)) / 20.0 - 0.5;
        const double at[2] = {uv[0] + x * f->w1[0] + y * f->w2[0], uv[1] + x * f->w1[1] + y * f->w2[1]};
        double s[2];
        dif_meso_slope(meso, at, s);
        sum += s[0] / 400.0;
        square += s[0] * s[0] / 400.0;
    }
    *mean = sum;
    *variance = square - sum * sum;
}

/* Near the size of a texel mean squares read linearly would have two to three times the variance. */
static void test_moments__of_a_footprint_are_those_of_its_slopes(void **state)
{
    (void)state;
    dif_field field;
    dif_meso meso;
    uint64_t random = 21;
    make_waves(0.2, 0.1, 8, 5, &field);
    assert_int_equal(dif_meso_create(&field, 1.0, 1.0, &meso, NULL), DIF_OK);
    for (double side = 0.35; side < 4.0; side *= 1.4) {
        double spread[2] = {0.0}, off = 0.0, means = 0.0;
        for (int k = 0; k < 300; k++) {
            const double uv[2] = {test_random(&random, 0.0, 1.0), test_random(&random, 0.0, 1.0)};
            const double a = test_random(&random, 0.0, DIF_TWO_PI), w = side / N, h = 1.7 * side / N;
            const dif_footprint f = {.w1 = {w * cos(a), w * sin(a)}, .w2 = {-h * sin(a), h * cos(a)}};
            double mean, variance;
            dif_slope_gauss g;
            dif_meso_moments(&meso, uv, &f, &g);
            sample_slopes(&meso, uv, &f, &random, &mean, &variance);
            spread[0] += g.var_x;
            spread[1] += variance;
            off += (g.mean_x - mean) * (g.mean_x - mean);
            means += mean * mean;
        }
        /* up to a quarter of a wave by almost half of one: blocks are square, and level is not width */
        assert_near(spread[0], spread[1], 0.05, 0.0);
        assert_at_most(sqrt(off), 0.03 * sqrt(means));
    }
    dif_meso_free(&meso);
    dif_field_free(&field);
}

/* A long footprint across the waves sees their variance, along them one slope. */
static void test_moments__follow_the_longer_axis(void **state)
{
    (void)state;
    dif_field field;
    dif_meso meso;
    make_waves(0.2, 0.0001, 8, 1, &field);
    assert_int_equal(dif_meso_create(&field, 1.0, 1.0, &meso, NULL), DIF_OK);
    const double uv[2] = {0.5, 0.5}; /* on a crest of the slope */
    const dif_footprint across = {.w1 = {16.0 / N, 0.0}, .w2 = {0.0, 1.0 / N}};
    const dif_footprint along = {.w1 = {1.0 / N, 0.0}, .w2 = {0.0, 16.0 / N}};
    dif_slope_gauss g;
    assert_int_equal(dif_meso_moments(&meso, uv, &across, &g), 16);
    assert_near(g.var_x, 0.5 * 0.2 * 0.2, 0.1, 0.0);
    assert_near(g.mean_x, 0.0, 0.0, 0.01);
    assert_int_equal(dif_meso_moments(&meso, uv, &along, &g), 16);
    assert_at_most(g.var_x, 0.02 * 0.2 * 0.2);
    assert_near(g.mean_x, 0.2, 0.06, 0.0);
    dif_meso_free(&meso);
    dif_field_free(&field);
}

static void test_moments__are_always_a_gaussian(void **state)
{
    (void)state;
    dif_field field;
    dif_meso meso;
    dif_error err;
    uint64_t random = 11;
    assert_int_equal(dif_field_create(37, 21, 0.5, 0.25, &field, NULL), DIF_OK);
    for (int i = 0; i < 37 * 21; i++)
        field.z_um[i] = test_random(&random, 0.0, 0.3);
    assert_int_equal(dif_meso_create(&field, 1.0, 2.0, &meso, NULL), DIF_OK);
    for (int k = 0; k < 2000; k++) {
        dif_slope_gauss g;
        const double uv[2] = {test_random(&random, -2.0, 2.0), test_random(&random, -2.0, 2.0)};
        const double size = exp(test_random(&random, -12.0, 3.0));
        const dif_footprint f = {
            .w1 = {size * test_random(&random, -1.0, 1.0), size * test_random(&random, -1.0, 1.0)},
            .w2 = {size * test_random(&random, -1.0, 1.0), size * test_random(&random, -1.0, 1.0)}};
        const int n = dif_meso_moments(&meso, uv, &f, &g);
        assert_true(n >= 1 && n <= 2 * DIF_MESO_PROBES);
        assert_int_equal(dif_slope_check(&g, &err), DIF_OK);
    }
    const double uv[2] = {0.1, 0.2};
    const dif_footprint none = square(0.0);
    dif_slope_gauss g;
    assert_int_equal(dif_meso_moments(&meso, uv, &none, &g), 1);
    assert_int_equal(dif_slope_check(&g, &err), DIF_OK);
    dif_meso_free(&meso);
    dif_field_free(&field);
}

static void test_create__refuses(void **state)
{
    (void)state;
    dif_field field;
    dif_meso meso;
    dif_error err;
    assert_int_equal(dif_field_create(3, 1, 1.0, 1.0, &field, NULL), DIF_OK);
    assert_int_equal(dif_meso_create(&field, 1.0, 1.0, &meso, &err), DIF_ERR_SIZE);
    assert_string_equal(err.text, "mesostructure of 3 x 1 samples, want at least 2 x 2");
    dif_field_free(&field);
    assert_int_equal(dif_field_create(4, 4, 1.0, 1.0, &field, NULL), DIF_OK);
    assert_int_equal(dif_meso_create(&field, NAN, 1.0, &meso, &err), DIF_ERR_ARG);
    assert_int_equal(dif_meso_create(&field, 1.0, 0.0, &meso, &err), DIF_ERR_ARG);
    const int live = test_alloc_live();
    test_alloc_fail_from(1);
    assert_int_equal(dif_meso_create(&field, 1.0, 1.0, &meso, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    assert_int_equal(test_alloc_live(), live);
    assert_null(meso.moment[0]);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moments__of_waves_seen_from_afar),
        cmocka_unit_test(test_moments__of_small_footprints_are_the_slope),
        cmocka_unit_test(test_moments__of_a_footprint_are_those_of_its_slopes),
        cmocka_unit_test(test_moments__follow_the_longer_axis),
        cmocka_unit_test(test_moments__are_always_a_gaussian),
        cmocka_unit_test(test_create__refuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
