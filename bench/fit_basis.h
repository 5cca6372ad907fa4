/* Uniform B-splines on an interval; for bench/fit only.
 * Does not: extrapolate: beyond the interval the value at its end holds. */
#ifndef DIF_FIT_BASIS_H
#define DIF_FIT_BASIS_H

enum { DIF_FIT_DEGREE_MAX = 3 };

/* Values of the basis functions that are not zero at x: n_coef functions on [low, high] of degree min(3, n_coef - 1).
 * Returns   the index of the first; value[0 ... degree] belongs to it and the following ones; their sum is 1 */
int dif_fit_basis_at(int n_coef, double low, double high, double x, double value[DIF_FIT_DEGREE_MAX + 1], int *degree);

#endif
