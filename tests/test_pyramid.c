#include "core/pyramid.h"

#include "alloc_count.h"
#include "near.h"
#include "rough.h"

static dif_pyramid pyramid_of(const dif_field *field)
{
    dif_pyramid p;
    assert_int_equal(dif_pyramid_create(field, 0.0, 1.0, &p, NULL), DIF_OK);
    return p;
}

static void test_create__top_is_the_whole_field(void **state)
{
    (void)state;
    static const int sizes[][2] = {{1, 1}, {64, 64}, {37, 50}, {1, 9}, {100, 33}};
    for (int i = 0; i < 5; i++) {
        dif_field field = test_rough_field(sizes[i][0], sizes[i][1], 0.1, 0.1, 0.8, 3);
        dif_pyramid p = pyramid_of(&field);
        double mean = 0.0, square = 0.0;
        for (size_t k = 0; k < dif_field_n(&field); k++) {
            mean += field.z_um[k];
            square += field.z_um[k] * field.z_um[k];
        }
        const int top = p.n_level - 1;
        assert_int_equal(p.nx[top] * p.ny[top], 1);
        assert_near((double)p.moment[top][0], mean / (double)dif_field_n(&field), 1e-6, 0.0); /* float */
        assert_near((double)p.moment[top][1], square / (double)dif_field_n(&field), 1e-6, 0.0);
        dif_pyramid_free(&p);
        dif_field_free(&field);
    }
}

static void test_create__block_is_the_mean_of_its_samples(void **state)
{
    (void)state;
    dif_field field = test_rough_field(13, 9, 0.1, 0.1, 0.8, 5);
    dif_pyramid p = pyramid_of(&field);
    assert_int_equal(p.nx[2], 4);
    assert_int_equal(p.ny[2], 3);
    double mean = 0.0; /* block (3, 2) of level 2: the corner sample alone */
    assert_near((double)p.moment[2][2 * (2 * 4 + 3)], field.z_um[8 * 13 + 12], 1e-6, 0.0);
    for (int k = 0; k < 16; k++)
        mean += field.z_um[(4 + k / 4) * 13 + 4 + k % 4] / 16.0;
    assert_near((double)p.moment[2][2 * (1 * 4 + 1)], mean, 1e-6, 0.0);
    dif_pyramid_free(&p);
    dif_field_free(&field);
}

static void test_height__is_linear_between_samples(void **state)
{
    (void)state;
    dif_field field = test_rough_field(6, 5, 0.1, 0.1, 0.8, 5);
    dif_pyramid p = pyramid_of(&field);
    const double *z = field.z_um;
    assert_near(dif_pyramid_height(&p, 2.0, 3.0), z[3 * 6 + 2], 1e-6, 0.0);
    assert_near(dif_pyramid_height(&p, 2.5, 3.0), 0.5 * (z[3 * 6 + 2] + z[3 * 6 + 3]), 1e-6, 0.0);
    assert_near(dif_pyramid_height(&p, 2.25, 3.5),
                0.375 * (z[3 * 6 + 2] + z[4 * 6 + 2]) + 0.125 * (z[3 * 6 + 3] + z[4 * 6 + 3]), 1e-6, 0.0);
    assert_near(dif_pyramid_height(&p, -7.0, 99.0), z[4 * 6], 1e-6, 0.0);
    dif_pyramid_free(&p);
    dif_field_free(&field);
}

/* Moments of the samples in a square of side `side` around sample (u, v), by plain sums. */
static void moments_of(const dif_field *field, double u, double v, double side, double *mean, double *sigma)
{
    double n = 0.0, sum = 0.0, square = 0.0;
    for (int iy = 0; iy < field->ny; iy++)
        for (int ix = 0; ix < field->nx; ix++)
            if (fabs(ix - u) < 0.5 * side && fabs(iy - v) < 0.5 * side) {
                const double z = field->z_um[iy * field->nx + ix];
                n++;
                sum += z;
                square += z * z;
            }
    *mean = sum / n;
    *sigma = sqrt(square / n - *mean * *mean);
}

static void test_footprint__has_the_moments_of_its_heights(void **state)
{
    (void)state;
    dif_field field = test_rough_field(256, 256, 0.1, 0.1, 0.8, 11);
    dif_pyramid p = pyramid_of(&field);
    static const double sides[] = {8.0, 11.0, 16.0, 50.0, 128.0};
    for (int i = 0; i < 5; i++) {
        const dif_footprint f = dif_footprint_rectangle(sides[i], sides[i], 1e9);
        double mean, sigma, want_mean, want_sigma;
        const int n = dif_pyramid_footprint(&p, 127.5, 127.5, &f, 4, &mean, &sigma);
        moments_of(&field, 127.5, 127.5, sides[i], &want_mean, &want_sigma);
        /* white heights are the hardest: a footprint's blurred rim holds about 2 / n_across of its area, and the means
         * of both differ by the noise of so many samples */
        const double noise = want_sigma / sides[i];
        assert_near(mean, want_mean, 0.0, 1.5 * noise);
        assert_near(sigma, want_sigma, 0.0, 1.5 * noise);
        assert_in_range(n, 16, 81);
    }
    dif_pyramid_free(&p);
    dif_field_free(&field);
}

static void test_footprint__ramp_has_the_spread_of_a_parallelogram(void **state)
{
    (void)state;
    dif_field field;
    assert_int_equal(dif_field_create(512, 512, 1.0, 1.0, &field, NULL), DIF_OK);
    for (int i = 0; i < 512 * 512; i++)
        field.z_um[i] = (i % 512 + 0.5 * (i / 512)) / 800.0;
    dif_pyramid p = pyramid_of(&field);
    const dif_footprint f = {{60.0, 25.0}, {-10.0, 20.0}, false};
    double mean, sigma;
    assert_true(dif_pyramid_footprint(&p, 250.0, 240.0, &f, 8, &mean, &sigma) >= 64);
    /* uniform along each vector: variance (g.w)^2 / 12 each; blocks and their blur add and take away little */
    const double g1 = (60.0 + 0.5 * 25.0) / 800.0, g2 = (-10.0 + 0.5 * 20.0) / 800.0;
    assert_near(mean, 370.0 / 800.0, 1e-5, 0.0);
    assert_near(sigma, sqrt((g1 * g1 + g2 * g2) / 12.0), 0.01, 0.0);
    dif_pyramid_free(&p);
    dif_field_free(&field);
}

static void test_footprint__below_a_sample_sees_no_spread(void **state)
{
    (void)state;
    dif_field field = test_rough_field(20, 20, 0.1, 0.1, 0.8, 11);
    dif_pyramid p = pyramid_of(&field);
    const dif_footprint f = dif_footprint_rectangle(1e-3, 1e-3, 1e9);
    double mean, sigma;
    assert_int_equal(dif_pyramid_footprint(&p, 7.3, 9.6, &f, 4, &mean, &sigma), 16);
    assert_near(mean, dif_pyramid_height(&p, 7.3, 9.6), 0.0, 1e-6);
    assert_near(sigma, 0.0, 0.0, 1e-3);
    dif_pyramid_free(&p);
    dif_field_free(&field);
}

static void test_footprint__huge_ones_end_at_the_mean(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 40, 0.1, 0.1, 0.8, 11);
    dif_pyramid p = pyramid_of(&field);
    const dif_footprint f = dif_footprint_rectangle(1e9, 1e9, 1e8);
    double mean, sigma;
    assert_int_equal(dif_pyramid_footprint(&p, 20.0, 20.0, &f, 4, &mean, &sigma), 64 * 64);
    assert_near(mean, (double)p.moment[p.n_level - 1][0], 1e-6, 0.0);
    dif_pyramid_free(&p);
    dif_field_free(&field);
}

static void test_create__bad_input_is_refused(void **state)
{
    (void)state;
    dif_error err;
    dif_pyramid p;
    dif_field field = test_rough_field(4, 4, 0.1, 0.1, 0.8, 11);
    assert_int_equal(dif_pyramid_create(&field, 1.0, 1.0, &p, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "heights 1 ... 1 um, want a range");
    test_alloc_fail_from(1);
    assert_int_equal(dif_pyramid_create(&field, 0.0, 1.0, &p, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    assert_int_equal(p.n_level, 0);
    field.z_um[5] = NAN;
    assert_int_equal(dif_pyramid_create(&field, 0.0, 1.0, &p, &err), DIF_ERR_NONFINITE);
    dif_field_free(&field);
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_create__top_is_the_whole_field),
        cmocka_unit_test(test_create__block_is_the_mean_of_its_samples),
        cmocka_unit_test(test_height__is_linear_between_samples),
        cmocka_unit_test(test_footprint__has_the_moments_of_its_heights),
        cmocka_unit_test(test_footprint__ramp_has_the_spread_of_a_parallelogram),
        cmocka_unit_test(test_footprint__below_a_sample_sees_no_spread),
        cmocka_unit_test(test_footprint__huge_ones_end_at_the_mean),
        cmocka_unit_test(test_create__bad_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
