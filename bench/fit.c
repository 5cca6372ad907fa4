#include "bench/fit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/fit_cells.h"
#include "bench/fit_order.h"
#include "bench/fit_ridges.h"
#include "core/alloc.h"

dif_fit_table_opts dif_fit_table_opts_default(void)
{
    return (dif_fit_table_opts){.line = {.known = false, .pitch_um = NAN},
                                .index = dif_index_default(),
                                .n_ridge_max = 8,
                                .order = DIF_FIT_ORDER_FIND,
                                .period_start_um = NAN,
                                .offset_free = false,
                                .n_part = 4,
                                .common_period = false};
}

/* A share of the data's rms that the model leaves and that a reader must be told of. */
static const double residual_told = 0.1;
/* Centre and an angular offset cannot be told apart beyond this correlation. */
static const double correlation_max = 0.999;

/* Everything a fit holds on to; freed in one place. */
typedef struct work {
    fit_view view;
    fit_line line;
    fit_spectrum spectrum;
    fit_state *state;
    fit_part *part;
    int n_part;
    char order_note[160];
    int n_left_over;
} work;

static void free_work(work *w)
{
    dif_release(w->part);
    if (w->state)
        dif_release(w->state->cell);
    dif_release(w->state);
    fit_spectrum_free(&w->spectrum);
    fit_line_free(&w->line);
    fit_view_free(&w->view);
}

static dif_status check_opts(const dif_fit_table_opts *o, dif_error *err)
{
    if (!(o->n_ridge_max >= 1 && o->n_ridge_max <= DIF_FIT_RIDGE_MAX))
        return dif_fail(err, DIF_ERR_ARG, "n_ridge_max = %d, want 1 ... %d", o->n_ridge_max, DIF_FIT_RIDGE_MAX);
    if (o->order == 0 || (o->order != DIF_FIT_ORDER_FIND && (o->order > 1000 || o->order < -1000)))
        return dif_fail(err, DIF_ERR_ARG, "order = %d, want a whole number from 1 to 1000 of either sign", o->order);
    if (!isnan(o->period_start_um) && !(o->period_start_um > 0.0 && isfinite(o->period_start_um)))
        return dif_fail(err, DIF_ERR_ARG, "start period = %g um, want a positive number", o->period_start_um);
    if (!(o->n_part >= 2 && o->n_part <= 64))
        return dif_fail(err, DIF_ERR_ARG, "n_part = %d, want 2 ... 64", o->n_part);
    if (!(o->index.n > 0.0 && o->index.kappa >= 0.0))
        return dif_fail(err, DIF_ERR_ARG, "refractive index %g + %g i, want n > 0 and kappa >= 0", o->index.n,
                        o->index.kappa);
    return DIF_OK;
}

/* The line: as known, or a Gaussian as wide as the highest peak of the spectrum. */
static dif_status make_line(work *w, const dif_fit_table_opts *o, dif_error *err)
{
    if (o->line.known)
        return fit_line_create(&o->line, w->view.table->plan.azimuth_rad, &w->line, err);
    const double range = w->view.f_high - w->view.f_low;
    dif_status status = fit_spectrum_create(&w->view, fmax(1.5 * w->view.f_step, range / 5000.0), &w->spectrum, err);
    if (status != DIF_OK)
        return status;
    const double sigma = fit_spectrum_peak_sigma(&w->spectrum);
    fit_spectrum_free(&w->spectrum);
    if (!(sigma > 0.0))
        return dif_fail(err, DIF_ERR_FIT, "no peak inside the scanned range: its ends are highest");
    w->line = fit_line_gauss(sigma);
    return DIF_OK;
}

/* Groups and cells around the given centres. */
static dif_status select_around(work *w, int n, const double *centre, double reach_sigma, dif_error *err)
{
    fit_state *s = w->state;
    const double sigma = w->line.sigma_per_um;
    dif_release(s->cell);
    s->cell = NULL;
    s->model.n_group = fit_ridges_group(&w->view, reach_sigma * sigma, n, centre, s->model.group);
    const fit_selection pick = {
        .n_group = s->model.n_group, .group = s->model.group, .step_per_um = sigma / 3.0, .n_max = FIT_CELL_MAX};
    dif_status status = fit_view_select(&w->view, &pick, &s->cell, &s->n_cell, err);
    if (status == DIF_OK && s->n_cell == 0)
        status = dif_fail(err, DIF_ERR_FIT, "no cell near the peaks");
    return status;
}

/* Peaks of the mean power over f, and the cells around them. */
static dif_status find_candidates(work *w, const dif_fit_table_opts *o, int *n, fit_candidate *candidate,
                                  dif_error *err)
{
    const double sigma = w->line.sigma_per_um;
    if (!(w->view.f_step < 2.0 * sigma))
        return dif_fail(err, DIF_ERR_FIT, "the angles are too coarse for the line: %.3g lines wide a step",
                        w->view.f_step / sigma);
    dif_status status = fit_spectrum_create(&w->view, fmax(sigma / 4.0, w->view.f_step), &w->spectrum, err);
    if (status != DIF_OK)
        return status;
    *n = fit_spectrum_candidates(&w->spectrum, &w->line, o->n_ridge_max, candidate);
    if (*n == 0)
        return dif_fail(err, DIF_ERR_FIT, "no peak inside the scanned range %.4g ... %.4g per um", w->view.f_low,
                        w->view.f_high);
    double centre[DIF_FIT_RIDGE_MAX];
    for (int k = 0; k < *n; k++)
        centre[k] = candidate[k].f_per_um;
    w->state->model.line = &w->line;
    return select_around(w, *n, centre, FIT_CHOOSE_SIGMA, err);
}

/* Strengths of the ridges found so far, from the data: mean power within one width, background included. */
static void rough_weights(const fit_state *s, double *weight)
{
    for (int k = 0; k < s->model.n_ridge; k++) {
        double sum = 0.0;
        int n = 0;
        for (int i = 0; i < s->n_cell; i++)
            if (fabs(s->cell[i].f_per_um - s->par[k]) < s->model.line->sigma_per_um) {
                sum += s->cell[i].y;
                n++;
            }
        weight[k] = n > 0 ? sum / n : 0.0;
    }
}

/* Keeps the ridges that have an order, and the cells around them. */
static dif_status keep_orders(work *w, const int *order, dif_error *err)
{
    fit_model *m = &w->state->model;
    double *centre = w->state->par;
    int n = 0;
    for (int k = 0; k < m->n_ridge; k++)
        if (order[k] != FIT_ORDER_NONE) {
            m->ridge[n] = m->ridge[k];
            m->ridge[n].order = order[k];
            centre[n++] = centre[k];
        }
    w->n_left_over = m->n_ridge - n;
    m->n_ridge = n;
    dif_status status = select_around(w, n, centre, FIT_WINDOW_SIGMA, err);
    for (int k = 0; k < n; k++)
        for (int g = 0; g < m->n_group; g++)
            if (centre[k] >= m->group[g].f_low && centre[k] <= m->group[g].f_high)
                m->ridge[k].group = g;
    return status;
}

/* Orders of one period, or the same order for each ridge; sets the shared start values. */
static dif_status set_orders(work *w, const dif_fit_table_opts *o, dif_error *err)
{
    fit_state *s = w->state;
    double f[DIF_FIT_RIDGE_MAX], weight[DIF_FIT_RIDGE_MAX], g = 0.0;
    int order[DIF_FIT_RIDGE_MAX];
    memcpy(f, s->par, sizeof f);
    rough_weights(s, weight);
    if (o->common_period) {
        const fit_order_input in = {.n = s->model.n_ridge,
                                    .f_per_um = f,
                                    .weight = weight,
                                    .sigma_per_um = w->line.sigma_per_um,
                                    .f_low = w->view.f_low,
                                    .f_high = w->view.f_high,
                                    .order = o->order,
                                    .period_start_um = o->period_start_um};
        dif_status found = fit_order_assign(&in, order, &g, w->order_note, err);
        if (found != DIF_OK)
            return found;
    } else {
        const int m = o->order == DIF_FIT_ORDER_FIND ? 1 : o->order < 0 ? -o->order : o->order;
        for (int k = 0; k < s->model.n_ridge; k++)
            order[k] = fabs(f[k]) < w->line.sigma_per_um ? 0 : f[k] < 0.0 ? -m : m;
        if (o->order == DIF_FIT_ORDER_FIND)
            snprintf(w->order_note, sizeof w->order_note, "order 1 assumed for each ridge");
    }
    dif_status status = keep_orders(w, order, err);
    if (status != DIF_OK)
        return status;
    s->model.common = o->common_period;
    s->model.offset_free = o->offset_free;
    s->model.width_free = !o->line.known;
    fit_model_number(&s->model);
    if (s->model.common)
        s->par[0] = g;
    if (s->model.offset_free)
        s->par[s->model.i_offset] = 0.0;
    if (s->model.width_free)
        s->par[s->model.i_width] = w->line.sigma_per_um;
    return DIF_OK;
}

/* Ridge that speaks for the table: the strongest one with a period, or the one nearest to the start period. */
static int headline(const dif_fit_result *r, double period_start_um)
{
    int best = -1;
    for (int k = 0; k < r->n_ridge; k++) {
        if (r->ridge[k].order == 0)
            continue;
        if (best < 0 || (isfinite(period_start_um) && fabs(r->ridge[k].period_um - period_start_um) <
                                                          fabs(r->ridge[best].period_um - period_start_um)))
            best = k;
    }
    return best;
}

/* Standard error of a centre from its parts: with weights w = 1/sd^2 of the parts about the value x of the whole fit,
 *   se^2 = sum w_j (x_j - x)^2 / ((n - 1) sum w_j),
 * which is sd/sqrt(n) for equal weights, and more if the parts together contradict the whole. The centres come in as
 * g = f/m (common period, all parts) or f (parts of one ridge; ridge >= 0). NaN for fewer than two parts. */
static double scatter_of(const work *w, int ridge, double x, int *n_used)
{
    double sum_w = 0.0, sum = 0.0;
    *n_used = 0;
    for (int i = 0; i < w->n_part; i++) {
        const int k = w->part[i].ridge, m = ridge >= 0 ? 1 : w->state->model.ridge[k].order;
        if ((ridge >= 0 && k != ridge) || m == 0)
            continue;
        const double sd = w->part[i].f_sd_per_um / m, d = w->part[i].f_per_um / m - x;
        sum_w += 1.0 / (sd * sd);
        sum += d * d / (sd * sd);
        (*n_used)++;
    }
    return *n_used > 1 ? sqrt(sum / ((*n_used - 1) * sum_w)) : (double)NAN;
}

/* Variance of ridge k's centre from the covariance of the shared parameters. */
static double centre_variance(const fit_state *s, int k)
{
    const fit_model *m = &s->model;
    if (m->common)
        return m->ridge[k].order * m->ridge[k].order * s->outcome.covariance[0];
    return s->outcome.covariance[k * (m->n_shared + 1)];
}

static void fill_ridges(const work *w, dif_fit_result *r)
{
    const fit_state *s = w->state;
    double total = 0.0;
    r->n_ridge = s->model.n_ridge;
    for (int k = 0; k < r->n_ridge; k++) {
        dif_fit_ridge *to = &r->ridge[k];
        int n = 0;
        to->order = s->model.ridge[k].order;
        to->f_per_um = fit_model_centre(&s->model, s->par, k);
        to->f_sd_per_um = sqrt(centre_variance(s, k));
        to->weight = fmax(fit_ridges_strength(s, k), 0.0);
        to->width_per_um = s->model.width_free ? fit_model_width(&s->model, s->par) : w->line.rms_per_um;
        const double per_f = fabs(to->order / (to->f_per_um * to->f_per_um));
        to->period_um = to->order ? fabs(to->order / to->f_per_um) : (double)NAN;
        to->period_sd_um = to->order ? per_f * to->f_sd_per_um : (double)NAN;
        to->period_scatter_um = to->order ? per_f * scatter_of(w, k, to->f_per_um, &n) : (double)NAN;
        total += to->weight;
    }
    for (int k = 0; k < r->n_ridge; k++)
        r->ridge[k].weight /= total;
    for (int i = 1; i < r->n_ridge; i++)
        for (int j = i; j > 0 && r->ridge[j].weight > r->ridge[j - 1].weight; j--) {
            const dif_fit_ridge swap = r->ridge[j];
            r->ridge[j] = r->ridge[j - 1];
            r->ridge[j - 1] = swap;
        }
}

/* Centre of the ridge that is now at f, before the model's last refinement. */
static double before_of(const fit_state *s, double f_per_um)
{
    for (int k = 0; k < s->model.n_ridge; k++)
        if (fit_model_centre(&s->model, s->par, k) == f_per_um)
            return s->before[k];
    return f_per_um;
}

static void fill_period(const work *w, const dif_fit_table_opts *o, dif_fit_result *r)
{
    const fit_state *s = w->state;
    const dif_fit_ridge *top = &r->ridge[headline(r, o->period_start_um)];
    r->period_um = top->period_um;
    r->period_sd_um = top->period_sd_um;
    r->period_scatter_um = top->period_scatter_um;
    if (s->model.common) {
        const double g = s->par[0];
        r->period_scatter_um = scatter_of(w, -1, g, &r->n_part) / (g * g);
    } else {
        r->n_part = 0;
        for (int i = 0; i < w->n_part; i++)
            r->n_part += fit_model_centre(&s->model, s->par, w->part[i].ridge) == top->f_per_um;
    }
    /* a model that had to be refined is not exact after the refinement either: its last step says how far off */
    r->period_model_um =
        s->has_before ? fabs(top->order / before_of(s, top->f_per_um) - top->order / top->f_per_um) : 0.0;
    r->period_uncertainty_um = fmax(fmax(r->period_sd_um, r->period_scatter_um), r->period_model_um); /* skips NaN */
    if (s->model.offset_free) {
        r->offset_rad = fit_model_offset(&s->model, s->par);
        r->offset_sd_rad = sqrt(s->outcome.covariance[s->model.i_offset * (s->model.n_shared + 1)]);
    }
}

static void fill_residuals(const work *w, dif_fit_result *r)
{
    const fit_state *s = w->state;
    double square = 0.0, data = 0.0;
    for (int i = 0; i < s->n_cell; i++) {
        const double d = fit_model_value(&s->model, s->par, &s->cell[i]) - s->cell[i].y;
        square += d * d;
        data += s->cell[i].y * s->cell[i].y;
    }
    r->residual_rms = sqrt(square / s->n_cell) * w->view.y_max;
    r->residual_share = sqrt(square / data);
    r->criterion = s->outcome.criterion;
    r->n_data = s->n_cell;
    r->n_parameter = s->model.n_par;
    r->n_iteration = s->outcome.n_iteration;
}

/* Appends to a note, "; " between. */
static void add_note(dif_fit_result *r, const char *text)
{
    const size_t used = strlen(r->note);
    if (text[0])
        snprintf(r->note + used, sizeof r->note - used, "%s%s", used ? "; " : "", text);
}

static void fill_note(const work *w, dif_fit_result *r)
{
    char text[160];
    if (r->residual_share > residual_told) {
        snprintf(text, sizeof text, "%.0f %% of the data's rms is not explained by the ridges",
                 100.0 * r->residual_share);
        add_note(r, text);
    }
    add_note(r, w->order_note);
    if (w->n_left_over > 0) {
        snprintf(text, sizeof text, "%d weak ridges are no orders and left out", w->n_left_over);
        add_note(r, text);
    }
    if (!isfinite(r->period_scatter_um))
        add_note(r, "too few parts for a scatter");
}

/* What must hold before a period is believed. */
static dif_status believe(const work *w, dif_error *err)
{
    const fit_state *s = w->state;
    const fit_outcome *o = &s->outcome;
    const fit_model *m = &s->model;
    if (!o->converged)
        return dif_fail(err, DIF_ERR_FIT, "not converged after %d iterations: %s", o->n_iteration, o->text);
    if (!o->has_covariance)
        return dif_fail(err, DIF_ERR_FIT, "the table does not determine all parameters (singular covariance)");
    for (int k = 0; k < m->n_ridge; k++) {
        const double sd = sqrt(centre_variance(s, k)), sigma = fit_model_width(m, s->par);
        if (!(sd < 0.25 * sigma))
            return dif_fail(err, DIF_ERR_FIT,
                            "the ridge at %.6g per um is not determined: its centre is uncertain by %.2g "
                            "of the line's width",
                            fit_model_centre(m, s->par, k), sd / sigma);
        if (m->offset_free) {
            const int at = m->common ? 0 : k, i = m->i_offset, n = m->n_shared;
            const double c = o->covariance[at * n + i] / sqrt(o->covariance[at * n + at] * o->covariance[i * n + i]);
            if (!(fabs(c) < correlation_max))
                return dif_fail(err, DIF_ERR_FIT,
                                "the table does not tell period and angular offset apart: scan two orders "
                                "or a wider range of wavelengths, or fit without an offset");
        }
    }
    return DIF_OK;
}

static dif_status run(work *w, const dif_fit_table_opts *o, dif_error *err)
{
    int n = 0;
    fit_candidate candidate[DIF_FIT_RIDGE_MAX];
    dif_status status = make_line(w, o, err);
    if (status == DIF_OK)
        status = find_candidates(w, o, &n, candidate, err);
    if (status == DIF_OK)
        status = fit_ridges_choose(w->state, n, candidate, err);
    if (status != DIF_OK)
        return status;
    if (w->state->model.n_ridge == 0)
        return dif_fail(err, DIF_ERR_FIT, "no ridge is supported by the table: of %d peaks none is a line", n);
    status = set_orders(w, o, err);
    if (status == DIF_OK)
        status = fit_ridges_solve(w->state, o->line.known ? o->line.pitch_um : (double)NAN, err);
    if (status == DIF_OK)
        status = believe(w, err);
    if (status == DIF_OK)
        status = fit_ridges_parts(w->state, o->n_part, w->part, &w->n_part, err);
    return status;
}

dif_status dif_fit_table(const dif_table *table, const dif_fit_table_opts *opts, dif_fit_result *out, dif_error *err)
{
    const dif_fit_table_opts o = opts ? *opts : dif_fit_table_opts_default();
    work w = {0};
    *out = (dif_fit_result){0};
    dif_status status = check_opts(&o, err);
    if (status == DIF_OK)
        status = fit_view_create(table, o.index, &w.view, err);
    if (status != DIF_OK)
        return status;
    w.state = dif_alloc(1, sizeof *w.state);
    w.part = dif_alloc((size_t)o.n_part * DIF_FIT_RIDGE_MAX, sizeof *w.part);
    if (!w.state || !w.part)
        status = dif_fail(err, DIF_ERR_NOMEM, "fit of a table");
    else if (w.view.n_lambda_valid < FIT_LAMBDA_MIN)
        status = dif_fail(err, DIF_ERR_FIT, "%d wavelengths with values, want at least %d", w.view.n_lambda_valid,
                          FIT_LAMBDA_MIN);
    else
        status = run(&w, &o, err);
    if (status == DIF_OK) {
        fill_ridges(&w, out);
        if (headline(out, o.period_start_um) < 0) {
            *out = (dif_fit_result){0};
            status = dif_fail(err, DIF_ERR_FIT, "only the specular ridge is in the scan: it has no period");
        } else {
            fill_period(&w, &o, out);
            fill_residuals(&w, out);
            fill_note(&w, out);
        }
    }
    free_work(&w);
    return status;
}
