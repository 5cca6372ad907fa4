/* Few wavelengths: the spectrum of a direction sampled where a DFT of the patch has a bin, and not elsewhere.
 *
 * With s = |(u, v)| and D the extent of the patch, bin n is seen at lambda_n = D s / n, so a direction sees the bins
 * n = ceil(D s / lambda_max) ... floor(D s / lambda_min), and
 *
 *   int p(lambda) S(lambda) dlambda  ~  sum_n p(lambda_n) S(lambda_n) lambda_n^2 / (D s),    |dlambda/dn| = lambda^2/(D s)
 *
 * This samples p often enough because |P|^2 holds no frequency finer than 1/D. It holds 1/D itself if the window is not
 * yet small at the patch's edges: then the light that its cut scatters into dark directions is not seen at the bins,
 * where the two edges cancel. For an exactly periodic patch D may be
 * its period (`lines`): the bins are then the orders, between which there is no light, and each stands for its line, of
 * area A in f, whence the weight lambda_n^2 A / s.
 * Where fewer than n_fixed bins are seen (near s = 0; for lines: none), n_fixed fixed wavelengths take over.
 * The source leaves the Jacobian lambda^2/(D s) out (`jacobian` false): each bin then counts the same, bins crowd at short
 * wavelengths, and pictures turn purple. Here they share the range's width equally, so that the brightness stays.
 * Leaves out: what lies between the bins; no bound of the error.
 * Does not: evaluate p. */
#ifndef DIF_NMM_H
#define DIF_NMM_H

#include <stdbool.h>

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_NMM_FIXED_MAX = 401 };

typedef struct dif_nmm {
    double extent_um;                    /* D > 0                                                         */
    double lambda_min_um, lambda_max_um; /* 0 < min < max                                                 */
    int n_fixed;                         /* 1 ... DIF_NMM_FIXED_MAX                                       */
    bool jacobian;                       /* false: the source's version                                   */
    double line_area_per_um;             /* A of a line in f if D is the period of lines, else 0          */
} dif_nmm;

/* DIF_OK, or DIF_ERR_ARG. */
DIF_MUST_USE dif_status dif_nmm_check(const dif_nmm *nmm, dif_error *err);

/* The bins that a direction with s = |(u, v)| in [0, 2] samples: *first and their number, 0 if fixed wavelengths take over. */
int dif_nmm_bins(const dif_nmm *nmm, double s, int *first);

/* Most wavelengths that any direction (s <= 2) needs. */
int dif_nmm_count_max(const dif_nmm *nmm);

/* The wavelengths of a direction, descending for bins and ascending for fixed ones, and what each stands for.
 *
 * Given     s  |(u, v)| in [0, 2]
 * Gives     lambda_um[n], weight_um[n], n <= dif_nmm_count_max
 * Returns   n >= 1 */
int dif_nmm_wavelengths(const dif_nmm *nmm, double s, double *lambda_um, double *weight_um);

/* The one of those wavelengths that stands for a given one: the nearest bin (or fixed wavelength). */
double dif_nmm_nearest_um(const dif_nmm *nmm, double s, double lambda_um);

/* Factors that bring D65 times the observer to core/spectrum.h's scale (white has Y = 1); made once, from its 1 nm grid. */
DIF_MUST_USE dif_status dif_nmm_scale(double scale[3], dif_error *err);

/* The wavelengths of a direction, as dif_nmm_wavelengths, and their weights for XYZ = sum_i xyz_weight[i] rho(lambda_i).
 * Fixed wavelengths are too few to weigh a spectrum by themselves: their weights are scaled so that rho = 1 is white. */
int dif_nmm_weights(const dif_nmm *nmm, const double scale[3], double s, double *lambda_um, double (*xyz_weight)[3]);

#ifdef __cplusplus
}
#endif
#endif
