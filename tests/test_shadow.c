#include "core/shadow.h"

#include "alloc_count.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "near.h"
#include "rough.h"

static dif_vec3 random_direction(uint64_t *seed)
{
    return dif_vec3_from_angles_rad(test_random(seed, 0.0, 0.5 * DIF_PI), test_random(seed, 0.0, DIF_TWO_PI));
}

static dif_shadow shadow_of(dif_shadowing kind, const dif_field *field)
{
    dif_shadow shadow;
    assert_int_equal(dif_shadow_create(kind, field, &shadow, NULL), DIF_OK);
    return shadow;
}

/* A small random surface: made once a test, small enough to be fast. */
static dif_field random_surface(int n, double height_um)
{
    dif_surface surface = dif_surface_default(DIF_SURFACE_RANDOM);
    dif_field field;
    surface.nx = surface.ny = n;
    surface.pitch_um = 0.1;
    surface.height_um = height_um;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    return field;
}

static void test_factor__reciprocal_and_within_bounds(void **state)
{
    (void)state;
    uint64_t seed = 31;
    dif_field field = random_surface(96, 0.3);
    for (int kind = 0; kind < 4; kind++) {
        dif_shadow shadow = shadow_of((dif_shadowing)kind, &field);
        for (int i = 0; i < 2000; i++) {
            const dif_vec3 a = random_direction(&seed), b = random_direction(&seed);
            const double s = dif_shadow_factor(&shadow, a, b);
            assert_true(s >= 0.0 && s <= 1.0);
            assert_near(dif_shadow_factor(&shadow, b, a), s, 1e-15, 0.0);
        }
        const dif_vec3 up = {0.0, 0.0, 1.0};
        assert_near(dif_shadow_factor(&shadow, up, up), 1.0, 1e-6, 0.0); /* the table is in float */
        dif_shadow_free(&shadow);
    }
    const dif_vec3 a = random_direction(&seed);
    assert_near(dif_shadow_factor(NULL, a, a), 1.0, 0.0, 0.0);
    dif_field_free(&field);
}

static void test_vcavity__is_its_definition(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int i = 0; i < 2000; i++) {
        const dif_vec3 l = random_direction(&seed), e = random_direction(&seed);
        const double norm = sqrt(2.0 * (1.0 + dif_vec3_dot(l, e)));
        const dif_vec3 h = {(l.x + e.x) / norm, (l.y + e.y) / norm, (l.z + e.z) / norm};
        const double eh = dif_vec3_dot(e, h);
        const double want = fmin(1.0, fmin(2.0 * h.z * e.z / eh, 2.0 * h.z * l.z / eh));
        assert_near(dif_shadow_vcavity(l, e), want, 1e-12, 1e-12);
    }
    /* a mirror pair sees no cavity; light along the surface does not enter */
    const dif_vec3 one = dif_vec3_from_angles_rad(1.2, 0.0), other = dif_vec3_from_angles_rad(-1.2, 0.0);
    assert_near(dif_shadow_vcavity(one, other), 1.0, 0.0, 0.0);
    assert_near(dif_shadow_vcavity((dif_vec3){1.0, 0.0, 0.0}, one), 0.0, 0.0, 0.0);
    assert_near(dif_shadow_vcavity((dif_vec3){1.0, 0.0, 0.0}, (dif_vec3){-1.0, 0.0, 0.0}), 1.0, 0.0, 0.0);
}

static void test_smith__known_values(void **state)
{
    (void)state;
    /* sigma = 0.5 at 45 degrees: z = 2, Psi = 2 Phi(2) + phi(2) */
    const dif_slope_gauss g = {0.3, 0.0, 0.25, 0.25, 0.0};
    const double psi = 2.0 * 0.97724986805182079 + 0.053990966513188063;
    assert_near(dif_shadow_smith(&g, dif_vec3_from_angles_rad(0.25 * DIF_PI, 1.0)), 2.0 / psi, 1e-14, 0.0);
    assert_near(dif_shadow_smith(&g, (dif_vec3){0.0, 0.0, 1.0}), 1.0, 0.0, 0.0);
    assert_near(dif_shadow_smith(&g, (dif_vec3){1.0, 0.0, 0.0}), 0.0, 0.0, 0.0);
    /* it is cos / norm of the visible slopes of the levelled Gaussian */
    const dif_slope_gauss level = {0.0, 0.0, 0.25, 0.04, 0.05};
    for (int i = 1; i < 20; i++) {
        const double theta = 0.08 * i, phi = 0.7 * i;
        const double want = cos(theta) / dif_slope_visible_of(&level, theta, phi).norm;
        assert_near(dif_shadow_smith(&level, dif_vec3_from_angles_rad(theta, phi)), want, 1e-12, 0.0);
    }
    /* grooves along y: nothing is masked along them */
    const dif_slope_gauss grooves = {0.0, 0.0, 0.25, 0.0, 0.0};
    assert_near(dif_shadow_smith(&grooves, dif_vec3_from_angles_rad(1.5, 0.5 * DIF_PI)), 1.0, 0.0, 1e-3);
    assert_near(dif_shadow_smith(&grooves, (dif_vec3){0.0, 1.0, 0.0}), 1.0, 0.0, 0.0);
}

static void test_masking__smith_table_is_smith(void **state)
{
    (void)state;
    uint64_t seed = 77;
    dif_field field = random_surface(64, 0.3);
    dif_shadow shadow = shadow_of(DIF_SHADOWING_SMITH, &field);
    double worst = 0.0;
    for (int i = 0; i < 5000; i++) {
        const dif_vec3 k = random_direction(&seed);
        worst = fmax(worst, fabs(dif_shadow_masking(&shadow, k) - dif_shadow_smith(&shadow.slopes, k)));
    }
    print_message("Smith by table: %.2g\n", worst);
    assert_at_most(worst, 2e-5);
    dif_shadow_free(&shadow);
    dif_field_free(&field);
}

/* How far the table of a surface is from its normals, over random directions up to 89 degrees. */
static double ndf_error(const dif_field *field)
{
    uint64_t seed = 78;
    double worst = 0.0;
    dif_ndf ndf;
    dif_shadow shadow = shadow_of(DIF_SHADOWING_NDF, field);
    assert_int_equal(dif_hemisphere_ndf_create(field, 193, true, &ndf, NULL), DIF_OK);
    for (int i = 0; i < 3000; i++) {
        const dif_vec3 k =
            dif_vec3_from_angles_rad(dif_rad_from_deg(test_random(&seed, 0.0, 89.0)), test_random(&seed, 0.0, 7.0));
        worst = fmax(worst, fabs(dif_shadow_masking(&shadow, k) - dif_hemisphere_masking(&ndf, k)));
    }
    dif_hemisphere_ndf_free(&ndf);
    dif_shadow_free(&shadow);
    return worst;
}

static void test_masking__ndf_table_is_the_normals(void **state)
{
    (void)state;
    dif_field rough = random_surface(128, 0.3), blazed;
    dif_surface surface = dif_surface_default(DIF_SURFACE_BLAZED);
    surface.nx = surface.ny = 256;
    assert_int_equal(dif_surface_make(&surface, &blazed, NULL), DIF_OK);
    const double of_rough = ndf_error(&rough), of_blazed = ndf_error(&blazed);
    print_message("NDF by table: random surface %.2g, blazed grating %.2g\n", of_rough, of_blazed);
    assert_at_most(of_rough, 1e-3);
    assert_at_most(of_blazed, 1e-2);
    dif_field_free(&rough);
    dif_field_free(&blazed);
}

static void test_masking__ndf_of_a_random_surface_is_near_smith(void **state)
{
    (void)state;
    dif_field field = random_surface(256, 0.5);
    dif_shadow ndf = shadow_of(DIF_SHADOWING_NDF, &field), smith = shadow_of(DIF_SHADOWING_SMITH, &field);
    for (int deg = 0; deg <= 80; deg += 5) {
        const dif_vec3 k = dif_vec3_from_angles_rad(dif_rad_from_deg(deg), 0.2 * deg);
        assert_near(dif_shadow_masking(&ndf, k), dif_shadow_masking(&smith, k), 0.0, 0.04); /* one small patch */
    }
    dif_shadow_free(&ndf);
    dif_shadow_free(&smith);
    dif_field_free(&field);
}

static void test_masking__flat_surface_has_none(void **state)
{
    (void)state;
    dif_field field;
    assert_int_equal(dif_field_create(8, 8, 0.1, 0.1, &field, NULL), DIF_OK);
    for (int kind = 0; kind < 4; kind++) {
        dif_shadow shadow = shadow_of((dif_shadowing)kind, &field);
        for (int deg = 0; deg < 90; deg += 1)
            assert_near(dif_shadow_masking(&shadow, dif_vec3_from_angles_rad(dif_rad_from_deg(deg), 1.0)), 1.0, 1e-6,
                        0.0);
        dif_shadow_free(&shadow);
    }
    dif_field_free(&field);
}

static void test_create__tilt_is_no_roughness(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 40, 0.1, 0.1, 0.05, 6), tilted = test_rough_field(40, 40, 0.1, 0.1, 0.05, 6);
    for (int i = 0; i < 1600; i++)
        tilted.z_um[i] += 0.2 * dif_field_x_um(&tilted, i % 40);
    for (int kind = DIF_SHADOWING_SMITH; kind <= DIF_SHADOWING_NDF; kind++) {
        dif_shadow a = shadow_of((dif_shadowing)kind, &field), b = shadow_of((dif_shadowing)kind, &tilted);
        for (int i = 0; i < 20; i++) {
            const dif_vec3 k = dif_vec3_from_angles_rad(0.07 * i, 0.9 * i);
            assert_near(dif_shadow_masking(&a, k), dif_shadow_masking(&b, k), 1e-6, 0.0);
        }
        dif_shadow_free(&a);
        dif_shadow_free(&b);
    }
    dif_field_free(&field);
    dif_field_free(&tilted);
}

static void test_names__round_trip(void **state)
{
    (void)state;
    static const char *const names[] = {"none", "vcavity", "smith", "ndf"};
    dif_shadowing kind;
    for (int i = 0; i < 4; i++) {
        assert_true(dif_shadowing_from_name(names[i], &kind));
        assert_int_equal(kind, i);
        assert_string_equal(dif_shadowing_name(kind), names[i]);
    }
    assert_false(dif_shadowing_from_name("Smith", &kind));
}

static void test_create__bad_input_is_refused(void **state)
{
    (void)state;
    dif_error err;
    dif_shadow shadow;
    dif_field field = test_rough_field(8, 8, 0.1, 0.1, 0.05, 6);
    assert_int_equal(dif_shadow_create(DIF_SHADOWING_NDF, NULL, &shadow, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "ndf shadowing needs the surface");
    assert_int_equal(dif_shadow_create((dif_shadowing)9, &field, &shadow, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "shadowing 9, want 0 ... 3");
    assert_int_equal(dif_shadow_create(DIF_SHADOWING_VCAVITY, NULL, &shadow, &err), DIF_OK);
    dif_shadow_free(&shadow);
    for (int k = 1; k <= 3; k++) {
        test_alloc_fail_from(k);
        assert_int_equal(dif_shadow_create(DIF_SHADOWING_NDF, &field, &shadow, &err), DIF_ERR_NOMEM);
        test_alloc_fail_from(0);
        assert_null(shadow.g);
    }
    test_alloc_fail_from(1);
    assert_int_equal(dif_shadow_create(DIF_SHADOWING_SMITH, &field, &shadow, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    dif_field_free(&field);
    assert_int_equal(test_alloc_live(), 0);
}

static void test_factor__allocates_nothing(void **state)
{
    (void)state;
    dif_field field = test_rough_field(16, 16, 0.1, 0.1, 0.05, 6);
    dif_shadow shadow = shadow_of(DIF_SHADOWING_NDF, &field);
    test_alloc_fail_from(0);
    assert_true(dif_shadow_factor(&shadow, dif_vec3_from_angles_rad(1.0, 2.0), dif_vec3_from_angles_rad(0.5, 3.0)) >
                0.0);
    assert_int_equal(test_alloc_calls(), 0);
    dif_shadow_free(&shadow);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_factor__reciprocal_and_within_bounds),
        cmocka_unit_test(test_vcavity__is_its_definition),
        cmocka_unit_test(test_smith__known_values),
        cmocka_unit_test(test_masking__smith_table_is_smith),
        cmocka_unit_test(test_masking__ndf_table_is_the_normals),
        cmocka_unit_test(test_masking__ndf_of_a_random_surface_is_near_smith),
        cmocka_unit_test(test_masking__flat_surface_has_none),
        cmocka_unit_test(test_create__tilt_is_no_roughness),
        cmocka_unit_test(test_names__round_trip),
        cmocka_unit_test(test_create__bad_input_is_refused),
        cmocka_unit_test(test_factor__allocates_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
