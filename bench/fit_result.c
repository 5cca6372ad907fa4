#include "bench/fit_result.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A share of the data's rms that the model leaves and that a reader must be told of. */
static const double residual_told = 0.1;

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
 *   se^2 = [sum w_j (x_j - x)^2 / (n - 1)] / W,   W = the larger of sum w_j and 1/sd^2 of the whole fit,
 * which is sd/sqrt(n) for equal weights, and more if the parts together contradict the whole; parts that see only some
 * of what the whole sees cannot make it less certain than it is. The centres come in as g = f/m (common period, all
 * parts) or f (parts of one ridge; ridge >= 0). NaN for fewer than two parts. */
static double scatter_of(const dif_fit_work *w, int ridge, double x, double sd_whole, int *n_used)
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
    return *n_used > 1 ? sqrt(sum / ((*n_used - 1) * fmax(sum_w, 1.0 / (sd_whole * sd_whole)))) : (double)NAN;
}

/* Variance of ridge k's centre from the covariance of the shared parameters. */
double dif_fit_result_centre_variance(const dif_fit_state *s, int k)
{
    const dif_fit_model *m = &s->model;
    if (m->common)
        return m->ridge[k].order * m->ridge[k].order * s->outcome.covariance[0];
    return s->outcome.covariance[k * (m->n_shared + 1)];
}

static void fill_ridges(const dif_fit_work *w, dif_fit_result *r)
{
    const dif_fit_state *s = w->state;
    double total = 0.0;
    r->n_ridge = s->model.n_ridge;
    for (int k = 0; k < r->n_ridge; k++) {
        dif_fit_ridge *to = &r->ridge[k];
        int n = 0;
        to->order = s->model.ridge[k].order;
        to->f_per_um = dif_fit_model_centre(&s->model, s->par, k);
        to->f_sd_per_um = sqrt(dif_fit_result_centre_variance(s, k));
        to->weight = fmax(dif_fit_ridges_strength(s, k), 0.0);
        to->width_per_um = s->model.width_free ? dif_fit_model_width(&s->model, s->par) : w->line.rms_per_um;
        const double per_f = fabs(to->order / (to->f_per_um * to->f_per_um));
        to->period_um = to->order ? fabs(to->order / to->f_per_um) : (double)NAN;
        to->period_sd_um = to->order ? per_f * to->f_sd_per_um : (double)NAN;
        to->period_scatter_um = to->order ? per_f * scatter_of(w, k, to->f_per_um, to->f_sd_per_um, &n) : (double)NAN;
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

/* What a refined model's period may still be off: three times what the last refinement moved (the steps shrink, but not
 * evenly), and no less than a share of what all of them did. f tells the ridge. */
static double model_error_um(const dif_fit_state *s, double f_per_um, int order)
{
    const double steps = 3.0,
                 share = 0.02; /* leaks are of this size in amplitude, and so is what a next step would move */
    for (int k = 0; k < s->model.n_ridge && s->has_before; k++)
        if (dif_fit_model_centre(&s->model, s->par, k) == f_per_um) {
            const double last = fabs(order / s->before[k] - order / f_per_um);
            return fmax(steps * last, share * fabs(order / s->plain[k] - order / f_per_um));
        }
    return 0.0;
}

static void fill_period(const dif_fit_work *w, double period_start_um, dif_fit_result *r)
{
    const dif_fit_state *s = w->state;
    const dif_fit_ridge *top = &r->ridge[headline(r, period_start_um)];
    r->period_um = top->period_um;
    r->period_sd_um = top->period_sd_um;
    r->period_scatter_um = top->period_scatter_um;
    if (s->model.common) {
        const double g = s->par[0];
        r->period_scatter_um = scatter_of(w, -1, g, sqrt(s->outcome.covariance[0]), &r->n_part) / (g * g);
    } else {
        r->n_part = 0;
        for (int i = 0; i < w->n_part; i++)
            r->n_part += dif_fit_model_centre(&s->model, s->par, w->part[i].ridge) == top->f_per_um;
    }
    r->period_model_um = model_error_um(s, top->f_per_um, top->order);
    r->period_uncertainty_um = fmax(fmax(r->period_sd_um, r->period_scatter_um), r->period_model_um); /* skips NaN */
    if (s->model.offset_free) {
        r->offset_rad = dif_fit_model_offset(&s->model, s->par);
        r->offset_sd_rad = sqrt(s->outcome.covariance[s->model.i_offset * (s->model.n_shared + 1)]);
    }
}

static void fill_residuals(const dif_fit_work *w, dif_fit_result *r)
{
    const dif_fit_state *s = w->state;
    double square = 0.0, data = 0.0;
    for (int i = 0; i < s->n_cell; i++) {
        const double d = dif_fit_model_value(&s->model, s->par, &s->cell[i]) - s->cell[i].y;
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

static void fill_note(const dif_fit_work *w, dif_fit_result *r)
{
    char text[160];
    if (r->residual_share > residual_told) {
        snprintf(text, sizeof text, "%.0f %% of the data's rms is not explained by the ridges",
                 100.0 * r->residual_share);
        add_note(r, text);
    }
    add_note(r, w->order_note);
    if (w->state->model.edge)
        add_note(r, w->state->model.n_ghost > 0
                        ? "leak through the patch's edges and ghosts of its samples are modelled"
                        : "leak through the patch's edges is modelled");
    if (w->n_left_over > 0) {
        snprintf(text, sizeof text, "%d weak ridges are no orders and left out", w->n_left_over);
        add_note(r, text);
    }
    if (w->n_given_up > 0) {
        snprintf(text, sizeof text, "%d ridges are not determined and given up", w->n_given_up);
        add_note(r, text);
    }
    if (!isfinite(r->period_scatter_um))
        add_note(r, "too few parts for a scatter");
}

dif_status dif_fit_result_fill(const dif_fit_work *w, double period_start_um, dif_fit_result *out, dif_error *err)
{
    fill_ridges(w, out);
    if (headline(out, period_start_um) < 0) {
        *out = (dif_fit_result){0};
        return dif_fail(err, DIF_ERR_FIT, "only the specular ridge is in the scan: it has no period");
    }
    fill_period(w, period_start_um, out);
    fill_residuals(w, out);
    fill_note(w, out);
    return DIF_OK;
}
