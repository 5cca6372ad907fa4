/* Samples of a map lie on rays through the origin of frequency space, one per pixel, so neighbouring pixels share memory
 * at one wavelength but not across wavelengths. The work therefore runs over tiles of frequency bins: each tile is read
 * once, by all wavelengths' pixels that fall into it. */
#include "bench/map.h"

#include <math.h>
#include <omp.h>

#include "bench/map_methods.h"
#include "bench/measure_impl.h"
#include "core/alloc.h"
#include "core/direct.h"
#include "core/response.h"
#include "core/spectrum.h"
#include "core/units.h"

enum {
    TILE = 32
}; /* bins on a side: 32 x 32 bins of 15 planes are 123 kB in float, a share of the second-level cache */

/* Everything one map needs. */
typedef struct map_job {
    const dif_map_plan *plan;
    const dif_measure_opts *opts;
    double (*weight)[3]; /* of each wavelength, for XYZ                                     */
    double *cosine;      /* wi.z + wo.z of each pixel, -1 outside the disc                  */
    float *gain;         /* of each pixel: quantity / power (at 1 um for the BRDF)          */
    double *sums;        /* sums[n_pixel^2][3], by all threads                              */
    double round_at;     /* see rounded()                                                   */
    omp_lock_t *row;     /* row[n_row], one a row of pixels                                 */
    int n_row;           /* locks that are ready                                            */
    dif_map *map;
} map_job;

static size_t pixels_of(const map_job *job)
{
    return (size_t)job->plan->n_pixel * (size_t)job->plan->n_pixel;
}

static double coordinate(int n_pixel, int i)
{
    return (2.0 * i + 1.0) / n_pixel - 1.0;
}

bool dif_map_direction(int n_pixel, int ix, int iy, dif_vec3 *out)
{
    const double x = coordinate(n_pixel, ix), y = -coordinate(n_pixel, iy), z2 = 1.0 - x * x - y * y;
    *out = (dif_vec3){x, y, z2 > 0.0 ? sqrt(z2) : 0.0};
    return z2 > 0.0;
}

static dif_status check_plan(const dif_map_plan *plan, const dif_measure_opts *opts, dif_error *err)
{
    if (!(plan->n_pixel >= DIF_MAP_PIXEL_MIN && plan->n_pixel <= DIF_MAP_PIXEL_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d pixels across, want %d ... %d", plan->n_pixel, DIF_MAP_PIXEL_MIN,
                        DIF_MAP_PIXEL_MAX);
    if (!(fabs(dif_vec3_dot(plan->fixed, plan->fixed) - 1.0) < 1e-9 && plan->fixed.z > 0.0))
        return dif_fail(err, DIF_ERR_ARG, "the fixed direction is not a unit vector above the surface");
    for (int i = 0; i < plan->n_lambda; i++)
        if (!(plan->lambda_um[i] > 0.0 && plan->lambda_um[i] < 1e6))
            return dif_fail(err, DIF_ERR_ARG, "wavelength %g um, want > 0", plan->lambda_um[i]);
    if (plan->n_lambda < 1)
        return dif_fail(err, DIF_ERR_ARG, "no wavelengths");
    return dif_map_check_method(plan, opts, err);
}

static dif_vec3 wi_of(const dif_map_plan *plan, dif_vec3 other)
{
    return plan->fixed_is_wo ? other : plan->fixed;
}

static dif_vec3 wo_of(const dif_map_plan *plan, dif_vec3 other)
{
    return plan->fixed_is_wo ? plan->fixed : other;
}

/* What a pixel fixes: its cosine sum and its gain. */
static void fill_pixels(const map_job *job, double area_um2)
{
    const dif_map_plan *plan = job->plan;
    const int n = plan->n_pixel;
#pragma omp parallel for schedule(dynamic, 16)
    for (int iy = 0; iy < n; iy++)
        for (int ix = 0; ix < n; ix++) {
            const size_t at = (size_t)iy * (size_t)n + (size_t)ix;
            dif_vec3 other;
            const bool inside = dif_map_direction(n, ix, iy, &other);
            job->cosine[at] = inside ? plan->fixed.z + other.z : -1.0;
            job->gain[at] = 0.0f;
            if (inside)
                job->gain[at] = (float)dif_method_gain(job->opts, job->opts->quantity, wi_of(plan, other),
                                                       wo_of(plan, other), area_um2);
        }
}

static double unit_of(const map_job *job, int il)
{
    const double lambda_um = job->plan->lambda_um[il];
    return job->opts->quantity == DIF_QUANTITY_BRDF ? 1.0 / (lambda_um * lambda_um) : 1.0;
}

/* Threads add to a pixel in any order, so sums must not depend on it: every term is first rounded to a multiple of one
 * quantum, and sums of multiples are exact as long as they stay below 2^52 of them. Adding a large number does the
 * rounding: this one is 3 * 2^q, of which 2^q is above all terms of a pixel together; the quantum is 2^(q - 51). */
static double round_at(const map_job *job)
{
    double sum = 0.0;
    for (int il = 0; il < job->plan->n_lambda; il++)
        sum += unit_of(job, il) * fmax(job->weight[il][0], fmax(job->weight[il][1], job->weight[il][2]));
    return 3.0 * exp2(ceil(log2(sum)));
}

static double rounded(double value, double at)
{
    return (value + at) - at;
}

static dif_status job_make(map_job *job, double area_um2, dif_error *err)
{
    const dif_map_plan *plan = job->plan;
    const size_t n = pixels_of(job);
    job->weight = dif_alloc((size_t)plan->n_lambda, sizeof *job->weight);
    job->cosine = dif_alloc(n, sizeof *job->cosine);
    job->gain = dif_alloc(n, sizeof *job->gain);
    job->sums = dif_alloc(3 * n, sizeof *job->sums);
    job->row = dif_alloc((size_t)plan->n_pixel, sizeof *job->row);
    job->map->xyz = dif_alloc(3 * n, sizeof *job->map->xyz);
    if (plan->keep_layers)
        job->map->layer = dif_alloc(n, (size_t)plan->n_lambda * sizeof *job->map->layer);
    if (!job->weight || !job->cosine || !job->gain || !job->sums || !job->row || !job->map->xyz ||
        (plan->keep_layers && !job->map->layer))
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for a map of %d pixels across", plan->n_pixel);
    job->map->n_pixel = plan->n_pixel;
    job->map->n_lambda = plan->n_lambda;
    for (; job->n_row < plan->n_pixel; job->n_row++)
        omp_init_lock(job->row + job->n_row);
    fill_pixels(job, area_um2);
    const dif_status status = dif_spectrum_weights(plan->n_lambda, plan->lambda_um, job->weight, err);
    job->round_at = status == DIF_OK ? round_at(job) : 0.0;
    return status;
}

static void job_free(map_job *job)
{
    while (job->n_row > 0)
        omp_destroy_lock(job->row + --job->n_row);
    dif_release(job->row);
    dif_release(job->weight);
    dif_release(job->cosine);
    dif_release(job->gain);
    dif_release(job->sums);
}

/* Pixels [*first, *end) whose frequency -k (fixed + coordinate) along one axis falls into [low, high). The coordinate
 * rises with the pixel (x) or falls (y, row 0 on top): sign +1 or -1. */
static void pixel_range(int n, double k, double fixed, int sign, double low, double high, int *first, int *end)
{
    /* -k (fixed + sign c) in [low, high)  <=>  sign c in (-high/k - fixed, -low/k - fixed] */
    const double from = -high / k - fixed, to = -low / k - fixed;
    const double lo = sign > 0 ? from : -to, hi = sign > 0 ? to : -from;
    /* c = (2 i + 1)/n - 1 */
    double a = 0.5 * ((lo + 1.0) * n - 1.0), b = 0.5 * ((hi + 1.0) * n - 1.0);
    /* sign > 0: i in (a, b]; sign < 0: i in [a, b) */
    a = sign > 0 ? floor(a) + 1.0 : ceil(a);
    b = sign > 0 ? floor(b) + 1.0 : ceil(b);
    *first = (int)fmin(fmax(a, 0.0), n);
    *end = (int)fmin(fmax(b, *first), n);
}

/* Adds the powers of n neighbouring pixels of row iy, from ix on, at one wavelength to their sums and layers. */
static void add_row(const map_job *job, double share, int il, int ix, int iy, int n, const float *power)
{
    const size_t first = (size_t)iy * (size_t)job->plan->n_pixel + (size_t)ix;
    const double unit = share * unit_of(job, il), at = job->round_at;
    double *sums = job->sums + 3 * first, w[3];
    for (int c = 0; c < 3; c++)
        w[c] = unit * job->weight[il][c];
    omp_set_lock(job->row + iy);
    for (size_t i = 0; i < (size_t)n; i++)
        for (size_t c = 0; c < 3; c++)
            sums[3 * i + c] += rounded(w[c] * (double)power[i], at);
    omp_unset_lock(job->row + iy);
    if (!job->map->layer)
        return;
    float *layer = job->map->layer + (size_t)il * pixels_of(job) + first;
    for (size_t i = 0; i < (size_t)n; i++)
        layer[i] += (float)unit * job->gain[first + i] * power[i];
}

/* One block of pixels at one wavelength. */
static void add_block(const map_job *job, const dif_sheet *sheet, double share, int il, int ix0, int nx, int iy0,
                      int ny)
{
    const dif_map_plan *plan = job->plan;
    const int n = plan->n_pixel;
    const double k = DIF_TWO_PI / plan->lambda_um[il];
    double kx[DIF_RESPONSE_GRID], ky[DIF_RESPONSE_GRID], kz[DIF_RESPONSE_GRID * DIF_RESPONSE_GRID];
    float power[DIF_RESPONSE_GRID * DIF_RESPONSE_GRID];
    for (int i = 0; i < nx; i++)
        kx[i] = -k * (plan->fixed.x + coordinate(n, ix0 + i));
    for (int j = 0; j < ny; j++) {
        ky[j] = -k * (plan->fixed.y - coordinate(n, iy0 + j));
        for (int i = 0; i < nx; i++)
            kz[j * DIF_RESPONSE_GRID + i] = k * job->cosine[(size_t)(iy0 + j) * (size_t)n + (size_t)(ix0 + i)];
    }
    dif_response_volume_grid(sheet, nx, kx, ny, ky, kz, DIF_RESPONSE_GRID, power, DIF_RESPONSE_GRID);
    for (int j = 0; j < ny; j++)
        add_row(job, share, il, ix0, iy0 + j, nx, power + j * DIF_RESPONSE_GRID);
}

/* All wavelengths' pixels of one tile of frequency space. */
static void add_tile(const map_job *job, const dif_sheet *sheet, double share, double kx0, double ky0, double side)
{
    const dif_map_plan *plan = job->plan;
    for (int il = 0; il < plan->n_lambda; il++) {
        const double k = DIF_TWO_PI / plan->lambda_um[il];
        int ix0, ix1, iy0, iy1;
        pixel_range(plan->n_pixel, k, plan->fixed.x, 1, kx0, kx0 + side, &ix0, &ix1);
        pixel_range(plan->n_pixel, k, plan->fixed.y, -1, ky0, ky0 + side, &iy0, &iy1);
        for (int y = iy0; y < iy1; y += DIF_RESPONSE_GRID)
            for (int x = ix0; x < ix1; x += DIF_RESPONSE_GRID) {
                const int nx = ix1 - x < DIF_RESPONSE_GRID ? ix1 - x : DIF_RESPONSE_GRID;
                const int ny = iy1 - y < DIF_RESPONSE_GRID ? iy1 - y : DIF_RESPONSE_GRID;
                add_block(job, sheet, share, il, x, nx, y, ny);
            }
    }
}

static dif_band band_of(const dif_map_plan *plan)
{
    const double k_max = DIF_TWO_PI / plan->lambda_um[0], k_min = DIF_TWO_PI / plan->lambda_um[plan->n_lambda - 1];
    return (dif_band){k_max * (1.0 + hypot(plan->fixed.x, plan->fixed.y)), k_min * plan->fixed.z,
                      k_max * (1.0 + plan->fixed.z)};
}

/* All tiles of one window's sheet; `done` and `span`: where it stands in the whole measurement. */
static void add_sheet(const map_job *job, const dif_sheet *sheet, double share, double done, double span)
{
    /* A tile's side in frequency; its sheet has bins of about this spacing. */
    const dif_band band = band_of(job->plan);
    const double reach = band.k_lateral_max_rad_per_um, side = 2.0 * reach * TILE / dif_sheet_info_of(sheet).n_bin_x;
    const int n_side = (int)ceil(2.0 * reach / side) + 1, n_tile = n_side * n_side;
#pragma omp parallel for schedule(dynamic)
    for (int tile = 0; tile < n_tile; tile++) {
        const double kx0 = -reach + side * (tile / n_side - 0.5), ky0 = -reach + side * (tile % n_side - 0.5);
        add_tile(job, sheet, share, kx0, ky0, side);
        if (omp_get_thread_num() == 0) /* the calling one; tiles come in order */
            dif_measure_progress(job->opts, done + span * tile / n_tile);
    }
}

static dif_status map_by_sheet(const map_job *job, const dif_field *field, double tol, const dif_window_set *set,
                               dif_measure_stats *stats, dif_error *err)
{
    const dif_band band = band_of(job->plan);
    dif_stopwatch watch = dif_stopwatch_start();
    for (int i = 0; i < set->n; i++) {
        dif_sheet *sheet;
        const dif_status status = dif_sheet_create_volume(field, set->window + i, &band, tol, NULL, &sheet, err);
        if (status != DIF_OK)
            return status;
        dif_measure_note_sheet(stats, sheet);
        dif_stopwatch_lap(&watch, &stats->build_wall_s, &stats->build_cpu_s);
        add_sheet(job, sheet, set->share[i], (i + 0.2) / set->n, 0.8 / set->n);
        dif_stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
        dif_sheet_free(sheet);
        dif_measure_progress(job->opts, (i + 1.0) / set->n);
    }
    return DIF_OK;
}

/* Applies the gains. */
static void finish(const map_job *job)
{
    const size_t n = pixels_of(job);
    for (size_t at = 0; at < n; at++)
        for (size_t c = 0; c < 3; c++)
            job->map->xyz[3 * at + c] = (float)(job->sums[3 * at + c] * (double)job->gain[at]);
}

/* One row of pixels at one wavelength and window, by the direct sum. */
static dif_status add_direct_row(const map_job *job, const dif_field *field, const dif_window_set *set, int iy, int il,
                                 int window, dif_vec3 *kappa, double (*amp)[2], dif_error *err)
{
    const dif_map_plan *plan = job->plan;
    const double k = DIF_TWO_PI / plan->lambda_um[il];
    float power[DIF_MAP_PIXEL_MAX];
    int n = 0, first = plan->n_pixel;
    for (int ix = 0; ix < plan->n_pixel; ix++) {
        dif_vec3 other;
        if (!dif_map_direction(plan->n_pixel, ix, iy, &other))
            continue;
        first = n == 0 ? ix : first;
        kappa[n++] =
            (dif_vec3){-k * (plan->fixed.x + other.x), -k * (plan->fixed.y + other.y), -k * (plan->fixed.z + other.z)};
    }
    if (n == 0)
        return DIF_OK;
    const dif_status status = dif_direct_amplitudes(field, set->window + window, (size_t)n, kappa, amp, err);
    for (int i = 0; i < n && status == DIF_OK; i++)
        power[i] = (float)(amp[i][0] * amp[i][0] + amp[i][1] * amp[i][1]);
    if (status == DIF_OK)
        add_row(job, set->share[window], il, first, iy, n, power);
    return status;
}

/* The reference: every pixel inside the disc, every wavelength, by the direct sum. */
static dif_status map_by_direct(const map_job *job, const dif_field *field, const dif_window_set *set,
                                dif_measure_stats *stats, dif_error *err)
{
    const dif_map_plan *plan = job->plan;
    const int n = plan->n_pixel;
    dif_vec3 *kappa = dif_alloc((size_t)n, sizeof *kappa);
    double(*amp)[2] = dif_alloc((size_t)n, sizeof *amp);
    dif_status status = kappa && amp ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for %d pixels", n);
    dif_stopwatch watch = dif_stopwatch_start();
    stats->bound = DIF_DIRECT_BOUND;
    for (int iy = 0; iy < n; iy++) {
        for (int row = 0; row < plan->n_lambda * set->n && status == DIF_OK; row++)
            status = add_direct_row(job, field, set, iy, row / set->n, row % set->n, kappa, amp, err);
        dif_measure_progress(job->opts, (iy + 1.0) / n);
    }
    dif_stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
    dif_release(kappa);
    dif_release(amp);
    return status;
}

static dif_status map_by(const map_job *job, const dif_field *field, double tol, const dif_window_set *set,
                         dif_measure_stats *stats, dif_error *err)
{
    if (job->opts->method == DIF_METHOD_DIRECT)
        return map_by_direct(job, field, set, stats, err);
    if (job->opts->method == DIF_METHOD_SHEET)
        return map_by_sheet(job, field, tol, set, stats, err);
    const dif_map_sums to = {.plan = job->plan,
                             .weight = (const double(*)[3])job->weight,
                             .gain = job->gain,
                             .per_lambda2 = job->opts->quantity == DIF_QUANTITY_BRDF,
                             .sums = job->sums,
                             .layer = job->map->layer};
    return dif_map_by_method(&to, field, tol, job->opts, set, stats, err);
}

dif_status dif_map_measure(const dif_field *field, const dif_map_plan *plan, double tol, const dif_measure_opts *opts,
                           dif_map *out, dif_measure_stats *stats, dif_error *err)
{
    dif_window_set set = {0};
    dif_measure_stats own;
    const dif_measure_opts defaults = dif_measure_opts_default();
    if (!opts)
        opts = &defaults;
    map_job job = {.plan = plan, .opts = opts, .map = out};
    if (!stats)
        stats = &own;
    *stats = (dif_measure_stats){0};
    *out = (dif_map){0};
    dif_status status = dif_measure_check_opts(field, tol, opts, err);
    if (status == DIF_OK)
        status = check_plan(plan, opts, err);
    if (status != DIF_OK)
        return status;
    const int threads = dif_measure_threads(opts);
    status = dif_window_set_make(field, opts, &set, err);
    if (status == DIF_OK)
        status = job_make(&job, set.area_um2, err);
    if (status == DIF_OK)
        status = map_by(&job, field, tol, &set, stats, err);
    if (status == DIF_OK)
        finish(&job);
    else
        dif_map_free(out);
    omp_set_num_threads(threads);
    stats->n_window = set.n;
    stats->n_sample = (size_t)plan->n_lambda * pixels_of(&job);
    stats->area_um2 = set.area_um2;
    dif_window_set_free(&set);
    job_free(&job);
    return status;
}

void dif_map_free(dif_map *map)
{
    dif_release(map->xyz);
    dif_release(map->layer);
    *map = (dif_map){0};
}
