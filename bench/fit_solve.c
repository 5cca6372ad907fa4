#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/fit_ceres.h"
#include "bench/fit_model.h"
#include "core/alloc.h"
#include "core/units.h"

/* What the solver's callback looks at. */
typedef struct job {
    const dif_fit_model *model;
    const dif_fit_cell *cell;
    int n;
    double *scratch; /* one row */
} job;

static dif_status eval(void *self, const double *par, double *residual, double *jacobian)
{
    const job *j = self;
    for (int i = 0; i < j->n; i++) {
        double *row = jacobian ? jacobian + (size_t)i * (size_t)j->model->stride : j->scratch;
        residual[i] = dif_fit_model_row(j->model, par, &j->cell[i], row) - j->cell[i].y;
    }
    return DIF_OK;
}

/* Correlation of residuals that are neighbours in angle: consecutive cells of one wavelength and group. */
static double angle_correlation(int n, const dif_fit_cell *c, const double *r)
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
static double wavelength_correlation(int n, const dif_fit_cell *c, const double *r)
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

/* Cells that count, if each is as good as copied to its neighbours: lengths of the correlation from that of next
 * neighbours, along angle and wavelength. Smooth misfits have a Gaussian correlation, the integral of which is
 * sqrt(pi / -ln rho). The first-order autoregressive (1 + rho)/(1 - rho) is several times longer for them. */
static double independent_cells(int n, const dif_fit_cell *cells, const double *residual, bool cautious)
{
    const double next[2] = {angle_correlation(n, cells, residual), wavelength_correlation(n, cells, residual)};
    double count = n;
    for (int i = 0; i < 2; i++) {
        const double rho = fmin(fmax(next[i], 0.0), 0.9999);
        const double length = cautious ? (1.0 + rho) / (1.0 - rho) : sqrt(DIF_PI / -log(rho));
        count /= rho > 0.0 ? fmax(1.0, length) : 1.0;
    }
    return count;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Robust deviation (1.4826 MAD about 0) of the residuals on the lines; far from a line residuals are small because the
 * signal is, and would make every core an outlier. */
static double core_deviation(const dif_fit_model *m, const double *par, int n, const dif_fit_cell *cells,
                             const double *residual, double *scratch)
{
    int n_core = 0;
    const double offset = dif_fit_model_offset(m, par), width = dif_fit_model_width(m, par);
    for (int i = 0; i < n; i++) {
        const double f = dif_fit_model_frequency(&cells[i], offset, NULL);
        for (int k = 0; k < m->n_ridge; k++)
            if (m->ridge[k].group == cells[i].group && fabs(f - dif_fit_model_centre(m, par, k)) < 1.5 * width) {
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
static double recompute(const dif_fit_model *m, const double *par, int n, const dif_fit_cell *cells, double loss_scale,
                        double *residual, double *rms)
{
    double cost = 0.0, square = 0.0;
    for (int i = 0; i < n; i++) {
        const double r = dif_fit_model_value(m, par, &cells[i]) - cells[i].y, s = r * r;
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
 * smooth misfit has hardly any independent cells. For the covariance of a clean line they are counted cautiously, down to
 * a single one, a misfit shaped like a shift; speckle is no such conspiracy. The criterion needs more of them than
 * parameters to mean anything. */
static void judge(const dif_fit_model *m, int n, const dif_fit_cell *cells, const double *residual,
                  dif_fit_outcome *out)
{
    const double variance = out->residual_rms * out->residual_rms;
    const double counted = independent_cells(n, cells, residual, false);
    out->independent_share = counted / n;
    out->n_independent = fmin(fmax(counted, 3.0 * m->n_par), n);
    out->criterion = out->n_independent * log(variance + 1e-300) + m->n_par * log(out->n_independent);
    double square = 0.0;
    for (int i = 0; i < n; i++)
        square += cells[i].y * cells[i].y;
    const bool clean = variance * n < DIF_FIT_CLEAN_SHARE * DIF_FIT_CLEAN_SHARE * square;
    const double independent = fmin(fmax(independent_cells(n, cells, residual, clean), 1.0), n);
    const double scale = variance * n / (n > m->n_par ? n - m->n_par : 1) * n / independent;
    for (int i = 0; i < m->n_shared * m->n_shared; i++)
        out->covariance[i] *= scale;
}

/* One round of the solver, held against the residuals computed here. */
static dif_status solve_round(const dif_ls *ls, const job *j, double *residual, dif_fit_outcome *out, dif_error *err)
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

/* Trials need not be finished to be compared. */
static const int n_iteration_max[] = {[DIF_FIT_LINEAR] = 15, [DIF_FIT_PLAIN] = 40, [DIF_FIT_ROBUST] = 150};

/* The rounds of a mode: all that is linear first, then everything, then everything with Huber's loss. */
static dif_status solve_rounds(const job *j, const int *size, const int *row_block, dif_fit_mode mode, double *par,
                               double *residual, dif_fit_outcome *out, dif_error *err)
{
    const dif_fit_model *m = j->model;
    job mine = *j;
    dif_ls ls = {.n_row = j->n, .n_shared = m->n_shared, .n_block = m->n_group, .size = size, .row_block = row_block};
    ls.par = par;
    ls.stride = m->stride;
    ls.eval = eval;
    ls.self = &mine;
    for (dif_fit_mode round = DIF_FIT_LINEAR; round <= mode && round <= DIF_FIT_ROBUST; round++) {
        ls.n_iteration_max = n_iteration_max[round];
        ls.hold_shared = round == DIF_FIT_LINEAR;
        ls.linear = round == DIF_FIT_LINEAR && !m->coherent;
        ls.want_covariance = round == DIF_FIT_ROBUST && m->n_shared > 0;
        if (round == DIF_FIT_ROBUST)
            ls.loss_scale = 3.0 * core_deviation(m, par, j->n, j->cell, residual, residual + j->n);
        dif_status status = solve_round(&ls, j, residual, out, err);
        if (status != DIF_OK || m->n_shared == 0)
            return status;
    }
    return DIF_OK;
}

dif_status dif_fit_model_solve(const dif_fit_model *model, int n, const dif_fit_cell *cells, dif_fit_mode mode,
                               double *par, dif_fit_outcome *out, dif_error *err)
{
    *out = (dif_fit_outcome){0};
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
