/* Colours of the angles of a plan: by full sampling of its wavelengths, or by nmm's own. */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "bench/measure_impl.h"
#include "core/alloc.h"
#include "core/spectrum.h"

void dif_readout_add_nmm(const dif_readout *reader, const double scale[3], dif_vec3 uvw, bool per_lambda2, double share,
                         double *lambda_um, double (*weight)[3], double xyz[3])
{
    const int n = dif_nmm_weights(&reader->nmm, scale, hypot(uvw.x, uvw.y), lambda_um, weight);
    dif_vec3 same[DIF_READ_MAX];
    double amp[DIF_READ_MAX][2];
    for (int i = 0; i < DIF_READ_MAX; i++)
        same[i] = uvw;
    for (int first = 0; first < n; first += DIF_READ_MAX) {
        const int count = n - first < DIF_READ_MAX ? n - first : DIF_READ_MAX;
        dif_readout_read(reader, count, same, lambda_um + first, true, amp);
        for (int i = 0; i < count; i++) {
            const double at_um = lambda_um[first + i];
            const double power = share * (amp[i][0] * amp[i][0] + amp[i][1] * amp[i][1]);
            for (int c = 0; c < 3; c++)
                xyz[c] += weight[first + i][c] * (per_lambda2 ? power / (at_um * at_um) : power);
        }
    }
}

static dif_status by_table(const dif_field *field, const dif_plan *plan, double tol, const dif_measure_opts *opts,
                           double (*xyz)[3], dif_measure_stats *stats, dif_error *err)
{
    dif_table table = {0};
    double(*weight)[3] = dif_alloc((size_t)plan->n_lambda, sizeof *weight);
    dif_status status = weight ? dif_spectrum_weights(plan->n_lambda, plan->lambda_um, weight, err)
                               : dif_fail(err, DIF_ERR_NOMEM, "no memory for %d wavelengths", plan->n_lambda);
    if (status == DIF_OK)
        status = dif_measure_table(field, plan, tol, opts, &table, stats, err);
    for (int il = 0; il < plan->n_lambda && status == DIF_OK; il++)
        for (int ia = 0; ia < plan->n_angle; ia++)
            for (int c = 0; c < 3; c++)
                xyz[ia][c] += weight[il][c] * table.value[(size_t)il * (size_t)plan->n_angle + (size_t)ia];
    dif_table_free(&table);
    dif_release(weight);
    return status;
}

/* Sums of all angles for one window. */
static dif_status add_window(const dif_readout *reader, const dif_plan *plan, bool per_lambda2, double share,
                             const double scale[3], double (*xyz)[3], dif_error *err)
{
    const size_t n_max = (size_t)dif_nmm_count_max(&reader->nmm), n_thread = (size_t)omp_get_max_threads();
    double *lambda_um = dif_alloc(n_max * n_thread, sizeof *lambda_um);
    double(*weight)[3] = dif_alloc(n_max * n_thread, sizeof *weight);
    dif_status status = DIF_OK;
    if (!lambda_um || !weight) {
        status = dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu wavelengths", n_max);
        goto done;
    }
#pragma omp parallel for schedule(dynamic, 16)
    for (int i = 0; i < plan->n_angle; i++) {
        const size_t at = n_max * (size_t)omp_get_thread_num();
        dif_vec3 wi, wo;
        dif_plan_directions(plan, i, &wi, &wo);
        dif_readout_add_nmm(reader, scale, dif_vec3_transfer(wi, wo), per_lambda2, share, lambda_um + at, weight + at,
                            xyz[i]);
    }
done:
    dif_release(lambda_um);
    dif_release(weight);
    return status;
}

static dif_status by_nmm(const dif_field *field, const dif_plan *plan, double tol, const dif_measure_opts *opts,
                         const dif_window_set *set, double (*xyz)[3], dif_measure_stats *stats, dif_error *err)
{
    const dif_reach reach = dif_reach_of_plan(plan);
    double scale[3];
    dif_stopwatch watch = dif_stopwatch_start();
    dif_status status = dif_nmm_scale(scale, err);
    for (int w = 0; w < set->n && status == DIF_OK; w++) {
        dif_readout reader;
        status = dif_readout_open(field, set->window + w, opts, tol, &reach, &reader, stats, err);
        if (status != DIF_OK)
            break;
        dif_stopwatch_lap(&watch, &stats->build_wall_s, &stats->build_cpu_s);
        status = add_window(&reader, plan, opts->quantity == DIF_QUANTITY_BRDF, set->share[w], scale, xyz, err);
        dif_stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
        dif_readout_close(&reader);
        dif_measure_progress(opts, (w + 1.0) / set->n);
    }
    for (int i = 0; i < plan->n_angle && status == DIF_OK; i++) {
        dif_vec3 wi, wo;
        dif_plan_directions(plan, i, &wi, &wo);
        const double gain = dif_method_gain(opts, opts->quantity, wi, wo, set->area_um2);
        for (int c = 0; c < 3; c++)
            xyz[i][c] *= gain;
    }
    return status;
}

dif_status dif_measure_colours(const dif_field *field, const dif_plan *plan, double tol, const dif_measure_opts *opts,
                               double (*xyz)[3], dif_measure_stats *stats, dif_error *err)
{
    const dif_measure_opts defaults = dif_measure_opts_default();
    dif_window_set set = {0};
    dif_measure_stats own;
    if (!opts)
        opts = &defaults;
    if (!stats)
        stats = &own;
    *stats = (dif_measure_stats){0};
    dif_status status = dif_plan_check(plan, err);
    if (status != DIF_OK)
        return status;
    memset(xyz, 0, (size_t)plan->n_angle * sizeof *xyz);
    if (opts->method != DIF_METHOD_NMM) {
        status = by_table(field, plan, tol, opts, xyz, stats, err);
        goto done;
    }
    status = dif_measure_check_opts(field, tol, opts, err);
    if (status != DIF_OK)
        return status;
    const int threads = dif_measure_threads(opts);
    status = dif_window_set_make(field, opts, &set, err);
    if (status == DIF_OK)
        status = by_nmm(field, plan, tol, opts, &set, xyz, stats, err);
    omp_set_num_threads(threads);
    stats->n_window = set.n;
    stats->n_sample = (size_t)plan->n_angle;
    stats->area_um2 = set.area_um2;
    dif_window_set_free(&set);
done:
    if (status != DIF_OK)
        memset(xyz, 0, (size_t)plan->n_angle * sizeof *xyz);
    return status;
}
