/* Maps by the methods that are read point by point: taylor, thesis, nmm, pq and stam. */
#include "bench/map_methods.h"

#include <math.h>
#include <omp.h>

#include "core/alloc.h"

/* What one window's pass over the map needs. */
typedef struct pass {
    const dif_map_sums *to;
    const dif_readout *reader;
    double share, scale[3];
    double *lambda_um;   /* nmm: room of each thread for the wavelengths of a pixel */
    double (*weight)[3]; /* and their weights                                         */
    size_t n_max;
} pass;

static bool uvw_of(const dif_map_plan *plan, int ix, int iy, dif_vec3 *uvw)
{
    dif_vec3 other;
    const bool inside = dif_map_direction(plan->n_pixel, ix, iy, &other);
    *uvw = dif_vec3_transfer(plan->fixed, other);
    return inside;
}

/* Pixels of one row at one wavelength, DIF_READ_MAX at a time. */
static void add_row(const pass *p, int iy, int il)
{
    const dif_map_plan *plan = p->to->plan;
    const size_t n_pixel = (size_t)plan->n_pixel, n = n_pixel * n_pixel;
    const double lambda_um = plan->lambda_um[il];
    const double unit = p->share * (p->to->per_lambda2 ? 1.0 / (lambda_um * lambda_um) : 1.0);
    dif_vec3 uvw[DIF_READ_MAX];
    double lambda[DIF_READ_MAX], amp[DIF_READ_MAX][2];
    size_t at[DIF_READ_MAX];
    for (int ix = 0; ix < plan->n_pixel;) {
        int count = 0;
        for (; ix < plan->n_pixel && count < DIF_READ_MAX; ix++) {
            at[count] = (size_t)iy * n_pixel + (size_t)ix;
            lambda[count] = lambda_um;
            if (uvw_of(plan, ix, iy, uvw + count))
                count++;
        }
        dif_readout_read(p->reader, count, uvw, lambda, false, amp);
        for (int i = 0; i < count; i++) {
            const double power = unit * (amp[i][0] * amp[i][0] + amp[i][1] * amp[i][1]);
            for (size_t c = 0; c < 3; c++)
                p->to->sums[3 * at[i] + c] += p->to->weight[il][c] * power;
            if (p->to->layer)
                p->to->layer[(size_t)il * n + at[i]] += p->to->gain[at[i]] * (float)power;
        }
    }
}

/* One row by nmm, each pixel at its own wavelengths. */
static void add_row_nmm(const pass *p, int iy)
{
    const dif_map_plan *plan = p->to->plan;
    const size_t room = p->n_max * (size_t)omp_get_thread_num();
    for (int ix = 0; ix < plan->n_pixel; ix++) {
        dif_vec3 uvw;
        double xyz[3] = {0.0, 0.0, 0.0};
        if (!uvw_of(plan, ix, iy, &uvw))
            continue;
        dif_readout_add_nmm(p->reader, p->scale, uvw, p->to->per_lambda2, p->share, p->lambda_um + room,
                            p->weight + room, xyz);
        for (size_t c = 0; c < 3; c++)
            p->to->sums[3 * ((size_t)iy * (size_t)plan->n_pixel + (size_t)ix) + c] += xyz[c];
    }
}

static dif_status add_window(pass *p, dif_error *err)
{
    const bool nmm = p->reader->method == DIF_METHOD_NMM;
    const size_t n_thread = (size_t)omp_get_max_threads();
    dif_status status = DIF_OK;
    if (nmm) {
        p->n_max = (size_t)dif_nmm_count_max(&p->reader->nmm);
        p->lambda_um = dif_alloc(p->n_max * n_thread, sizeof *p->lambda_um);
        p->weight = dif_alloc(p->n_max * n_thread, sizeof *p->weight);
        status = p->lambda_um && p->weight ? dif_nmm_scale(p->scale, err)
                                           : dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu wavelengths", p->n_max);
    }
    if (status == DIF_OK) {
#pragma omp parallel for schedule(dynamic)
        for (int iy = 0; iy < p->to->plan->n_pixel; iy++) {
            for (int il = 0; il < p->to->plan->n_lambda && !nmm; il++)
                add_row(p, iy, il);
            if (nmm)
                add_row_nmm(p, iy);
        }
    }
    dif_release(p->lambda_um);
    dif_release(p->weight);
    return status;
}

static dif_reach reach_of_map(const dif_map_plan *plan)
{
    dif_reach reach = dif_reach_empty();
    for (int iy = 0; iy < plan->n_pixel; iy++)
        for (int ix = 0; ix < plan->n_pixel; ix++) {
            dif_vec3 uvw;
            if (uvw_of(plan, ix, iy, &uvw))
                dif_reach_add(&reach, uvw, plan->lambda_um[0]);
        }
    for (int i = 0; i < plan->n_lambda; i++) {
        reach.lambda_min_um = fmin(reach.lambda_min_um, plan->lambda_um[i]);
        reach.lambda_max_um = fmax(reach.lambda_max_um, plan->lambda_um[i]);
    }
    return reach;
}

dif_status dif_map_check_method(const dif_map_plan *plan, const dif_measure_opts *opts, dif_error *err)
{
    if (opts->method == DIF_METHOD_THESIS && opts->quantity == DIF_QUANTITY_BRDF)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "the source's program has no absolute BRDF: its gain is 1");
    if (opts->method == DIF_METHOD_NMM && plan->keep_layers)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "nmm has no spectral layers: each pixel has wavelengths of its own");
    return DIF_OK;
}

dif_status dif_map_by_method(const dif_map_sums *to, const dif_field *field, double tol, const dif_measure_opts *opts,
                             const dif_window_set *set, dif_measure_stats *stats, dif_error *err)
{
    const dif_reach reach = reach_of_map(to->plan);
    dif_stopwatch watch = dif_stopwatch_start();
    for (int w = 0; w < set->n; w++) {
        dif_readout reader;
        dif_status status = dif_readout_open(field, set->window + w, opts, tol, &reach, &reader, stats, err);
        if (status != DIF_OK)
            return status;
        dif_stopwatch_lap(&watch, &stats->build_wall_s, &stats->build_cpu_s);
        pass p = {.to = to, .reader = &reader, .share = set->share[w]};
        status = add_window(&p, err);
        dif_stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
        dif_readout_close(&reader);
        if (status != DIF_OK)
            return status;
        dif_measure_progress(opts, (w + 1.0) / set->n);
    }
    return DIF_OK;
}
