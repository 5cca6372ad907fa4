#include "alloc_count.h"
#include "bench/map.h"
#include "bench/measure.h"
#include "core/units.h"
#include "near.h"
#include "rough.h"

static dif_shadow shadow_of(dif_shadowing kind, const dif_field *field)
{
    dif_shadow shadow;
    assert_int_equal(dif_shadow_create(kind, field, &shadow, NULL), DIF_OK);
    return shadow;
}

static dif_sample ask(const dif_field *field, const dif_shadow *shadow, dif_vec3 wi, dif_vec3 wo)
{
    const dif_query query = {.wi = wi, .wo = wo, .lambda_um = 0.55};
    dif_measure_opts opts = dif_measure_opts_default();
    dif_sample sample;
    opts.method = DIF_METHOD_DIRECT;
    opts.shadow = shadow;
    assert_int_equal(dif_measure_queries(field, 1, &query, 1e-6, &opts, &sample, NULL, NULL), DIF_OK);
    return sample;
}

static void test_queries__scale_by_s_and_stay_reciprocal(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 40, 0.1, 0.1, 0.1, 21);
    const dif_vec3 wi = dif_vec3_from_angles_rad(1.2, 0.3), wo = dif_vec3_from_angles_rad(0.7, 2.1);
    const dif_sample bare = ask(&field, NULL, wi, wo);
    for (int kind = 0; kind < 4; kind++) {
        dif_shadow shadow = shadow_of((dif_shadowing)kind, &field);
        const double s = dif_shadow_factor(&shadow, wi, wo);
        const dif_sample seen = ask(&field, &shadow, wi, wo), back = ask(&field, &shadow, wo, wi);
        assert_true(kind == DIF_SHADOWING_NONE ? s == 1.0 : s < 1.0);
        assert_near(seen.power, bare.power, 1e-15, 0.0);
        assert_near(seen.rho, s * bare.rho, 1e-14, 0.0);
        assert_near(seen.brdf_per_sr, s * bare.brdf_per_sr, 1e-14, 0.0);
        assert_near(back.brdf_per_sr, seen.brdf_per_sr, 1e-9, 0.0);
        dif_shadow_free(&shadow);
    }
    dif_field_free(&field);
}

/* A plan of nine angles, light from 70 degrees. */
static dif_plan small_plan(void)
{
    dif_plan plan;
    assert_int_equal(dif_plan_create(9, 2, &plan, NULL), DIF_OK);
    plan.fixed_rad = dif_rad_from_deg(70.0);
    for (int i = 0; i < 9; i++)
        plan.angle_rad[i] = dif_rad_from_deg(-80.0 + 20.0 * i);
    plan.lambda_um[0] = 0.45;
    plan.lambda_um[1] = 0.6;
    return plan;
}

static void test_table__scales_rho_but_not_power_and_passes_its_check(void **state)
{
    (void)state;
    dif_field field = test_rough_field(48, 48, 0.1, 0.1, 0.1, 22);
    dif_shadow shadow = shadow_of(DIF_SHADOWING_NDF, &field);
    dif_plan plan = small_plan();
    for (int quantity = 0; quantity < 3; quantity++) {
        dif_measure_opts opts = dif_measure_opts_default();
        dif_table bare, seen;
        dif_measure_check check;
        opts.quantity = (dif_quantity)quantity;
        assert_int_equal(dif_measure_table(&field, &plan, 1e-9, &opts, &bare, NULL, NULL), DIF_OK);
        opts.shadow = &shadow;
        assert_int_equal(dif_measure_table(&field, &plan, 1e-9, &opts, &seen, NULL, NULL), DIF_OK);
        for (int i = 0; i < 18; i++) {
            dif_vec3 wi, wo;
            dif_plan_directions(&plan, i % 9, &wi, &wo);
            const double s = quantity == DIF_QUANTITY_POWER ? 1.0 : dif_shadow_factor(&shadow, wi, wo);
            assert_near(seen.value[i], s * bare.value[i], 1e-12, 0.0);
        }
        assert_int_equal(dif_measure_check_table(&field, &seen, &opts, 12, 1, &check, NULL), DIF_OK);
        assert_at_most(check.worst_amplitude, 1e-9);
        dif_table_free(&bare);
        dif_table_free(&seen);
    }
    dif_plan_free(&plan);
    dif_shadow_free(&shadow);
    dif_field_free(&field);
}

static void test_map__scales_pixels_and_passes_its_check(void **state)
{
    (void)state;
    enum { N = 24 };
    const double lambda_um[] = {0.5, 0.6};
    dif_field field = test_rough_field(40, 40, 0.1, 0.1, 0.1, 23);
    dif_shadow shadow = shadow_of(DIF_SHADOWING_SMITH, &field);
    const dif_map_plan plan = {.fixed = dif_vec3_from_angles_rad(1.1, 0.4),
                               .n_pixel = N,
                               .n_lambda = 2,
                               .lambda_um = lambda_um,
                               .keep_layers = true};
    dif_measure_opts opts = dif_measure_opts_default();
    dif_map bare, seen;
    dif_map_check check;
    assert_int_equal(dif_map_measure(&field, &plan, 1e-5, &opts, &bare, NULL, NULL), DIF_OK);
    opts.shadow = &shadow;
    assert_int_equal(dif_map_measure(&field, &plan, 1e-5, &opts, &seen, NULL, NULL), DIF_OK);
    for (int i = 0; i < N * N; i++) {
        dif_vec3 wo;
        if (!dif_map_direction(N, i % N, i / N, &wo))
            continue;
        const double s = dif_shadow_factor(&shadow, plan.fixed, wo);
        assert_near((double)seen.xyz[3 * i + 1], s * (double)bare.xyz[3 * i + 1], 1e-6, 0.0); /* float */
        assert_near((double)seen.layer[i], s * (double)bare.layer[i], 1e-6, 0.0);
    }
    assert_int_equal(dif_map_check_layers(&field, &plan, &seen, &opts, 20, 1, &check, NULL), DIF_OK);
    assert_at_most(check.worst_amplitude, 1e-5);
    dif_map_free(&bare);
    dif_map_free(&seen);
    dif_shadow_free(&shadow);
    dif_field_free(&field);
}

static void test_thesis__knows_no_shadowing(void **state)
{
    (void)state;
    dif_error err;
    dif_table table;
    dif_field field = test_rough_field(32, 32, 0.1, 0.1, 0.1, 24);
    dif_shadow shadow = shadow_of(DIF_SHADOWING_VCAVITY, NULL), none = shadow_of(DIF_SHADOWING_NONE, NULL);
    dif_plan plan = small_plan();
    dif_measure_opts opts = dif_measure_opts_default();
    opts.method = DIF_METHOD_THESIS;
    opts.shadow = &shadow;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-6, &opts, &table, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "the source's program has no vcavity shadowing: its gain is 1");
    opts.shadow = &none;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-6, &opts, &table, NULL, &err), DIF_OK);
    dif_table_free(&table);
    dif_plan_free(&plan);
    dif_field_free(&field);
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_queries__scale_by_s_and_stay_reciprocal),
        cmocka_unit_test(test_table__scales_rho_but_not_power_and_passes_its_check),
        cmocka_unit_test(test_map__scales_pixels_and_passes_its_check),
        cmocka_unit_test(test_thesis__knows_no_shadowing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
