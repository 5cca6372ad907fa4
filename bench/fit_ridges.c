#include "bench/fit_ridges.h"

#include <math.h>
#include <string.h>

#include "core/alloc.h"

static int by_f(const dif_fit_group *a, const dif_fit_group *b)
{
    return (a->f_low > b->f_low) - (a->f_low < b->f_low);
}

static void sort_groups(int n, dif_fit_group *g)
{
    for (int i = 1; i < n; i++)
        for (int j = i; j > 0 && by_f(&g[j - 1], &g[j]) > 0; j--) {
            const dif_fit_group swap = g[j];
            g[j] = g[j - 1];
            g[j - 1] = swap;
        }
}

int dif_fit_ridges_group(const dif_fit_view *view, double reach_per_um, int n, const double *centre,
                         dif_fit_group group[DIF_FIT_RIDGE_MAX])
{
    dif_fit_group one[DIF_FIT_RIDGE_MAX];
    for (int k = 0; k < n; k++) {
        one[k] = (dif_fit_group){.n_level = DIF_FIT_LEVEL, .n_slope = DIF_FIT_SLOPE};
        one[k].f_low = fmax(centre[k] - reach_per_um, view->f_low);
        one[k].f_high = fmin(centre[k] + reach_per_um, view->f_high);
    }
    sort_groups(n, one);
    int n_group = 0;
    for (int k = 0; k < n; k++) {
        if (n_group > 0 && one[k].f_low <= group[n_group - 1].f_high)
            group[n_group - 1].f_high = fmax(group[n_group - 1].f_high, one[k].f_high);
        else
            group[n_group++] = one[k];
    }
    return n_group;
}

/* What the cells around one centre cover. */
typedef struct coverage {
    double kz_low, kz_high;
    int n_lambda;        /* wavelengths with a cell within one width */
    int n_left, n_right; /* cells on either side                     */
} coverage;

static coverage cover(int n, const dif_fit_cell *cells, int group, double centre, double sigma)
{
    coverage c = {.kz_low = INFINITY, .kz_high = -INFINITY};
    int last = -1;
    for (int i = 0; i < n; i++) {
        const double t = (cells[i].f_per_um - centre) / sigma;
        if (cells[i].group != group || fabs(t) > 2.5)
            continue;
        c.kz_low = fmin(c.kz_low, cells[i].kz_rad_per_um);
        c.kz_high = fmax(c.kz_high, cells[i].kz_rad_per_um);
        c.n_left += t < -0.5;
        c.n_right += t > 0.5;
        if (fabs(t) < 1.0 && cells[i].i_lambda != last) {
            last = cells[i].i_lambda;
            c.n_lambda++;
        }
    }
    return c;
}

static void group_range(dif_fit_group *g, int index, int n, const dif_fit_cell *cells)
{
    g->kz_low = INFINITY;
    g->kz_high = -INFINITY;
    for (int i = 0; i < n; i++)
        if (cells[i].group == index) {
            g->kz_low = fmin(g->kz_low, cells[i].kz_rad_per_um);
            g->kz_high = fmax(g->kz_high, cells[i].kz_rad_per_um);
        }
}

bool dif_fit_ridges_range(dif_fit_model *model, int n, const dif_fit_cell *cells, const double *centre, int *lost)
{
    for (int g = 0; g < model->n_group; g++)
        group_range(&model->group[g], g, n, cells);
    for (int k = 0; k < model->n_ridge; k++) {
        dif_fit_component *r = &model->ridge[k];
        const coverage c = cover(n, cells, r->group, centre[k], model->line->sigma_per_um);
        *lost = k;
        if (c.n_lambda < DIF_FIT_LAMBDA_MIN || c.n_left < DIF_FIT_LAMBDA_MIN || c.n_right < DIF_FIT_LAMBDA_MIN)
            return false;
        r->kz_low = c.kz_low;
        r->kz_high = c.kz_high;
        const int cap = c.n_lambda / 6 > 3 ? c.n_lambda / 6 : 3;
        r->n_coef = r->n_coef > cap ? cap : r->n_coef;
        r->n_side = r->n_side > cap ? cap : r->n_side;
    }
    return true;
}

double dif_fit_ridges_strength(const dif_fit_state *state, int k)
{
    const dif_fit_model *m = &state->model;
    const double offset = dif_fit_model_offset(m, state->par), width = dif_fit_model_width(m, state->par);
    double sum = 0.0;
    int n = 0;
    for (int i = 0; i < state->n_cell; i++) {
        const double f = dif_fit_model_frequency(&state->cell[i], offset, NULL);
        if (state->cell[i].group == m->ridge[k].group && fabs(f - dif_fit_model_centre(m, state->par, k)) < width) {
            const double c = dif_fit_model_amplitude(m, state->par, k, state->cell[i].kz_rad_per_um);
            sum += m->coherent ? c * c : c;
            n++;
        }
    }
    return n > 0 ? sum / n : 0.0;
}

double dif_fit_ridges_criterion(const dif_fit_state *s, double n_independent)
{
    const double variance = s->outcome.residual_rms * s->outcome.residual_rms;
    return n_independent * log(variance + 1e-300) + s->model.n_par * log(n_independent);
}

/* The cells of one group as a problem of their own. */
static dif_status extract_group(const dif_fit_state *all, int g, dif_fit_state *out, dif_error *err)
{
    memset(out, 0, sizeof *out);
    out->cell = dif_alloc((size_t)all->n_cell, sizeof *out->cell);
    if (!out->cell)
        return dif_fail(err, DIF_ERR_NOMEM, "%d cells", all->n_cell);
    for (int i = 0; i < all->n_cell; i++)
        if (all->cell[i].group == g) {
            out->cell[out->n_cell] = all->cell[i];
            out->cell[out->n_cell++].group = 0;
        }
    out->model.line = all->model.line;
    out->model.n_group = 1;
    out->model.group[0] = all->model.group[g];
    return DIF_OK;
}

/* The ridge to give up first: one that moved away, has no strength or fell onto another; -1 if all are sound. */
static int unsound(const dif_fit_state *s, const double *start)
{
    const double sigma = s->model.line->sigma_per_um;
    for (int k = s->model.n_ridge - 1; k >= 0; k--) {
        if (!(fabs(s->par[k] - start[k]) < 2.5 * sigma) || !(dif_fit_ridges_strength(s, k) > 0.0))
            return k;
        for (int j = 0; j < k; j++)
            if (fabs(s->par[k] - s->par[j]) < 1.5 * sigma)
                return k;
    }
    return -1;
}

static int weakest(const dif_fit_state *s)
{
    int k = 0;
    for (int i = 1; i < s->model.n_ridge; i++)
        if (dif_fit_ridges_strength(s, i) < dif_fit_ridges_strength(s, k))
            k = i;
    return k;
}

static void drop(dif_fit_model *m, double *centre, int k)
{
    for (int i = k; i + 1 < m->n_ridge; i++) {
        m->ridge[i] = m->ridge[i + 1];
        centre[i] = centre[i + 1];
    }
    m->n_ridge--;
}

/* Fits the group with free centres from the given ones; ridges that are not seen are dropped first. */
static dif_status solve_group(dif_fit_state *s, double *centre, dif_error *err)
{
    int lost = 0;
    while (!dif_fit_ridges_range(&s->model, s->n_cell, s->cell, centre, &lost))
        drop(&s->model, centre, lost);
    for (int k = 0; k < s->model.n_ridge; k++)
        s->model.ridge[k].f_per_um = centre[k];
    dif_fit_model_number(&s->model);
    memset(s->par, 0, sizeof s->par);
    memcpy(s->par, centre, (size_t)s->model.n_ridge * sizeof *centre);
    return dif_fit_model_solve(&s->model, s->n_cell, s->cell, DIF_FIT_PLAIN, s->par, &s->outcome, err);
}

/* Puts the group's candidates into a model, at most n_free. */
static void add_candidates(dif_fit_model *m, int n, const dif_fit_candidate *candidate, int n_free, double *centre)
{
    m->n_ridge = 0;
    for (int c = 0; c < n && m->n_ridge < n_free; c++) {
        const double f = candidate[c].f_per_um;
        if (f < m->group[0].f_low || f > m->group[0].f_high)
            continue;
        m->ridge[m->n_ridge] = (dif_fit_component){.n_coef = DIF_FIT_CHOOSE_COEF, .n_side = DIF_FIT_CHOOSE_COEF};
        centre[m->n_ridge++] = f;
    }
}

/* All candidates of one group together (ridges that interfere explain little one by one), then without the weakest as
 * long as the criterion falls. one and trial are two states of the group. */
static dif_status prune(dif_fit_state *one, dif_fit_state *trial, int n, const dif_fit_candidate *candidate, int n_free,
                        dif_error *err)
{
    double centre[DIF_FIT_RIDGE_MAX] = {0};
    bool first = true;
    add_candidates(&trial->model, n, candidate, n_free, centre);
    for (;;) {
        dif_status status = solve_group(trial, centre, err);
        if (status != DIF_OK)
            return status;
        int k = unsound(trial, centre);
        if (k < 0) {
            const double n_independent = fmax(trial->outcome.n_independent, first ? 0.0 : one->outcome.n_independent);
            if (first || dif_fit_ridges_criterion(trial, n_independent) <= dif_fit_ridges_criterion(one, n_independent))
                *one = *trial;
            else
                return DIF_OK;
            first = false;
            k = trial->model.n_ridge > 0 ? weakest(trial) : 0;
        }
        if (trial->model.n_ridge == 0)
            return DIF_OK;
        for (int i = 0; i < trial->model.n_ridge && unsound(trial, centre) < 0; i++)
            centre[i] = trial->par[i];
        drop(&trial->model, centre, k);
    }
}

dif_status dif_fit_ridges_choose(dif_fit_state *state, int n, const dif_fit_candidate *candidate, dif_error *err)
{
    dif_status status = DIF_OK;
    dif_fit_state *one = dif_alloc(2, sizeof *one);
    if (!one)
        return dif_fail(err, DIF_ERR_NOMEM, "fits of single stretches");
    for (int g = 0; g < state->model.n_group && status == DIF_OK; g++) {
        dif_release(one[0].cell);
        one[0].cell = NULL;
        status = extract_group(state, g, &one[0], err);
        if (status != DIF_OK)
            break;
        one[1] = one[0]; /* shares the cells, read only from here on */
        status = prune(&one[0], &one[1], n, candidate, DIF_FIT_RIDGE_MAX - state->model.n_ridge, err);
        for (int k = 0; k < one[0].model.n_ridge && status == DIF_OK; k++) {
            dif_fit_component *r = &state->model.ridge[state->model.n_ridge];
            *r = one[0].model.ridge[k];
            r->group = g;
            r->f_per_um = one[0].par[k];
            r->strength = dif_fit_ridges_strength(&one[0], k);
            state->par[state->model.n_ridge++] = r->f_per_um;
        }
    }
    dif_release(one[0].cell);
    dif_release(one);
    return status;
}
