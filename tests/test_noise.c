#include "tests/near.h"

#include "fixtures/noise.h"

static void test_unit__is_uniform_and_depends_on_everything(void **state)
{
    (void)state;
    double sum = 0.0, sum2 = 0.0, neighbours = 0.0;
    for (int j = -100; j < 100; j++) {
        for (int i = -100; i < 100; i++) {
            const double u = dif_noise_unit(9, 2, i, j);
            assert_at_most(0.0, u);
            assert_true(u < 1.0);
            sum += u;
            sum2 += u * u;
            neighbours += (u - 0.5) * (dif_noise_unit(9, 2, i + 1, j) - 0.5);
        }
    }
    /* 40000 values: four deviations of the mean, the mean square and the product of neighbours */
    assert_near(sum / 40000, 0.5, 0.0, 4.0 * 0.2887 / 200);
    assert_near(sum2 / 40000, 1.0 / 3.0, 0.0, 4.0 * 0.2981 / 200);
    assert_near(neighbours / 40000, 0.0, 0.0, 4.0 / 12.0 / 200);
    const double u = dif_noise_unit(9, 2, 3, 4);
    assert_near(dif_noise_unit(9, 2, 3, 4), u, 0.0, 0.0);
    assert_true(dif_noise_unit(8, 2, 3, 4) != u);
    assert_true(dif_noise_unit(9, 1, 3, 4) != u);
    assert_true(dif_noise_unit(9, 2, 4, 3) != u);
    assert_true(dif_noise_unit(9, 2, -3, 4) != u);
}

static void test_normal__has_unit_deviation(void **state)
{
    (void)state;
    double sum = 0.0, sum2 = 0.0, sum4 = 0.0;
    for (int i = 0; i < 40000; i++) {
        const double g = dif_noise_normal(1, 0, i % 200, i / 200);
        assert_true(isfinite(g));
        sum += g;
        sum2 += g * g;
        sum4 += g * g * g * g;
    }
    /* four deviations of each moment of a normal variable: 1, 2, 96 over the count */
    assert_near(sum / 40000, 0.0, 0.0, 4.0 / 200);
    assert_near(sum2 / 40000, 1.0, 0.0, 4.0 * sqrt(2.0) / 200);
    assert_near(sum4 / 40000, 3.0, 0.0, 4.0 * sqrt(96.0) / 200);
}

static void test_smooth__has_unit_deviation_over_places(void **state)
{
    (void)state;
    uint64_t random = 17;
    double sum = 0.0, sum2 = 0.0;
    for (int i = 0; i < 40000; i++) {
        const double v = dif_noise_smooth(5, 3, test_random(&random, -4e3, 4e3), test_random(&random, -4e3, 4e3));
        sum += v;
        sum2 += v * v;
    }
    assert_near(sum / 40000, 0.0, 0.0, 4.0 / 200);
    assert_near(sum2 / 40000, 1.0, 0.0, 4.0 * sqrt(2.0) / 200); /* a sum of uniforms has a smaller fourth moment */
}

/* Value, slope and curvature are the same from both sides of a knot. */
static void test_smooth__is_twice_differentiable_at_knots(void **state)
{
    (void)state;
    const double h = 1e-3;
    for (int knot = -3; knot <= 3; knot++) {
        double left[3], right[3];
        for (int k = 0; k < 3; k++) {
            left[k] = dif_noise_smooth(5, 3, knot - k * h - 1e-12, 0.3);
            right[k] = dif_noise_smooth(5, 3, knot + k * h, 0.3);
        }
        assert_near(left[0], right[0], 0.0, 1e-9);
        const double slope_l = (3.0 * left[0] - 4.0 * left[1] + left[2]) / (2.0 * h);
        const double slope_r = (-3.0 * right[0] + 4.0 * right[1] - right[2]) / (2.0 * h);
        assert_near(slope_l, slope_r, 0.0, 3e-5); /* h^2/3 of third derivatives up to 40 */
        const double bend_l = (left[0] - 2.0 * left[1] + left[2]) / (h * h);
        const double bend_r = (right[0] - 2.0 * right[1] + right[2]) / (h * h);
        assert_near(bend_l, bend_r, 0.0, 0.1); /* h times a jump of third derivatives below 100 */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_unit__is_uniform_and_depends_on_everything),
        cmocka_unit_test(test_normal__has_unit_deviation),
        cmocka_unit_test(test_smooth__has_unit_deviation_over_places),
        cmocka_unit_test(test_smooth__is_twice_differentiable_at_knots),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
