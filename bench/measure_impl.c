/* What table and query measurements share. */
#define _POSIX_C_SOURCE 200809L
#include "bench/measure_impl.h"

#include <math.h>
#include <omp.h>
#include <time.h>

#include "core/alloc.h"
#include "core/units.h"

static double clock_s(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

dif_stopwatch dif_stopwatch_start(void)
{
    return (dif_stopwatch){clock_s(CLOCK_MONOTONIC), clock_s(CLOCK_PROCESS_CPUTIME_ID)};
}

void dif_stopwatch_lap(dif_stopwatch *since, double *wall_s, double *cpu_s)
{
    const dif_stopwatch now = dif_stopwatch_start();
    *wall_s += now.wall_s - since->wall_s;
    *cpu_s += now.cpu_s - since->cpu_s;
    *since = now;
}

void dif_measure_progress(const dif_measure_opts *opts, double share)
{
    if (opts->progress)
        opts->progress(opts->progress_self, share);
}

void dif_window_set_free(dif_window_set *set)
{
    dif_release(set->window);
    dif_release(set->share);
}

static dif_status area_of_replicas(const dif_field *field, const dif_measure_opts *opts, double *area_um2,
                                   dif_error *err)
{
    dif_cell_layout layout;
    const dif_status status = dif_cell_layout_make(field, opts, &layout, err);
    const dif_replica *r = &layout.replica;
    *area_um2 = status == DIF_OK ? r->nx * r->period_x_um * r->ny * r->period_y_um : 0.0;
    return status;
}

dif_status dif_window_set_make(const dif_field *field, const dif_measure_opts *opts, dif_window_set *set,
                               dif_error *err)
{
    const dif_average average = dif_method_has_windows(opts->method) ? opts->average : DIF_AVERAGE_NONE;
    *set = (dif_window_set){.n = dif_window_tile_count(opts->window, opts->sigma_um, average, field)};
    set->window = dif_alloc((size_t)set->n, sizeof *set->window);
    set->share = dif_alloc((size_t)set->n, sizeof *set->share);
    double *wx = dif_alloc((size_t)field->nx, sizeof *wx), *wy = dif_alloc((size_t)field->ny, sizeof *wy);
    dif_status status = DIF_OK;
    if (!set->window || !set->share || !wx || !wy) {
        status = dif_fail(err, DIF_ERR_NOMEM, "no memory for %d windows", set->n);
        goto done;
    }
    dif_window_tile(opts->window, opts->sigma_um, average, field, set->window);
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
    if (opts->method == DIF_METHOD_PQ)
        status = area_of_replicas(field, opts, &set->area_um2, err);
    else if (opts->method == DIF_METHOD_STAM) /* of the unbounded Gaussian window */
        set->area_um2 = 4.0 * DIF_PI * opts->sigma_um * opts->sigma_um;
done:
    dif_release(wx);
    dif_release(wy);
    return status;
}

dif_status dif_measure_check_opts(const dif_field *field, double tol, const dif_measure_opts *opts, dif_error *err)
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
    return dif_method_check_opts(field, opts, err);
}

dif_sheet_opts dif_measure_sheet_opts(const dif_measure_opts *opts)
{
    dif_sheet_opts out = dif_sheet_opts_default();
    if (opts->method == DIF_METHOD_TAYLOR)
        out.basis = DIF_BASIS_POWERS;
    out.n_terms = opts->n_terms;
    out.force_single = opts->single && opts->method == DIF_METHOD_TAYLOR;
    return out;
}

void dif_measure_note_sheet(dif_measure_stats *stats, const dif_sheet *sheet)
{
    const dif_sheet_info info = dif_sheet_info_of(sheet);
    stats->bound = fmax(stats->bound, info.bound);
    stats->n_plane = info.n_plane;
    stats->n_tap = info.n_tap;
    stats->single = info.single;
}

double dif_measure_shadowing(const dif_measure_opts *opts, dif_quantity quantity, dif_vec3 wi, dif_vec3 wo)
{
    return quantity == DIF_QUANTITY_POWER ? 1.0 : dif_shadow_factor(opts->shadow, wi, wo);
}

dif_vec3 dif_measure_kappa(const dif_query *query)
{
    const dif_vec3 uvw = dif_vec3_transfer(query->wi, query->wo);
    const double k = DIF_TWO_PI / query->lambda_um;
    return (dif_vec3){k * uvw.x, k * uvw.y, k * uvw.z};
}

int dif_measure_threads(const dif_measure_opts *opts)
{
    const int before = omp_get_max_threads();
    if (opts->n_thread > 0)
        omp_set_num_threads(opts->n_thread);
    return before;
}
