#include "bench/fit_model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/fit_basis.h"
#include "bench/fit_ceres.h"
#include "core/alloc.h"
#include "core/units.h"

int fit_model_n_side(const fit_model *m)
{
    return (m->edge ? FIT_EDGE_TERMS : 0) + 2 * m->n_ghost;
}

void fit_model_number(fit_model *m)
{
    m->n_shared = m->common ? 1 : m->n_ridge;
    m->i_offset = m->offset_free ? m->n_shared++ : -1;
    m->i_width = m->width_free ? m->n_shared++ : -1;
    int at = m->n_shared, largest = 0;
    for (int g = 0; g < m->n_group; g++) {
        fit_group *group = &m->group[g];
        group->size = 0;
        for (int k = 0; k < m->n_ridge; k++)
            if (m->ridge[k].group == g) {
                m->ridge[k].at = group->size;
                group->size += m->ridge[k].n_coef + fit_model_n_side(m) * m->ridge[k].n_side;
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

double fit_model_centre(const fit_model *m, const double *par, int k)
{
    return m->common ? m->ridge[k].order * par[0] : par[k];
}

double fit_model_offset(const fit_model *m, const double *par)
{
    return m->offset_free ? par[m->i_offset] : 0.0;
}

double fit_model_width(const fit_model *m, const double *par)
{
    return m->width_free ? par[m->i_width] : m->line->sigma_per_um;
}

double fit_model_frequency(const fit_cell *cell, double offset_rad, double *slope)
{
    const double s = sin(offset_rad), half = sin(0.5 * offset_rad), c1 = -2.0 * half * half;
    if (slope)
        *slope = cell->turn_c * (1.0 + c1) - cell->turn_s * s;
    return cell->f_per_um + cell->turn_s * c1 + cell->turn_c * s;
}

/* Sum of coefficients times basis; adds scale * basis to row (may be NULL). */
static double spline(int n, double low, double high, double x, const double *coef, double scale, double *row)
{
    double b[FIT_DEGREE_MAX + 1], sum = 0.0;
    int degree = 0;
    const int first = fit_basis_at(n, low, high, x, b, &degree);
    for (int j = 0; j <= degree; j++) {
        sum += coef[first + j] * b[j];
        if (row)
            row[first + j] += scale * b[j];
    }
    return sum;
}

double fit_model_amplitude(const fit_model *m, const double *par, int k, double kz)
{
    const fit_ridge *r = &m->ridge[k];
    return spline(r->n_coef, r->kz_low, r->kz_high, kz, par + m->group[r->group].start + r->at, 0.0, NULL);
}

/* Place of f in its group, -1 ... 1. */
static double place_in_group(const fit_group *g, double f)
{
    const double half = 0.5 * (g->f_high - g->f_low);
    return half > 0.0 ? (f - g->f_low) / half - 1.0 : 0.0;
}

/* The side terms of a line at delta, in the order of their coefficients. */
typedef struct side {
    double value, d_delta, d_g;
} side;

static void sides_at(const fit_model *m, const double *par, double delta, const fit_shape *shape, side *out)
{
    if (m->edge) {
        const double t = delta / m->line->sigma_per_um, dt = 1.0 / m->line->sigma_per_um;
        fit_shape s = *shape;
        if (m->coherent) {
            const double omega = DIF_PI * m->line->extent_um;
            s.re = cos(omega * delta);
            s.im = sin(omega * delta);
            s.dre = -omega * s.im;
            s.dim = omega * s.re;
        }
        *out++ = (side){.value = s.re, .d_delta = s.dre};
        *out++ = (side){.value = s.im, .d_delta = s.dim};
        *out++ = (side){.value = t * s.re, .d_delta = t * s.dre + dt * s.re};
        *out++ = (side){.value = t * s.im, .d_delta = t * s.dim + dt * s.im};
    }
    for (int i = 0; i < 2 * m->n_ghost; i++) {
        const int order = m->ghost_order[i / 2], sign = i % 2 ? -1 : 1;
        const double apart = m->ghost_f_per_um[i / 2] - order * (m->common ? par[0] : m->ghost_g_per_um);
        fit_pair_shape p = {0};
        if (m->coherent) {
            p.s = fit_line_amplitude(m->line, delta - sign * apart, &p.ds_ddelta);
            p.ds_dapart = -p.ds_ddelta;
        } else
            p = fit_line_pair(m->line, delta, sign * apart);
        *out++ = (side){.value = p.s, .d_delta = p.ds_ddelta, .d_g = -sign * order * p.ds_dapart};
    }
}

/* What multiplies C_k: the line, or its amplitude if amplitudes are summed. */
static double main_shape(const fit_model *m, double delta, const fit_shape *s, double *slope)
{
    if (m->coherent)
        return fit_line_amplitude(m->line, delta, slope);
    *slope = s->dl;
    return s->l;
}

/* One ridge's part of a row: returns the value, fills the ridge's own columns, and the derivatives by delta, by g at
 * fixed delta, and by the logarithm of the width. */
static double ridge_row(const fit_model *m, const fit_ridge *r, const double *par, double delta, double kz, double *row,
                        double *d_delta, double *d_log_width)
{
    side sides[FIT_SIDE_MAX];
    const double *coef = par + m->group[r->group].start + r->at;
    double *own = row + m->n_shared + r->at, slope = 0.0, d_g = 0.0;
    const fit_shape s = fit_line_at(m->line, delta, fit_model_width(m, par));
    const double shape = main_shape(m, delta, &s, &slope);
    const double c = spline(r->n_coef, r->kz_low, r->kz_high, kz, coef, shape, own);
    double value = c * shape;
    *d_delta = c * slope;
    *d_log_width = c * s.dl_dlog_width;
    sides_at(m, par, delta, &s, sides);
    for (int i = 0; i < fit_model_n_side(m); i++) {
        const int at = r->n_coef + i * r->n_side;
        const double a = spline(r->n_side, r->kz_low, r->kz_high, kz, coef + at, sides[i].value, own + at);
        value += a * sides[i].value;
        *d_delta += a * sides[i].d_delta;
        d_g += a * sides[i].d_g;
    }
    const double outer = m->coherent ? 2.0 * value : 1.0;
    if (m->coherent)
        for (int i = 0; i < r->n_coef + fit_model_n_side(m) * r->n_side; i++)
            own[i] *= outer;
    *d_delta *= outer;
    if (m->common)
        row[0] += outer * d_g;
    return m->coherent ? value * value : value;
}

/* Model value and Jacobian row of one cell. */
static double cell_row(const fit_model *m, const double *par, const fit_cell *cell, double *row)
{
    const fit_group *g = &m->group[cell->group];
    const double *block = par + g->start;
    double *own = row + m->n_shared;
    double slope = 0.0, value = 0.0;
    const double f = fit_model_frequency(cell, fit_model_offset(m, par), &slope);
    const double kz = cell->kz_rad_per_um, place = place_in_group(g, cell->f_per_um);
    memset(row, 0, (size_t)m->stride * sizeof *row);
    for (int k = 0; k < m->n_ridge; k++) {
        const fit_ridge *r = &m->ridge[k];
        if (r->group != cell->group)
            continue;
        double d_delta = 0.0, d_log_width = 0.0;
        value += ridge_row(m, r, par, f - fit_model_centre(m, par, k), kz, row, &d_delta, &d_log_width);
        row[m->common ? 0 : k] -= d_delta * (m->common ? r->order : 1);
        if (m->offset_free)
            row[m->i_offset] += d_delta * slope;
        if (m->width_free)
            row[m->i_width] += d_log_width / fit_model_width(m, par);
    }
    if (g->n_level > 0)
        value += spline(g->n_level, g->kz_low, g->kz_high, kz, block + g->at, 1.0, own + g->at);
    if (g->n_slope > 0)
        value += place * spline(g->n_slope, g->kz_low, g->kz_high, kz, block + g->at + g->n_level, place,
                                own + g->at + g->n_level);
    return value;
}

double fit_model_value(const fit_model *m, const double *par, const fit_cell *cell)
{
    const fit_group *g = &m->group[cell->group];
    const double *block = par + g->start;
    const double f = fit_model_frequency(cell, fit_model_offset(m, par), NULL);
    const double kz = cell->kz_rad_per_um;
    double value = 0.0;
    for (int k = 0; k < m->n_ridge; k++) {
        const fit_ridge *r = &m->ridge[k];
        if (r->group != cell->group)
            continue;
        side sides[FIT_SIDE_MAX];
        const double delta = f - fit_model_centre(m, par, k);
        const fit_shape s = fit_line_at(m->line, delta, fit_model_width(m, par));
        double slope = 0.0, sum = fit_model_amplitude(m, par, k, kz) * main_shape(m, delta, &s, &slope);
        sides_at(m, par, delta, &s, sides);
        for (int i = 0; i < fit_model_n_side(m); i++)
            sum += sides[i].value *
                   spline(r->n_side, r->kz_low, r->kz_high, kz, block + r->at + r->n_coef + i * r->n_side, 0.0, NULL);
        value += m->coherent ? sum * sum : sum;
    }
    const double *level = block + g->at;
    if (g->n_level > 0)
        value += spline(g->n_level, g->kz_low, g->kz_high, kz, level, 0.0, NULL);
    if (g->n_slope > 0)
        value += place_in_group(g, cell->f_per_um) *
                 spline(g->n_slope, g->kz_low, g->kz_high, kz, level + g->n_level, 0.0, NULL);
    return value;
}

/* What the solver's callback looks at. */
typedef struct job {
    const fit_model *model;
    const fit_cell *cell;
    int n;
    double *scratch; /* one row */
} job;

static dif_status eval(void *self, const double *par, double *residual, double *jacobian)
{
    const job *j = self;
    for (int i = 0; i < j->n; i++) {
        double *row = jacobian ? jacobian + (size_t)i * (size_t)j->model->stride : j->scratch;
        residual[i] = cell_row(j->model, par, &j->cell[i], row) - j->cell[i].y;
    }
    return DIF_OK;
}

/* Correlation of residuals that are neighbours in angle: consecutive cells of one wavelength and group. */
static double angle_correlation(int n, const fit_cell *c, const double *r)
{
    double product = 0.0, square = 0.0;
    for (int i = 0; i + 1 < n; i++)
        if (c[i].i_lambda == c[i + 1].i_lambda && c[i].group == c[i + 1].group) {
            product += r[i] * r[i + 1];
            square += 0.5 * (r[i] * r[i] + r[i + 1] * r[i + 1]);
        }
    return square > 0.0 ? product / square : 0.0;
}

/* Correlation of residuals at the same frequency in neighbouring wavelengths. */
static double wavelength_correlation(int n, const fit_cell *c, const double *r)
{
    double product = 0.0, square = 0.0;
    int begin = 0, next = 0;
    while (begin < n) {
        for (next = begin; next < n && c[next].i_lambda == c[begin].i_lambda; next++)
            ;
        int j = next;
        for (int i = begin; i < next && j < n; i++) {
            const int row = c[next].i_lambda;
            while (j + 1 < n && c[j + 1].i_lambda == row &&
                   fabs(c[j + 1].f_per_um - c[i].f_per_um) <= fabs(c[j].f_per_um - c[i].f_per_um))
                j++;
            if (c[j].group != c[i].group)
                continue;
            product += r[i] * r[j];
            square += 0.5 * (r[i] * r[i] + r[j] * r[j]);
        }
        begin = next;
    }
    return square > 0.0 ? product / square : 0.0;
}

/* Cells that neighbouring ones tell nothing new about count less: n (1 - rho)/(1 + rho) for each axis, as for a
 * first-order autoregressive series. */
static double independent_cells(int n, const fit_cell *cells, const double *residual)
{
    const double a = fmin(fmax(angle_correlation(n, cells, residual), 0.0), 0.999);
    const double b = fmin(fmax(wavelength_correlation(n, cells, residual), 0.0), 0.999);
    return n * (1.0 - a) / (1.0 + a) * (1.0 - b) / (1.0 + b);
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Robust deviation (1.4826 MAD about 0) of the residuals on the lines; far from a line residuals are small because the
 * signal is, and would make every core an outlier. */
static double core_deviation(const fit_model *m, const double *par, int n, const fit_cell *cells,
                             const double *residual, double *scratch)
{
    int n_core = 0;
    const double offset = fit_model_offset(m, par), width = fit_model_width(m, par);
    for (int i = 0; i < n; i++) {
        const double f = fit_model_frequency(&cells[i], offset, NULL);
        for (int k = 0; k < m->n_ridge; k++)
            if (m->ridge[k].group == cells[i].group && fabs(f - fit_model_centre(m, par, k)) < 1.5 * width) {
                scratch[n_core++] = fabs(residual[i]);
                break;
            }
    }
    if (n_core == 0)
        return 0.0;
    qsort(scratch, (size_t)n_core, sizeof *scratch, by_value);
    return 1.4826 * scratch[n_core / 2];
}

/* The solver's sum computed here, from the path without Jacobian; fills residual[n] and the rms. */
static double recompute(const fit_model *m, const double *par, int n, const fit_cell *cells, double loss_scale,
                        double *residual, double *rms)
{
    double cost = 0.0, square = 0.0;
    for (int i = 0; i < n; i++) {
        const double r = fit_model_value(m, par, &cells[i]) - cells[i].y, s = r * r;
        residual[i] = r;
        square += s;
        if (loss_scale > 0.0 && fabs(r) > loss_scale)
            cost += loss_scale * fabs(r) - 0.5 * loss_scale * loss_scale;
        else
            cost += 0.5 * s;
    }
    *rms = sqrt(square / n);
    return cost;
}

/* BIC with the number of independent cells, and the covariance scaled by the residuals' variance and correlation. A
 * smooth misfit has hardly any independent cells: for the covariance it may count as a single one, which is the worst
 * case, a misfit shaped like a shift; the criterion needs more of them than parameters to mean anything. */
static void judge(const fit_model *m, int n, const fit_cell *cells, const double *residual, fit_outcome *out)
{
    const double independent = fmin(fmax(independent_cells(n, cells, residual), 1.0), n);
    const double variance = out->residual_rms * out->residual_rms;
    out->n_independent = fmin(fmax(independent, 3.0 * m->n_par), n);
    out->criterion = out->n_independent * log(variance + 1e-300) + m->n_par * log(out->n_independent);
    const double scale = variance * n / (n > m->n_par ? n - m->n_par : 1) * n / independent;
    for (int i = 0; i < m->n_shared * m->n_shared; i++)
        out->covariance[i] *= scale;
}

/* One round of the solver, held against the residuals computed here. */
static dif_status solve_round(const dif_ls *ls, const job *j, double *residual, fit_outcome *out, dif_error *err)
{
    dif_ls_report report = {0};
    dif_status status = dif_ls_solve(ls, out->covariance, &report, err);
    if (status != DIF_OK)
        return status;
    const double cost = recompute(j->model, ls->par, j->n, j->cell, ls->loss_scale, residual, &out->residual_rms);
    /* two sums of n rounded squares; a wrong model path differs by far more */
    if (!(fabs(cost - report.cost) <= 1e-6 * cost + 1e-20 * j->n))
        return dif_fail(err, DIF_ERR_FIT, "residuals recomputed outside the solver give %g, it claims %g", cost,
                        report.cost);
    out->cost = cost;
    out->n_iteration += report.n_iteration;
    out->converged = report.converged;
    out->has_covariance = report.has_covariance;
    memcpy(out->text, report.text, sizeof out->text);
    return DIF_OK;
}

/* The rounds of a mode: all that is linear first, then everything, then everything with Huber's loss. */
static dif_status solve_rounds(const job *j, const int *size, const int *row_block, fit_mode mode, double *par,
                               double *residual, fit_outcome *out, dif_error *err)
{
    const fit_model *m = j->model;
    job mine = *j;
    dif_ls ls = {.n_row = j->n, .n_shared = m->n_shared, .n_block = m->n_group, .size = size, .row_block = row_block};
    ls.par = par;
    ls.stride = m->stride;
    ls.n_iteration_max = 60;
    ls.eval = eval;
    ls.self = &mine;
    for (fit_mode round = FIT_LINEAR; round <= mode; round++) {
        ls.hold_shared = round == FIT_LINEAR;
        ls.linear = round == FIT_LINEAR && !m->coherent;
        ls.want_covariance = round == FIT_ROBUST && m->n_shared > 0;
        if (round == FIT_ROBUST)
            ls.loss_scale = 3.0 * core_deviation(m, par, j->n, j->cell, residual, residual + j->n);
        dif_status status = solve_round(&ls, j, residual, out, err);
        if (status != DIF_OK || m->n_shared == 0)
            return status;
    }
    return DIF_OK;
}

dif_status fit_model_solve(const fit_model *model, int n, const fit_cell *cells, fit_mode mode, double *par,
                           fit_outcome *out, dif_error *err)
{
    *out = (fit_outcome){0};
    int size[DIF_FIT_RIDGE_MAX];
    for (int g = 0; g < model->n_group; g++)
        size[g] = model->group[g].size;
    double *residual = dif_alloc(2 * (size_t)n + (size_t)model->stride, sizeof *residual); /* and scratch */
    int *row_block = dif_alloc((size_t)n, sizeof *row_block);
    dif_status status = DIF_OK;
    if (!residual || !row_block) {
        status = dif_fail(err, DIF_ERR_NOMEM, "fit of %d cells", n);
        goto cleanup;
    }
    for (int i = 0; i < n; i++)
        row_block[i] = cells[i].group;
    const job j = {.model = model, .cell = cells, .n = n, .scratch = residual + 2 * (size_t)n};
    status = solve_rounds(&j, size, row_block, mode, par, residual, out, err);
    if (status == DIF_OK)
        judge(model, n, cells, residual, out);
cleanup:
    dif_release(row_block);
    dif_release(residual);
    return status;
}
