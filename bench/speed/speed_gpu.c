#define _POSIX_C_SOURCE 200809L /* clock_gettime */
/* Speed of the GPU evaluator: the cost of a pixel by each method in texture reads and as the time of a frame of 1920 x 1080,
 * and the table of 1801 x 401 with its transfers and without. Needs core, fixtures and gpu alone, so that it can be carried
 * to a machine with nothing but a driver (and OpenCV's core, which holds the DFT).
 * Colours are held against full sampling in 2 nm, from which the integrated table is made, too: in 5 nm, the 81 wavelengths
 * that are timed, the sum itself is off by more than the table (one window's spectrum has lines of a few nm).
 * A software renderer does the slow methods on tiles of the frame, whose time is scaled by pixels.
 * usage: speed_gpu [--smallest] [--require-hardware]; exit 4: no GPU */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/alloc.h"
#include "core/colour.h"
#include "core/sheet.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "gpu/gpu.h"

enum { WIDTH = 1920, HEIGHT = 1080, REPS = 5, N_LAMBDA = 81, N_FINE = 201, N_CHECK = 200, NO_GPU = 4 };
enum { TILE = 8, TILES = 16 };
#define TOL_FRAME 1e-4 /* of sheets behind colours */
#define TOL_TABLE 1e-6

/* What is measured, and on what. */
typedef struct bench {
    dif_gpu *gpu;
    dif_gpu_info info;
    bool smallest;
    dif_field field;
    dif_window window;
    double share, lambda_um[N_LAMBDA], fine_um[N_FINE];
    int n_lambda, n_fine, width, height;
    dif_sheet *sheet, *patch;
    const dif_sheet *sheets[1], *patches[1];
    dif_lut lut;
    double full_s_per_pixel, lut_s_per_pixel;
} bench;

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void must(dif_status status, const dif_error *err)
{
    if (status == DIF_OK)
        return;
    fprintf(stderr, "%s: %s\n", dif_status_text(status), err->text);
    exit(status == DIF_ERR_RESOURCE ? NO_GPU : EXIT_FAILURE);
}

static void *room(size_t n, size_t size)
{
    void *block = dif_alloc(n, size);
    dif_error err = {DIF_ERR_NOMEM, "no memory for a frame"};
    must(block ? DIF_OK : DIF_ERR_NOMEM, &err);
    return block;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Pixel (x, y) of the frame looks at every direction within 80 degrees: rows are rings, columns azimuths. */
static dif_vec3 look(const bench *b, int x, int y)
{
    const double s = 0.985 * (y + 0.5) / b->height, phi = DIF_TWO_PI * (x + 0.5) / b->width;
    return (dif_vec3){s * cos(phi), s * sin(phi), sqrt(1.0 - s * s)};
}

/* The whole frame, or its tiles. */
static size_t directions(const bench *b, bool tiles, dif_vec3 *wi, dif_vec3 *wo)
{
    const dif_vec3 light = dif_vec3_from_angles_rad(0.5, 0.3);
    const int n_y = tiles ? TILES * TILE : b->height, n_x = tiles ? TILE : b->width;
    size_t n = 0;
    for (int y = 0; y < n_y; y++)
        for (int x = 0; x < n_x; x++, n++) {
            const int tile = y / TILE;
            const int at_x = tiles ? (tile * 7 % TILES) * b->width / TILES + x : x;
            const int at_y = tiles ? tile * b->height / TILES + y % TILE : y;
            wi[n] = light;
            wo[n] = look(b, at_x % b->width, at_y % b->height);
        }
    return n;
}

static double lab_difference(const double a[3], const double b[3], double exposure)
{
    double scaled[2][3], lab[2][3];
    for (int c = 0; c < 3; c++) {
        scaled[0][c] = exposure * a[c];
        scaled[1][c] = exposure * b[c];
    }
    dif_colour_lab_from_xyz(scaled[0], lab[0]);
    dif_colour_lab_from_xyz(scaled[1], lab[1]);
    return dif_colour_difference_2000(lab[0], lab[1]);
}

/* Errors of a frame on some of its pixels: worst |XYZ| over the peak against the same method on the CPU, and the 95th
 * percentile of the colour difference from full spectral sampling, exposed so that the brightest of them is white. */
static void errors(const dif_model *model, const dif_model *full, size_t n, const dif_vec3 *wi, const dif_vec3 *wo,
                   double (*got)[3], double *worst, double *p95)
{
    const size_t n_check = n < N_CHECK ? n : N_CHECK;
    static dif_vec3 some_wi[N_CHECK], some_wo[N_CHECK];
    static double own[N_CHECK][3], want[N_CHECK][3], de[N_CHECK];
    double peak = 0.0;
    dif_evaluator cpu;
    dif_error err;
    for (size_t i = 0; i < n_check; i++) {
        some_wi[i] = wi[i * (n / n_check)];
        some_wo[i] = wo[i * (n / n_check)];
    }
    must(dif_cpu_evaluator_open(model, &cpu, &err), &err);
    must(cpu.colours(cpu.self, n_check, some_wi, some_wo, own, NULL, &err), &err);
    dif_evaluator_close(&cpu);
    must(dif_cpu_evaluator_open(full, &cpu, &err), &err);
    must(cpu.colours(cpu.self, n_check, some_wi, some_wo, want, NULL, &err), &err);
    dif_evaluator_close(&cpu);
    *worst = 0.0;
    for (size_t i = 0; i < n_check; i++)
        peak = fmax(peak, want[i][1]);
    for (size_t i = 0; i < n_check; i++) {
        const double *at = got[i * (n / n_check)];
        for (int c = 0; c < 3; c++)
            *worst = fmax(*worst, fabs(at[c] - own[i][c]));
        de[i] = lab_difference(at, want[i], peak > 0.0 ? 1.0 / peak : 1.0);
    }
    qsort(de, n_check, sizeof *de, by_size);
    *p95 = de[(size_t)(0.95 * (double)(n_check - 1))];
}

static void header(void)
{
    printf("name,n,tol,err_reached,reps,min_s,median_s,per_s,reads_per_pixel,frame_s,upload_s,download_s,de2000_p95\n");
}

/* A frame by one method. n_wave: wavelengths that a pixel sees. tiles: measure those only. */
static double run_frame(const bench *b, const char *name, const dif_model *model, const dif_model *full,
                        dif_gpu_eval_opts opts, bool tiles, double n_wave)
{
    const size_t n_max = tiles ? (size_t)TILES * TILE * TILE : (size_t)b->width * (size_t)b->height;
    dif_vec3 *wi = room(n_max, sizeof *wi), *wo = room(n_max, sizeof *wo);
    double(*xyz)[3] = room(n_max, sizeof *xyz);
    const size_t n = directions(b, tiles, wi, wo);
    double run_s[REPS], worst, p95;
    dif_evaluator eval;
    dif_eval_cost cost;
    dif_error err;
    must(dif_gpu_evaluator_open(b->gpu, model, &opts, &eval, &err), &err);
    for (int i = -1; i < REPS; i++) { /* one warm-up */
        must(eval.colours(eval.self, n, wi, wo, xyz, &cost, &err), &err);
        if (i >= 0)
            run_s[i] = cost.run_s;
    }
    dif_evaluator_close(&eval);
    errors(model, full, n, wi, wo, xyz, &worst, &p95);
    qsort(run_s, REPS, sizeof *run_s, by_size);
    const double per_pixel_s = run_s[REPS / 2] / (double)n;
    printf("%s %s%s,%zu,%.0e,%.2e,%d,%.6f,%.6f,%.4g,%.1f,%.6f,%.4f,%.4f,%.3f\n", name,
           opts.path == DIF_GPU_COMPUTE ? "compute" : "fragment", opts.half ? " half" : "", n, TOL_FRAME, worst, REPS,
           run_s[0], run_s[REPS / 2], 1.0 / per_pixel_s, dif_gpu_reads_of_colour(model, n_wave),
           per_pixel_s * WIDTH * HEIGHT, cost.upload_s, cost.download_s, p95);
    fflush(stdout);
    dif_release(wi);
    dif_release(wo);
    dif_release(xyz);
    return per_pixel_s;
}

/* nmm reads as many waves as a direction sees bins: the mean over the frame. */
static double waves_of_nmm(const bench *b, const dif_nmm *nmm)
{
    const dif_vec3 light = dif_vec3_from_angles_rad(0.5, 0.3);
    double sum = 0.0;
    for (int y = 0; y < b->height; y++) {
        int first;
        const dif_vec3 uvw = dif_vec3_transfer(light, look(b, 17 * y % b->width, y));
        const int n = dif_nmm_bins(nmm, hypot(uvw.x, uvw.y), &first);
        sum += n > 0 ? n : nmm->n_fixed;
    }
    return sum / b->height;
}

static void frames(bench *b)
{
    const bool slow = b->info.software || b->smallest;
    const double extent_um = b->field.nx * b->field.pitch_x_um;
    const dif_model full = {.kind = DIF_MODEL_SHEET,
                            .n_sheet = 1,
                            .sheet = b->sheets,
                            .share = &b->share,
                            .n_lambda = b->n_lambda,
                            .lambda_um = b->lambda_um,
                            .nmm = {extent_um, b->lambda_um[0], b->lambda_um[b->n_lambda - 1], 8, true, 0.0},
                            .replica = {42, 42, 1.56, 1.56},
                            .stam = {1.55, (double)NAN, 0.5 * DIF_PI, b->window.sigma_um},
                            .lut = &b->lut,
                            .quantity = DIF_QUANTITY_POWER,
                            .index = dif_index_default()};
    dif_gpu_eval_opts opts = dif_gpu_eval_opts_default();
    dif_model model = full, fine = full;
    fine.n_lambda = b->n_fine;
    fine.lambda_um = b->fine_um;
    model.kind = DIF_MODEL_LUT;
    b->lut_s_per_pixel = run_frame(b, "lut", &model, &fine, opts, false, 0.0);
    opts.half = true;
    run_frame(b, "lut", &model, &fine, opts, false, 0.0);
    opts.path = DIF_GPU_FRAGMENT;
    run_frame(b, "lut", &model, &fine, opts, false, 0.0);
    opts.half = false;
    run_frame(b, "lut", &model, &fine, opts, false, 0.0);
    for (int path = DIF_GPU_COMPUTE; path <= DIF_GPU_FRAGMENT; path++) {
        opts.path = (dif_gpu_path)path;
        model.kind = DIF_MODEL_STAM;
        run_frame(b, "stam", &model, &fine, opts, false, b->n_lambda);
        model.kind = DIF_MODEL_NMM;
        run_frame(b, "nmm", &model, &fine, opts, slow, waves_of_nmm(b, &model.nmm));
        model.kind = DIF_MODEL_PQ;
        model.sheet = b->patches;
        run_frame(b, "pq", &model, &fine, opts, slow, b->n_lambda);
        model.sheet = b->sheets;
        const double full_s = run_frame(b, "sheet 81 wavelengths", &full, &fine, opts, slow, b->n_lambda);
        if (path == DIF_GPU_COMPUTE)
            b->full_s_per_pixel = full_s;
    }
}

/* The table of 1801 x 401: everything from the first call on, later calls, the shaders alone. */
static void table(bench *b)
{
    const int n_angle = b->smallest ? 91 : 1801, n_lambda = b->smallest ? 21 : 401;
    const double k = DIF_TWO_PI / 0.38;
    const dif_band band = {2.0 * k, 0.0, 2.0 * k};
    dif_plan plan;
    dif_sheet *line;
    dif_error err;
    must(dif_plan_create(n_angle, n_lambda, &plan, &err), &err);
    plan.fixed_is_wo = true;
    plan.fixed_rad = dif_rad_from_deg(75.0);
    for (int i = 0; i < n_angle; i++)
        plan.angle_rad[i] = dif_rad_from_deg(-89.0 + 178.0 * i / (n_angle - 1));
    for (int i = 0; i < n_lambda; i++)
        plan.lambda_um[i] = 0.38 + 0.4 * i / (n_lambda - 1);
    must(dif_sheet_create_line(&b->field, &b->window, 0.0, &band, TOL_TABLE, NULL, &line, &err), &err);
    const dif_sheet *lines[1] = {line};
    const dif_model model = {.kind = DIF_MODEL_SHEET,
                             .n_sheet = 1,
                             .sheet = lines,
                             .share = &b->share,
                             .quantity = DIF_QUANTITY_POWER,
                             .index = dif_index_default()};
    const size_t n = (size_t)n_angle * (size_t)n_lambda;
    double *want = room(n, sizeof *want), *got = room(n, sizeof *got), whole_s[REPS], run_s[REPS], first_s = 0.0;
    dif_evaluator cpu, gpu;
    dif_eval_cost cost = {0}, first = {0};
    must(dif_cpu_evaluator_open(&model, &cpu, &err), &err);
    must(cpu.table(cpu.self, &plan, want, NULL, &err), &err);
    dif_evaluator_close(&cpu);
    must(dif_gpu_evaluator_open(b->gpu, &model, NULL, &gpu, &err), &err);
    for (int i = -1; i < REPS; i++) {
        const double since_s = now_s();
        must(gpu.table(gpu.self, &plan, got, &cost, &err), &err);
        if (i < 0) {
            first_s = now_s() - since_s;
            first = cost;
            continue;
        }
        whole_s[i] = now_s() - since_s;
        run_s[i] = cost.run_s;
    }
    dif_evaluator_close(&gpu);
    double worst = 0.0;
    for (size_t i = 0; i < n; i++)
        worst = fmax(worst, fabs(got[i] - want[i]));
    qsort(whole_s, REPS, sizeof *whole_s, by_size);
    qsort(run_s, REPS, sizeof *run_s, by_size);
    printf("table first call (shader compiled and sheet uploaded),%zu,%.0e,%.2e,1,%.6f,%.6f,%.4g,,,%.4f,%.4f,\n", n,
           TOL_TABLE, worst, first_s, first_s, (double)n / first_s, first.upload_s, first.download_s);
    printf("table with transfers,%zu,%.0e,%.2e,%d,%.6f,%.6f,%.4g,,,%.4f,%.4f,\n", n, TOL_TABLE, worst, REPS, whole_s[0],
           whole_s[REPS / 2], (double)n / whole_s[REPS / 2], cost.upload_s, cost.download_s);
    printf("table without transfers,%zu,%.0e,%.2e,%d,%.6f,%.6f,%.4g,,,0,0,\n", n, TOL_TABLE, worst, REPS, run_s[0],
           run_s[REPS / 2], (double)n / run_s[REPS / 2]);
    dif_release(want);
    dif_release(got);
    dif_sheet_free(line);
    dif_plan_free(&plan);
}

/* The surface, its sheets and its integrated table. */
static void prepare(bench *b)
{
    dif_surface surface = dif_surface_default(DIF_SURFACE_XENOPELTIS);
    dif_lut_opts how = dif_lut_opts_default();
    const double k = DIF_TWO_PI / 0.38;
    const dif_band band = {1.5 * k, 0.0, 2.0 * k}; /* light at 0.5 rad, any view */
    const dif_window flat = {.kind = DIF_WINDOW_FLAT};
    dif_field cell;
    dif_error err;
    if (b->smallest) {
        surface.nx = surface.ny = 64;
        how.n_azimuth = 64;
        how.n_radius = 16;
    }
    must(dif_surface_make(&surface, &b->field, &err), &err);
    b->window = (dif_window){DIF_WINDOW_GAUSS, 0.25 * b->field.nx * b->field.pitch_x_um, 0.0, 0.0};
    surface.nx = surface.ny = 32;
    must(dif_surface_make(&surface, &cell, &err), &err);
    must(dif_sheet_create_volume(&b->field, &b->window, &band, TOL_FRAME, NULL, &b->sheet, &err), &err);
    must(dif_sheet_create_volume(&cell, &flat, &band, TOL_FRAME, NULL, &b->patch, &err), &err);
    dif_field_free(&cell);
    must(dif_lut_create(&b->field, 1, &b->window, &b->share, b->n_fine, b->fine_um, TOL_FRAME, &how, &b->lut, &err),
         &err);
    b->sheets[0] = b->sheet;
    b->patches[0] = b->patch;
}

int main(int argc, char **argv)
{
    bench b = {.share = 1.0, .width = WIDTH, .height = HEIGHT, .n_lambda = N_LAMBDA, .n_fine = N_FINE};
    dif_gpu_opts opts = dif_gpu_opts_default();
    dif_error err;
    for (int i = 1; i < argc; i++) {
        b.smallest = b.smallest || strcmp(argv[i], "--smallest") == 0;
        opts.require_hardware = opts.require_hardware || strcmp(argv[i], "--require-hardware") == 0;
    }
    if (b.smallest) {
        b.width = 64;
        b.height = 36;
        b.n_lambda = 5;
        b.n_fine = 11;
    }
    for (int i = 0; i < b.n_lambda; i++)
        b.lambda_um[i] = dif_um_from_nm(380.0 + 400.0 * i / (b.n_lambda - 1));
    for (int i = 0; i < b.n_fine; i++)
        b.fine_um[i] = dif_um_from_nm(380.0 + 400.0 * i / (b.n_fine - 1));
    must(dif_gpu_open(&opts, &b.gpu, &err), &err);
    b.info = dif_gpu_info_of(b.gpu);
    fprintf(stderr, "%s; %s; %s, %s; times by %s\n", b.info.renderer, b.info.version, b.info.platform,
            b.info.software ? "software" : "hardware", b.info.timer && !b.info.software ? "timer query" : "the clock");
    prepare(&b);
    header();
    frames(&b);
    table(&b);
    fprintf(stderr, "%d maps; a pixel by lut takes %.3g ns, by full sampling of %d wavelengths %.3g ns%s: %.0f times\n",
            b.lut.n_map, 1e9 * b.lut_s_per_pixel, b.n_lambda, 1e9 * b.full_s_per_pixel,
            b.info.software || b.smallest ? " (on tiles)" : "", b.full_s_per_pixel / b.lut_s_per_pixel);
    dif_lut_free(&b.lut);
    dif_sheet_free(b.sheet);
    dif_sheet_free(b.patch);
    dif_field_free(&b.field);
    dif_gpu_close(b.gpu);
    return 0;
}
