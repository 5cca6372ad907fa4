/* Arbitrary directions: the volume form, its points read in an order that shares memory. */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "bench/measure_impl.h"
#include "core/alloc.h"
#include "core/direct.h"
#include "core/response.h"

enum { CHUNK = 1024 };

/* kappa of all queries and the band they need. */
static dif_status kappa_make(size_t n, const dif_query *query, dif_vec3 *kappa, dif_band *band, dif_error *err)
{
    *band = (dif_band){0.0, (double)INFINITY, 0.0};
    for (size_t i = 0; i < n; i++) {
        const dif_status status = dif_query_check(i, query + i, err);
        if (status != DIF_OK)
            return status;
        kappa[i] = dif_measure_kappa(query + i);
        band->k_lateral_max_rad_per_um = fmax(band->k_lateral_max_rad_per_um, hypot(kappa[i].x, kappa[i].y));
        band->kz_min_rad_per_um = fmin(band->kz_min_rad_per_um, -kappa[i].z);
        band->kz_max_rad_per_um = fmax(band->kz_max_rad_per_um, -kappa[i].z);
    }
    return DIF_OK;
}

/* Points first ... first+n of an order, n <= CHUNK. */
static void read_chunk(const dif_sheet *sheet, size_t n, const size_t *order, const dif_vec3 *kappa, double (*amp)[2])
{
    dif_vec3 point[CHUNK] = {0};
    double value[CHUNK][2];
    for (size_t i = 0; i < n; i++)
        point[i] = kappa[order[i]];
    dif_response_volume(sheet, n, point, value);
    for (size_t i = 0; i < n; i++) {
        amp[order[i]][0] = value[i][0];
        amp[order[i]][1] = value[i][1];
    }
}

static dif_status read_volume(const dif_sheet *sheet, size_t n, const dif_vec3 *kappa, double (*amp)[2], dif_error *err)
{
    size_t *order = dif_alloc(n, sizeof *order);
    if (!order)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory to order %zu queries", n);
    const dif_status status = dif_sheet_order(sheet, n, kappa, order, err);
    if (status == DIF_OK) {
#pragma omp parallel for schedule(dynamic)
        for (size_t first = 0; first < n; first += CHUNK)
            read_chunk(sheet, n - first < CHUNK ? n - first : CHUNK, order + first, kappa, amp);
    }
    dif_release(order);
    return status;
}

/* Queries first ... first+n, n <= DIF_READ_MAX. */
static void read_queries(const dif_readout *reader, int n, const dif_query *query, double (*amp)[2])
{
    dif_vec3 uvw[DIF_READ_MAX];
    double lambda_um[DIF_READ_MAX];
    for (int i = 0; i < n; i++) {
        uvw[i] = dif_vec3_transfer(query[i].wi, query[i].wo);
        lambda_um[i] = query[i].lambda_um;
    }
    dif_readout_read(reader, n, uvw, lambda_um, false, amp);
}

static dif_status amplitudes_by_method(const dif_field *field, const dif_window *window, const dif_measure_opts *opts,
                                       double tol, size_t n, const dif_query *query, double (*amp)[2],
                                       dif_measure_stats *stats, dif_error *err)
{
    dif_reach reach = dif_reach_empty();
    dif_readout reader;
    dif_stopwatch watch = dif_stopwatch_start();
    for (size_t i = 0; i < n; i++)
        dif_reach_add(&reach, dif_vec3_transfer(query[i].wi, query[i].wo), query[i].lambda_um);
    const dif_status status = dif_readout_open(field, window, opts, tol, &reach, &reader, stats, err);
    if (status != DIF_OK)
        return status;
    dif_stopwatch_lap(&watch, &stats->build_wall_s, &stats->build_cpu_s);
#pragma omp parallel for schedule(dynamic)
    for (size_t first = 0; first < n; first += DIF_READ_MAX)
        read_queries(&reader, n - first < DIF_READ_MAX ? (int)(n - first) : DIF_READ_MAX, query + first, amp + first);
    dif_stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
    dif_readout_close(&reader);
    return DIF_OK;
}

/* Amplitudes of all queries for one window, by any method. */
static dif_status amplitudes(const dif_field *field, const dif_window *window, const dif_measure_opts *opts, double tol,
                             const dif_band *band, size_t n, const dif_query *query, const dif_vec3 *kappa,
                             double (*amp)[2], dif_measure_stats *stats, dif_error *err)
{
    dif_stopwatch watch = dif_stopwatch_start();
    if (opts->method != DIF_METHOD_DIRECT && opts->method != DIF_METHOD_SHEET && opts->method != DIF_METHOD_TAYLOR)
        return amplitudes_by_method(field, window, opts, tol, n, query, amp, stats, err);
    if (opts->method == DIF_METHOD_DIRECT) {
        const dif_status status = dif_direct_amplitudes(field, window, n, kappa, amp, err);
        stats->bound = DIF_DIRECT_BOUND;
        dif_stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
        return status;
    }
    dif_sheet *sheet;
    const dif_sheet_opts how = dif_measure_sheet_opts(opts);
    dif_status status = dif_sheet_create_volume(field, window, band, tol, &how, &sheet, err);
    if (status != DIF_OK)
        return status;
    dif_measure_note_sheet(stats, sheet);
    dif_stopwatch_lap(&watch, &stats->build_wall_s, &stats->build_cpu_s);
    status = read_volume(sheet, n, kappa, amp, err);
    dif_stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
    dif_sheet_free(sheet);
    return status;
}

static void finish_sample(const dif_query *query, const dif_measure_opts *opts, double area_um2, dif_sample *sample)
{
    const dif_index index = opts->index;
    if (opts->method == DIF_METHOD_STAM)
        sample->amp_re = sample->amp_im = (double)NAN;
    if (opts->method == DIF_METHOD_THESIS) { /* its gain is 1 */
        sample->rho = sample->power;
        sample->brdf_per_sr = (double)NAN;
        return;
    }
    const double seen = sample->power * dif_shadow_factor(opts->shadow, query->wi, query->wo);
    sample->rho = seen * dif_brdf_gain_rho(index, query->wi, query->wo);
    sample->brdf_per_sr = seen * dif_brdf_gain_per_sr(index, query->wi, query->wo, query->lambda_um, area_um2);
}

static dif_status measure_queries(const dif_field *field, size_t n, const dif_query *query, double tol,
                                  const dif_measure_opts *opts, const dif_window_set *set, dif_sample *out,
                                  dif_measure_stats *stats, dif_error *err)
{
    dif_band band;
    dif_vec3 *kappa = dif_alloc(n, sizeof *kappa);
    double(*amp)[2] = dif_alloc(n, sizeof *amp);
    dif_status status = kappa && amp ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu queries", n);
    if (status == DIF_OK)
        status = kappa_make(n, query, kappa, &band, err);
    for (int w = 0; w < set->n && status == DIF_OK; w++) {
        status = amplitudes(field, set->window + w, opts, tol, &band, n, query, kappa, amp, stats, err);
        for (size_t i = 0; i < n && status == DIF_OK; i++) {
            out[i].power += set->share[w] * (amp[i][0] * amp[i][0] + amp[i][1] * amp[i][1]);
            out[i].amp_re = set->n == 1 ? amp[i][0] : (double)NAN;
            out[i].amp_im = set->n == 1 ? amp[i][1] : (double)NAN;
        }
        dif_measure_progress(opts, (w + 1.0) / set->n);
    }
    for (size_t i = 0; i < n && status == DIF_OK; i++)
        finish_sample(query + i, opts, set->area_um2, out + i);
    dif_release(kappa);
    dif_release(amp);
    return status;
}

dif_status dif_measure_queries(const dif_field *field, size_t n, const dif_query *query, double tol,
                               const dif_measure_opts *opts, dif_sample *out, dif_measure_stats *stats, dif_error *err)
{
    dif_window_set set = {0};
    const dif_measure_opts defaults = dif_measure_opts_default();
    dif_measure_stats own;
    if (!opts)
        opts = &defaults;
    if (!stats)
        stats = &own;
    *stats = (dif_measure_stats){0};
    memset(out, 0, n * sizeof *out);
    dif_status status = dif_measure_check_opts(field, tol, opts, err);
    if (status != DIF_OK || n == 0)
        return status;
    const int threads = dif_measure_threads(opts);
    status = dif_window_set_make(field, opts, &set, err);
    if (status == DIF_OK)
        status = measure_queries(field, n, query, tol, opts, &set, out, stats, err);
    omp_set_num_threads(threads);
    stats->n_window = set.n;
    stats->n_sample = n;
    stats->area_um2 = set.area_um2;
    dif_window_set_free(&set);
    if (status != DIF_OK)
        memset(out, 0, n * sizeof *out);
    return status;
}
