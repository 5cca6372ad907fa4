/* The GPU evaluator against the CPU's, which reads sheets of a tight tolerance in double: tables, values and colours of every
 * kind, by both paths. */
#include "gpu_bench.h"

/* DESIGN's tolerances: 2e-6 absolute of p, 1e-4 relative for 99 of 100. */
static void check_table(const bench *b, dif_gpu_eval_opts opts, double azimuth_rad)
{
    enum { N_ANGLE = 181, N_WAVE = 41 };
    static double want[N_WAVE * N_ANGLE], got[N_WAVE * N_ANGLE];
    dif_plan plan = make_plan(N_ANGLE, N_WAVE, azimuth_rad);
    dif_evaluator cpu = open_cpu(b), gpu = open_with(b, opts);
    dif_eval_cost cost;
    dif_error err;
    double worst, p99;
    assert_int_equal(cpu.table(cpu.self, &plan, want, NULL, &err), DIF_OK);
    if (gpu.table(gpu.self, &plan, got, &cost, &err) != DIF_OK)
        fail_msg("%s", err.text);
    compare((size_t)N_WAVE * N_ANGLE, want, got, &worst, &p99);
    print_message("table by %s, %s: worst %.2g, p99 %.2g; %.1f + %.1f + %.1f ms\n",
                  dif_model_kind_name(b->model[0].kind), gpu.name, worst, p99, 1e3 * cost.upload_s, 1e3 * cost.run_s,
                  1e3 * cost.download_s);
    assert_at_most(worst, 2e-6);
    assert_at_most(p99, 1e-4);
    dif_evaluator_close(&cpu);
    dif_evaluator_close(&gpu);
    dif_plan_free(&plan);
}

static void check_values(const bench *b, dif_gpu_eval_opts opts)
{
    enum { N = 3000 };
    static dif_query query[N];
    static double want[N], got[N];
    dif_evaluator cpu = open_cpu(b), gpu = open_with(b, opts);
    dif_error err;
    uint64_t seed = 5;
    double worst, p99;
    for (int i = 0; i < N; i++) {
        query[i].wi = dif_vec3_from_angles_rad(test_random(&seed, 0.0, 1.4), test_random(&seed, 0.0, DIF_TWO_PI));
        query[i].wo = dif_vec3_from_angles_rad(test_random(&seed, 0.0, 1.4), test_random(&seed, 0.0, DIF_TWO_PI));
        query[i].lambda_um = test_random(&seed, 0.38, 0.78);
    }
    assert_int_equal(cpu.values(cpu.self, N, query, want, NULL, &err), DIF_OK);
    if (gpu.values(gpu.self, N, query, got, NULL, &err) != DIF_OK)
        fail_msg("%s", err.text);
    compare(N, want, got, &worst, &p99);
    print_message("%s by %s, %s: worst %.2g, p99 %.2g\n", dif_quantity_name(b->model[0].quantity),
                  dif_model_kind_name(b->model[0].kind), gpu.name, worst, p99);
    /* the BRDF of a patch is its power times area/lambda^2, here up to 1e4 per sr */
    assert_at_most(worst, b->model[0].quantity == DIF_QUANTITY_BRDF ? 2e-2 : 2e-6);
    assert_at_most(p99, 1e-4);
    assert_int_equal(gpu.values(gpu.self, 0, query, got, NULL, &err), DIF_OK);
    dif_evaluator_close(&cpu);
    dif_evaluator_close(&gpu);
}

static void check_colours(const bench *b, dif_gpu_eval_opts opts, double worst_want, double p99_want)
{
    static dif_vec3 wi[1100], wo[1100];
    static double want[1100][3], got[1100][3];
    const int n = make_map(wi, wo);
    dif_evaluator cpu = open_cpu(b), gpu = open_with(b, opts);
    dif_error err;
    double worst, p99;
    assert_int_equal(cpu.colours(cpu.self, (size_t)n, wi, wo, want, NULL, &err), DIF_OK);
    if (gpu.colours(gpu.self, (size_t)n, wi, wo, got, NULL, &err) != DIF_OK)
        fail_msg("%s", err.text);
    compare(3 * (size_t)n, &want[0][0], &got[0][0], &worst, &p99);
    print_message("colours by %s, %s%s: worst %.2g, p99 %.2g\n", dif_model_kind_name(b->model[0].kind), gpu.name,
                  opts.half ? ", half" : "", worst, p99);
    assert_at_most(worst, worst_want);
    assert_at_most(p99, p99_want);
    dif_evaluator_close(&cpu);
    dif_evaluator_close(&gpu);
}

/* Tables by both paths, from lines and from volumes. */
static void check_tables(dif_gpu *gpu, dif_field field, dif_model_kind kind, int n_window)
{
    bench b = bench_open(gpu, field, kind, 0.3, n_window);
    bench_settle(&b);
    check_table(&b, by(DIF_GPU_COMPUTE), 0.3);
    check_table(&b, by(DIF_GPU_FRAGMENT), 0.3);
    bench_close(&b);
}

static void test_table__rough_surface_two_windows(void **state)
{
    check_tables(gpu_of(state), rough(), DIF_MODEL_SHEET, 2);
}

static void test_table__blazed_grating(void **state)
{
    check_tables(gpu_of(state), made(DIF_SURFACE_BLAZED), DIF_MODEL_SHEET, 1);
}

static void test_table__snake(void **state)
{
    check_tables(gpu_of(state), made(DIF_SURFACE_XENOPELTIS), DIF_MODEL_SHEET, 3);
}

static void test_table__nmm(void **state)
{
    check_tables(gpu_of(state), made(DIF_SURFACE_ELAPHE), DIF_MODEL_NMM, 2);
}

static void test_table__pq(void **state)
{
    check_tables(gpu_of(state), rough(), DIF_MODEL_PQ, 1);
}

static void test_table__stam(void **state)
{
    check_tables(gpu_of(state), rough(), DIF_MODEL_STAM, 1);
}

static void test_table__volumes(void **state)
{
    static const dif_model_kind KINDS[] = {DIF_MODEL_SHEET, DIF_MODEL_NMM, DIF_MODEL_PQ};
    bench b = bench_open(gpu_of(state), test_rough_field(64, 60, 0.15, 0.14, 0.9, 1), DIF_MODEL_SHEET, (double)NAN, 2);
    bench_settle(&b);
    for (int i = 0; i < 3; i++) {
        b.model[0].kind = b.model[1].kind = KINDS[i];
        check_table(&b, by(DIF_GPU_COMPUTE), 0.3);
        check_table(&b, by(DIF_GPU_FRAGMENT), -2.0);
    }
    bench_close(&b);
}

static void test_values__kinds_quantities_and_paths(void **state)
{
    static const dif_model_kind KINDS[] = {DIF_MODEL_SHEET, DIF_MODEL_NMM, DIF_MODEL_PQ, DIF_MODEL_STAM};
    static const dif_quantity QUANTITIES[] = {DIF_QUANTITY_POWER, DIF_QUANTITY_RHO, DIF_QUANTITY_BRDF};
    bench b = bench_open(gpu_of(state), test_rough_field(64, 60, 0.15, 0.14, 0.9, 1), DIF_MODEL_SHEET, (double)NAN, 2);
    bench_settle(&b);
    for (int i = 0; i < 4; i++) {
        b.model[0].kind = b.model[1].kind = KINDS[i];
        for (int q = 0; q < 3; q++) {
            b.model[0].quantity = b.model[1].quantity = QUANTITIES[q];
            check_values(&b, by(DIF_GPU_COMPUTE));
        }
        check_values(&b, by(DIF_GPU_FRAGMENT));
    }
    bench_close(&b);
}

static void test_colours__kinds_and_paths(void **state)
{
    static const dif_model_kind KINDS[] = {DIF_MODEL_SHEET, DIF_MODEL_NMM, DIF_MODEL_PQ, DIF_MODEL_STAM};
    bench b = bench_open(gpu_of(state), test_rough_field(64, 60, 0.15, 0.14, 0.9, 1), DIF_MODEL_SHEET, (double)NAN, 2);
    bench_settle(&b);
    for (int i = 0; i < 4; i++) {
        b.model[0].kind = b.model[1].kind = KINDS[i];
        check_colours(&b, by(DIF_GPU_COMPUTE), 2e-6, 1e-4);
        check_colours(&b, by(DIF_GPU_FRAGMENT), 2e-6, 1e-4);
        b.model[0].nmm.jacobian = b.model[1].nmm.jacobian = false;
    }
    bench_close(&b);
}

static void test_colours__lut(void **state)
{
    /* from one map up, each number of numbers in the last texel of a stack */
    static const int MAPS[] = {1, 2, 3, 4, 7, DIF_LUT_MAPS_FROM_TOL};
    dif_gpu *gpu = gpu_of(state);
    dif_field field = made(DIF_SURFACE_XENOPELTIS);
    for (int i = 0; i < 6; i++) {
        dif_lut lut = make_lut(&field, MAPS[i]);
        bench b = {.gpu = gpu};
        b.model[0] = b.model[1] = (dif_model){.kind = DIF_MODEL_LUT,
                                              .lut = &lut,
                                              .quantity = i % 2 ? DIF_QUANTITY_RHO : DIF_QUANTITY_POWER,
                                              .index = {1.5, 0.0}};
        /* Linear filtering: a place is right to 1e-4 of a texel or so, and neighbours differ by up to their value. A
         * graphics card's filter has 8 bits of a texel, hence the wider bounds off llvmpipe. */
        const bool exact = dif_gpu_info_of(gpu).software && dif_gpu_info_of(gpu).float_linear;
        check_colours(&b, by(DIF_GPU_COMPUTE), exact ? 1e-5 : 5e-3, exact ? 1e-3 : 1e-2);
        check_colours(&b, by(DIF_GPU_FRAGMENT), exact ? 1e-5 : 5e-3, exact ? 1e-3 : 1e-2);
        dif_gpu_eval_opts half = by(DIF_GPU_COMPUTE);
        half.half = true; /* 11 bits of each map */
        check_colours(&b, half, 5e-3, 1e-2);
        dif_lut_free(&lut);
    }
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table__rough_surface_two_windows),
        cmocka_unit_test(test_table__blazed_grating),
        cmocka_unit_test(test_table__snake),
        cmocka_unit_test(test_table__nmm),
        cmocka_unit_test(test_table__pq),
        cmocka_unit_test(test_table__stam),
        cmocka_unit_test(test_table__volumes),
        cmocka_unit_test(test_values__kinds_quantities_and_paths),
        cmocka_unit_test(test_colours__kinds_and_paths),
        cmocka_unit_test(test_colours__lut),
    };
    return cmocka_run_group_tests(tests, open_gpu, close_gpu);
}
