/* Deliberately wrong shaders: each is far outside what right ones are held to. */
#include "gpu_bench.h"

/* How far a wrong shader is off, in units of DESIGN's tolerance for the whole: the better hidden of table and colours. */
static double caught(const bench *b, dif_gpu_eval_opts opts, double azimuth_rad)
{
    enum { N_ANGLE = 91, N_WAVE = 9 };
    static double want[N_WAVE * N_ANGLE], got[N_WAVE * N_ANGLE];
    dif_plan plan = make_plan(N_ANGLE, N_WAVE, azimuth_rad);
    dif_evaluator right = open_with(b, by(opts.path)), wrong = open_with(b, opts);
    double worst, p99;
    assert_int_equal(right.table(right.self, &plan, want, NULL, NULL), DIF_OK);
    assert_int_equal(wrong.table(wrong.self, &plan, got, NULL, NULL), DIF_OK);
    compare((size_t)N_WAVE * N_ANGLE, want, got, &worst, &p99);
    dif_evaluator_close(&right);
    dif_evaluator_close(&wrong);
    dif_plan_free(&plan);
    return fmax(worst / 2e-6, p99 / 1e-4);
}

static void test_fault__each_is_far_outside_the_tolerance(void **state)
{
    static const dif_model_kind KINDS[] = {DIF_MODEL_SHEET, DIF_MODEL_NMM, DIF_MODEL_PQ, DIF_MODEL_STAM};
    dif_gpu *gpu = gpu_of(state);
    for (int volume = 0; volume < 2; volume++) {
        bench b = bench_open(gpu, test_rough_field(64, 60, 0.15, 0.14, 0.9, 1), DIF_MODEL_SHEET,
                             volume ? (double)NAN : 0.3, 1);
        bench_settle(&b);
        for (int i = 0; i < 4; i++) {
            b.model[1].kind = KINDS[i];
            for (int fault = DIF_GPU_FAULT_PLANE; fault <= DIF_GPU_FAULT_TAP; fault++) {
                dif_gpu_eval_opts opts = by(fault % 2 ? DIF_GPU_COMPUTE : DIF_GPU_FRAGMENT);
                opts.fault = (dif_gpu_fault)fault;
                const double times = caught(&b, opts, 0.3);
                print_message("fault %d of %s, %s: %.3g times the tolerance\n", fault, dif_model_kind_name(KINDS[i]),
                              volume ? "volumes" : "lines", times);
                assert_true(times > 100.0);
            }
        }
        bench_close(&b);
    }
}

static void test_fault__lut_too(void **state)
{
    static dif_vec3 wi[1100], wo[1100];
    static double want[1100][3], got[1100][3];
    dif_gpu *gpu = gpu_of(state);
    const int n = make_map(wi, wo);
    dif_field field = made(DIF_SURFACE_XENOPELTIS);
    dif_lut lut = make_lut(&field, 8);
    bench b = {.gpu = gpu, .model[1] = {.kind = DIF_MODEL_LUT, .lut = &lut, .index = {1.5, 0.0}}};
    dif_evaluator right = open_with(&b, by(DIF_GPU_COMPUTE));
    assert_int_equal(right.colours(right.self, (size_t)n, wi, wo, want, NULL, NULL), DIF_OK);
    for (int fault = DIF_GPU_FAULT_PLANE; fault <= DIF_GPU_FAULT_TAP; fault++) {
        dif_gpu_eval_opts opts = by(DIF_GPU_COMPUTE);
        double worst, p99;
        opts.fault = (dif_gpu_fault)fault;
        dif_evaluator wrong = open_with(&b, opts);
        assert_int_equal(wrong.colours(wrong.self, (size_t)n, wi, wo, got, NULL, NULL), DIF_OK);
        compare(3 * (size_t)n, &want[0][0], &got[0][0], &worst, &p99);
        print_message("fault %d of lut: worst %.2g, p99 %.2g\n", fault, worst, p99);
        assert_true(p99 > 5e-2); /* half floats stay below 1e-3 */
        dif_evaluator_close(&wrong);
    }
    dif_evaluator_close(&right);
    dif_lut_free(&lut);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fault__each_is_far_outside_the_tolerance),
        cmocka_unit_test(test_fault__lut_too),
    };
    return cmocka_run_group_tests(tests, open_gpu, close_gpu);
}
