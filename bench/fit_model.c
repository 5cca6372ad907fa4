#include "bench/fit_model.h"

#include <math.h>
#include <string.h>

#include "bench/fit_basis.h"
#include "core/units.h"

/* Number of terms beside the amplitude that ridge r has. */
static int n_side(const dif_fit_model *m, const dif_fit_component *r)
{
    return r->n_side > 0 ? (m->edge ? DIF_FIT_EDGE_TERMS : 0) + 2 * m->n_ghost + r->n_cross : 0;
}

/* Later ridges of the same group that are close enough to interfere. */
static void find_partners(dif_fit_model *m, int k)
{
    dif_fit_component *r = &m->ridge[k];
    r->n_cross = 0;
    for (int l = k + 1; l < m->n_ridge && r->n_cross < DIF_FIT_CROSS_MAX && !m->coherent; l++)
        if (m->ridge[l].group == r->group &&
            fabs(m->ridge[l].f_per_um - r->f_per_um) < DIF_FIT_CROSS_SIGMA * m->line->sigma_per_um)
            r->cross[r->n_cross++] = l;
}

void dif_fit_model_number(dif_fit_model *m)
{
    m->n_shared = m->common ? 1 : m->n_ridge;
    m->i_offset = m->offset_free ? m->n_shared++ : -1;
    m->i_width = m->width_free ? m->n_shared++ : -1;
    int at = m->n_shared, largest = 0;
    for (int g = 0; g < m->n_group; g++) {
        dif_fit_group *group = &m->group[g];
        group->size = 0;
        for (int k = 0; k < m->n_ridge; k++)
            if (m->ridge[k].group == g) {
                find_partners(m, k);
                m->ridge[k].at = group->size;
                group->size += m->ridge[k].n_coef + n_side(m, &m->ridge[k]) * m->ridge[k].n_side;
            }
        group->at = group->size;
        group->size += group->n_level + group->n_slope;
        group->start = at;
        at += group->size;
        largest = group->size > largest ? group->size : largest;
    }
    m->n_par = at;
    m->stride = m->n_shared + largest;
}

double dif_fit_model_centre(const dif_fit_model *m, const double *par, int k)
{
    return m->common ? m->ridge[k].order * par[0] : par[k];
}

double dif_fit_model_offset(const dif_fit_model *m, const double *par)
{
    return m->offset_free ? par[m->i_offset] : 0.0;
}

double dif_fit_model_width(const dif_fit_model *m, const double *par)
{
    return m->width_free ? par[m->i_width] : m->line->sigma_per_um;
}

double dif_fit_model_frequency(const dif_fit_cell *cell, double offset_rad, double *slope)
{
    const double s = sin(offset_rad), half = sin(0.5 * offset_rad), c1 = -2.0 * half * half;
    if (slope)
        *slope = cell->turn_c * (1.0 + c1) - cell->turn_s * s;
    return cell->f_per_um + cell->turn_s * c1 + cell->turn_c * s;
}

/* Sum of coefficients times basis; adds scale * basis to row (may be NULL). */
static double spline(int n, double low, double high, double x, const double *coef, double scale, double *row)
{
    double b[DIF_FIT_DEGREE_MAX + 1], sum = 0.0;
    int degree = 0;
    const int first = dif_fit_basis_at(n, low, high, x, b, &degree);
    for (int j = 0; j <= degree; j++) {
        sum += coef[first + j] * b[j];
        if (row)
            row[first + j] += scale * b[j];
    }
    return sum;
}

double dif_fit_model_amplitude(const dif_fit_model *m, const double *par, int k, double kz)
{
    const dif_fit_component *r = &m->ridge[k];
    return spline(r->n_coef, r->kz_low, r->kz_high, kz, par + m->group[r->group].start + r->at, 0.0, NULL);
}

/* Place of f in its group, -1 ... 1. */
static double place_in_group(const dif_fit_group *g, double f)
{
    const double half = 0.5 * (g->f_high - g->f_low);
    return half > 0.0 ? (f - g->f_low) / half - 1.0 : 0.0;
}

/* A place in the table as the model sees it. */
typedef struct place {
    double f, kz, width;
    double slope; /* df / d offset                    */
    double t;     /* -1 ... 1 over the group          */
    double centre[DIF_FIT_RIDGE_MAX];
} place;

/* A term beside the amplitude: its shape, derivatives by delta, by g at fixed delta, by the partner's delta. */
typedef struct side {
    double value, d_delta, d_g, d_other;
    int other; /* the partner, or -1 */
} side;

static void edge_sides(const dif_fit_model *m, double delta, const dif_fit_shape *shape, side *out)
{
    const double t = delta / m->line->sigma_per_um, dt = 1.0 / m->line->sigma_per_um;
    dif_fit_shape s = *shape;
    if (m->coherent) {
        const double omega = DIF_PI * m->line->extent_um;
        s.re = cos(omega * delta);
        s.im = sin(omega * delta);
        s.dre = -omega * s.im;
        s.dim = omega * s.re;
    }
    out[0] = (side){.value = s.re, .d_delta = s.dre, .other = -1};
    out[1] = (side){.value = s.im, .d_delta = s.dim, .other = -1};
    out[2] = (side){.value = t * s.re, .d_delta = t * s.dre + dt * s.re, .other = -1};
    out[3] = (side){.value = t * s.im, .d_delta = t * s.dim + dt * s.im, .other = -1};
}

static side ghost_side(const dif_fit_model *m, const double *par, double delta, int i_ghost, int sign)
{
    const int order = m->ghost_order[i_ghost];
    const double apart = m->ghost_f_per_um[i_ghost] - order * (m->common ? par[0] : m->ghost_g_per_um);
    const double there = delta - sign * apart; /* its derivative by g is sign order */
    if (m->coherent) {
        double slope = 0.0;
        const double value = dif_fit_line_amplitude(m->line, there, &slope);
        return (side){.value = value, .d_delta = slope, .d_g = sign * order * slope, .other = -1};
    }
    const dif_fit_pair_shape p = dif_fit_line_pair(m->line, delta, there, m->line->sigma_per_um);
    return (side){.value = p.s, .d_delta = p.ds_da + p.ds_db, .d_g = sign * order * p.ds_db, .other = -1};
}

static int sides_at(const dif_fit_model *m, const dif_fit_component *r, const double *par, const place *at,
                    double delta, const dif_fit_shape *shape, side out[DIF_FIT_SIDE_MAX])
{
    int n = 0;
    if (r->n_side == 0)
        return 0;
    if (m->edge) {
        edge_sides(m, delta, shape, out);
        n = DIF_FIT_EDGE_TERMS;
    }
    for (int i = 0; i < 2 * m->n_ghost; i++)
        out[n++] = ghost_side(m, par, delta, i / 2, i % 2 ? -1 : 1);
    for (int i = 0; i < r->n_cross; i++) {
        const dif_fit_pair_shape p = dif_fit_line_pair(m->line, delta, at->f - at->centre[r->cross[i]], at->width);
        out[n++] = (side){.value = p.s, .d_delta = p.ds_da, .d_other = p.ds_db, .other = r->cross[i]};
    }
    return n;
}

/* What multiplies C_k: the line, or its amplitude if amplitudes are summed. */
static double main_shape(const dif_fit_model *m, double delta, const dif_fit_shape *s, double *slope)
{
    if (m->coherent)
        return dif_fit_line_amplitude(m->line, delta, slope);
    *slope = s->dl;
    return s->l;
}

/* Derivatives of a value by each ridge's delta, by g at fixed deltas, and by the logarithm of the width. */
typedef struct slopes {
    double delta[DIF_FIT_RIDGE_MAX], g, log_width;
} slopes;

/* Ridge k's part of a row: returns the value, fills the ridge's own columns and adds to the slopes. */
static double ridge_row(const dif_fit_model *m, int k, const double *par, const place *at, double *row, slopes *d)
{
    side sides[DIF_FIT_SIDE_MAX];
    const dif_fit_component *r = &m->ridge[k];
    const double *coef = par + m->group[r->group].start + r->at;
    double *own = row + m->n_shared + r->at, slope = 0.0;
    const double delta = at->f - at->centre[k];
    const dif_fit_shape s = dif_fit_line_at(m->line, delta, at->width);
    const double shape = main_shape(m, delta, &s, &slope);
    const double c = spline(r->n_coef, r->kz_low, r->kz_high, at->kz, coef, shape, own);
    const int n = sides_at(m, r, par, at, delta, &s, sides);
    double value = c * shape, amplitude[DIF_FIT_SIDE_MAX];
    for (int i = 0; i < n; i++) {
        const int first = r->n_coef + i * r->n_side;
        amplitude[i] = spline(r->n_side, r->kz_low, r->kz_high, at->kz, coef + first, sides[i].value, own + first);
        value += amplitude[i] * sides[i].value;
    }
    const double outer = m->coherent ? 2.0 * value : 1.0;
    for (int i = 0; i < r->n_coef + n * r->n_side && m->coherent; i++)
        own[i] *= outer;
    d->delta[k] += outer * c * slope;
    d->log_width += outer * c * s.dl_dlog_width;
    for (int i = 0; i < n; i++) {
        d->delta[k] += outer * amplitude[i] * sides[i].d_delta;
        d->g += outer * amplitude[i] * sides[i].d_g;
        if (sides[i].other >= 0)
            d->delta[sides[i].other] += outer * amplitude[i] * sides[i].d_other;
    }
    return m->coherent ? value * value : value;
}

static place place_of(const dif_fit_model *m, const double *par, const dif_fit_cell *cell)
{
    place p = {.kz = cell->kz_rad_per_um, .width = dif_fit_model_width(m, par)};
    p.f = dif_fit_model_frequency(cell, dif_fit_model_offset(m, par), &p.slope);
    p.t = place_in_group(&m->group[cell->group], cell->f_per_um);
    for (int k = 0; k < m->n_ridge; k++)
        p.centre[k] = dif_fit_model_centre(m, par, k);
    return p;
}

double dif_fit_model_row(const dif_fit_model *m, const double *par, const dif_fit_cell *cell, double *row)
{
    const dif_fit_group *g = &m->group[cell->group];
    const double *level = par + g->start + g->at;
    const place at = place_of(m, par, cell);
    slopes d = {.g = 0.0};
    double value = 0.0;
    memset(row, 0, (size_t)m->stride * sizeof *row);
    for (int k = 0; k < m->n_ridge; k++)
        if (m->ridge[k].group == cell->group)
            value += ridge_row(m, k, par, &at, row, &d);
    for (int k = 0; k < m->n_ridge; k++) {
        row[m->common ? 0 : k] -= d.delta[k] * (m->common ? m->ridge[k].order : 1);
        if (m->offset_free)
            row[m->i_offset] += d.delta[k] * at.slope;
    }
    if (m->common)
        row[0] += d.g;
    if (m->width_free)
        row[m->i_width] += d.log_width / at.width;
    double *own = row + m->n_shared + g->at;
    if (g->n_level > 0)
        value += spline(g->n_level, g->kz_low, g->kz_high, at.kz, level, 1.0, own);
    if (g->n_slope > 0)
        value += at.t * spline(g->n_slope, g->kz_low, g->kz_high, at.kz, level + g->n_level, at.t, own + g->n_level);
    return value;
}

double dif_fit_model_value(const dif_fit_model *m, const double *par, const dif_fit_cell *cell)
{
    const dif_fit_group *g = &m->group[cell->group];
    const double *block = par + g->start, *level = block + g->at;
    const place at = place_of(m, par, cell);
    double value = 0.0;
    for (int k = 0; k < m->n_ridge; k++) {
        const dif_fit_component *r = &m->ridge[k];
        if (r->group != cell->group)
            continue;
        side sides[DIF_FIT_SIDE_MAX];
        const double delta = at.f - at.centre[k], *coef = block + r->at + r->n_coef;
        const dif_fit_shape s = dif_fit_line_at(m->line, delta, at.width);
        double slope = 0.0, sum = dif_fit_model_amplitude(m, par, k, at.kz) * main_shape(m, delta, &s, &slope);
        const int n = sides_at(m, r, par, &at, delta, &s, sides);
        for (int i = 0; i < n; i++)
            sum += sides[i].value * spline(r->n_side, r->kz_low, r->kz_high, at.kz, coef + i * r->n_side, 0.0, NULL);
        value += m->coherent ? sum * sum : sum;
    }
    if (g->n_level > 0)
        value += spline(g->n_level, g->kz_low, g->kz_high, at.kz, level, 0.0, NULL);
    if (g->n_slope > 0)
        value += at.t * spline(g->n_slope, g->kz_low, g->kz_high, at.kz, level + g->n_level, 0.0, NULL);
    return value;
}
