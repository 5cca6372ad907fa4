/* From a solved ridge model to what the caller is told: ridges, period, uncertainties, residuals, note; for bench/fit
 * only.
 * Does not: fit. */
#ifndef DIF_FIT_RESULT_H
#define DIF_FIT_RESULT_H

#include "bench/fit.h"
#include "bench/fit_cells.h"
#include "bench/fit_ridges.h"

/* Everything a table fit holds on to. */
typedef struct dif_fit_work {
    dif_fit_view view;
    dif_fit_lineshape line;
    dif_fit_spectrum spectrum;
    dif_fit_state *state;
    dif_fit_part *part; /* of bands and ridges */
    int n_part;
    char order_note[160];
    int n_left_over, n_given_up;
} dif_fit_work;

/* Variance of ridge k's centre from the covariance of the shared parameters. */
double dif_fit_result_centre_variance(const dif_fit_state *state, int k);

/* Fills *out. Status DIF_ERR_FIT if no ridge has a period; *out zeroed then. */
DIF_MUST_USE dif_status dif_fit_result_fill(const dif_fit_work *work, double period_start_um, dif_fit_result *out,
                                            dif_error *err);

#endif
