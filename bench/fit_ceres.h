/* Robust nonlinear least squares on Ceres, for bench/fit only.
 *
 *   minimise  sum_i rho(r_i(shared, own_b(i))^2) / 2
 *
 * A row depends on the shared parameters and on one of several blocks of its own, so that what belongs to one group
 * of rows alone (amplitudes, background) is eliminated group by group.
 * Does not: know any model, print, judge a result. */
#ifndef DIF_FIT_CERES_H
#define DIF_FIT_CERES_H

#include <stdbool.h>

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dif_ls {
    int n_row;
    int n_shared;         /* >= 0                                                                   */
    int n_block;          /* >= 1                                                                   */
    const int *size;      /* size[n_block], each >= 1                                               */
    const int *row_block; /* row_block[n_row], in [0, n_block)                                      */
    double *par;          /* shared first, then the blocks; start in, solution out; owned by caller */
    int stride;           /* of a Jacobian row: n_shared + the largest block                        */
    const double *low;    /* low[n_shared] and high[n_shared]: bounds, or NULL                      */
    const double *high;
    double loss_scale; /* Huber's: residuals beyond it count linearly; 0 = plain squares         */
    int n_iteration_max;
    bool hold_shared; /* solve for the blocks alone                                             */
    bool linear;      /* the problem is linear in what is free: take the full step                */
    bool want_covariance;
    /* Fills residual[n_row] at `par`, and jacobian[n_row * stride] (shared columns, then own) if it is not NULL. */
    dif_status (*eval)(void *self, const double *par, double *residual, double *jacobian);
    void *self;
} dif_ls;

typedef struct dif_ls_report {
    bool converged;
    int n_iteration;
    double cost;         /* the sum above, as the solver believes it */
    bool has_covariance; /* false: not asked for, or the Jacobian has no full rank                  */
    char text[160];      /* the solver's word                                                      */
} dif_ls_report;

/* Solves. covariance[n_shared * n_shared] (may be NULL) is (J^T J)^-1 of the shared parameters, loss applied, for
 * residuals of unit variance.
 * Status    DIF_ERR_NOMEM, DIF_ERR_FOREIGN, or what eval returned; not converging is no error here */
DIF_MUST_USE dif_status dif_ls_solve(const dif_ls *ls, double *covariance, dif_ls_report *report, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
