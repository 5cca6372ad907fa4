#include <math.h>
#include <string.h>

#include "bench/fit_ridges.h"
#include "core/alloc.h"

/* Numbers of coefficients that are tried for the amplitude splines. */
static const int coef_tried[] = {4, 6, 9, 13, 18};
enum { N_TRIED = sizeof coef_tried / sizeof coef_tried[0] };

/* Side terms are believed if they bring the residual below this share of what it was: leak and ghosts explain nearly
 * all that a clean line leaves, while speckle only gives way a little to any further freedom. They are not tried unless the line is clean: a leak is a
 * few per cent of an amplitude at most. */
static const double side_gain = 0.5;

/* Orders weaker than this share of the strongest tell the period little; they go without side terms. */
static const double weak_share = 0.03;
enum { N_SIDE_RIDGE = 3 }; /* and so do all but the strongest */

/* Where a fit starts: shared parameters, and the centres they mean. */
typedef struct start {
    double shared[DIF_FIT_SHARED_MAX], centre[DIF_FIT_RIDGE_MAX];
    double strength[DIF_FIT_RIDGE_MAX]; /* mean of C_k, where amplitudes are summed         */
    bool plain[DIF_FIT_RIDGE_MAX];      /* too weak to be worth side terms                  */
} start;

/* One attempt: all ridges with n_coef coefficients each for amplitude and side terms. */
static dif_status attempt(dif_fit_state *s, int n_coef, const start *from, dif_fit_mode mode, dif_error *err)
{
    dif_fit_model *m = &s->model;
    int lost = 0;
    for (int k = 0; k < m->n_ridge; k++) {
        m->ridge[k].f_per_um = from->centre[k];
        m->ridge[k].n_coef = n_coef;
        m->ridge[k].n_side = from->plain[k] ? 0 : n_coef;
    }
    if (!dif_fit_ridges_range(m, s->n_cell, s->cell, from->centre, &lost))
        return dif_fail(err, DIF_ERR_FIT,
                        "the ridge at %.6g per um is not seen on both sides at %d wavelengths or more",
                        from->centre[lost], DIF_FIT_LAMBDA_MIN);
    dif_fit_model_number(m);
    memset(s->par, 0, sizeof s->par);
    memcpy(s->par, from->shared, (size_t)m->n_shared * sizeof *from->shared);
    for (int k = 0; k < m->n_ridge && m->coherent; k++)
        for (int i = 0; i < m->ridge[k].n_coef; i++)
            s->par[m->group[m->ridge[k].group].start + m->ridge[k].at + i] = sqrt(fmax(from->strength[k], 0.0));
    return dif_fit_model_solve(m, s->n_cell, s->cell, mode, s->par, &s->outcome, err);
}

/* Raises the number of coefficients while the criterion falls; *best gets the best. */
static dif_status choose_coefs(dif_fit_state *s, int first, const start *from, dif_fit_state *best, int *n_coef,
                               dif_error *err)
{
    for (int i = first; i < N_TRIED; i++) {
        dif_status status = attempt(s, coef_tried[i], from, DIF_FIT_PLAIN, err);
        if (status != DIF_OK)
            return status;
        const double n_independent = s->outcome.n_independent;
        if (i > first && dif_fit_ridges_criterion(s, n_independent) >= dif_fit_ridges_criterion(best, n_independent))
            break;
        *best = *s;
        *n_coef = coef_tried[i];
    }
    return DIF_OK;
}

/* The ghosts that samples of the given pitch put around each order: the lowest n whose n/pitch, folded into the orders,
 * lies outside the line but close enough to matter. Amplitudes fall as 1/n, so only the first few count. Returns how
 * many there are; none is switched on. */
static int find_ghosts(dif_fit_model *m, double pitch_um, double g_per_um)
{
    const double sigma = m->line->sigma_per_um;
    int n_found = 0;
    if (!(pitch_um > 0.0) || m->line->n_wave == 0 || !m->common)
        return 0;
    for (int n = 1; n <= DIF_FIT_GHOST_N_MAX && n_found < DIF_FIT_GHOST_MAX; n++) {
        const double f = n / pitch_um;
        const int order = (int)lround(f / g_per_um);
        const double apart = fabs(f - order * g_per_um);
        if (!(apart > DIF_FIT_APART_MIN * sigma && apart < DIF_FIT_APART_MAX * sigma))
            continue;
        m->ghost_f_per_um[n_found] = f;
        m->ghost_order[n_found++] = order;
    }
    return n_found;
}

/* With a ghost the sum of squares is a narrow bent valley over g: walks along it in steps of the ghost's distance, all
 * else solved for, to start the solver at its lowest point. */
static dif_status walk_ghost(dif_fit_state *s, start *from, dif_error *err)
{
    const dif_fit_model *m = &s->model;
    const double sigma = m->line->sigma_per_um;
    const double middle = from->shared[0], reach = 0.04 * sigma;
    double best = INFINITY, found = middle;
    dif_status status = DIF_OK;
    for (double t = -DIF_FIT_APART_MAX; t <= DIF_FIT_APART_MAX && status == DIF_OK; t += 1.0) {
        const double g = (m->ghost_f_per_um[0] - t * sigma) / m->ghost_order[0];
        if (fabs(g - middle) > reach || fabs(t) < DIF_FIT_APART_MIN)
            continue;
        from->shared[0] = g;
        status = attempt(s, DIF_FIT_WALK_COEF, from, DIF_FIT_LINEAR, err);
        if (status == DIF_OK && s->outcome.residual_rms < best) {
            best = s->outcome.residual_rms;
            found = g;
        }
    }
    from->shared[0] = found;
    return status;
}

static double data_rms(const dif_fit_state *s)
{
    double square = 0.0;
    for (int i = 0; i < s->n_cell; i++)
        square += s->cell[i].y * s->cell[i].y;
    return sqrt(square / s->n_cell);
}

/* Is ridge k one of the strongest few? */
static bool worth_sides(int n, const double *strength, int k)
{
    int n_stronger = 0;
    double strongest = 0.0;
    for (int i = 0; i < n; i++) {
        n_stronger += strength[i] > strength[k];
        strongest = fmax(strongest, strength[i]);
    }
    return n_stronger < N_SIDE_RIDGE && strength[k] >= weak_share * strongest;
}

/* Residual rms over the groups of the ridges that have side terms: what they are judged by. */
static double side_rms(const dif_fit_state *s, const start *from)
{
    double square = 0.0;
    int n = 0;
    for (int i = 0; i < s->n_cell; i++)
        for (int k = 0; k < s->model.n_ridge; k++)
            if (s->model.ridge[k].group == s->cell[i].group && !from->plain[k]) {
                const double r = dif_fit_model_value(&s->model, s->par, &s->cell[i]) - s->cell[i].y;
                square += r * r;
                n++;
                break;
            }
    return sqrt(square / (n > 0 ? n : 1));
}

/* Adds the leak through the edges, then one ghost after the other, as long as each explains most of what is left. *best
 * is the fit so far; state->before gets the centres of the last but one. */
static dif_status add_sides(dif_fit_state *s, double pitch_um, start *from, dif_fit_state *best, dif_fit_state *trial,
                            int *n_coef, dif_error *err)
{
    int n_trial = 0, n_ghost = 0;
    dif_status status = DIF_OK;
    if (!s->model.line->has_edge || !(best->outcome.residual_rms < DIF_FIT_CLEAN_SHARE * data_rms(s)))
        return DIF_OK;
    s->model.edge = true;
    s->model.coherent = s->model.line->n_wave == 1;
    for (int k = 0; k < s->model.n_ridge; k++)
        from->strength[k] = dif_fit_ridges_strength(best, k);
    for (int k = 0; k < s->model.n_ridge; k++)
        from->plain[k] = s->model.common && !worth_sides(s->model.n_ridge, from->strength, k);
    for (int step = 0; step <= n_ghost; step++) {
        s->model.n_ghost = step;
        if (step == 1)
            status = walk_ghost(s, from, err);
        if (status == DIF_OK)
            status = choose_coefs(s, step > 0 ? 1 : 0, from, trial, &n_trial, err);
        if (status != DIF_OK || !(side_rms(trial, from) < side_gain * side_rms(best, from)))
            break;
        for (int k = 0; k < s->model.n_ridge; k++) {
            s->before[k] = dif_fit_model_centre(&best->model, best->par, k);
            s->plain[k] = step == 0 ? s->before[k] : s->plain[k];
        }
        s->has_before = true;
        *best = *trial;
        *n_coef = n_trial;
        memcpy(from->shared, best->par, (size_t)best->model.n_shared * sizeof *from->shared);
        if (step == 0)
            n_ghost = find_ghosts(&s->model, pitch_um, best->par[0]);
    }
    return status;
}

void dif_fit_ridges_drop(dif_fit_state *s, int k)
{
    dif_fit_model *m = &s->model;
    double shared[DIF_FIT_SHARED_MAX];
    memcpy(shared, s->par, sizeof shared);
    for (int i = k; i + 1 < m->n_ridge; i++)
        m->ridge[i] = m->ridge[i + 1];
    m->n_ridge--;
    m->edge = m->coherent = s->has_before = false;
    m->n_ghost = 0;
    memmove(shared + k, shared + k + 1, (size_t)(DIF_FIT_SHARED_MAX - k - 1) * sizeof *shared);
    memcpy(s->par, shared, sizeof shared);
    dif_fit_model_number(m);
}

dif_status dif_fit_ridges_solve(dif_fit_state *s, double pitch_um, dif_error *err)
{
    dif_fit_state *work = dif_alloc(2, sizeof *work);
    start *from = dif_alloc(1, sizeof *from);
    int n_coef = 0;
    dif_status status = DIF_OK;
    if (!work || !from) {
        status = dif_fail(err, DIF_ERR_NOMEM, "trial fits");
        goto cleanup;
    }
    dif_fit_model_number(&s->model);
    memcpy(from->shared, s->par, sizeof from->shared);
    for (int k = 0; k < s->model.n_ridge; k++)
        from->centre[k] = dif_fit_model_centre(&s->model, s->par, k);
    status = choose_coefs(s, 0, from, &work[0], &n_coef, err);
    if (status == DIF_OK)
        status = add_sides(s, pitch_um, from, &work[0], &work[1], &n_coef, err);
    if (status == DIF_OK) {
        s->model = work[0].model;
        memcpy(from->shared, work[0].par, (size_t)s->model.n_shared * sizeof *from->shared);
        status = attempt(s, n_coef, from, DIF_FIT_ROBUST, err);
    }
cleanup:
    dif_release(from);
    dif_release(work);
    return status;
}

/* First and last wavelength index that a group's cells have, and how many there are. */
static int lambda_span(const dif_fit_state *s, int g, int *first, int *last)
{
    int n = 0;
    *first = -1;
    *last = -1;
    for (int i = 0; i < s->n_cell; i++)
        if (s->cell[i].group == g) {
            if (*first < 0)
                *first = s->cell[i].i_lambda;
            n += s->cell[i].i_lambda != *last;
            *last = s->cell[i].i_lambda;
        }
    return n;
}

/* The cells of one group in one band of wavelengths, with the offset applied. */
static void extract_band(const dif_fit_state *all, int g, int low, int high, dif_fit_state *part)
{
    const double offset = dif_fit_model_offset(&all->model, all->par);
    part->n_cell = 0;
    for (int i = 0; i < all->n_cell; i++) {
        const dif_fit_cell *c = &all->cell[i];
        if (c->group != g || c->i_lambda < low || c->i_lambda >= high)
            continue;
        dif_fit_cell *to = &part->cell[part->n_cell++];
        *to = *c;
        to->group = 0;
        to->f_per_um = dif_fit_model_frequency(c, offset, NULL);
    }
}

/* Takes one ridge out of a model. */
static void drop_ridge(dif_fit_model *m, int k, int *origin, double *centre)
{
    for (int i = k; i + 1 < m->n_ridge; i++) {
        m->ridge[i] = m->ridge[i + 1];
        origin[i] = origin[i + 1];
        centre[i] = centre[i + 1];
    }
    m->n_ridge--;
}

/* The ridges of one group as a model with free centres and fewer coefficients, for a band of the wavelengths. */
static void part_model(const dif_fit_state *all, int g, int n_band, dif_fit_model *m, int *origin, double *centre)
{
    m->n_group = 1;
    m->group[0] = all->model.group[g];
    m->group[0].n_level = 2;
    m->group[0].n_slope = 1;
    m->n_ridge = 0;
    m->edge = all->model.edge;
    m->coherent = all->model.coherent;
    m->n_ghost = all->model.n_ghost;
    memcpy(m->ghost_f_per_um, all->model.ghost_f_per_um, sizeof m->ghost_f_per_um);
    memcpy(m->ghost_order, all->model.ghost_order, sizeof m->ghost_order);
    m->ghost_g_per_um = all->par[0];
    for (int k = 0; k < all->model.n_ridge; k++) {
        if (all->model.ridge[k].group != g)
            continue;
        dif_fit_component *r = &m->ridge[m->n_ridge];
        *r = all->model.ridge[k];
        r->group = 0;
        r->f_per_um = dif_fit_model_centre(&all->model, all->par, k);
        r->n_coef = 2 + (r->n_coef + n_band - 1) / n_band;
        r->n_side = r->n_side > 0 ? r->n_coef : 0;
        origin[m->n_ridge] = k;
        centre[m->n_ridge++] = dif_fit_model_centre(&all->model, all->par, k);
    }
}

/* Fits one band of one group and appends what it gives. */
static dif_status fit_band(const dif_fit_state *all, int g, int n_band, dif_fit_state *part, dif_fit_part *out,
                           int *n_out, dif_error *err)
{
    int origin[DIF_FIT_RIDGE_MAX], lost = 0;
    double centre[DIF_FIT_RIDGE_MAX];
    dif_fit_model *m = &part->model;
    part_model(all, g, n_band, m, origin, centre);
    while (m->n_ridge > 0 && !dif_fit_ridges_range(m, part->n_cell, part->cell, centre, &lost))
        drop_ridge(m, lost, origin, centre);
    if (m->n_ridge == 0)
        return DIF_OK;
    dif_fit_model_number(m);
    if (part->n_cell < 3 * m->n_par)
        return DIF_OK;
    memset(part->par, 0, sizeof part->par);
    memcpy(part->par, centre, (size_t)m->n_ridge * sizeof *centre);
    for (int k = 0; k < m->n_ridge && m->coherent; k++)
        for (int i = 0; i < m->ridge[k].n_coef; i++)
            part->par[m->group[0].start + m->ridge[k].at + i] =
                sqrt(fmax(dif_fit_ridges_strength(all, origin[k]), 0.0));
    dif_status status =
        dif_fit_model_solve(m, part->n_cell, part->cell, DIF_FIT_ROBUST, part->par, &part->outcome, err);
    if (status != DIF_OK || !part->outcome.converged || !part->outcome.has_covariance)
        return status;
    for (int k = 0; k < m->n_ridge; k++) {
        const double variance = part->outcome.covariance[k * (m->n_shared + 1)];
        if (fabs(part->par[k] - centre[k]) < 2.0 * m->line->sigma_per_um && variance > 0.0)
            out[(*n_out)++] =
                (dif_fit_part){.ridge = origin[k], .f_per_um = part->par[k], .f_sd_per_um = sqrt(variance)};
    }
    return DIF_OK;
}

dif_status dif_fit_ridges_parts(const dif_fit_state *state, int n_band, dif_fit_part *part, int *n_part, dif_error *err)
{
    *n_part = 0;
    dif_status status = DIF_OK;
    dif_fit_lineshape line = *state->model.line;
    if (state->model.width_free)
        line = dif_fit_line_gauss(dif_fit_model_width(&state->model, state->par));
    dif_fit_state *one = dif_alloc(1, sizeof *one);
    dif_fit_cell *cell = dif_alloc((size_t)state->n_cell, sizeof *cell);
    if (!one || !cell) {
        status = dif_fail(err, DIF_ERR_NOMEM, "fits of parts");
        goto cleanup;
    }
    one->model.line = &line;
    one->cell = cell;
    for (int g = 0; g < state->model.n_group; g++) {
        int first = 0, last = 0;
        const int n_lambda = lambda_span(state, g, &first, &last);
        /* fewer bands rather than bands that are too short */
        const int most = n_lambda / (DIF_FIT_LAMBDA_MIN + 2), n = n_band < most ? n_band : most;
        const double width = (last - first + 1) / (double)n;
        for (int b = 0; b < n && status == DIF_OK; b++) {
            extract_band(state, g, first + (int)lround(b * width), first + (int)lround((b + 1) * width), one);
            status = fit_band(state, g, n, one, part, n_part, err);
        }
    }
cleanup:
    dif_release(cell);
    dif_release(one);
    return status;
}
