/* The GPU evaluator's calls: more than one pass, streamed sheets, limits, bad input. */
#include "gpu_bench.h"

static void test_budget__streamed_sheets_give_the_same(void **state)
{
    enum { N = 500 };
    dif_query query[N];
    static double all[N], streamed[N];
    bench b = bench_open(gpu_of(state), test_rough_field(64, 60, 0.15, 0.14, 0.9, 1), DIF_MODEL_SHEET, (double)NAN, 3);
    bench_settle(&b);
    uint64_t seed = 9;
    for (int i = 0; i < N; i++) {
        query[i].wi = dif_vec3_from_angles_rad(test_random(&seed, 0.0, 1.4), test_random(&seed, 0.0, DIF_TWO_PI));
        query[i].wo = dif_vec3_from_angles_rad(test_random(&seed, 0.0, 1.4), test_random(&seed, 0.0, DIF_TWO_PI));
        query[i].lambda_um = test_random(&seed, 0.38, 0.78);
    }
    dif_gpu_eval_opts opts = by(DIF_GPU_COMPUTE);
    assert_true(opts.budget_bytes == (size_t)1 << 30);
    dif_evaluator gpu = open_with(&b, opts);
    assert_int_equal(gpu.values(gpu.self, N, query, all, NULL, NULL), DIF_OK);
    dif_evaluator_close(&gpu);
    const size_t one = 8 * (size_t)b.sheet[1][0]->s.n * (size_t)b.sheet[1][0]->y.n * (size_t)b.sheet[1][0]->z.n;
    for (int slots = 1; slots <= 2; slots++) { /* 3 sheets in one slot, then in two */
        dif_eval_cost first, second;
        opts.budget_bytes = (size_t)slots * one + one / 2;
        gpu = open_with(&b, opts);
        for (int round = 0; round < 2; round++) {
            assert_int_equal(gpu.values(gpu.self, N, query, streamed, round ? &second : &first, NULL), DIF_OK);
            for (int i = 0; i < N; i++) /* sums in another order, in float */
                assert_near(streamed[i], all[i], 1e-6, 1e-12);
        }
        assert_true(first.upload_s > 0.0 && second.upload_s > 0.0);
        dif_evaluator_close(&gpu);
    }
    bench_close(&b);
}

static void test_table__larger_than_one_pass(void **state)
{
    /* 2051 angles and 515 wavelengths are two passes either way, the last of three each */
    enum { N_ANGLE = 2051, N_WAVE = 515 };
    bench b = bench_open(gpu_of(state), test_rough_field(16, 16, 0.3, 0.3, 0.2, 1), DIF_MODEL_SHEET, 0.0, 1);
    bench_settle(&b);
    dif_plan plan = make_plan(N_ANGLE, N_WAVE, 0.0);
    double *want = malloc((size_t)N_ANGLE * N_WAVE * sizeof *want),
           *got = malloc((size_t)N_ANGLE * N_WAVE * sizeof *got);
    assert_true(want && got);
    dif_evaluator cpu = open_cpu(&b), gpu = open_with(&b, by(DIF_GPU_COMPUTE));
    assert_int_equal(cpu.table(cpu.self, &plan, want, NULL, NULL), DIF_OK);
    assert_int_equal(gpu.table(gpu.self, &plan, got, NULL, NULL), DIF_OK);
    double worst, p99;
    compare((size_t)N_ANGLE * N_WAVE, want, got, &worst, &p99);
    assert_at_most(worst, 2e-6);
    assert_at_most(p99, 1e-4);
    free(want);
    free(got);
    dif_evaluator_close(&cpu);
    dif_evaluator_close(&gpu);
    dif_plan_free(&plan);
    bench_close(&b);
}

static void test_colours__more_than_one_pass(void **state)
{
    enum { N = DIF_EVAL_ITEMS + 3 };
    dif_gpu *gpu = gpu_of(state);
    bench b = {.gpu = gpu};
    const double lambda_um = 0.55;
    for (int side = 0; side < 2; side++)
        b.model[side] = (dif_model){.kind = DIF_MODEL_STAM,
                                    .stam = {2.5, (double)NAN, 0.3, 5.0},
                                    .n_lambda = 1,
                                    .lambda_um = &lambda_um,
                                    .index = {1.5, 0.0}};
    dif_vec3 *wi = malloc(N * sizeof *wi), *wo = malloc(N * sizeof *wo);
    double(*want)[3] = malloc(N * sizeof *want), (*got)[3] = malloc(N * sizeof *got);
    assert_true(wi && wo && want && got);
    uint64_t seed = 2;
    for (int i = 0; i < N; i++) {
        wi[i] = dif_vec3_from_angles_rad(0.4, 0.3);
        wo[i] = dif_vec3_from_angles_rad(test_random(&seed, -1.5, 1.5), test_random(&seed, 0.2, 0.4));
    }
    dif_evaluator cpu = open_cpu(&b), eval = open_with(&b, by(DIF_GPU_FRAGMENT));
    assert_int_equal(cpu.colours(cpu.self, N, wi, wo, want, NULL, NULL), DIF_OK);
    assert_int_equal(eval.colours(eval.self, N, wi, wo, got, NULL, NULL), DIF_OK);
    for (int i = 0; i < N; i++)
        for (int c = 0; c < 3; c++)
            assert_near(got[i][c], want[i][c], 1e-4, 2e-6);
    free(wi);
    free(wo);
    free(want);
    free(got);
    dif_evaluator_close(&cpu);
    dif_evaluator_close(&eval);
}

static void test_open__a_table_beyond_the_texture_limit_names_both_numbers(void **state)
{
    dif_gpu *gpu = gpu_of(state);
    const int limit = dif_gpu_info_of(gpu).texture_max;
    static float coef[3];
    const dif_lut lut = {.n_azimuth = limit + 1, .n_radius = 2, .n_map = 1, .s0 = 0.01, .coef = coef};
    const dif_model model = {.kind = DIF_MODEL_LUT, .lut = &lut, .index = {1.5, 0.0}};
    dif_gpu_eval_opts opts = dif_gpu_eval_opts_default();
    dif_evaluator out;
    dif_error err;
    char want[200];
    const int live = dif_gpu_live(gpu);
    opts.half = dif_gpu_info_of(gpu).float_linear ? false : true;
    if (opts.half)
        skip(); /* the scale of half floats reads the table, which is not there */
    assert_int_equal(dif_gpu_evaluator_open(gpu, &model, &opts, &out, &err), DIF_ERR_SIZE);
    snprintf(want, sizeof want,
             "a wavelength-integrated table needs a texture of %d x 2, and the GPU's largest side is %d", limit + 1,
             limit);
    assert_string_equal(err.text, want);
    assert_null(out.self);
    assert_int_equal(dif_gpu_live(gpu), live);
}

/* ---- bad input ---- */

static void test_calls__what_a_kind_cannot_answer(void **state)
{
    dif_gpu *gpu = gpu_of(state);
    dif_error err;
    double value[1], xyz[1][3];
    const dif_query query = {{0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, 0.5};
    bench b = bench_open(gpu, test_rough_field(16, 16, 0.3, 0.3, 0.2, 1), DIF_MODEL_SHEET, 0.0, 1);
    bench_settle(&b);
    dif_evaluator eval = open_with(&b, by(DIF_GPU_COMPUTE));
    assert_int_equal(eval.values(eval.self, 1, &query, value, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "line sheets serve tables only");
    assert_int_equal(eval.colours(eval.self, 1, &query.wi, &query.wo, xyz, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "line sheets serve tables only");
    dif_plan plan = make_plan(2, 1, 0.1);
    assert_int_equal(eval.table(eval.self, &plan, value, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "a table at azimuth 5.72957795 deg, the model's sheets are at 0 deg");
    plan.azimuth_rad = 0.0;
    plan.lambda_um[0] = 0.1; /* far beyond the band of 380 nm */
    assert_int_equal(eval.table(eval.self, &plan, value, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "a direction or wavelength outside the band that the model was made for");
    plan.lambda_um[0] = (double)NAN;
    assert_int_equal(eval.table(eval.self, &plan, value, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "wavelength 0 is nan nm, want a finite number > 0");
    dif_plan_free(&plan);
    dif_evaluator_close(&eval);
    bench_close(&b);
}

static void test_open__checks_model_and_options(void **state)
{
    dif_gpu *gpu = gpu_of(state);
    dif_evaluator out;
    dif_error err;
    dif_gpu_eval_opts opts = dif_gpu_eval_opts_default();
    dif_model model = {.kind = DIF_MODEL_LUT, .index = {1.5, 0.0}};
    assert_int_equal(dif_gpu_evaluator_open(gpu, &model, NULL, &out, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "a model by lut without a table");
    model = (dif_model){.kind = DIF_MODEL_STAM, .stam = {2.5, 1.7, 0.0, 5.0}, .index = {1.5, 0.0}};
    opts.path = (dif_gpu_path)7;
    assert_int_equal(dif_gpu_evaluator_open(gpu, &model, &opts, &out, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "path 7 is none");
    opts = dif_gpu_eval_opts_default();
    opts.fault = (dif_gpu_fault)-1;
    assert_int_equal(dif_gpu_evaluator_open(gpu, &model, &opts, &out, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "fault -1 is none");
    assert_null(out.self);
    opts = dif_gpu_eval_opts_default();
    assert_int_equal(dif_gpu_evaluator_open(gpu, &model, &opts, &out, &err), DIF_OK);
    double xyz[1][3];
    const dif_vec3 up = {0.0, 0.0, 1.0}, down = {0.0, 0.0, -1.0};
    assert_int_equal(out.colours(out.self, 1, &up, &up, xyz, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "colours of a model without wavelengths");
    const dif_query below = {up, down, 0.5};
    assert_int_equal(out.values(out.self, 1, &below, xyz[0], NULL, &err), DIF_ERR_ARG);
    dif_evaluator_close(&out);
}

static void test_open__taylor_sheets_are_refused(void **state)
{
    bench b = bench_open(gpu_of(state), test_rough_field(16, 16, 0.3, 0.3, 0.2, 1), DIF_MODEL_SHEET, 0.0, 1);
    bench_settle(&b);
    const dif_window window = {.kind = DIF_WINDOW_FLAT};
    const dif_band band = {10.0, 0.0, 10.0};
    const dif_sheet_opts powers = {DIF_BASIS_POWERS, DIF_TERMS_FROM_TOL, false, false};
    dif_sheet *sheet;
    dif_evaluator out;
    dif_error err;
    assert_int_equal(dif_sheet_create_line(&b.field, &window, 0.0, &band, 1e-6, &powers, &sheet, NULL), DIF_OK);
    b.seen[1][0] = sheet;
    assert_int_equal(dif_gpu_evaluator_open(b.gpu, &b.model[1], NULL, &out, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "the GPU reads no sheets of Taylor terms");
    dif_sheet_free(sheet);
    bench_close(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_budget__streamed_sheets_give_the_same),
        cmocka_unit_test(test_table__larger_than_one_pass),
        cmocka_unit_test(test_colours__more_than_one_pass),
        cmocka_unit_test(test_open__a_table_beyond_the_texture_limit_names_both_numbers),
        cmocka_unit_test(test_calls__what_a_kind_cannot_answer),
        cmocka_unit_test(test_open__checks_model_and_options),
        cmocka_unit_test(test_open__taylor_sheets_are_refused),
    };
    return cmocka_run_group_tests(tests, open_gpu, close_gpu);
}
