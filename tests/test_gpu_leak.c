/* Contexts and evaluators made and closed a thousand times: no GL object, no heap block and no memory stays behind.
 * A context's memory is the driver's own, so its growth is bounded by the resident size of the process. */
#include <stdio.h>

#include "alloc_count.h"
#include "gpu_bench.h"

#ifdef __SANITIZE_ADDRESS__
enum { CONTEXTS = 50, EVALUATORS = 100, SANITIZED = 1 }; /* each costs ten times as much */
#else
enum { CONTEXTS = 1000, EVALUATORS = 1000, SANITIZED = 0 };
#endif

/* Resident size in MiB, or 0 where it cannot be known. */
static double resident_mib(void)
{
    long pages = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file)
        return 0.0;
    if (fscanf(file, "%ld %ld", &pages, &resident) != 2)
        resident = 0;
    fclose(file);
    return (double)resident * 4096.0 / 1048576.0;
}

static void test_open__a_thousand_contexts_leave_nothing(void **state)
{
    (void)gpu_of(state);
    double before = 0.0;
    for (int i = 0; i < CONTEXTS; i++) {
        dif_gpu *gpu;
        dif_error err;
        if (i == CONTEXTS / 10) /* caches are warm */
            before = resident_mib();
        const int blocks = test_alloc_live();
        assert_int_equal(dif_gpu_open(NULL, &gpu, &err), DIF_OK);
        assert_int_equal(dif_gpu_check(gpu, "in a new context", NULL), DIF_OK);
        dif_gpu_close(gpu);
        assert_int_equal(test_alloc_live(), blocks);
    }
    const double grown = resident_mib() - before;
    print_message("%d contexts: %.1f MiB more\n", CONTEXTS, grown);
    /* 10 KiB each; a context of Mesa's takes megabytes */
    assert_true(SANITIZED || grown < 0.01 * CONTEXTS);
}

/* One in ten is used, too: where the driver keeps no shaders, compiling them is what takes the time. */
static void cycle(bench *b, const dif_shadow *shadow, int i, const dif_plan *plan, double *value)
{
    static const dif_model_kind KINDS[] = {DIF_MODEL_SHEET, DIF_MODEL_NMM, DIF_MODEL_PQ, DIF_MODEL_STAM};
    dif_error err;
    b->model[1].kind = KINDS[i / 10 % 4];
    b->model[1].shadow = i % 3 ? shadow : NULL;
    dif_evaluator eval = open_with(b, by(DIF_GPU_COMPUTE));
    if (i % 10 == 0)
        assert_int_equal(eval.table(eval.self, plan, value, NULL, &err), DIF_OK);
    dif_evaluator_close(&eval);
}

static void test_evaluator__a_thousand_leave_nothing(void **state)
{
    dif_gpu *gpu = gpu_of(state);
    bench b = bench_open(gpu, test_rough_field(16, 16, 0.3, 0.3, 0.2, 1), DIF_MODEL_SHEET, 0.0, 1);
    bench_settle(&b);
    double value[20], before = 0.0;
    dif_plan plan = make_plan(5, 4, 0.0);
    dif_shadow shadow;
    assert_int_equal(dif_shadow_create(DIF_SHADOWING_SMITH, &b.field, &shadow, NULL), DIF_OK);
    const int blocks = test_alloc_live();
    assert_int_equal(dif_gpu_begin(gpu, NULL), DIF_OK);
    const int live = dif_gpu_live(gpu);
    for (int i = 0; i < EVALUATORS; i++) {
        if (i == EVALUATORS / 10)
            before = resident_mib();
        cycle(&b, &shadow, i, &plan, value);
        assert_int_equal(dif_gpu_live(gpu), live);
        assert_int_equal(test_alloc_live(), blocks);
        assert_int_equal(dif_gpu_check(gpu, "after an evaluator", NULL), DIF_OK);
    }
    const double grown = resident_mib() - before;
    print_message("%d evaluators: %.1f MiB more\n", EVALUATORS, grown);
    /* an evaluator's textures take 13 MiB */
    assert_true(SANITIZED || grown < 0.05 * EVALUATORS);
    dif_plan_free(&plan);
    dif_shadow_free(&shadow);
    bench_close(&b);
}

static void test_evaluator__the_kth_allocation_failing(void **state)
{
    static const dif_model_kind KINDS[] = {DIF_MODEL_SHEET, DIF_MODEL_NMM, DIF_MODEL_STAM, DIF_MODEL_LUT};
    dif_gpu *gpu = gpu_of(state);
    bench b = bench_open(gpu, test_rough_field(16, 16, 0.3, 0.3, 0.2, 1), DIF_MODEL_SHEET, 0.0, 2);
    float coef[16 * 8 * 3] = {0};
    const dif_lut lut = {.n_azimuth = 16, .n_radius = 8, .n_map = 1, .s0 = 0.01, .coef = coef};
    bench_settle(&b);
    b.model[1].lut = &lut;
    const int blocks = test_alloc_live(), live = dif_gpu_live(gpu);
    for (int kind = 0; kind < 4; kind++) {
        int k = 1;
        for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; k++) {
            dif_evaluator out;
            dif_error err;
            b.model[1].kind = KINDS[kind];
            test_alloc_fail_from(k);
            status = dif_gpu_evaluator_open(gpu, &b.model[1], NULL, &out, &err);
            test_alloc_fail_from(0);
            assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
            assert_int_equal(out.self == NULL, status != DIF_OK);
            dif_evaluator_close(&out);
            assert_int_equal(test_alloc_live(), blocks);
            assert_int_equal(dif_gpu_live(gpu), live);
        }
        assert_true(k > 3);
    }
    bench_close(&b);
}

static void test_calls__allocate_nothing(void **state)
{
    bench b = bench_open(gpu_of(state), test_rough_field(16, 16, 0.3, 0.3, 0.2, 1), DIF_MODEL_SHEET, 0.0, 1);
    bench_settle(&b);
    double value[20];
    dif_plan plan = make_plan(5, 4, 0.0);
    dif_evaluator eval = open_with(&b, by(DIF_GPU_FRAGMENT));
    test_alloc_fail_from(1);
    const dif_status status = eval.table(eval.self, &plan, value, NULL, NULL);
    assert_int_equal(test_alloc_calls(), 0);
    test_alloc_fail_from(0);
    assert_int_equal(status, DIF_OK);
    dif_evaluator_close(&eval);
    dif_plan_free(&plan);
    bench_close(&b);
}

static void test_open__the_allocation_failing(void **state)
{
    (void)gpu_of(state);
    dif_gpu *gpu;
    dif_error err;
    test_alloc_fail_from(1);
    assert_int_equal(dif_gpu_open(NULL, &gpu, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    assert_null(gpu);
    assert_string_equal(err.text, "no memory for a GPU context");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_open__the_allocation_failing),
        cmocka_unit_test(test_open__a_thousand_contexts_leave_nothing),
        cmocka_unit_test(test_evaluator__a_thousand_leave_nothing),
        cmocka_unit_test(test_evaluator__the_kth_allocation_failing),
        cmocka_unit_test(test_calls__allocate_nothing),
    };
    return cmocka_run_group_tests(tests, open_gpu, close_gpu);
}
