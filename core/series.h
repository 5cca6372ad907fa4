/* Taylor and Jacobi-Anger expansions of exp(i x): number of terms from a tolerance, and the bound reached.
 * Does not: evaluate fields. */
#ifndef DIF_SERIES_H
#define DIF_SERIES_H

#ifdef __cplusplus
extern "C" {
#endif

/* Bound of |exp(i x) - sum_{n<=N} (i x)^n / n!| for |x| <= x_max:  e^x x^{N+1} / (N+1)!     DESIGN section 3
 * x = 1.5 pi gives 2.994e-4, 8.815e-8, 1.005e-11 for N = 20, 25, 30. */
double dif_series_taylor_bound(double x_max, int n);

/* Smallest N whose bound is <= tol (at most 4096; the bound tells). */
int dif_series_taylor_order(double x_max, double tol);

/* Size of the largest term, x^n/n! at n ~ x: how many digits cancel. */
double dif_series_taylor_peak(double x_max);

/* Tail bound 2 sum_{n>=M} |J_n(z)| of the Jacobi-Anger expansion cut before term M, and the smallest M for tol. */
double dif_series_jacobi_bound(double z, int m);
int dif_series_jacobi_order(double z, double tol);

#ifdef __cplusplus
}
#endif
#endif
