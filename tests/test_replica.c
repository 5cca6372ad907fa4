#include "core/replica.h"

#include "core/units.h"
#include "near.h"

/* (1/n) sum_j exp(2 i x (j - (n-1)/2)): its real part; the imaginary one vanishes by symmetry. */
static double explicit_sum(int n, double x)
{
    double sum = 0.0;
    for (int j = 0; j < n; j++)
        sum += cos(2.0 * x * (j - 0.5 * (n - 1)));
    return sum / n;
}

static void test_ratio__equals_the_explicit_sum(void **state)
{
    (void)state;
    const int counts[] = {1, 2, 3, 7, 26, 501};
    uint64_t random = 5;
    for (int c = 0; c < 6; c++)
        for (int i = 0; i < 200; i++) {
            const double x = test_random(&random, -60.0, 60.0);
            /* the sum's phases reach n |x| and are rounded to 1e-16 of that */
            assert_near(dif_replica_ratio(counts[c], x), explicit_sum(counts[c], x), 0.0, 4e-16 * counts[c] * 61.0);
        }
}

static void test_ratio__one_replica_changes_nothing(void **state)
{
    (void)state;
    for (double x = -10.0; x < 10.0; x += 0.37)
        assert_near(dif_replica_ratio(1, x), 1.0, 1e-15, 0.0);
    assert_near(dif_replica_ratio(1, DIF_PI), 1.0, 1e-15, 0.0);
}

static void test_ratio__limit_on_every_order(void **state)
{
    (void)state;
    const int counts[] = {2, 3, 26, 27, DIF_REPLICA_MAX};
    for (int c = 0; c < 5; c++)
        for (int j = -9; j <= 9; j++) {
            const double sign = j % 2 != 0 && counts[c] % 2 == 0 ? -1.0 : 1.0;
            /* pi j is rounded, so N times that rounding is seen: (1e6 * 2e-15)^2/6 */
            assert_near(dif_replica_ratio(counts[c], j * DIF_PI), sign, 1e-15, 0.0);
            /* and beside it, where sin/sin alone would be 0/0: 1 - (n^2 - 1) x^2 / 6 */
            const double beside = 1e-3 / counts[c], want = 1.0 - 1e-6 / 6.0;
            assert_near(dif_replica_ratio(counts[c], j * DIF_PI + beside), sign * want, 0.0, 4e-7);
        }
}

static void test_ratio__power_stays_in_the_unit_interval(void **state)
{
    (void)state;
    uint64_t random = 7;
    for (int i = 0; i < 5000; i++) {
        const int n = (int)test_random(&random, 1.0, 3000.0);
        assert_at_most(fabs(dif_replica_ratio(n, test_random(&random, -1e4, 1e4))), 1.0 + 1e-15);
    }
}

static void test_factor__is_the_product_over_both_axes(void **state)
{
    (void)state;
    const dif_replica replica = {3, 5, 2.5, 1.2};
    const double kx = 2.2, ky = -0.9;
    double re = 0.0, im = 0.0;
    for (int i = -1; i <= 1; i++)
        for (int j = -2; j <= 2; j++) {
            re += cos(kx * 2.5 * i + ky * 1.2 * j) / 15.0;
            im += sin(kx * 2.5 * i + ky * 1.2 * j) / 15.0;
        }
    assert_near(dif_replica_factor(&replica, kx, ky), re, 0.0, 1e-15);
    assert_near(im, 0.0, 0.0, 1e-15);
}

static void test_check__bad_replicas_have_their_codes(void **state)
{
    (void)state;
    const struct {
        dif_replica replica;
        const char *text;
    } bad[] = {
        {{0, 1, 1.0, 1.0}, "0 replicas along x, want 1 ... 1000000"},
        {{1, 1000001, 1.0, 1.0}, "1000001 replicas along y, want 1 ... 1000000"},
        {{1, 1, 0.0, 1.0}, "a period of 0 um along x, want > 0"},
        {{1, 1, 1.0, -2.0}, "a period of -2 um along y, want > 0"},
        {{1, 1, (double)NAN, 1.0}, "a period of nan um along x, want > 0"},
    };
    dif_error err;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(dif_replica_check(&bad[i].replica, &err), DIF_ERR_ARG);
        if (i < 4)
            assert_string_equal(err.text, bad[i].text);
    }
    const dif_replica good = {1, DIF_REPLICA_MAX, 1e-3, 1e3};
    assert_int_equal(dif_replica_check(&good, &err), DIF_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ratio__equals_the_explicit_sum),
        cmocka_unit_test(test_ratio__one_replica_changes_nothing),
        cmocka_unit_test(test_ratio__limit_on_every_order),
        cmocka_unit_test(test_ratio__power_stays_in_the_unit_interval),
        cmocka_unit_test(test_factor__is_the_product_over_both_axes),
        cmocka_unit_test(test_check__bad_replicas_have_their_codes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
