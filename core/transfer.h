/* Colour maps seen from afar: the mean colour of heights that scatter, from a table made beforehand.
 * Source: Heitz, Nowrouzezahrai, Poulin, Neyret 2014.
 * Does not: say how the heights scatter (core/pyramid.h), sRGB encoding (core/colour.h), draw pictures (bench/view.h). */
#ifndef DIF_TRANSFER_H
#define DIF_TRANSFER_H

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

#define DIF_TRANSFER_SIGMA_MAX 0.5 /* no distribution on [0, 1] has a larger standard deviation */

/* Mean colour over a Gaussian of map positions t, N(mean, sigma^2): rgb[n_sigma][n_mean][3], linear light, floats, to be
 * read linearly in both directions:
 *
 *   column mean (n_mean - 1),  row sqrt(sigma / DIF_TRANSFER_SIGMA_MAX) (n_sigma - 1) */
typedef struct dif_transfer {
    int n_mean, n_sigma;
    float *rgb; /* owned */
} dif_transfer;

/* Blurs a colour map: piecewise linear through colour[n][3] at t = i / (n - 1), its end colours beyond [0, 1].
 *
 *   mean colour = c_0 + sum_i c'_i (R(t_i) - R(t_i+1)),  R(t) = E[max(0, X - t)] = sigma Psi((mean - t) / sigma)
 *
 * Given     n        colours, 2 ... 4096, which become the table's columns
 *           n_sigma  rows, 2 ... 4096
 * Status    DIF_ERR_ARG (n, n_sigma, a colour that is not finite), DIF_ERR_NOMEM; *out zeroed on failure
 * Owns      the caller frees with dif_transfer_free
 * Accuracy  float rounding at the table's places */
DIF_MUST_USE dif_status dif_transfer_create(int n, const double (*colour)[3], int n_sigma, dif_transfer *out,
                                            dif_error *err);
void dif_transfer_free(dif_transfer *transfer); /* accepts a zeroed struct */

/* Reads the table; mean and sigma are cut to its range (NaN to 0). */
void dif_transfer_colour(const dif_transfer *transfer, double mean, double sigma, double rgb[3]);

#ifdef __cplusplus
}
#endif
#endif
