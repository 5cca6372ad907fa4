#include "tests/near.h"

#include "core/fresnel.h"

static void test_schlick__normal_incidence_is_exact(void **state)
{
    (void)state;
    assert_near(dif_fresnel_schlick(dif_index_default(), 1.0), 0.04, 1e-15, 0.0); /* ((1.5 - 1) / 2.5)^2 */
    /* silver-like: ((n-1)^2 + k^2) / ((n+1)^2 + k^2) */
    const dif_index metal = {.n = 0.05, .kappa = 4.0};
    assert_near(dif_fresnel_schlick(metal, 1.0), 16.9025 / 17.1025, 1e-15, 0.0);
}

static void test_schlick__grazing_reflects_all(void **state)
{
    (void)state;
    uint64_t random = 3;
    for (int i = 0; i < 1000; i++) {
        const dif_index index = {test_random(&random, 0.05, 4.0), test_random(&random, 0.0, 6.0)};
        assert_near(dif_fresnel_schlick(index, 0.0), 1.0, 1e-14, 0.0); /* (n-1)^2 + 4n = (n+1)^2 */
    }
}

static void test_schlick__falls_with_the_cosine_and_stays_a_share(void **state)
{
    (void)state;
    uint64_t random = 4;
    for (int i = 0; i < 1000; i++) {
        const dif_index index = {test_random(&random, 0.05, 4.0), test_random(&random, 0.0, 6.0)};
        double before = 1.0 + 1e-14;
        for (int k = 0; k <= 20; k++) {
            const double now = dif_fresnel_schlick(index, k / 20.0);
            assert_at_most(now, before);
            assert_at_most(0.0, now);
            before = now;
        }
    }
}

static void test_schlick__rounding_outside_the_range_is_clamped(void **state)
{
    (void)state;
    const dif_index index = dif_index_default();
    assert_near(dif_fresnel_schlick(index, 1.0 + 1e-15), dif_fresnel_schlick(index, 1.0), 0.0, 0.0);
    assert_near(dif_fresnel_schlick(index, -1e-15), dif_fresnel_schlick(index, 0.0), 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_schlick__normal_incidence_is_exact),
        cmocka_unit_test(test_schlick__grazing_reflects_all),
        cmocka_unit_test(test_schlick__falls_with_the_cosine_and_stays_a_share),
        cmocka_unit_test(test_schlick__rounding_outside_the_range_is_clamped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
