/* The wavelength-integrated table: XYZ(u, v, w) of a surface under D65 as K Chebyshev maps in |w| over a polar (u, v)
 * plane, for real-time colour.
 *
 *   XYZ(u, v, w) = sum_lambda weight(lambda) p(k u, k v, k w),  k = 2 pi / lambda          core/spectrum.h
 *                = sum_n Q_n(u, v) T_n(t),   t = 2 |w| / sqrt(4 - u^2 - v^2) - 1 in [-1, 1]
 *
 * It holds the power p, no gain: rho or the BRDF's share that does not depend on the wavelength multiplies the result.
 * Axes      row r: s = sqrt(u^2 + v^2) = s0 sinh(r a), so that the neighbourhood of the mirror direction is resolved
 *           evenly and the rest logarithmically (the wavelength integral smears along s in proportion to s);
 *           column c: azimuth of (u, v) = 2 pi c / n_azimuth.
 * Does not: open files (core/io/lut_io.h). */
#ifndef DIF_LUT_H
#define DIF_LUT_H

#include "core/field.h"
#include "core/window.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_LUT_MAP_MAX = 48 };

typedef struct dif_lut_opts {
    int n_azimuth;              /* columns, 16 ... 16384                                                   */
    int n_radius;               /* rows, 8 ... 4096                                                        */
    int n_map;                  /* Chebyshev maps, 1 ... DIF_LUT_MAP_MAX, or DIF_LUT_MAPS_FROM_TOL         */
    double source_diameter_rad; /* angular diameter of the light (sun: 0.53 degrees), 0 = a point */
    void (*progress)(void *self, double share);    /* may be NULL; called from the calling thread      */
    void (*stage)(void *self, const char *begins); /* may be NULL; "sheet", "rings", "texels", "blur" */
    void *progress_self;                           /* of both                                              */
} dif_lut_opts;

#define DIF_LUT_MAPS_FROM_TOL (-1)

/* 4096 x 320, maps from tol, point source. */
dif_lut_opts dif_lut_opts_default(void);

typedef struct dif_lut {
    int n_azimuth, n_radius, n_map;
    double s0;   /* where rows turn from even to logarithmic spacing                            */
    double tail; /* largest change that the dropped maps would make, Y = 1 being a mirror        */
    float *coef; /* coef[n_radius][n_azimuth][n_map][3], owned                                  */
} dif_lut;

/* Row spacing a and the radius of a row. */
double dif_lut_row_step(const dif_lut *lut);
double dif_lut_radius(const dif_lut *lut, int row);

/* Builds the table.
 *
 * Given     windows[n_window] with share[n_window] (summing to 1): the coherence windows to average over
 *           lambda_um[n_lambda], ascending
 *           tol   wanted error of the maps (not of the interpolation between texels), Y = 1 being a mirror
 * Status    DIF_ERR_ARG, DIF_ERR_TOL, DIF_ERR_SIZE, DIF_ERR_NOMEM, DIF_ERR_FOREIGN; *out zeroed on failure
 * Owns      the caller frees with dif_lut_free */
DIF_MUST_USE dif_status dif_lut_create(const dif_field *field, int n_window, const dif_window *windows,
                                       const double *share, int n_lambda, const double *lambda_um, double tol,
                                       const dif_lut_opts *opts, dif_lut *out, dif_error *err);
void dif_lut_free(dif_lut *lut);

/* Colour at (u, v, w), |(u, v, w)| <= 2: linear interpolation between texels, Clenshaw's sum over the maps. */
void dif_lut_eval(const dif_lut *lut, double u, double v, double w, double xyz[3]);

#ifdef __cplusplus
}
#endif
#endif
