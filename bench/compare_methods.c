#include "bench/compare_methods.h"

#include <math.h>
#include <string.h>

#include "bench/compare_methods_impl.h"
#include "bench/fit.h"
#include "bench/measure_impl.h"
#include "core/alloc.h"
#include "core/replica.h"

enum { MANY_REPLICAS = 500 }; /* a finite grating's maxima are off by about 1/N^2: 4 nm for 26 periods of 2500 nm */

/* The rows: a method and how its options differ from the shared ones. */
typedef struct variant {
    const char *name;
    dif_method method;
    bool single, no_jacobian;
} variant;

static const variant VARIANTS[DIF_COMPARE_MAX] = {
    {"sheet", DIF_METHOD_SHEET, false, false},
    {"taylor", DIF_METHOD_TAYLOR, false, false},
    {"taylor in float", DIF_METHOD_TAYLOR, true, false},
    {"direct", DIF_METHOD_DIRECT, false, false},
    {"thesis", DIF_METHOD_THESIS, false, false},
    {"nmm", DIF_METHOD_NMM, false, false},
    {"nmm without its Jacobian", DIF_METHOD_NMM, false, true},
    {"pq", DIF_METHOD_PQ, false, false},
    {"stam", DIF_METHOD_STAM, false, false},
};

dif_compare_opts dif_compare_opts_default(void)
{
    return (dif_compare_opts){
        .n_check = 100, .seed = 1, .fit = true, .colour_max_deg = 85.0, .colour_step_deg = 0.1, .colour_step_nm = 1.0};
}

static dif_status check(const dif_compare_opts *how, dif_error *err)
{
    if (!(how->n_check >= 1 && how->n_check <= 1000000))
        return dif_fail(err, DIF_ERR_ARG, "%d cells to check, want 1 ... 1000000", how->n_check);
    if (!(how->colour_max_deg > 0.0 && how->colour_max_deg < 90.0))
        return dif_fail(err, DIF_ERR_ARG, "colours up to %g deg, want 0 < deg < 90", how->colour_max_deg);
    if (!(how->colour_step_deg > 1e-4 && how->colour_step_deg <= how->colour_max_deg))
        return dif_fail(err, DIF_ERR_ARG, "colours every %g deg, want 1e-4 < deg <= %g", how->colour_step_deg,
                        how->colour_max_deg);
    if (!(how->colour_step_nm >= 0.01 && how->colour_step_nm <= 100.0))
        return dif_fail(err, DIF_ERR_ARG, "colours from a wavelength every %g nm, want 0.01 ... 100",
                        how->colour_step_nm);
    return DIF_OK;
}

/* splitmix64, as bench/measure_check.c. */
static unsigned long long random_next(unsigned long long *state)
{
    unsigned long long z = (*state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

static dif_status job_make(dif_compare_job *j, dif_error *err)
{
    const size_t n_check = (size_t)j->how.n_check;
    const size_t n_cell = (size_t)j->plan->n_angle * (size_t)j->plan->n_lambda;
    unsigned long long state = j->how.seed;
    dif_status status = dif_compare_colour_plan(j, err);
    if (status != DIF_OK)
        return status;
    const size_t n_angle = (size_t)j->colour_plan.n_angle;
    j->cell = dif_alloc(n_check, sizeof *j->cell);
    j->query = dif_alloc(n_check, sizeof *j->query);
    j->truth = dif_alloc(n_check, sizeof *j->truth);
    j->full = dif_alloc(n_angle, sizeof *j->full);
    j->xyz = dif_alloc(n_angle, sizeof *j->xyz);
    j->de = dif_alloc(n_angle, sizeof *j->de);
    if (!j->cell || !j->query || !j->truth || !j->full || !j->xyz || !j->de)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory to compare methods");
    for (size_t i = 0; i < n_check; i++) {
        j->cell[i] = (size_t)(random_next(&state) % n_cell);
        dif_plan_directions(j->plan, (int)(j->cell[i] % (size_t)j->plan->n_angle), &j->query[i].wi, &j->query[i].wo);
        j->query[i].lambda_um = j->plan->lambda_um[j->cell[i] / (size_t)j->plan->n_angle];
    }
    return dif_compare_full_colours(j, err);
}

static void job_free(dif_compare_job *j)
{
    dif_release(j->cell);
    dif_release(j->query);
    dif_release(j->truth);
    dif_plan_free(&j->colour_plan);
    dif_release(j->full);
    dif_release(j->xyz);
    dif_release(j->de);
}

static dif_compare_row row_empty(const variant *v)
{
    const double nan = (double)NAN;
    return (dif_compare_row){.method = v->method,
                             .name = v->name,
                             .leaves_out = dif_method_leaves_out(v->method),
                             .bound = nan,
                             .build_s = nan,
                             .eval_s = nan,
                             .cpu_s = nan,
                             .argmax_mean_um = nan,
                             .argmax_sd_um = nan,
                             .fit_period_um = nan,
                             .fit_uncertainty_um = nan,
                             .error_worst = nan,
                             .error_rms = nan,
                             .de_median = nan,
                             .de_p95 = nan,
                             .de_worst = nan,
                             .de_worst_deg = nan,
                             .shift_x = nan,
                             .shift_y = nan};
}

/* The source's statistic: plain maxima, first order assumed. A maximum of nmm lies at the wavelength of its bin. */
static void note_argmax(const dif_compare_job *j, const dif_measure_opts *opts, const dif_table *table,
                        dif_compare_row *row)
{
    const dif_plan *plan = &table->plan;
    const dif_reach reach = dif_reach_of_plan(plan);
    const dif_nmm nmm = dif_method_nmm(j->field, opts, reach.lambda_min_um, reach.lambda_max_um);
    double sum = 0.0, sum2 = 0.0;
    for (int il = 0; il < plan->n_lambda; il++) {
        const double *value = table->value + (size_t)il * (size_t)plan->n_angle;
        int best = 0;
        double sin_sum, cos_sum;
        for (int ia = 1; ia < plan->n_angle; ia++)
            best = value[ia] > value[best] ? ia : best;
        dif_plan_transfer(plan, best, &sin_sum, &cos_sum);
        const bool bins = opts->method == DIF_METHOD_NMM;
        const double asked_um = plan->lambda_um[il];
        const double period_um = (bins ? dif_nmm_nearest_um(&nmm, fabs(sin_sum), asked_um) : asked_um) / fabs(sin_sum);
        sum += period_um;
        sum2 += period_um * period_um;
    }
    const double mean = sum / plan->n_lambda;
    row->argmax_mean_um = mean;
    row->argmax_sd_um = sqrt(fmax(sum2 / plan->n_lambda - mean * mean, 0.0));
}

static void note_fit(const dif_compare_job *j, const dif_measure_opts *opts, const dif_table *table,
                     dif_compare_row *row)
{
    const dif_field *field = j->field;
    dif_fit_table_opts how = dif_fit_table_opts_default();
    dif_fit_result fit;
    dif_error err;
    const double c = fabs(cos(j->plan->azimuth_rad)), s = fabs(sin(j->plan->azimuth_rad));
    if (opts->method == DIF_METHOD_STAM)
        return; /* its lines are where the period that it was given says */
    how.line = (dif_fit_line){.known = true,
                              .window = {.kind = opts->window, .sigma_um = opts->sigma_um},
                              .size_x_um = field->nx * field->pitch_x_um,
                              .size_y_um = field->ny * field->pitch_y_um,
                              .average = opts->average,
                              .pitch_um = c > s ? field->pitch_x_um : field->pitch_y_um};
    how.index = opts->index;
    if (opts->method == DIF_METHOD_PQ) {
        dif_field cell;
        dif_replica replica;
        if (dif_measure_cell(field, opts, &cell, &replica, &err) != DIF_OK)
            return;
        how.line.window.kind = DIF_WINDOW_FLAT;
        how.line.average = DIF_AVERAGE_NONE;
        how.line.size_x_um = replica.nx * replica.period_x_um;
        how.line.size_y_um = replica.ny * replica.period_y_um;
        how.line.pitch_um = c > s ? cell.pitch_x_um : cell.pitch_y_um;
        dif_field_free(&cell);
    } else if (opts->method == DIF_METHOD_THESIS) { /* the endless tiling has no edge */
        how.line.average = DIF_AVERAGE_NONE;
        how.line.size_x_um = how.line.size_y_um = 40.0 * opts->sigma_um;
    }
    if (dif_fit_table(table, &how, &fit, &err) == DIF_OK) {
        row->fit_period_um = fit.period_um;
        row->fit_uncertainty_um = fit.period_uncertainty_um;
    } else {
        memcpy(row->text, err.text, sizeof row->text);
    }
}

static void note_error(const dif_compare_job *j, const dif_table *table, dif_compare_row *row)
{
    double worst = 0.0, sum = 0.0;
    for (int i = 0; i < j->how.n_check; i++) {
        const double error = fabs(sqrt(table->value[j->cell[i]]) - sqrt(j->truth[i].power));
        worst = fmax(worst, error);
        sum += error * error;
    }
    row->error_worst = worst;
    row->error_rms = sqrt(sum / j->how.n_check);
}

/* Maxima of the table, for pq of one with enough replicas that a finite grating's shift is not seen. */
static dif_status find_argmax(const dif_compare_job *j, const dif_measure_opts *opts, const dif_table *table,
                              dif_compare_row *row, dif_error *err)
{
    if (opts->method != DIF_METHOD_PQ || opts->n_replica != DIF_REPLICAS_FROM_WINDOW) {
        note_argmax(j, opts, table, row);
        return DIF_OK;
    }
    dif_measure_opts many = *opts;
    dif_table longer;
    many.n_replica = MANY_REPLICAS;
    const dif_status status = dif_measure_table(j->field, j->plan, j->tol, &many, &longer, NULL, err);
    if (status != DIF_OK)
        return status;
    note_argmax(j, &many, &longer, row);
    dif_table_free(&longer);
    return DIF_OK;
}

static void run_row(const dif_compare_job *j, const variant *v, dif_compare_row *row)
{
    dif_measure_opts opts = *j->opts;
    dif_measure_stats stats;
    dif_table table = {0};
    dif_error err = {DIF_OK, ""};
    opts.method = v->method;
    opts.single = v->single;
    opts.nmm_jacobian = !v->no_jacobian;
    opts.quantity = DIF_QUANTITY_POWER;
    opts.progress = NULL;
    row->status = dif_measure_table(j->field, j->plan, j->tol, &opts, &table, &stats, &err);
    if (row->status == DIF_OK) {
        row->bound = stats.bound;
        row->build_s = stats.build_wall_s;
        row->eval_s = stats.eval_wall_s;
        row->cpu_s = stats.build_cpu_s + stats.eval_cpu_s;
        note_error(j, &table, row);
        if (j->how.fit)
            note_fit(j, &opts, &table, row);
        row->status = find_argmax(j, &opts, &table, row, &err);
    }
    if (row->status == DIF_OK)
        row->status = dif_compare_colours(j, &opts, row, &err);
    if (row->status != DIF_OK)
        memcpy(row->text, err.text, sizeof row->text);
    dif_table_free(&table);
}

/* The truth at the checked cells, and what the whole table would have cost. */
static dif_status run_direct(const dif_compare_job *j, dif_compare_row *row, dif_error *err)
{
    dif_measure_opts opts = *j->opts;
    dif_measure_stats stats;
    opts.method = DIF_METHOD_DIRECT;
    opts.progress = NULL;
    const dif_status status =
        dif_measure_queries(j->field, (size_t)j->how.n_check, j->query, 0.5, &opts, j->truth, &stats, err);
    if (status != DIF_OK)
        return status;
    const double ratio = (double)j->plan->n_angle * j->plan->n_lambda / j->how.n_check;
    row->bound = stats.bound;
    row->build_s = 0.0;
    row->eval_s = ratio * stats.eval_wall_s;
    row->cpu_s = ratio * stats.eval_cpu_s;
    row->error_worst = row->error_rms = 0.0;
    return DIF_OK;
}

dif_status dif_compare_methods(const dif_field *field, const dif_plan *plan, double tol, const dif_measure_opts *opts,
                               const dif_compare_opts *how, dif_compare *out, dif_error *err)
{
    const dif_measure_opts defaults = dif_measure_opts_default();
    dif_compare_job j = {.field = field, .plan = plan, .tol = tol, .opts = opts ? opts : &defaults};
    j.how = how ? *how : dif_compare_opts_default();
    *out = (dif_compare){0};
    dif_status status = check(&j.how, err);
    if (status == DIF_OK)
        status = dif_plan_check(plan, err);
    if (status != DIF_OK)
        return status;
    for (int i = 0; i < DIF_COMPARE_MAX; i++)
        out->row[i] = row_empty(VARIANTS + i);
    status = job_make(&j, err);
    for (int i = 0; i < DIF_COMPARE_MAX && status == DIF_OK; i++)
        if (VARIANTS[i].method == DIF_METHOD_DIRECT)
            status = run_direct(&j, out->row + i, err);
    for (int i = 0; i < DIF_COMPARE_MAX && status == DIF_OK; i++) {
        if (VARIANTS[i].method != DIF_METHOD_DIRECT)
            run_row(&j, VARIANTS + i, out->row + i);
        if (j.opts->progress)
            j.opts->progress(j.opts->progress_self, (i + 1.0) / DIF_COMPARE_MAX);
    }
    out->n = DIF_COMPARE_MAX;
    out->exposure = j.exposure;
    job_free(&j);
    if (status != DIF_OK)
        *out = (dif_compare){0};
    return status;
}
