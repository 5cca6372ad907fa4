/* Shadowing on the GPU against core/shadow.h, for every kind: the factor itself, and what evaluators make of it. */
#include "core/shadow.h"

#include "gpu_bench.h"

static const dif_shadowing SHADOWINGS[] = {DIF_SHADOWING_NONE, DIF_SHADOWING_VCAVITY, DIF_SHADOWING_SMITH,
                                           DIF_SHADOWING_NDF};
enum { N_SHADOWING = 4, N = 6000 };

static dif_query query[N];

/* Random directions, a third of them grazing, and the places where a quotient or an azimuth is none. */
static void make_queries(double lambda_min_um)
{
    static const double EDGES[][4] = {{0.0, 0.0, 0.0, 0.0},        {1.57, 0.0, 1.57, DIF_PI},
                                      {1.57, 0.3, 0.0, 0.0},       {1.57, 0.5 * DIF_PI, 1.2, 0.0},
                                      {1.2, DIF_PI, 1.2, -DIF_PI}, {1.57, 1.0, 1.57, 1.0}};
    uint64_t seed = 11;
    for (int i = 0; i < N; i++) {
        const double most = i % 3 ? 1.4 : 1.57;
        query[i] =
            (dif_query){dif_vec3_from_angles_rad(test_random(&seed, 0.0, most), test_random(&seed, 0.0, DIF_TWO_PI)),
                        dif_vec3_from_angles_rad(test_random(&seed, 0.0, most), test_random(&seed, 0.0, DIF_TWO_PI)),
                        test_random(&seed, lambda_min_um, 0.78)};
    }
    for (size_t i = 0; i < sizeof EDGES / sizeof *EDGES; i++) {
        query[i].wi = dif_vec3_from_angles_rad(EDGES[i][0], EDGES[i][1]);
        query[i].wo = dif_vec3_from_angles_rad(EDGES[i][2], EDGES[i][3]);
    }
}

static void values_of(dif_gpu *gpu, const dif_model *model, dif_gpu_path path, double *value)
{
    const dif_gpu_eval_opts opts = by(path);
    dif_evaluator eval;
    dif_error err;
    if (dif_gpu_evaluator_open(gpu, model, &opts, &eval, &err) != DIF_OK ||
        eval.values(eval.self, N, query, value, NULL, &err) != DIF_OK)
        fail_msg("%s", err.text);
    dif_evaluator_close(&eval);
}

/* Bumps so narrow that they diffract all directions alike: what is left of rho is its gain and S. */
static void check_factor(dif_gpu *gpu, const char *what, const dif_field *field)
{
    static double plain[N], shadowed[N];
    dif_model model = {
        .kind = DIF_MODEL_STAM, .stam = {2.5, 2.5, 0.0, 1e-4}, .quantity = DIF_QUANTITY_RHO, .index = {1.5, 0.0}};
    make_queries(0.38);
    for (int path = DIF_GPU_COMPUTE; path <= DIF_GPU_FRAGMENT; path++) {
        model.shadow = NULL;
        values_of(gpu, &model, (dif_gpu_path)path, plain);
        for (int k = 0; k < N_SHADOWING; k++) {
            dif_shadow shadow;
            double worst = 0.0, least = 1.0;
            assert_int_equal(dif_shadow_create(SHADOWINGS[k], field, &shadow, NULL), DIF_OK);
            model.shadow = &shadow;
            values_of(gpu, &model, (dif_gpu_path)path, shadowed);
            for (int i = 0; i < N; i++) {
                const double want = dif_shadow_factor(&shadow, query[i].wi, query[i].wo);
                const double difference = fabs(shadowed[i] / plain[i] - want);
                worst = isnan(difference) ? 1e9 : fmax(worst, difference);
                least = fmin(least, want);
            }
            print_message("S %s, %s, path %d: %.2g, least %.2g\n", dif_shadowing_name(shadow.kind), what, path, worst,
                          least);
            assert_at_most(worst, 2e-6); /* float: places to 1e-5 of a row, which differ by a tenth */
            assert_true(shadow.kind == DIF_SHADOWING_NONE ? least >= 1.0 : least < 0.5);
            dif_shadow_free(&shadow);
        }
    }
}

static void test_factor__as_the_cpu_in_every_direction(void **state)
{
    dif_field field = rough();
    check_factor(gpu_of(state), "rough", &field);
    dif_field_free(&field);
}

static void test_factor__grooves_have_no_variance_along_them(void **state)
{
    dif_field field = made(DIF_SURFACE_BLAZED);
    check_factor(gpu_of(state), "grooves", &field);
    dif_field_free(&field);
}

/* Shadowed tables, values and colours of a model by both evaluators; the power knows no shadows. */
static void check_values(const bench *b, dif_gpu_path path)
{
    static double want[N], got[N], back[N];
    dif_evaluator cpu = open_cpu(b);
    double worst = 0.0, p99, largest = 0.0;
    dif_error err;
    if (cpu.values(cpu.self, N, query, want, NULL, &err) != DIF_OK)
        fail_msg("%s", err.text);
    dif_evaluator_close(&cpu);
    values_of(b->gpu, &b->model[1], path, got);
    for (int i = 0; i < N; i++)
        largest = fmax(largest, want[i]);
    compare(N, want, got, &worst, &p99);
    print_message("%s of %s, shadowing %s: worst %.2g of %.2g, p99 %.2g\n", dif_quantity_name(b->model[1].quantity),
                  dif_model_kind_name(b->model[1].kind), dif_shadowing_name(b->model[1].shadow->kind), worst, largest,
                  p99);
    /* 2e-6 of rho up to 1; the BRDF of a patch is up to 1e4 per sr, and grazing gains go up, too */
    assert_at_most(worst, 2e-6 * fmax(1.0, largest));
    assert_at_most(p99, 1e-4);
    if (b->model[1].quantity != DIF_QUANTITY_BRDF)
        return;
    for (int i = 0; i < N; i++) { /* reciprocity: light and detector swapped */
        const dif_vec3 wi = query[i].wi;
        query[i].wi = query[i].wo;
        query[i].wo = wi;
    }
    values_of(b->gpu, &b->model[1], path, back);
    for (int i = 0; i < N; i++)
        assert_near(back[i], got[i], 1e-5, 1e-7 * largest);
}

static void test_values__every_kind_is_shadowed(void **state)
{
    static const dif_model_kind KINDS[] = {DIF_MODEL_SHEET, DIF_MODEL_NMM, DIF_MODEL_PQ, DIF_MODEL_STAM};
    bench b = bench_open(gpu_of(state), test_rough_field(64, 60, 0.15, 0.14, 0.9, 1), DIF_MODEL_SHEET, (double)NAN, 2);
    bench_settle(&b);
    for (int k = 1; k < N_SHADOWING; k++) {
        dif_shadow shadow;
        assert_int_equal(dif_shadow_create(SHADOWINGS[k], &b.field, &shadow, NULL), DIF_OK);
        b.model[0].shadow = b.model[1].shadow = &shadow;
        for (int i = 0; i < 4; i++) {
            make_queries(0.39);
            b.model[0].kind = b.model[1].kind = KINDS[i];
            b.model[0].quantity = b.model[1].quantity = DIF_QUANTITY_RHO;
            check_values(&b, i % 2 ? DIF_GPU_COMPUTE : DIF_GPU_FRAGMENT);
            b.model[0].quantity = b.model[1].quantity = DIF_QUANTITY_BRDF;
            check_values(&b, i % 2 ? DIF_GPU_FRAGMENT : DIF_GPU_COMPUTE);
        }
        dif_shadow_free(&shadow);
    }
    bench_close(&b);
}

static void test_values__the_power_is_not_shadowed(void **state)
{
    static double plain[N], shadowed[N];
    dif_model model = {
        .kind = DIF_MODEL_STAM, .stam = {2.5, 2.5, 0.0, 0.3}, .quantity = DIF_QUANTITY_POWER, .index = {1.5, 0.0}};
    const dif_shadow shadow = {.kind = DIF_SHADOWING_VCAVITY};
    make_queries(0.38);
    values_of(gpu_of(state), &model, DIF_GPU_COMPUTE, plain);
    model.shadow = &shadow;
    values_of(gpu_of(state), &model, DIF_GPU_COMPUTE, shadowed);
    assert_memory_equal(plain, shadowed, sizeof plain);
}

static void test_table__lines_are_shadowed(void **state)
{
    enum { N_ANGLE = 121, N_WAVE = 9 };
    static double want[N_ANGLE * N_WAVE], got[N_ANGLE * N_WAVE], bare[N_ANGLE * N_WAVE];
    bench b = bench_open(gpu_of(state), rough(), DIF_MODEL_SHEET, 0.3, 2);
    bench_settle(&b);
    dif_plan plan = make_plan(N_ANGLE, N_WAVE, 0.3);
    dif_evaluator cpu = open_cpu(&b);
    assert_int_equal(cpu.table(cpu.self, &plan, bare, NULL, NULL), DIF_OK);
    dif_evaluator_close(&cpu);
    for (int k = 1; k < N_SHADOWING; k++) {
        dif_shadow shadow;
        double worst, p99;
        assert_int_equal(dif_shadow_create(SHADOWINGS[k], &b.field, &shadow, NULL), DIF_OK);
        b.model[0].shadow = b.model[1].shadow = &shadow;
        cpu = open_cpu(&b);
        assert_int_equal(cpu.table(cpu.self, &plan, want, NULL, NULL), DIF_OK);
        dif_evaluator_close(&cpu);
        for (int path = DIF_GPU_COMPUTE; path <= DIF_GPU_FRAGMENT; path++) {
            dif_evaluator gpu = open_with(&b, by((dif_gpu_path)path));
            assert_int_equal(gpu.table(gpu.self, &plan, got, NULL, NULL), DIF_OK);
            dif_evaluator_close(&gpu);
            compare(N_ANGLE * N_WAVE, want, got, &worst, &p99);
            print_message("table, %s, path %d: worst %.2g, p99 %.2g\n", dif_shadowing_name(shadow.kind), path, worst,
                          p99);
            assert_at_most(worst, 2e-6);
            assert_at_most(p99, 1e-4);
        }
        for (int i = 0; i < N_ANGLE * N_WAVE; i++) {
            dif_vec3 wi, wo;
            dif_plan_directions(&plan, i % N_ANGLE, &wi, &wo);
            assert_near(want[i], bare[i] * dif_shadow_factor(&shadow, wi, wo), 1e-12, 0.0);
        }
        dif_shadow_free(&shadow);
    }
    dif_plan_free(&plan);
    bench_close(&b);
}

static void check_colours(const bench *b, dif_gpu_path path, double worst_want, double p99_want)
{
    static dif_vec3 wi[1100], wo[1100];
    static double want[1100][3], got[1100][3];
    const size_t n = (size_t)make_map(wi, wo);
    dif_evaluator cpu = open_cpu(b), gpu = open_with(b, by(path));
    double worst, p99;
    assert_int_equal(cpu.colours(cpu.self, n, wi, wo, want, NULL, NULL), DIF_OK);
    assert_int_equal(gpu.colours(gpu.self, n, wi, wo, got, NULL, NULL), DIF_OK);
    compare(3 * n, &want[0][0], &got[0][0], &worst, &p99);
    print_message("colours by %s, %s, path %d: worst %.2g, p99 %.2g\n", dif_model_kind_name(b->model[1].kind),
                  dif_shadowing_name(b->model[1].shadow->kind), (int)path, worst, p99);
    assert_at_most(worst, worst_want);
    assert_at_most(p99, p99_want);
    dif_evaluator_close(&cpu);
    dif_evaluator_close(&gpu);
}

static void test_colours__sampled_and_integrated(void **state)
{
    dif_gpu *gpu = gpu_of(state);
    dif_field field = made(DIF_SURFACE_XENOPELTIS);
    dif_lut lut = make_lut(&field, 5);
    bench b = bench_open(gpu, test_rough_field(64, 60, 0.15, 0.14, 0.9, 1), DIF_MODEL_SHEET, (double)NAN, 1);
    bench_settle(&b);
    /* the table's filtered reads: test_gpu_eval.c */
    const bool exact = dif_gpu_info_of(gpu).software && dif_gpu_info_of(gpu).float_linear;
    b.model[0].lut = b.model[1].lut = &lut;
    for (int k = 1; k < N_SHADOWING; k++) {
        dif_shadow shadow;
        assert_int_equal(dif_shadow_create(SHADOWINGS[k], &field, &shadow, NULL), DIF_OK);
        b.model[0].shadow = b.model[1].shadow = &shadow;
        for (int path = DIF_GPU_COMPUTE; path <= DIF_GPU_FRAGMENT; path++) {
            b.model[0].kind = b.model[1].kind = DIF_MODEL_SHEET;
            check_colours(&b, (dif_gpu_path)path, 2e-6, 1e-4);
            b.model[0].kind = b.model[1].kind = DIF_MODEL_LUT;
            check_colours(&b, (dif_gpu_path)path, exact ? 1e-5 : 5e-3, exact ? 1e-3 : 1e-2);
        }
        dif_shadow_free(&shadow);
    }
    dif_lut_free(&lut);
    dif_field_free(&field);
    bench_close(&b);
}

static void test_open__a_shadowing_that_is_none(void **state)
{
    dif_gpu *gpu = gpu_of(state);
    const dif_shadow empty = {.kind = DIF_SHADOWING_SMITH};
    const dif_model model = {.kind = DIF_MODEL_STAM,
                             .stam = {2.5, 2.5, 0.0, 0.3},
                             .quantity = DIF_QUANTITY_RHO,
                             .index = {1.5, 0.0},
                             .shadow = &empty};
    dif_evaluator out;
    dif_error err;
    const int live = dif_gpu_live(gpu);
    assert_int_equal(dif_gpu_evaluator_open(gpu, &model, NULL, &out, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "smith shadowing with a table of 0 x 0");
    assert_int_equal(dif_gpu_live(gpu), live);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_factor__as_the_cpu_in_every_direction),
        cmocka_unit_test(test_factor__grooves_have_no_variance_along_them),
        cmocka_unit_test(test_values__every_kind_is_shadowed),
        cmocka_unit_test(test_values__the_power_is_not_shadowed),
        cmocka_unit_test(test_table__lines_are_shadowed),
        cmocka_unit_test(test_colours__sampled_and_integrated),
        cmocka_unit_test(test_open__a_shadowing_that_is_none),
    };
    return cmocka_run_group_tests(tests, open_gpu, close_gpu);
}
