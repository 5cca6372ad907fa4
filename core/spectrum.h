/* From spectra to tristimulus values: the 1931 2-degree observer under D65 on any wavelength grid.
 * Does not: leave XYZ (core/colour.h). */
#ifndef DIF_SPECTRUM_H
#define DIF_SPECTRUM_H

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Colour-matching functions at a wavelength, linear between the 1 nm values, 0 outside 380 ... 780 nm. */
void dif_spectrum_observer(double lambda_um, double xyz_bar[3]);

/* Relative power of D65, linear between the 5 nm values (as CIE 15 asks), 0 outside 380 ... 780 nm. */
double dif_spectrum_d65(double lambda_um);

/* White of a perfect mirror under D65, Y = 1: (0.95047, 1, 1.08883), ASTM E308; sRGB's matrix has the same white. */
void dif_spectrum_white(double xyz[3]);

/* Weights that turn a spectrum rho(lambda) into XYZ = sum_i weight[i] rho(lambda_i).
 *
 *   weight_i = D65(lambda_i) (x, y, z bar)(lambda_i) dlambda_i,  trapezoid dlambda
 *
 * scaled so that rho = 1 gives D65's white exactly, on any grid: each of X, Y and Z by its own factor (all three equal
 * but for the grid's own error). A single wavelength has dlambda 1 and is scaled by Y alone, so that its chromaticity
 * is the spectral line's.
 *
 * Given     lambda_um[n], ascending, n >= 1
 * Gives     weight[n][3]
 * Status    DIF_ERR_ARG: not ascending, or no wavelength inside 380 ... 780 nm */
DIF_MUST_USE dif_status dif_spectrum_weights(int n, const double *lambda_um, double (*weight)[3], dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
