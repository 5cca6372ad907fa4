/* Models of a surface, read by the reference evaluator, against the measurements that they share their parts with. */
#include "bench/model_build.h"

#include "alloc_count.h"
#include "bench/lut_check.h"
#include "bench/scan.h"
#include "core/brdf.h"
#include "core/evaluator.h"
#include "core/units.h"
#include "rough.h"

#define TOL 1e-10
static const double LAMBDA_UM[] = {0.4, 0.45, 0.52, 0.6, 0.7};
enum { N_LAMBDA = 5, N_QUERY = 300, N_WITH_VALUES = 4 };

/* Kinds with values at a wavelength, and the method that each stands for. */
static const struct {
    dif_model_kind kind;
    dif_method method;
} KINDS[N_WITH_VALUES] = {{DIF_MODEL_SHEET, DIF_METHOD_SHEET},
                          {DIF_MODEL_NMM, DIF_METHOD_NMM},
                          {DIF_MODEL_PQ, DIF_METHOD_PQ},
                          {DIF_MODEL_STAM, DIF_METHOD_STAM}};

static dif_measure_opts make_opts(dif_quantity quantity)
{
    dif_measure_opts opts = dif_measure_opts_default();
    opts.sigma_um = 0.7;
    opts.period_um = 1.1;
    opts.quantity = quantity;
    opts.average = DIF_AVERAGE_WELCH;
    return opts;
}

static dif_plan make_plan(double azimuth_deg)
{
    dif_range angle, lambda;
    dif_plan plan;
    assert_int_equal(dif_range_parse("-80:80:0.5", &angle, NULL), DIF_OK);
    assert_int_equal(dif_range_parse("400:700:75", &lambda, NULL), DIF_OK);
    assert_int_equal(dif_scan_plan(azimuth_deg > 50.0, 60.0, azimuth_deg, &angle, &lambda, &plan, NULL), DIF_OK);
    return plan;
}

static void make_queries(dif_query *query)
{
    uint64_t random = 5;
    for (int i = 0; i < N_QUERY; i++) {
        query[i].wi = dif_vec3_from_angles_rad(test_random(&random, 0.0, 1.5), test_random(&random, 0.0, DIF_TWO_PI));
        query[i].wo = dif_vec3_from_angles_rad(test_random(&random, 0.0, 1.5), test_random(&random, 0.0, DIF_TWO_PI));
        query[i].lambda_um = test_random(&random, 0.4, 0.7);
    }
}

static dif_model_built build_volume(const dif_field *field, dif_model_kind kind, const dif_measure_opts *opts)
{
    dif_model_built built;
    dif_error err = {DIF_OK, ""};
    const dif_lut_opts lut = {.n_azimuth = 64, .n_radius = 32, .n_map = 6};
    if (dif_model_build_volume(field, kind, N_LAMBDA, LAMBDA_UM, NULL, kind == DIF_MODEL_LUT ? 1e-3 : TOL, opts, &lut,
                               &built, &err) != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(err.status, DIF_OK);
    return built;
}

static dif_evaluator open_cpu(const dif_model_built *built)
{
    dif_evaluator cpu;
    assert_int_equal(dif_cpu_evaluator_open(&built->model, &cpu, NULL), DIF_OK);
    assert_string_equal(cpu.name, "cpu");
    return cpu;
}

/* Values of a model and of a measurement may both be off by 2 TOL sqrt(p), times the gain. */
static void assert_same(double got, double want, double peak)
{
    assert_near(got, want, 1e-8, 1e-9 * peak);
}

static void test_table__equals_the_measured_one(void **state)
{
    (void)state;
    dif_field field = test_rough_field(60, 51, 0.06, 0.07, 0.4, 3);
    for (int quantity = 0; quantity < 3; quantity++)
        for (int k = 0; k < N_WITH_VALUES; k++) {
            const dif_measure_opts opts = make_opts((dif_quantity)quantity);
            dif_measure_opts measured = opts;
            const double azimuths_deg[] = {0.0, 37.0, 90.0};
            dif_plan plan = make_plan(azimuths_deg[quantity]);
            dif_model_built built;
            dif_table want;
            dif_eval_cost cost;
            measured.method = KINDS[k].method;
            assert_int_equal(dif_measure_table(&field, &plan, TOL, &measured, &want, NULL, NULL), DIF_OK);
            assert_int_equal(dif_model_build_table(&field, KINDS[k].kind, &plan, TOL, &opts, &built, NULL), DIF_OK);
            dif_evaluator cpu = open_cpu(&built);
            const size_t n = (size_t)plan.n_angle * (size_t)plan.n_lambda;
            double *value = calloc(n, sizeof *value), peak = 0.0;
            assert_int_equal(cpu.table(cpu.self, &plan, value, &cost, NULL), DIF_OK);
            for (size_t i = 0; i < n; i++)
                peak = fmax(peak, want.value[i]);
            for (size_t i = 0; i < n; i++)
                assert_same(value[i], want.value[i], peak);
            assert_true(peak > 0.0 && cost.run_s > 0.0);
            assert_int_equal(cost.upload_s > 0.0 || cost.download_s > 0.0, 0);
            free(value);
            dif_evaluator_close(&cpu);
            dif_model_built_free(&built);
            dif_table_free(&want);
            dif_plan_free(&plan);
        }
    dif_field_free(&field);
    assert_int_equal(test_alloc_live(), 0);
}

static void test_values__equal_measured_queries(void **state)
{
    (void)state;
    dif_field field = test_rough_field(60, 51, 0.06, 0.07, 0.4, 3);
    dif_query query[N_QUERY];
    make_queries(query);
    for (int quantity = 0; quantity < 3; quantity++)
        for (int k = 0; k < N_WITH_VALUES; k++) {
            const dif_measure_opts opts = make_opts((dif_quantity)quantity);
            dif_measure_opts measured = opts;
            dif_sample sample[N_QUERY];
            double value[N_QUERY];
            measured.method = KINDS[k].method;
            assert_int_equal(dif_measure_queries(&field, N_QUERY, query, TOL, &measured, sample, NULL, NULL), DIF_OK);
            dif_model_built built = build_volume(&field, KINDS[k].kind, &opts);
            dif_evaluator cpu = open_cpu(&built);
            assert_int_equal(cpu.values(cpu.self, N_QUERY, query, value, NULL, NULL), DIF_OK);
            for (int i = 0; i < N_QUERY; i++) {
                const double wants[] = {sample[i].power, sample[i].rho, sample[i].brdf_per_sr};
                /* a gain of 1e3 near the horizon multiplies the error, too */
                assert_same(value[i], wants[quantity], fmax(1.0, wants[quantity] / fmax(sample[i].power, 1e-300)));
            }
            dif_evaluator_close(&cpu);
            dif_model_built_free(&built);
        }
    dif_field_free(&field);
}

static void test_colours__equal_measured_ones(void **state)
{
    (void)state;
    dif_field field = test_rough_field(60, 51, 0.06, 0.07, 0.4, 3);
    dif_plan plan = make_plan(37.0);
    const size_t n = (size_t)plan.n_angle;
    dif_vec3 *wi = calloc(n, sizeof *wi), *wo = calloc(n, sizeof *wo);
    double(*want)[3] = calloc(n, sizeof *want), (*xyz)[3] = calloc(n, sizeof *xyz);
    for (int i = 0; i < plan.n_angle; i++)
        dif_plan_directions(&plan, i, wi + i, wo + i);
    for (int k = 0; k < N_WITH_VALUES; k++) {
        const dif_measure_opts opts = make_opts(DIF_QUANTITY_RHO);
        dif_measure_opts measured = opts;
        measured.method = KINDS[k].method;
        assert_int_equal(dif_measure_colours(&field, &plan, TOL, &measured, want, NULL, NULL), DIF_OK);
        dif_model_built built;
        assert_int_equal(dif_model_build_volume(&field, KINDS[k].kind, plan.n_lambda, plan.lambda_um, NULL, TOL, &opts,
                                                NULL, &built, NULL),
                         DIF_OK);
        dif_evaluator cpu = open_cpu(&built);
        assert_int_equal(cpu.colours(cpu.self, n, wi, wo, xyz, NULL, NULL), DIF_OK);
        for (size_t i = 0; i < n; i++)
            for (int c = 0; c < 3; c++)
                assert_same(xyz[i][c], want[i][c], 1.0);
        dif_evaluator_close(&cpu);
        dif_model_built_free(&built);
    }
    free(wi);
    free(wo);
    free(want);
    free(xyz);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_colours__of_a_lut_are_its_own_times_the_gain(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 41, 0.06, 0.07, 0.3, 3);
    const dif_measure_opts opts = make_opts(DIF_QUANTITY_RHO);
    dif_model_built built = build_volume(&field, DIF_MODEL_LUT, &opts);
    dif_evaluator cpu = open_cpu(&built);
    dif_query query[N_QUERY];
    dif_vec3 wi[N_QUERY], wo[N_QUERY];
    double xyz[N_QUERY][3], value;
    dif_error err;
    make_queries(query);
    for (int i = 0; i < N_QUERY; i++) {
        wi[i] = query[i].wi;
        wo[i] = query[i].wo;
    }
    assert_int_equal(cpu.colours(cpu.self, N_QUERY, wi, wo, xyz, NULL, NULL), DIF_OK);
    for (int i = 0; i < N_QUERY; i++) {
        const dif_vec3 q = dif_vec3_transfer(wi[i], wo[i]);
        double want[3];
        dif_lut_eval(built.model.lut, q.x, q.y, q.z, want);
        for (int c = 0; c < 3; c++)
            assert_near(xyz[i][c], want[c] * dif_brdf_gain_rho(opts.index, wi[i], wo[i]), 1e-14, 0.0);
    }
    assert_int_equal(cpu.values(cpu.self, 1, query, &value, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "a lut has colours, no values at a wavelength");
    dif_evaluator_close(&cpu);
    dif_model_built_free(&built);
    dif_field_free(&field);
}

/* Shadowing of the options goes into the model: tables, values and colours are those of the measurement. */
static void test_shadow__is_that_of_the_options(void **state)
{
    (void)state;
    static const dif_shadowing SHADOWINGS[] = {DIF_SHADOWING_VCAVITY, DIF_SHADOWING_SMITH, DIF_SHADOWING_NDF};
    dif_field field = test_rough_field(60, 51, 0.06, 0.07, 0.4, 3);
    dif_plan plan = make_plan(37.0);
    const size_t n = (size_t)plan.n_angle * (size_t)plan.n_lambda;
    double *value = calloc(n, sizeof *value), (*xyz)[3] = calloc(n, sizeof *xyz),
           (*want_xyz)[3] = calloc(n, sizeof *xyz);
    dif_vec3 *wi = calloc(n, sizeof *wi), *wo = calloc(n, sizeof *wo);
    for (int i = 0; i < plan.n_angle; i++)
        dif_plan_directions(&plan, i, wi + i, wo + i);
    for (int k = 0; k < 3; k++)
        for (int quantity = DIF_QUANTITY_POWER; quantity <= DIF_QUANTITY_BRDF; quantity++) {
            dif_measure_opts opts = make_opts((dif_quantity)quantity);
            dif_shadow shadow;
            dif_table want;
            dif_model_built built;
            double peak = 0.0;
            assert_int_equal(dif_shadow_create(SHADOWINGS[k], &field, &shadow, NULL), DIF_OK);
            opts.shadow = &shadow;
            assert_int_equal(dif_measure_table(&field, &plan, TOL, &opts, &want, NULL, NULL), DIF_OK);
            assert_int_equal(dif_model_build_table(&field, DIF_MODEL_SHEET, &plan, TOL, &opts, &built, NULL), DIF_OK);
            assert_ptr_equal(built.model.shadow, &shadow);
            dif_evaluator cpu = open_cpu(&built);
            assert_int_equal(cpu.table(cpu.self, &plan, value, NULL, NULL), DIF_OK);
            for (size_t i = 0; i < n; i++)
                peak = fmax(peak, want.value[i]);
            for (size_t i = 0; i < n; i++)
                assert_same(value[i], want.value[i], peak);
            dif_evaluator_close(&cpu);
            dif_model_built_free(&built);
            dif_table_free(&want);
            if (quantity == DIF_QUANTITY_RHO) {
                assert_int_equal(dif_measure_colours(&field, &plan, TOL, &opts, want_xyz, NULL, NULL), DIF_OK);
                assert_int_equal(dif_model_build_volume(&field, DIF_MODEL_SHEET, plan.n_lambda, plan.lambda_um, NULL,
                                                        TOL, &opts, NULL, &built, NULL),
                                 DIF_OK);
                cpu = open_cpu(&built);
                assert_int_equal(cpu.colours(cpu.self, (size_t)plan.n_angle, wi, wo, xyz, NULL, NULL), DIF_OK);
                for (int i = 0; i < plan.n_angle; i++)
                    for (int c = 0; c < 3; c++)
                        assert_same(xyz[i][c], want_xyz[i][c], 1.0);
                dif_evaluator_close(&cpu);
                dif_model_built_free(&built);
            }
            dif_shadow_free(&shadow);
        }
    free(value);
    free(xyz);
    free(want_xyz);
    free(wi);
    free(wo);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_reach__of_a_fixed_direction_serves_its_map(void **state)
{
    (void)state;
    dif_field field = test_rough_field(30, 31, 0.06, 0.07, 0.3, 3);
    const dif_vec3 wi = dif_vec3_from_angles_rad(1.2, 0.4);
    const dif_model_reach reach = dif_model_reach_of_fixed(wi);
    const dif_measure_opts opts = make_opts(DIF_QUANTITY_POWER);
    dif_model_built built, any = build_volume(&field, DIF_MODEL_SHEET, &opts);
    assert_int_equal(
        dif_model_build_volume(&field, DIF_MODEL_SHEET, N_LAMBDA, LAMBDA_UM, &reach, TOL, &opts, NULL, &built, NULL),
        DIF_OK);
    dif_evaluator cpu = open_cpu(&built), wide = open_cpu(&any);
    /* opposite the light, at both ends of the spectrum, and grazing */
    for (int i = 0; i < 100; i++) {
        const dif_query query = {wi, dif_vec3_from_angles_rad(1.57 * i / 99.0, 0.4 + 0.7 * (i % 9)), i % 2 ? 0.4 : 0.7};
        double value, want;
        assert_int_equal(cpu.values(cpu.self, 1, &query, &value, NULL, NULL), DIF_OK);
        assert_int_equal(wide.values(wide.self, 1, &query, &want, NULL, NULL), DIF_OK);
        assert_same(value, want, 1.0);
    }
    dif_evaluator_close(&cpu);
    dif_evaluator_close(&wide);
    dif_model_built_free(&built);
    dif_model_built_free(&any);
    dif_field_free(&field);
}

static void test_build__bad_requests_have_their_codes(void **state)
{
    (void)state;
    dif_field field = test_rough_field(20, 20, 0.06, 0.07, 0.3, 3);
    dif_plan plan = make_plan(0.0);
    dif_measure_opts opts = make_opts(DIF_QUANTITY_RHO);
    const double unordered_um[] = {0.5, 0.4};
    const dif_model_reach beyond = {2.1, 0.0, 2.0};
    dif_model_built built;
    dif_error err;
    assert_int_equal(dif_model_build_table(&field, DIF_MODEL_LUT, &plan, TOL, &opts, &built, &err),
                     DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "a lut has colours, no table over wavelengths");
    assert_null(built.own);
    assert_int_equal(dif_model_build_table(&field, DIF_MODEL_SHEET, &plan, 0.0, &opts, &built, &err), DIF_ERR_TOL);
    assert_int_equal(
        dif_model_build_volume(&field, DIF_MODEL_SHEET, 2, unordered_um, NULL, TOL, &opts, NULL, &built, &err),
        DIF_ERR_ARG);
    assert_string_equal(err.text, "wavelength 1 is 0.4 um, want > 0 and ascending");
    assert_int_equal(
        dif_model_build_volume(&field, DIF_MODEL_SHEET, N_LAMBDA, LAMBDA_UM, &beyond, TOL, &opts, NULL, &built, &err),
        DIF_ERR_ARG);
    assert_int_equal(
        dif_model_build_volume(&field, (dif_model_kind)9, N_LAMBDA, LAMBDA_UM, NULL, TOL, &opts, NULL, &built, &err),
        DIF_ERR_ARG);
    assert_string_equal(err.text, "model kind 9 is none");
    opts.period_um = (double)NAN;
    assert_int_equal(dif_model_build_table(&field, DIF_MODEL_PQ, &plan, TOL, &opts, &built, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "pq needs the surface's period, and none was given");
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_build__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field = test_rough_field(20, 16, 0.06, 0.07, 0.1, 3);
    dif_plan plan = make_plan(0.0);
    const dif_measure_opts opts = make_opts(DIF_QUANTITY_RHO);
    const dif_lut_opts lut = {.n_azimuth = 16, .n_radius = 8, .n_map = 2};
    const int live = test_alloc_live();
    for (int form = 0; form < 3; form++) {
        int n_failed = 0;
        for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; n_failed++) {
            const dif_model_kind kind = form == 2 ? DIF_MODEL_LUT : DIF_MODEL_PQ;
            dif_model_built built;
            dif_evaluator cpu = {0};
            test_alloc_fail_from(n_failed + 1);
            status = form == 0 ? dif_model_build_table(&field, kind, &plan, 1e-3, &opts, &built, NULL)
                               : dif_model_build_volume(&field, kind, N_LAMBDA, LAMBDA_UM, NULL, 1e-3, &opts, &lut,
                                                        &built, NULL);
            if (status == DIF_OK)
                status = dif_cpu_evaluator_open(&built.model, &cpu, NULL);
            test_alloc_fail_from(0);
            assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
            dif_evaluator_close(&cpu);
            dif_model_built_free(&built);
            assert_int_equal(test_alloc_live(), live);
        }
        assert_true(n_failed > 8);
    }
    dif_plan_free(&plan);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table__equals_the_measured_one),
        cmocka_unit_test(test_values__equal_measured_queries),
        cmocka_unit_test(test_colours__equal_measured_ones),
        cmocka_unit_test(test_colours__of_a_lut_are_its_own_times_the_gain),
        cmocka_unit_test(test_shadow__is_that_of_the_options),
        cmocka_unit_test(test_reach__of_a_fixed_direction_serves_its_map),
        cmocka_unit_test(test_build__bad_requests_have_their_codes),
        cmocka_unit_test(test_build__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
