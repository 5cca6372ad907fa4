/* jn() is POSIX, not C17. */
#define _XOPEN_SOURCE 700

#include "tests/near.h"

#include <complex.h>

#include "core/series.h"
#include "core/units.h"

#define UNIT ((double complex)I) /* I itself is a float */

static void test_taylor_bound__known_values(void **state)
{
    (void)state;
    /* published to four digits */
    assert_near(dif_series_taylor_bound(1.5 * DIF_PI, 20), 2.994e-4, 2e-4, 0.0);
    assert_near(dif_series_taylor_bound(1.5 * DIF_PI, 25), 8.815e-8, 2e-4, 0.0);
    assert_near(dif_series_taylor_bound(1.5 * DIF_PI, 30), 1.005e-11, 5e-4, 0.0);
    assert_near(dif_series_taylor_bound(1.0, 0), exp(1.0), 1e-15, 0.0);
    assert_near(dif_series_taylor_bound(-1.0, 0), exp(1.0), 1e-15, 0.0);
    assert_near(dif_series_taylor_bound(0.0, 0), 0.0, 0.0, 0.0);
}

static void test_taylor_bound__covers_the_true_error(void **state)
{
    (void)state;
    for (double x = 0.1; x < 8.0; x += 0.37) {
        for (int n = 0; n <= 40; n++) {
            double complex term = 1.0, sum = 1.0;
            for (int k = 1; k <= n; k++) {
                term *= UNIT * x / k;
                sum += term;
            }
            const double error = cabs(cexp(UNIT * x) - sum);
            /* rounding of terms as large as the peak comes on top of the bound */
            assert_at_most(error, dif_series_taylor_bound(x, n) + 1e-15 * dif_series_taylor_peak(x) * (n + 1));
        }
    }
}

static void test_taylor_order__is_the_smallest_that_reaches_tol(void **state)
{
    (void)state;
    for (double tol = 1e-1; tol > 1e-13; tol *= 0.1) {
        for (double x = 0.0; x < 60.0; x += 1.7) {
            const int n = dif_series_taylor_order(x, tol);
            assert_at_most(dif_series_taylor_bound(x, n), tol * (1.0 + 1e-9));
            if (n > 0)
                assert_at_most(tol * (1.0 - 1e-9), dif_series_taylor_bound(x, n - 1));
        }
    }
    assert_int_equal(dif_series_taylor_order(1e9, 1e-6), 4096); /* the cap; the bound tells */
}

static void test_taylor_peak__is_the_largest_term(void **state)
{
    (void)state;
    assert_near(dif_series_taylor_peak(0.0), 1.0, 0.0, 0.0);
    assert_near(dif_series_taylor_peak(0.9), 1.0, 0.0, 0.0);
    assert_near(dif_series_taylor_peak(3.0), 4.5, 1e-14, 0.0); /* 3^3/3! */
    for (double x = 0.5; x < 40.0; x += 0.61) {
        double term = 1.0, largest = 1.0;
        for (int n = 1; n < 200; n++) {
            term *= x / n;
            largest = fmax(largest, term);
        }
        assert_near(dif_series_taylor_peak(x), largest, 1e-13, 0.0);
    }
}

static double jacobi_tail(double z, int m)
{
    double sum = 0.0;
    for (int n = (int)fabs(z) + m + 400; n >= m; n--)
        sum += fabs(jn(n, z));
    return 2.0 * sum;
}

static void test_jacobi_bound__covers_the_tail_closely(void **state)
{
    (void)state;
    for (double z = 0.0; z < 90.0; z += 3.3) {
        for (int m = 0; m < 120; m += 7) {
            const double tail = jacobi_tail(z, m), bound = dif_series_jacobi_bound(z, m);
            assert_at_most(tail, bound * (1.0 + 1e-14));
            assert_near(bound, tail, 3e-3, 1e-300); /* the part that is only bounded is below a thousandth */
        }
    }
}

static void test_jacobi_order__is_the_smallest_that_reaches_tol(void **state)
{
    (void)state;
    for (double tol = 1e-1; tol > 1e-13; tol *= 0.1) {
        for (double z = -30.0; z < 60.0; z += 4.7) {
            const int m = dif_series_jacobi_order(z, tol);
            assert_at_most(dif_series_jacobi_bound(z, m), tol);
            if (m > 0)
                assert_at_most(tol, dif_series_jacobi_bound(z, m - 1));
        }
    }
    assert_int_equal(dif_series_jacobi_order(0.0, 1e-6), 1); /* J_0(0) = 1 alone */
    assert_int_equal(dif_series_jacobi_order(0.0, 3.0), 0);
}

/* exp(i z sin t) from the terms below M differs by no more than the bound. */
static void test_jacobi_bound__holds_for_the_expansion(void **state)
{
    (void)state;
    uint64_t random = 5;
    for (int trial = 0; trial < 400; trial++) {
        const double z = test_random(&random, 0.0, 25.0), t = test_random(&random, 0.0, DIF_TWO_PI);
        const int m = (int)test_random(&random, 1.0, 50.0);
        double complex sum = j0(z);
        for (int n = 1; n < m; n++)
            sum += jn(n, z) * (cexp(UNIT * (n * t)) + (n % 2 ? -1.0 : 1.0) * cexp(-UNIT * (n * t)));
        assert_at_most(cabs(sum - cexp(UNIT * (z * sin(t)))), dif_series_jacobi_bound(z, m) + 1e-13);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_taylor_bound__known_values),
        cmocka_unit_test(test_taylor_bound__covers_the_true_error),
        cmocka_unit_test(test_taylor_order__is_the_smallest_that_reaches_tol),
        cmocka_unit_test(test_taylor_peak__is_the_largest_term),
        cmocka_unit_test(test_jacobi_bound__covers_the_tail_closely),
        cmocka_unit_test(test_jacobi_order__is_the_smallest_that_reaches_tol),
        cmocka_unit_test(test_jacobi_bound__holds_for_the_expansion),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
