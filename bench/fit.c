#include "bench/fit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/fit_cells.h"
#include "bench/fit_order.h"
#include "bench/fit_result.h"
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

/* A centre less certain than this share of the line's width is not determined. */
static const double centre_share_max = 0.3;
/* A model that leaves more than this share of the data's rms is none, unless noise is what it leaves: residuals of which
 * at least this share are independent. */
static const double misfit_max = 0.3, noise_share = 0.2;
/* Distance in f of cells that are fitted, in line widths. */
static const double cell_step = 1.0 / 3.0;
/* Fewer cells between the fitted ones than this say nothing. */
static const int held_out_min = 100;
/* Centre and an angular offset cannot be told apart beyond this correlation. */
static const double correlation_max = 0.999;

static void free_work(dif_fit_work *w)
{
    dif_release(w->part);
    if (w->state)
        dif_release(w->state->cell);
    dif_release(w->state);
    dif_fit_spectrum_free(&w->spectrum);
    dif_fit_line_free(&w->line);
    dif_fit_view_free(&w->view);
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
static dif_status make_line(dif_fit_work *w, const dif_fit_table_opts *o, dif_error *err)
{
    if (o->line.known)
        return dif_fit_line_create(&o->line, w->view.table->plan.azimuth_rad, &w->line, err);
    const double range = w->view.f_high - w->view.f_low;
    dif_status status =
        dif_fit_spectrum_create(&w->view, fmax(1.5 * w->view.f_step, range / 5000.0), &w->spectrum, err);
    if (status != DIF_OK)
        return status;
    const double sigma = dif_fit_spectrum_peak_sigma(&w->spectrum);
    dif_fit_spectrum_free(&w->spectrum);
    if (!(sigma > 0.0))
        return dif_fail(err, DIF_ERR_FIT, "no peak inside the scanned range: its ends are highest");
    w->line = dif_fit_line_gauss(sigma);
    return DIF_OK;
}

/* Groups and cells around the given centres. */
static dif_status select_around(dif_fit_work *w, int n, const double *centre, double reach_sigma, dif_error *err)
{
    dif_fit_state *s = w->state;
    const double sigma = w->line.sigma_per_um;
    dif_release(s->cell);
    s->cell = NULL;
    s->model.n_group = dif_fit_ridges_group(&w->view, reach_sigma * sigma, n, centre, s->model.group);
    const dif_fit_selection pick = {.n_group = s->model.n_group,
                                    .group = s->model.group,
                                    .step_per_um = sigma * cell_step,
                                    .n_max = DIF_FIT_CELL_MAX};
    dif_status status = dif_fit_view_select(&w->view, &pick, &s->cell, &s->n_cell, err);
    if (status == DIF_OK && s->n_cell == 0)
        status = dif_fail(err, DIF_ERR_FIT, "no cell near the peaks");
    return status;
}

/* Peaks of the mean power over f, and the cells around them. */
static dif_status find_candidates(dif_fit_work *w, const dif_fit_table_opts *o, int *n, dif_fit_candidate *candidate,
                                  dif_error *err)
{
    const double sigma = w->line.sigma_per_um;
    if (!(w->view.f_step < 2.0 * sigma))
        return dif_fail(err, DIF_ERR_FIT, "the angles are too coarse for the line: %.3g lines wide a step",
                        w->view.f_step / sigma);
    dif_status status = dif_fit_spectrum_create(&w->view, fmax(sigma / 4.0, w->view.f_step), &w->spectrum, err);
    if (status != DIF_OK)
        return status;
    *n = dif_fit_spectrum_candidates(&w->spectrum, &w->line, o->n_ridge_max, candidate);
    if (*n == 0)
        return dif_fail(err, DIF_ERR_FIT, "no peak inside the scanned range %.4g ... %.4g per um", w->view.f_low,
                        w->view.f_high);
    double centre[DIF_FIT_RIDGE_MAX];
    for (int k = 0; k < *n; k++)
        centre[k] = candidate[k].f_per_um;
    w->state->model.line = &w->line;
    return select_around(w, *n, centre, DIF_FIT_CHOOSE_SIGMA, err);
}

/* Keeps the ridges that have an order, and the cells around them. The mirror direction knows nothing of a common period
 * (only of an offset), and its strength would hide the orders' misfit. */
static dif_status keep_orders(dif_fit_work *w, const int *order, bool mirror_useless, dif_error *err)
{
    dif_fit_model *m = &w->state->model;
    double *centre = w->state->par;
    int n = 0;
    for (int k = 0; k < m->n_ridge; k++)
        w->n_left_over += order[k] == DIF_FIT_ORDER_NONE;
    for (int k = 0; k < m->n_ridge; k++)
        if (order[k] != DIF_FIT_ORDER_NONE && !(mirror_useless && order[k] == 0)) {
            m->ridge[n] = m->ridge[k];
            m->ridge[n].order = order[k];
            centre[n++] = centre[k];
        }
    m->n_ridge = n;
    dif_status status = select_around(w, n, centre, DIF_FIT_WINDOW_SIGMA, err);
    for (int k = 0; k < n; k++)
        for (int g = 0; g < m->n_group; g++)
            if (centre[k] >= m->group[g].f_low && centre[k] <= m->group[g].f_high)
                m->ridge[k].group = g;
    return status;
}

/* Orders of one period, or the same order for each ridge; sets the shared start values. */
static dif_status set_orders(dif_fit_work *w, const dif_fit_table_opts *o, dif_error *err)
{
    dif_fit_state *s = w->state;
    double f[DIF_FIT_RIDGE_MAX], weight[DIF_FIT_RIDGE_MAX], g = 0.0;
    int order[DIF_FIT_RIDGE_MAX];
    memcpy(f, s->par, sizeof f);
    for (int k = 0; k < s->model.n_ridge; k++)
        weight[k] = s->model.ridge[k].strength;
    if (o->common_period) {
        const dif_fit_order_input in = {.n = s->model.n_ridge,
                                        .f_per_um = f,
                                        .weight = weight,
                                        .sigma_per_um = w->line.sigma_per_um,
                                        .f_low = w->view.f_low,
                                        .f_high = w->view.f_high,
                                        .order = o->order,
                                        .period_start_um = o->period_start_um,
                                        .loose = o->offset_free};
        dif_status found = dif_fit_order_assign(&in, order, &g, w->order_note, err);
        if (found != DIF_OK)
            return found;
    } else {
        const int m = o->order == DIF_FIT_ORDER_FIND ? 1 : o->order < 0 ? -o->order : o->order;
        for (int k = 0; k < s->model.n_ridge; k++)
            order[k] = fabs(f[k]) < w->line.sigma_per_um ? 0 : f[k] < 0.0 ? -m : m;
        snprintf(w->order_note, sizeof w->order_note, "order %d %s for each ridge", m,
                 o->order == DIF_FIT_ORDER_FIND ? "assumed" : "as given");
    }
    dif_status status = keep_orders(w, order, o->common_period && !o->offset_free, err);
    if (status != DIF_OK)
        return status;
    s->model.common = o->common_period;
    s->model.offset_free = o->offset_free;
    s->model.width_free = !o->line.known;
    dif_fit_model_number(&s->model);
    if (s->model.common)
        s->par[0] = g;
    if (s->model.offset_free)
        s->par[s->model.i_offset] = 0.0;
    if (s->model.width_free)
        s->par[s->model.i_width] = w->line.sigma_per_um;
    return DIF_OK;
}

/* The ridge with the least certain centre and its uncertainty in line widths; infinite for one of no strength. */
static int weakest(const dif_fit_state *s, double *share)
{
    int worst = -1;
    *share = 0.0;
    for (int k = 0; k < s->model.n_ridge; k++) {
        const double sd = sqrt(dif_fit_result_centre_variance(s, k)) / dif_fit_model_width(&s->model, s->par);
        const double here = dif_fit_ridges_strength(s, k) > 0.0 && isfinite(sd) ? sd : HUGE_VAL;
        if (worst < 0 || here > *share) {
            *share = here;
            worst = k;
        }
    }
    return worst;
}

/* Centre and offset must not be two names of one thing. */
static dif_status believe_offset(const dif_fit_state *s, dif_error *err)
{
    const dif_fit_model *m = &s->model;
    const double *cov = s->outcome.covariance;
    for (int k = 0; k < m->n_ridge && m->offset_free; k++) {
        const int at = m->common ? 0 : k, i = m->i_offset, n = m->n_shared;
        const double c = cov[at * n + i] / sqrt(cov[at * n + at] * cov[i * n + i]);
        if (!(fabs(c) < correlation_max))
            return dif_fail(err, DIF_ERR_FIT,
                            "the table does not tell period and angular offset apart: scan two orders or a wider range "
                            "of wavelengths, or fit without an offset");
    }
    return DIF_OK;
}

/* What must hold before a period is believed. */
static dif_status believe(const dif_fit_state *s, dif_error *err)
{
    const dif_fit_outcome *o = &s->outcome;
    double share = 0.0;
    if (!o->converged)
        return dif_fail(err, DIF_ERR_FIT, "not converged after %d iterations: %s", o->n_iteration, o->text);
    if (!o->has_covariance)
        return dif_fail(err, DIF_ERR_FIT, "the table does not determine all parameters (singular covariance)");
    double square = 0.0;
    for (int i = 0; i < s->n_cell; i++)
        square += s->cell[i].y * s->cell[i].y;
    const double left = o->residual_rms / sqrt(square / s->n_cell);
    if (left > misfit_max && o->independent_share < noise_share)
        return dif_fail(err, DIF_ERR_FIT,
                        "the ridges leave %.0f %% of the table's rms unexplained, and that is not noise", 100.0 * left);
    const int k = weakest(s, &share);
    if (!(share < centre_share_max))
        return dif_fail(err, DIF_ERR_FIT,
                        "the ridge at %.6g per um is not determined: its centre is uncertain by %.2g line "
                        "widths",
                        dif_fit_model_centre(&s->model, s->par, k), share);
    return believe_offset(s, err);
}

/* Fits all ridges; of ridges with periods of their own those that are not determined are given up, one by one. */
static dif_status solve_believed(dif_fit_work *w, const dif_fit_table_opts *o, dif_error *err)
{
    dif_fit_state *s = w->state;
    const double pitch_um = o->line.known ? o->line.pitch_um : (double)NAN;
    for (;;) {
        double share = 0.0;
        dif_status status = dif_fit_ridges_solve(s, pitch_um, err);
        if (status != DIF_OK)
            return status;
        const int k = weakest(s, &share);
        if (s->model.common || s->model.n_ridge < 2 || (s->outcome.has_covariance && share < centre_share_max))
            return believe(s, err);
        dif_fit_ridges_drop(s, k);
        w->n_given_up++;
    }
}

/* Cells that were not fitted, half way between those that were, must be explained as well: a model that only bends
 * through its own cells is not believed. */
static dif_status believe_held_out(const dif_fit_work *w, dif_error *err)
{
    const dif_fit_state *s = w->state;
    const dif_fit_selection between = {.n_group = s->model.n_group,
                                       .group = s->model.group,
                                       .step_per_um = w->line.sigma_per_um * cell_step,
                                       .n_max = DIF_FIT_CELL_MAX,
                                       .between = true};
    dif_fit_cell *cell = NULL;
    int n = 0;
    dif_status status = dif_fit_view_select(&w->view, &between, &cell, &n, err);
    double square = 0.0;
    for (int i = 0; i < n; i++) {
        const double r = dif_fit_model_value(&s->model, s->par, &cell[i]) - cell[i].y;
        square += r * r;
    }
    dif_release(cell);
    if (status == DIF_OK && n >= held_out_min && !(sqrt(square / n) <= 2.0 * s->outcome.residual_rms + 1e-9))
        return dif_fail(err, DIF_ERR_FIT, "%d cells that were not fitted are off by %.3g, those that were by %.3g", n,
                        sqrt(square / n), s->outcome.residual_rms);
    return status;
}

static dif_status run(dif_fit_work *w, const dif_fit_table_opts *o, dif_error *err)
{
    int n = 0;
    dif_fit_candidate candidate[DIF_FIT_RIDGE_MAX];
    dif_status status = make_line(w, o, err);
    if (status == DIF_OK)
        status = find_candidates(w, o, &n, candidate, err);
    if (status == DIF_OK)
        status = dif_fit_ridges_choose(w->state, n, candidate, err);
    if (status != DIF_OK)
        return status;
    if (w->state->model.n_ridge == 0)
        return dif_fail(err, DIF_ERR_FIT, "no ridge is supported by the table: of %d peaks none is a line", n);
    status = set_orders(w, o, err);
    if (status == DIF_OK)
        status = solve_believed(w, o, err);
    if (status == DIF_OK)
        status = believe_held_out(w, err);
    if (status == DIF_OK)
        status = dif_fit_ridges_parts(w->state, o->n_part, w->part, &w->n_part, err);
    return status;
}

dif_status dif_fit_table(const dif_table *table, const dif_fit_table_opts *opts, dif_fit_result *out, dif_error *err)
{
    const dif_fit_table_opts o = opts ? *opts : dif_fit_table_opts_default();
    dif_fit_work w = {0};
    *out = (dif_fit_result){0};
    dif_status status = check_opts(&o, err);
    if (status == DIF_OK)
        status = dif_fit_view_create(table, o.index, &w.view, err);
    if (status != DIF_OK)
        return status;
    w.state = dif_alloc(1, sizeof *w.state);
    w.part = dif_alloc((size_t)o.n_part * DIF_FIT_RIDGE_MAX, sizeof *w.part);
    if (!w.state || !w.part)
        status = dif_fail(err, DIF_ERR_NOMEM, "fit of a table");
    else if (w.view.n_lambda_valid < DIF_FIT_LAMBDA_MIN)
        status = dif_fail(err, DIF_ERR_FIT, "%d wavelengths with values, want at least %d", w.view.n_lambda_valid,
                          DIF_FIT_LAMBDA_MIN);
    else
        status = run(&w, &o, err);
    if (status == DIF_OK)
        status = dif_fit_result_fill(&w, o.period_start_um, out, err);
    free_work(&w);
    return status;
}
