/* What the tests of the GPU evaluator share: a surface with a model for either side, and how two answers differ. */
#ifndef DIF_TEST_GPU_BENCH_H
#define DIF_TEST_GPU_BENCH_H

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

static inline int open_gpu(void **state)
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

static inline int close_gpu(void **state)
{
    dif_gpu_close(*state);
    return 0;
}

static inline dif_gpu *gpu_of(void **state)
{
    if (!*state)
        skip();
    return *state;
}

/* Opens a model of a kind on a surface. azimuth_rad NaN: volume sheets. */
static inline bench bench_open(dif_gpu *gpu, dif_field field, dif_model_kind kind, double azimuth_rad, int n_window)
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
static inline void bench_settle(bench *b)
{
    for (int side = 0; side < 2; side++) {
        for (int w = 0; w < b->n_window; w++)
            b->seen[side][w] = b->sheet[side][w];
        b->model[side].sheet = b->seen[side];
        b->model[side].share = b->share;
        b->model[side].lambda_um = b->lambda_um;
    }
}

static inline void bench_close(bench *b)
{
    for (int side = 0; side < 2; side++)
        for (int w = 0; w < b->n_window; w++)
            dif_sheet_free(b->sheet[side][w]);
    dif_field_free(&b->field);
}

static inline dif_evaluator open_cpu(const bench *b)
{
    dif_evaluator cpu;
    dif_error err;
    assert_int_equal(dif_cpu_evaluator_open(&b->model[0], &cpu, &err), DIF_OK);
    return cpu;
}

static inline dif_evaluator open_with(const bench *b, dif_gpu_eval_opts opts)
{
    dif_evaluator gpu;
    dif_error err;
    if (dif_gpu_evaluator_open(b->gpu, &b->model[1], &opts, &gpu, &err) != DIF_OK)
        fail_msg("%s", err.text);
    return gpu;
}

static inline dif_gpu_eval_opts by(dif_gpu_path path)
{
    dif_gpu_eval_opts opts = dif_gpu_eval_opts_default();
    opts.path = path;
    return opts;
}

static inline int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Worst absolute difference in units of the largest value or 1, and the 99th percentile of the symmetric relative one above
 * 1e-5 of the largest. */
static inline void compare(size_t n, const double *want, const double *got, double *worst, double *p99)
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

static inline dif_plan make_plan(int n_angle, int n_lambda, double azimuth_rad)
{
    dif_plan plan;
    assert_int_equal(dif_plan_create(n_angle, n_lambda, &plan, NULL), DIF_OK);
    plan.fixed_is_wo = true;
    plan.fixed_rad = 0.4;
    plan.azimuth_rad = azimuth_rad;
    for (int i = 0; i < n_angle; i++)
        plan.angle_rad[i] = dif_rad_from_deg(-85.0 + 170.0 * i / (n_angle - 1));
    for (int i = 0; i < n_lambda; i++)
        plan.lambda_um[i] = n_lambda > 1 ? 0.38 + 0.4 * i / (n_lambda - 1) : 0.5;
    return plan;
}

/* Every direction of a hemisphere that a square map of 32^2 pixels holds. */
static inline int make_map(dif_vec3 *wi, dif_vec3 *wo)
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

static inline dif_field rough(void)
{
    return test_rough_field(150, 140, 0.15, 0.14, 0.9, 1);
}

static inline dif_field made(dif_surface_kind kind)
{
    dif_surface surface = dif_surface_default(kind);
    dif_field field;
    surface.nx = 250;
    surface.ny = 240;
    surface.pitch_um = 0.1;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    return field;
}

/* A small integrated table of a snake. */
static inline dif_lut make_lut(const dif_field *field, int n_map)
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

#endif
