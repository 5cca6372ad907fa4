#include "bench/measure_impl.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "core/alloc.h"
#include "core/direct.h"
#include "core/response.h"
#include "core/sheet.h"
#include "core/units.h"

static const char *const METHOD_NAMES[] = {"sheet", "taylor", "direct", "thesis", "nmm", "pq", "stam"};
enum { N_METHOD = sizeof METHOD_NAMES / sizeof *METHOD_NAMES, DIRECT_CELLS = 64 };

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
                              .thesis_terms = DIF_THESIS_TERMS,
                              .period_um = (double)NAN,
                              .period_across_um = (double)NAN,
                              .n_replica = DIF_REPLICAS_FROM_WINDOW,
                              .n_replica_across = DIF_REPLICAS_FROM_WINDOW,
                              .nmm_jacobian = true,
                              .nmm_fixed = 16,
                              .n_thread = 0};
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
                                 const dif_window_set *set, double *value, dif_measure_stats *stats, dif_error *err)
{
    transfer t = {0};
    dif_band band;
    const dif_sheet_opts how = dif_measure_sheet_opts(opts);
    dif_stopwatch watch = dif_stopwatch_start();
    dif_status status = transfer_make(plan, &t, &band, err);
    for (int i = 0; i < set->n && status == DIF_OK; i++) {
        dif_sheet *sheet;
        status = dif_sheet_create_line(field, set->window + i, plan->azimuth_rad, &band, tol, &how, &sheet, err);
        if (status != DIF_OK)
            break;
        dif_measure_note_sheet(stats, sheet);
        dif_stopwatch_lap(&watch, &stats->build_wall_s, &stats->build_cpu_s);
        add_table(sheet, plan, &t, set->share[i], value);
        dif_stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
        dif_sheet_free(sheet);
        dif_measure_progress(opts, (i + 1.0) / set->n);
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

/* Cells [first, first + n) by the direct sum; adds share * power. */
static dif_status add_direct_cells(const dif_field *field, const dif_window *window, const dif_plan *plan, size_t first,
                                   size_t n, double share, double *value, dif_error *err)
{
    dif_vec3 kappa[DIRECT_CELLS];
    double amp[DIRECT_CELLS][2];
    for (size_t i = 0; i < n; i++) {
        const dif_query query = query_of_cell(plan, first + i);
        kappa[i] = dif_measure_kappa(&query);
    }
    const dif_status status = dif_direct_amplitudes(field, window, n, kappa, amp, err);
    for (size_t i = 0; i < n && status == DIF_OK; i++)
        value[first + i] += share * (amp[i][0] * amp[i][0] + amp[i][1] * amp[i][1]);
    return status;
}

static dif_status table_by_direct(const dif_field *field, const dif_plan *plan, const dif_measure_opts *opts,
                                  const dif_window_set *set, double *value, dif_measure_stats *stats, dif_error *err)
{
    const size_t n = (size_t)plan->n_angle * (size_t)plan->n_lambda, step = DIRECT_CELLS;
    dif_stopwatch watch = dif_stopwatch_start();
    stats->bound = DIF_DIRECT_BOUND;
    for (size_t first = 0; first < n; first += step) {
        const size_t count = n - first < step ? n - first : step;
        for (int i = 0; i < set->n; i++) {
            const dif_status status =
                add_direct_cells(field, set->window + i, plan, first, count, set->share[i], value, err);
            if (status != DIF_OK)
                return status;
        }
        dif_measure_progress(opts, (double)(first + count) / (double)n);
    }
    dif_stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
    return DIF_OK;
}

static dif_status table_by(const dif_field *field, const dif_plan *plan, double tol, const dif_measure_opts *opts,
                           const dif_window_set *set, double *value, dif_measure_stats *stats, dif_error *err)
{
    if (opts->method == DIF_METHOD_DIRECT)
        return table_by_direct(field, plan, opts, set, value, stats, err);
    if (opts->method == DIF_METHOD_SHEET || opts->method == DIF_METHOD_TAYLOR)
        return table_by_sheet(field, plan, tol, opts, set, value, stats, err);
    return dif_table_by_method(field, plan, tol, opts, set, value, stats, err);
}

/* From powers to the wanted quantity. Only the BRDF's gain depends on the wavelength, as 1/lambda^2. */
static void apply_gain(dif_table *table, const dif_measure_opts *opts, double area_um2)
{
    const dif_plan *plan = &table->plan;
    if (table->quantity == DIF_QUANTITY_POWER)
        return;
    const bool per_lambda = table->quantity == DIF_QUANTITY_BRDF;
    for (int ia = 0; ia < plan->n_angle; ia++) {
        dif_vec3 wi, wo;
        dif_plan_directions(plan, ia, &wi, &wo);
        const double gain = dif_method_gain(opts, table->quantity, wi, wo, area_um2);
        for (int il = 0; il < plan->n_lambda; il++) {
            const double lambda_um = plan->lambda_um[il];
            table->value[(size_t)il * (size_t)plan->n_angle + (size_t)ia] *=
                per_lambda ? gain / (lambda_um * lambda_um) : gain;
        }
    }
}

dif_status dif_measure_table(const dif_field *field, const dif_plan *plan, double tol, const dif_measure_opts *opts,
                             dif_table *out, dif_measure_stats *stats, dif_error *err)
{
    dif_window_set set = {0};
    const dif_measure_opts defaults = dif_measure_opts_default();
    dif_measure_stats own;
    if (!opts)
        opts = &defaults;
    if (!stats)
        stats = &own;
    *stats = (dif_measure_stats){0};
    *out = (dif_table){0};
    dif_status status = dif_measure_check_opts(field, tol, opts, err);
    if (status == DIF_OK)
        status = dif_plan_check(plan, err);
    if (status == DIF_OK && opts->method == DIF_METHOD_THESIS && opts->quantity == DIF_QUANTITY_BRDF)
        status = dif_fail(err, DIF_ERR_UNSUPPORTED, "the source's program has no absolute BRDF: its gain is 1");
    if (status == DIF_OK)
        status = dif_table_create(plan, opts->quantity, out, err);
    if (status != DIF_OK)
        return status;
    const int threads = dif_measure_threads(opts);
    status = dif_window_set_make(field, opts, &set, err);
    if (status == DIF_OK)
        status = table_by(field, plan, tol, opts, &set, out->value, stats, err);
    omp_set_num_threads(threads);
    stats->n_window = set.n;
    stats->n_sample = (size_t)plan->n_angle * (size_t)plan->n_lambda;
    stats->area_um2 = set.area_um2;
    dif_window_set_free(&set);
    if (status == DIF_OK)
        apply_gain(out, opts, stats->area_um2);
    else
        dif_table_free(out);
    return status;
}
