#include "tests/near.h"

#include "core/brdf.h"
#include "core/units.h"

static dif_vec3 random_direction(uint64_t *random)
{
    return dif_vec3_from_angles_rad(test_random(random, 0.0, 1.5), test_random(random, 0.0, DIF_TWO_PI));
}

static void test_gain__closed_values_at_normal_incidence(void **state)
{
    (void)state;
    const dif_vec3 up = {0.0, 0.0, 1.0};
    const dif_index index = dif_index_default();
    assert_near(dif_brdf_gain_rho(index, up, up), 1.0, 1e-15, 0.0);                 /* 2^2 / (2^2 1) */
    assert_near(dif_brdf_gain_efficiency(0.8, up, up), 0.8, 1e-15, 0.0);            /* R 2^2 / (1 1 2^2) */
    assert_near(dif_brdf_gain_per_sr(index, up, up, 0.5, 100.0), 16.0, 1e-14, 0.0); /* 0.04 100 / 0.25 */
    assert_near(dif_brdf_gain(DIF_QUANTITY_POWER, index, up, up, 0.5, 100.0), 1.0, 0.0, 0.0);
    assert_near(dif_brdf_gain(DIF_QUANTITY_RHO, index, up, up, 0.5, 100.0), 1.0, 1e-15, 0.0);
    assert_near(dif_brdf_gain(DIF_QUANTITY_BRDF, index, up, up, 0.5, 100.0), 16.0, 1e-14, 0.0);
}

/* A mirror pair at theta: wi.wo = cos 2 theta, so (1 + wi.wo)^2 = 4 cos^4 and w^2 = 4 cos^2. */
static void test_gain__mirror_pairs(void **state)
{
    (void)state;
    const dif_index index = {.n = 1.3, .kappa = 0.4};
    for (int deg = 0; deg <= 85; deg += 5) {
        const double theta = dif_rad_from_deg(deg), c = cos(theta);
        const dif_vec3 wi = dif_vec3_from_angles_rad(theta, 0.3), wo = dif_vec3_from_angles_rad(-theta, 0.3);
        const double r = dif_fresnel_schlick(index, c); /* the half vector is the normal */
        assert_near(dif_brdf_reflectance(index, wi, wo), r, 1e-13, 0.0);
        assert_near(dif_brdf_gain_efficiency(r, wi, wo), r, 1e-12, 0.0); /* specular order of a mirror carries R */
        assert_near(dif_brdf_gain_rho(index, wi, wo), r / dif_fresnel_schlick(index, 1.0) * c, 1e-12, 0.0);
    }
}

static void test_gain__reciprocal(void **state)
{
    (void)state;
    uint64_t random = 11;
    const dif_index index = {.n = 1.7, .kappa = 2.0};
    for (int i = 0; i < 2000; i++) {
        const dif_vec3 a = random_direction(&random), b = random_direction(&random);
        const double f = dif_brdf_gain_per_sr(index, a, b, 0.5, 80.0), g = dif_brdf_gain_per_sr(index, b, a, 0.5, 80.0);
        assert_near(f, g, 1e-12, 0.0);
        assert_near(dif_brdf_gain_efficiency(0.5, a, b), dif_brdf_gain_efficiency(0.5, b, a), 1e-12, 0.0);
        /* rho carries 1/cos_o alone */
        assert_near(dif_brdf_gain_rho(index, a, b) * b.z, dif_brdf_gain_rho(index, b, a) * a.z, 1e-12, 0.0);
    }
}

/* The three gains differ by known factors only. */
static void test_gain__quantities_agree_with_each_other(void **state)
{
    (void)state;
    uint64_t random = 12;
    const dif_index index = dif_index_default();
    for (int i = 0; i < 2000; i++) {
        const dif_vec3 wi = random_direction(&random), wo = random_direction(&random);
        const double lambda_um = test_random(&random, 0.3, 1.0), area_um2 = test_random(&random, 1.0, 4000.0);
        const double rho = dif_brdf_gain(DIF_QUANTITY_RHO, index, wi, wo, lambda_um, area_um2);
        const double brdf = dif_brdf_gain(DIF_QUANTITY_BRDF, index, wi, wo, lambda_um, area_um2);
        assert_near(brdf, rho * 0.04 / wi.z * area_um2 / (lambda_um * lambda_um), 1e-12, 0.0);
        const double c = sqrt(0.5 * (1.0 + dif_vec3_dot(wi, wo))), g = 1.0 + dif_vec3_dot(wi, wo);
        const double w = wi.z + wo.z;
        assert_near(rho, dif_fresnel_schlick(index, c) / 0.04 * g * g / (w * w * wo.z), 1e-12, 0.0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gain__closed_values_at_normal_incidence),
        cmocka_unit_test(test_gain__mirror_pairs),
        cmocka_unit_test(test_gain__reciprocal),
        cmocka_unit_test(test_gain__quantities_agree_with_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
