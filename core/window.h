/* The coherence window W(x, y) = wx(x) wy(y): Gaussian or flat, and its tiling over a patch (Welch).
 * Does not: touch heights. */
#ifndef DIF_WINDOW_H
#define DIF_WINDOW_H

#include "core/field.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_window_kind { DIF_WINDOW_GAUSS, DIF_WINDOW_FLAT } dif_window_kind;

/* One window. The Gaussian is exp(-r^2 / (2 sigma^2)) around (x_um, y_um), cut by the patch; the flat one is 1 on
 * the patch and ignores the other members. */
typedef struct dif_window {
    dif_window_kind kind;
    double sigma_um;   /* > 0                          */
    double x_um, y_um; /* centre, in the field's frame */
} dif_window;

typedef enum dif_average {
    DIF_AVERAGE_NONE, /* one window at the centre: one speckle realisation             */
    DIF_AVERAGE_WELCH /* windows tiled over the patch, |P|^2 averaged: the expectation */
} dif_average;

/* Default width of the source: a quarter of 65 um. */
#define DIF_SIGMA_DEFAULT_UM 16.25

/* Sums over the samples of one axis or both. */
typedef struct dif_window_sums {
    double w;  /* sum of W   */
    double w2; /* sum of W^2 */
} dif_window_sums;

/* Fills wx[nx] and wy[ny]; returns the sums over the whole patch. */
dif_window_sums dif_window_fill(const dif_window *window, const dif_field *field, double *wx, double *wy);

/* Number of windows that dif_window_tile gives, >= 1. */
int dif_window_tile_count(dif_window_kind kind, double sigma_um, dif_average average, const dif_field *field);

/* The windows of an averaging mode: windows[dif_window_tile_count(...)].
 *
 * Welch: centres on a grid of spacing <= sigma, symmetric about the patch centre, from one sigma inside one edge to one
 * sigma inside the other (the one centre where the patch is narrower than 2 sigma). Windows are cut by the patch, so
 * an average is sum |P_s|^2 / sum (sum W_s)^2: a cut window counts less. A flat window is never tiled. */
void dif_window_tile(dif_window_kind kind, double sigma_um, dif_average average, const dif_field *field,
                     dif_window *windows);

#ifdef __cplusplus
}
#endif
#endif
