#define _POSIX_C_SOURCE 200809L
#include "bench/measure.h"

#include <math.h>
#include <omp.h>
#include <string.h>
#include <time.h>

#include "core/alloc.h"
#include "core/direct.h"
#include "core/response.h"
#include "core/sheet.h"
#include "core/units.h"

static const char *const METHOD_NAMES[] = {"sheet", "taylor", "direct"};
enum { N_METHOD = sizeof METHOD_NAMES / sizeof *METHOD_NAMES, CHUNK = 4096, DIRECT_CELLS = 64 };

const char *dif_method_name(dif_method method)
{
    return METHOD_NAMES[method];
}

bool dif_method_from_name(const char *name, dif_method *out)
{
    for (int i = 0; i < N_METHOD; i++)
        if (strcmp(name, METHOD_NAMES[i]) == 0) {
            *out = (dif_method)i;
            return true;
        }
    return false;
}

dif_measure_opts dif_measure_opts_default(void)
{
    return (dif_measure_opts){.method = DIF_METHOD_SHEET,
                              .n_terms = DIF_TERMS_FROM_TOL,
                              .window = DIF_WINDOW_GAUSS,
                              .sigma_um = DIF_SIGMA_DEFAULT_UM,
                              .average = DIF_AVERAGE_NONE,
                              .quantity = DIF_QUANTITY_RHO,
                              .index = dif_index_default(),
                              .n_thread = 0};
}

/* Wall and processor time, both in seconds. */
typedef struct stopwatch {
    double wall_s, cpu_s;
} stopwatch;

static double clock_s(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static stopwatch stopwatch_now(void)
{
    return (stopwatch){clock_s(CLOCK_MONOTONIC), clock_s(CLOCK_PROCESS_CPUTIME_ID)};
}

/* Adds the time since *since to the two sums and restarts. */
static void stopwatch_lap(stopwatch *since, double *wall_s, double *cpu_s)
{
    const stopwatch now = stopwatch_now();
    *wall_s += now.wall_s - since->wall_s;
    *cpu_s += now.cpu_s - since->cpu_s;
    *since = now;
}

static void report_progress(const dif_measure_opts *opts, double share)
{
    if (opts->progress)
        opts->progress(opts->progress_self, share);
}

/* The windows of a measurement, and the share that each has in the average. */
typedef struct window_set {
    int n;
    dif_window *window;
    double *share; /* (sum W_s)^2 / sum_s (sum W_s)^2                 */
    double area_um2;
} window_set;

static void window_set_free(window_set *set)
{
    dif_release(set->window);
    dif_release(set->share);
}

static dif_status window_set_make(const dif_field *field, const dif_measure_opts *opts, window_set *set, dif_error *err)
{
    *set = (window_set){.n = dif_window_tile_count(opts->window, opts->sigma_um, opts->average, field)};
    set->window = dif_alloc((size_t)set->n, sizeof *set->window);
    set->share = dif_alloc((size_t)set->n, sizeof *set->share);
    double *wx = dif_alloc((size_t)field->nx, sizeof *wx), *wy = dif_alloc((size_t)field->ny, sizeof *wy);
    dif_status status = DIF_OK;
    if (!set->window || !set->share || !wx || !wy) {
        status = dif_fail(err, DIF_ERR_NOMEM, "no memory for %d windows", set->n);
        goto done;
    }
    dif_window_tile(opts->window, opts->sigma_um, opts->average, field, set->window);
    double total = 0.0, total_w2 = 0.0;
    for (int i = 0; i < set->n; i++) {
        const dif_window_sums sums = dif_window_fill(set->window + i, field, wx, wy);
        set->share[i] = sums.w * sums.w;
        total += set->share[i];
        total_w2 += sums.w2;
    }
    for (int i = 0; i < set->n; i++)
        set->share[i] /= total;
    set->area_um2 = field->pitch_x_um * field->pitch_y_um * total / total_w2;
done:
    dif_release(wx);
    dif_release(wy);
    return status;
}

static dif_status check(const dif_field *field, double tol, const dif_measure_opts *opts, dif_error *err)
{
    const dif_status status = dif_field_check(field, err);
    if (status != DIF_OK)
        return status;
    if (!(tol >= 1e-14 && tol < 1.0))
        return dif_fail(err, DIF_ERR_TOL, "tol = %g, want 1e-14 <= tol < 1", tol);
    if (opts->window == DIF_WINDOW_GAUSS && !(opts->sigma_um > 0.0 && opts->sigma_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "sigma = %g um, want > 0", opts->sigma_um);
    if (!(opts->index.n > 0.0 && opts->index.kappa >= 0.0 && opts->index.n < 1e6 && opts->index.kappa < 1e6))
        return dif_fail(err, DIF_ERR_ARG, "refractive index %g + %gi, want n > 0 and kappa >= 0", opts->index.n,
                        opts->index.kappa);
    if (opts->n_thread < 0 || opts->n_thread > 1024)
        return dif_fail(err, DIF_ERR_ARG, "%d threads, want 0 (all) ... 1024", opts->n_thread);
    return DIF_OK;
}

static dif_sheet_opts sheet_opts(const dif_measure_opts *opts)
{
    dif_sheet_opts out = dif_sheet_opts_default();
    if (opts->method == DIF_METHOD_TAYLOR)
        out.basis = DIF_BASIS_POWERS;
    out.n_terms = opts->n_terms;
    return out;
}

static void note_sheet(dif_measure_stats *stats, const dif_sheet *sheet)
{
    const dif_sheet_info info = dif_sheet_info_of(sheet);
    stats->bound = fmax(stats->bound, info.bound);
    stats->n_plane = info.n_plane;
    stats->n_tap = info.n_tap;
    stats->single = info.single;
}

/* Directions of a plan's angles: sine and cosine sums. */
typedef struct transfer {
    double *s, *c; /* s[n_angle] = -(sin_i + sin_o), c[n_angle] = cos_i + cos_o */
} transfer;

static dif_status transfer_make(const dif_plan *plan, transfer *out, dif_band *band, dif_error *err)
{
    out->s = dif_alloc((size_t)plan->n_angle, sizeof *out->s);
    out->c = dif_alloc((size_t)plan->n_angle, sizeof *out->c);
    if (!out->s || !out->c)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d angles", plan->n_angle);
    double s_max = 0.0, c_min = 2.0, c_max = 0.0;
    for (int i = 0; i < plan->n_angle; i++) {
        double sin_sum;
        dif_plan_transfer(plan, i, &sin_sum, &out->c[i]);
        out->s[i] = -sin_sum;
        s_max = fmax(s_max, fabs(sin_sum));
        c_min = fmin(c_min, out->c[i]);
        c_max = fmax(c_max, out->c[i]);
    }
    double lambda_min = plan->lambda_um[0], lambda_max = plan->lambda_um[0];
    for (int i = 1; i < plan->n_lambda; i++) {
        lambda_min = fmin(lambda_min, plan->lambda_um[i]);
        lambda_max = fmax(lambda_max, plan->lambda_um[i]);
    }
    *band =
        (dif_band){DIF_TWO_PI / lambda_min * s_max, DIF_TWO_PI / lambda_max * c_min, DIF_TWO_PI / lambda_min * c_max};
    return DIF_OK;
}

/* Powers of a whole table from one sheet, added with a share. */
static void add_table(const dif_sheet *sheet, const dif_plan *plan, const transfer *t, double share, double *value)
{
#pragma omp parallel for schedule(static)
    for (int il = 0; il < plan->n_lambda; il++)
        dif_response_line_power(sheet, DIF_TWO_PI / plan->lambda_um[il], (size_t)plan->n_angle, t->s, t->c, share,
                                value + (size_t)il * (size_t)plan->n_angle);
}

static dif_status table_by_sheet(const dif_field *field, const dif_plan *plan, double tol, const dif_measure_opts *opts,
                                 const window_set *set, double *value, dif_measure_stats *stats, dif_error *err)
{
    transfer t = {0};
    dif_band band;
    const dif_sheet_opts how = sheet_opts(opts);
    stopwatch watch = stopwatch_now();
    dif_status status = transfer_make(plan, &t, &band, err);
    for (int i = 0; i < set->n && status == DIF_OK; i++) {
        dif_sheet *sheet;
        status = dif_sheet_create_line(field, set->window + i, plan->azimuth_rad, &band, tol, &how, &sheet, err);
        if (status != DIF_OK)
            break;
        note_sheet(stats, sheet);
        stopwatch_lap(&watch, &stats->build_wall_s, &stats->build_cpu_s);
        add_table(sheet, plan, &t, set->share[i], value);
        stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
        dif_sheet_free(sheet);
        report_progress(opts, (i + 1.0) / set->n);
    }
    dif_release(t.s);
    dif_release(t.c);
    return status;
}

static dif_query query_of_cell(const dif_plan *plan, size_t cell)
{
    dif_query query = {.lambda_um = plan->lambda_um[cell / (size_t)plan->n_angle]};
    dif_plan_directions(plan, (int)(cell % (size_t)plan->n_angle), &query.wi, &query.wo);
    return query;
}

static dif_vec3 kappa_of_query(const dif_query *query)
{
    const dif_vec3 uvw = dif_vec3_transfer(query->wi, query->wo);
    const double k = DIF_TWO_PI / query->lambda_um;
    return (dif_vec3){k * uvw.x, k * uvw.y, k * uvw.z};
}

/* Cells [first, first + n) by the direct sum; adds share * power. */
static dif_status add_direct_cells(const dif_field *field, const dif_window *window, const dif_plan *plan, size_t first,
                                   size_t n, double share, double *value, dif_error *err)
{
    dif_vec3 kappa[DIRECT_CELLS];
    double amp[DIRECT_CELLS][2];
    for (size_t i = 0; i < n; i++) {
        const dif_query query = query_of_cell(plan, first + i);
        kappa[i] = kappa_of_query(&query);
    }
    const dif_status status = dif_direct_amplitudes(field, window, n, kappa, amp, err);
    for (size_t i = 0; i < n && status == DIF_OK; i++)
        value[first + i] += share * (amp[i][0] * amp[i][0] + amp[i][1] * amp[i][1]);
    return status;
}

/* Double rounding of a direct sum's phases (up to a few thousand radians). */
#define DIRECT_BOUND 1e-12

static dif_status table_by_direct(const dif_field *field, const dif_plan *plan, const dif_measure_opts *opts,
                                  const window_set *set, double *value, dif_measure_stats *stats, dif_error *err)
{
    const size_t n = (size_t)plan->n_angle * (size_t)plan->n_lambda, step = DIRECT_CELLS;
    stopwatch watch = stopwatch_now();
    stats->bound = DIRECT_BOUND;
    for (size_t first = 0; first < n; first += step) {
        const size_t count = n - first < step ? n - first : step;
        for (int i = 0; i < set->n; i++) {
            const dif_status status =
                add_direct_cells(field, set->window + i, plan, first, count, set->share[i], value, err);
            if (status != DIF_OK)
                return status;
        }
        report_progress(opts, (double)(first + count) / (double)n);
    }
    stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
    return DIF_OK;
}

/* From powers to the wanted quantity. Only the BRDF's gain depends on the wavelength, as 1/lambda^2. */
static void apply_gain(dif_table *table, dif_index index, double area_um2)
{
    const dif_plan *plan = &table->plan;
    if (table->quantity == DIF_QUANTITY_POWER)
        return;
    const bool per_lambda = table->quantity == DIF_QUANTITY_BRDF;
    for (int ia = 0; ia < plan->n_angle; ia++) {
        dif_vec3 wi, wo;
        dif_plan_directions(plan, ia, &wi, &wo);
        const double gain = dif_brdf_gain(table->quantity, index, wi, wo, 1.0, area_um2);
        for (int il = 0; il < plan->n_lambda; il++) {
            const double lambda_um = plan->lambda_um[il];
            table->value[(size_t)il * (size_t)plan->n_angle + (size_t)ia] *=
                per_lambda ? gain / (lambda_um * lambda_um) : gain;
        }
    }
}

/* Sets the number of threads of this call; returns the number to restore. */
static int threads_begin(const dif_measure_opts *opts)
{
    const int before = omp_get_max_threads();
    if (opts->n_thread > 0)
        omp_set_num_threads(opts->n_thread);
    return before;
}

dif_status dif_measure_table(const dif_field *field, const dif_plan *plan, double tol, const dif_measure_opts *opts,
                             dif_table *out, dif_measure_stats *stats, dif_error *err)
{
    window_set set = {0};
    dif_measure_stats own;
    if (!stats)
        stats = &own;
    *stats = (dif_measure_stats){0};
    *out = (dif_table){0};
    dif_status status = check(field, tol, opts, err);
    if (status == DIF_OK)
        status = dif_plan_check(plan, err);
    if (status == DIF_OK)
        status = dif_table_create(plan, opts->quantity, out, err);
    if (status != DIF_OK)
        return status;
    const int threads = threads_begin(opts);
    status = window_set_make(field, opts, &set, err);
    if (status == DIF_OK)
        status = opts->method == DIF_METHOD_DIRECT
                     ? table_by_direct(field, plan, opts, &set, out->value, stats, err)
                     : table_by_sheet(field, plan, tol, opts, &set, out->value, stats, err);
    omp_set_num_threads(threads);
    stats->n_window = set.n;
    stats->n_sample = (size_t)plan->n_angle * (size_t)plan->n_lambda;
    stats->area_um2 = set.area_um2;
    window_set_free(&set);
    if (status == DIF_OK)
        apply_gain(out, opts->index, stats->area_um2);
    else
        dif_table_free(out);
    return status;
}

static dif_status check_query(size_t i, const dif_query *query, dif_error *err)
{
    const double norm_i = dif_vec3_dot(query->wi, query->wi), norm_o = dif_vec3_dot(query->wo, query->wo);
    if (!(query->lambda_um > 0.0 && query->lambda_um < 1e6))
        return dif_fail(err, DIF_ERR_ARG, "query %zu: wavelength %g um, want > 0", i + 1, query->lambda_um);
    if (!(fabs(norm_i - 1.0) < 1e-9 && fabs(norm_o - 1.0) < 1e-9))
        return dif_fail(err, DIF_ERR_ARG, "query %zu: directions are not unit vectors", i + 1);
    if (!(query->wi.z > 0.0 && query->wo.z > 0.0))
        return dif_fail(err, DIF_ERR_ARG, "query %zu: a direction is not above the surface", i + 1);
    return DIF_OK;
}

/* kappa of all queries and the band they need. */
static dif_status kappa_make(size_t n, const dif_query *query, dif_vec3 *kappa, dif_band *band, dif_error *err)
{
    *band = (dif_band){0.0, (double)INFINITY, 0.0};
    for (size_t i = 0; i < n; i++) {
        const dif_status status = check_query(i, query + i, err);
        if (status != DIF_OK)
            return status;
        kappa[i] = kappa_of_query(query + i);
        band->k_lateral_max_rad_per_um = fmax(band->k_lateral_max_rad_per_um, hypot(kappa[i].x, kappa[i].y));
        band->kz_min_rad_per_um = fmin(band->kz_min_rad_per_um, -kappa[i].z);
        band->kz_max_rad_per_um = fmax(band->kz_max_rad_per_um, -kappa[i].z);
    }
    return DIF_OK;
}

/* Amplitudes of all queries for one window, by any method. */
static dif_status amplitudes(const dif_field *field, const dif_window *window, const dif_measure_opts *opts, double tol,
                             const dif_band *band, size_t n, const dif_vec3 *kappa, double (*amp)[2],
                             dif_measure_stats *stats, dif_error *err)
{
    stopwatch watch = stopwatch_now();
    if (opts->method == DIF_METHOD_DIRECT) {
        const dif_status status = dif_direct_amplitudes(field, window, n, kappa, amp, err);
        stats->bound = DIRECT_BOUND;
        stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
        return status;
    }
    dif_sheet *sheet;
    const dif_sheet_opts how = sheet_opts(opts);
    const dif_status status = dif_sheet_create_volume(field, window, band, tol, &how, &sheet, err);
    if (status != DIF_OK)
        return status;
    note_sheet(stats, sheet);
    stopwatch_lap(&watch, &stats->build_wall_s, &stats->build_cpu_s);
#pragma omp parallel for schedule(dynamic)
    for (size_t first = 0; first < n; first += CHUNK)
        dif_response_volume(sheet, n - first < CHUNK ? n - first : CHUNK, kappa + first, amp + first);
    stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
    dif_sheet_free(sheet);
    return DIF_OK;
}

static void finish_sample(const dif_query *query, dif_index index, double area_um2, dif_sample *sample)
{
    sample->rho = sample->power * dif_brdf_gain_rho(index, query->wi, query->wo);
    sample->brdf_per_sr = sample->power * dif_brdf_gain_per_sr(index, query->wi, query->wo, query->lambda_um, area_um2);
}

static dif_status measure_queries(const dif_field *field, size_t n, const dif_query *query, double tol,
                                  const dif_measure_opts *opts, const window_set *set, dif_sample *out,
                                  dif_measure_stats *stats, dif_error *err)
{
    dif_band band;
    dif_vec3 *kappa = dif_alloc(n, sizeof *kappa);
    double(*amp)[2] = dif_alloc(n, sizeof *amp);
    dif_status status = kappa && amp ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu queries", n);
    if (status == DIF_OK)
        status = kappa_make(n, query, kappa, &band, err);
    for (int w = 0; w < set->n && status == DIF_OK; w++) {
        status = amplitudes(field, set->window + w, opts, tol, &band, n, kappa, amp, stats, err);
        for (size_t i = 0; i < n && status == DIF_OK; i++) {
            out[i].power += set->share[w] * (amp[i][0] * amp[i][0] + amp[i][1] * amp[i][1]);
            out[i].amp_re = set->n == 1 ? amp[i][0] : (double)NAN;
            out[i].amp_im = set->n == 1 ? amp[i][1] : (double)NAN;
        }
        report_progress(opts, (w + 1.0) / set->n);
    }
    for (size_t i = 0; i < n && status == DIF_OK; i++)
        finish_sample(query + i, opts->index, set->area_um2, out + i);
    dif_release(kappa);
    dif_release(amp);
    return status;
}

dif_status dif_measure_queries(const dif_field *field, size_t n, const dif_query *query, double tol,
                               const dif_measure_opts *opts, dif_sample *out, dif_measure_stats *stats, dif_error *err)
{
    window_set set = {0};
    dif_measure_stats own;
    if (!stats)
        stats = &own;
    *stats = (dif_measure_stats){0};
    memset(out, 0, n * sizeof *out);
    dif_status status = check(field, tol, opts, err);
    if (status != DIF_OK || n == 0)
        return status;
    const int threads = threads_begin(opts);
    status = window_set_make(field, opts, &set, err);
    if (status == DIF_OK)
        status = measure_queries(field, n, query, tol, opts, &set, out, stats, err);
    omp_set_num_threads(threads);
    stats->n_window = set.n;
    stats->n_sample = n;
    stats->area_um2 = set.area_um2;
    window_set_free(&set);
    if (status != DIF_OK)
        memset(out, 0, n * sizeof *out);
    return status;
}
