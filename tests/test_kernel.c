#include "core/kernel.h"

#include "core/units.h"
#include "near.h"

/* The promise of the module: reproducing exp(i xi x) from bins, at offsets and positions of no special kind. */
static double interpolation_error(const dif_kernel *kernel, double at, double xi)
{
    double tap[DIF_KERNEL_WIDTH_MAX], re = 0.0, im = 0.0;
    const double first = ceil(at - 0.5 * kernel->width);
    dif_kernel_taps(kernel, at - first - 0.5 * (kernel->width - 1), tap);
    for (int i = 0; i < kernel->width; i++) {
        re += tap[i] * cos(xi * (first + i));
        im += tap[i] * sin(xi * (first + i));
    }
    const double gain = 1.0 / dif_kernel_transform(kernel, xi);
    return hypot(re * gain - cos(xi * at), im * gain - sin(xi * at));
}

static void test_make__bound_is_met_and_holds(void **state)
{
    (void)state;
    uint64_t random = 1;
    double worst_share = 0.0;
    for (double sigma = 1.5; sigma <= 3.0; sigma += 0.5)
        for (double tol = 1e-1; tol > 1e-13; tol *= 0.1) {
            const dif_kernel kernel = dif_kernel_make(tol, sigma);
            if (kernel.width < DIF_KERNEL_WIDTH_MAX)
                assert_at_most(kernel.bound, tol);
            for (int i = 0; i < 400; i++) {
                const double xi = DIF_PI / sigma * test_random(&random, -1.0, 1.0);
                const double error = interpolation_error(&kernel, test_random(&random, -40.0, 40.0), xi);
                /* 1e-14: rounding of the test's own sines at arguments up to 100 */
                assert_at_most(error, kernel.bound + 1e-14);
                worst_share = fmax(worst_share, error / (kernel.bound + 1e-14));
            }
        }
    print_message("worst error / bound: %.3f\n", worst_share);
    /* a bound that is never approached would be no bound but a guess */
    assert_true(worst_share > 0.5);
}

static void test_make__narrower_kernels_miss_the_tolerance(void **state)
{
    (void)state;
    const dif_kernel wide = dif_kernel_make(1e-6, 2.0), narrow = dif_kernel_make(1e-4, 2.0);
    assert_true(narrow.width < wide.width);
    assert_true(narrow.bound > 1e-6);
}

static void test_transform__is_the_integral_of_the_taps(void **state)
{
    (void)state;
    const dif_kernel kernel = dif_kernel_make(1e-9, 2.0);
    const double xi = 0.7;
    double sum = 0.0;
    /* midpoint rule over each tap's interval; 2000 steps: 1e-7 of a smooth integrand */
    const int n = 2000;
    for (int i = 0; i < n; i++) {
        double tap[DIF_KERNEL_WIDTH_MAX];
        const double t = -0.5 + (i + 0.5) / n;
        dif_kernel_taps(&kernel, t, tap);
        for (int j = 0; j < kernel.width; j++)
            sum += tap[j] * cos(xi * (t + 0.5 * (kernel.width - 1) - j)) / n;
    }
    assert_near(dif_kernel_transform(&kernel, xi), sum, 1e-8, 0.0);
    assert_near(dif_kernel_transform(&kernel, -xi), sum, 1e-8, 0.0);
}

static void test_reciprocal__is_one_over_the_transform(void **state)
{
    (void)state;
    for (double tol = 1e-2; tol > 1e-13; tol *= 1e-2) {
        const dif_kernel kernel = dif_kernel_make(tol, 2.0);
        const dif_reciprocal reciprocal = dif_kernel_reciprocal(&kernel);
        for (int i = 0; i <= 100; i++) {
            const double share = -1.0 + 0.02 * i;
            const double product =
                dif_reciprocal_at(&reciprocal, share) * dif_kernel_transform(&kernel, share * DIF_PI / 2.0);
            /* a twentieth of the bound leaves the kernel's own error in charge; 3e-14 is rounding */
            assert_near(product, 1.0, 0.0, fmax(0.05 * kernel.bound, 3e-14));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_make__bound_is_met_and_holds),
        cmocka_unit_test(test_make__narrower_kernels_miss_the_tolerance),
        cmocka_unit_test(test_transform__is_the_integral_of_the_taps),
        cmocka_unit_test(test_reciprocal__is_one_over_the_transform),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
