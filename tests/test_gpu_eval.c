/* The GPU evaluator against the CPU's, which reads sheets of a tight tolerance in double: tables, values and colours of every
 * kind, by both paths; wrong shaders are caught; nothing leaks. */
#include <string.h>

#include "core/sheet_impl.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "gpu/egl_ctx.h"
#include "gpu/gpu_eval_impl.h"
#include "near.h"
#include "rough.h"

#define TOL_CPU 1e-11
#define TOL_GPU 1e-7

enum { N_LAMBDA = 9, WINDOWS_MAX = 3 };

/* A surface, its windows, and one model for either side. */
typedef struct bench {
    dif_gpu *gpu;
    dif_field field;
    int n_window;
    dif_sheet *sheet[2][WINDOWS_MAX];
    const dif_sheet *seen[2][WINDOWS_MAX];
    double share[WINDOWS_MAX], lambda_um[N_LAMBDA];
    dif_model model[2]; /* CPU, GPU */
} bench;

static int open_gpu(void **state)
{
    dif_gpu *gpu = NULL;
    dif_error err;
    if (dif_gpu_open(NULL, &gpu, &err) != DIF_OK)
        print_message("%s: skipping\n", err.text);
    else
        print_message("%s\n", dif_gpu_info_of(gpu).renderer);
    *state = gpu;
    return 0;
}

static int close_gpu(void **state)
{
    dif_gpu_close(*state);
    return 0;
}

static dif_gpu *gpu_of(void **state)
{
    if (!*state)
        skip();
    return *state;
}

/* Opens a model of a kind on a surface. azimuth_rad NaN: volume sheets. */
static bench bench_open(dif_gpu *gpu, dif_field field, dif_model_kind kind, double azimuth_rad, int n_window)
{
    static const double TOLS[2] = {TOL_CPU, TOL_GPU};
    bench b = {.gpu = gpu, .field = field, .n_window = n_window};
    const double extent_um = field.nx * field.pitch_x_um, k = DIF_TWO_PI / 0.38;
    const dif_band band = {2.0 * k, 0.0, 2.0 * k};
    const dif_sheet_opts opts = {DIF_BASIS_WAVES, DIF_TERMS_FROM_TOL, false, false};
    for (int i = 0; i < N_LAMBDA; i++)
        b.lambda_um[i] = 0.38 + 0.4 * i / (N_LAMBDA - 1);
    for (int w = 0; w < n_window; w++) {
        const dif_window window = {DIF_WINDOW_GAUSS, 0.2 * extent_um, (w - 1) * 0.1 * extent_um, 0.05 * extent_um};
        b.share[w] = 1.0 / n_window;
        for (int side = 0; side < 2; side++) {
            dif_error err;
            const dif_status status =
                isnan(azimuth_rad)
                    ? dif_sheet_create_volume(&field, &window, &band, TOLS[side], &opts, &b.sheet[side][w], &err)
                    : dif_sheet_create_line(&field, &window, azimuth_rad, &band, TOLS[side], &opts, &b.sheet[side][w],
                                            &err);
            assert_int_equal(status, DIF_OK);
        }
    }
    for (int side = 0; side < 2; side++)
        b.model[side] = (dif_model){.kind = kind,
                                    .n_sheet = n_window,
                                    .nmm = {.extent_um = extent_um,
                                            .lambda_min_um = 0.38,
                                            .lambda_max_um = 0.78,
                                            .n_fixed = 8,
                                            .jacobian = true},
                                    .replica = {7, 3, 2.5, 1.7},
                                    .stam = {2.5, 1.7, 0.3, 5.0},
                                    .n_lambda = N_LAMBDA,
                                    .quantity = DIF_QUANTITY_RHO,
                                    .index = {1.5, 0.2},
                                    .area_um2 = 0.3 * extent_um * extent_um};
    return b;
}

/* Points the models at their arrays, which lie in the bench: once it has its place. */
static void bench_settle(bench *b)
{
    for (int side = 0; side < 2; side++) {
        for (int w = 0; w < b->n_window; w++)
            b->seen[side][w] = b->sheet[side][w];
        b->model[side].sheet = b->seen[side];
        b->model[side].share = b->share;
        b->model[side].lambda_um = b->lambda_um;
    }
}

static void bench_close(bench *b)
{
    for (int side = 0; side < 2; side++)
        for (int w = 0; w < b->n_window; w++)
            dif_sheet_free(b->sheet[side][w]);
    dif_field_free(&b->field);
}

static dif_evaluator open_cpu(const bench *b)
{
    dif_evaluator cpu;
    dif_error err;
    assert_int_equal(dif_cpu_evaluator_open(&b->model[0], &cpu, &err), DIF_OK);
    return cpu;
}

static dif_evaluator open_with(const bench *b, dif_gpu_eval_opts opts)
{
    dif_evaluator gpu;
    dif_error err;
    if (dif_gpu_evaluator_open(b->gpu, &b->model[1], &opts, &gpu, &err) != DIF_OK)
        fail_msg("%s", err.text);
    return gpu;
}

static dif_gpu_eval_opts by(dif_gpu_path path)
{
    dif_gpu_eval_opts opts = dif_gpu_eval_opts_default();
    opts.path = path;
    return opts;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Worst absolute difference in units of the largest value or 1, and the 99th percentile of the symmetric relative one above
 * 1e-5 of the largest. */
static void compare(size_t n, const double *want, const double *got, double *worst, double *p99)
{
    static double relative[1 << 16];
    double peak = 0.0;
    size_t n_relative = 0;
    *worst = 0.0;
    for (size_t i = 0; i < n; i++)
        peak = fmax(peak, want[i]);
    for (size_t i = 0; i < n; i++) {
        const double difference = fabs(got[i] - want[i]), size = fmax(fabs(got[i]), fabs(want[i]));
        *worst = isnan(difference) ? 1e9 : fmax(*worst, difference);
        if (size > 1e-5 * peak && n_relative < sizeof relative / sizeof *relative)
            relative[n_relative++] = isnan(difference) ? 1e9 : difference / size;
    }
    qsort(relative, n_relative, sizeof *relative, by_size);
    *p99 = n_relative > 0 ? relative[(size_t)(0.99 * (double)(n_relative - 1))] : 0.0;
}

static dif_plan make_plan(int n_angle, int n_lambda, double azimuth_rad)
{
    dif_plan plan;
    assert_int_equal(dif_plan_create(n_angle, n_lambda, &plan, NULL), DIF_OK);
    plan.fixed_is_wo = true;
    plan.fixed_rad = 0.4;
    plan.azimuth_rad = azimuth_rad;
    for (int i = 0; i < n_angle; i++)
        plan.angle_rad[i] = dif_rad_from_deg(-85.0 + 170.0 * i / (n_angle - 1));
    for (int i = 0; i < n_lambda; i++)
        plan.lambda_um[i] = 0.38 + 0.4 * i / (n_lambda - 1);
    return plan;
}

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

/* Every direction of a hemisphere that a square map of 32^2 pixels holds. */
static int make_map(dif_vec3 *wi, dif_vec3 *wo)
{
    enum { SIDE = 32 };
    int n = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            const double a = (2.0 * x + 1.0) / SIDE - 1.0, b = (2.0 * y + 1.0) / SIDE - 1.0;
            if (a * a + b * b > 0.98)
                continue;
            wi[n] = dif_vec3_from_angles_rad(0.5, 0.3);
            wo[n++] = (dif_vec3){a, b, sqrt(1.0 - a * a - b * b)};
        }
    /* the mirror direction, where (u, v) vanishes */
    wi[n] = dif_vec3_from_angles_rad(0.5, 0.3);
    wo[n] = (dif_vec3){-wi[n].x, -wi[n].y, wi[n].z};
    return n + 1;
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

static dif_field rough(void)
{
    return test_rough_field(150, 140, 0.15, 0.14, 0.9, 1);
}

static dif_field made(dif_surface_kind kind)
{
    dif_surface surface = dif_surface_default(kind);
    dif_field field;
    surface.nx = 250;
    surface.ny = 240;
    surface.pitch_um = 0.1;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    return field;
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

/* A small integrated table of a snake. */
static dif_lut make_lut(const dif_field *field, int n_map)
{
    const dif_window window = {DIF_WINDOW_GAUSS, 4.0, 0.0, 0.0};
    const double share = 1.0;
    double lambda_um[21];
    dif_lut_opts opts = dif_lut_opts_default();
    dif_lut lut;
    dif_error err;
    opts.n_azimuth = 256;
    opts.n_radius = 80;
    opts.n_map = n_map;
    for (int i = 0; i < 21; i++)
        lambda_um[i] = 0.38 + 0.02 * i;
    assert_int_equal(dif_lut_create(field, 1, &window, &share, 21, lambda_um, 1e-4, &opts, &lut, &err), DIF_OK);
    return lut;
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
