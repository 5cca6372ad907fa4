/* One wave with harmonics over a plane, fitted to samples of a surface: the piece that fit_surface.c repeats for the
 * whole scan, for its bands and while the number of harmonics is being found. Not installed.
 * Does not: choose starts or judge results. */
#ifndef DIF_FIT_WAVE_H
#define DIF_FIT_WAVE_H

#include <stdbool.h>

#include "bench/fit.h"
#include "core/field.h"

enum { DIF_WAVE_PLANE = 3, DIF_WAVE_OWN_MAX = DIF_WAVE_PLANE + 2 * DIF_FIT_HARMONIC_MAX };

/* Samples of one fit, in the start wave's frame and in units of `length_um` and `height_um`. */
typedef struct dif_wave_data {
    int n;
    double *along, *across, *z;
    double length_um, height_um;
    int n_harmonic;
    bool across_free;
} dif_wave_data;

/* What one fit found: f in 1/um. */
typedef struct dif_wave_fit {
    double f_along, f_across;
    double covariance[2][2]; /* of f_along, f_across, 1/um^2 */
    double variance;         /* of the residuals, in heights of the data's rms        */
    double unit_covariance;  /* of f_along in 1/length, for residuals of variance 1   */
    double own[DIF_WAVE_OWN_MAX];
    double rms_um; /* of the residuals, recomputed */
    int n_iteration;
} dif_wave_fit;

/* Takes the samples of rect = {ix0, ix1, iy0, iy1}, thinned evenly to at most n_max; `along` runs along psi.
 * Status    DIF_ERR_FIT if they are flat, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_wave_data_make(const dif_field *field, const int rect[4], double psi_rad, int n_max,
                                           dif_wave_data *out, dif_error *err);
void dif_wave_data_free(dif_wave_data *data);

/* The frequency near f_per_um at which one harmonic explains most. */
double dif_wave_refine(const dif_wave_data *data, double f_per_um);

/* Fits from f_along, f_across (1/um).  Status DIF_ERR_FIT with the reason, DIF_ERR_NOMEM, DIF_ERR_FOREIGN */
DIF_MUST_USE dif_status dif_wave_fit_solve(dif_wave_data *data, double f_along, double f_across, dif_wave_fit *out,
                                           dif_error *err);

/* How much larger the variance of the period is than white residuals would make it (at least 1). A misfit that repeats
 * from line to line (a wall between two samples, harmonics that were left out) is one observation per place along the
 * wave, however many lines there are, and it is largest where the profile is steepest: with g_p = sum of residual times
 * dh/df over all samples of place p, the sandwich (1/A) sum g_p^2 (1/A) against sigma^2/A. */
DIF_MUST_USE dif_status dif_wave_design_effect(dif_wave_data *data, const dif_wave_fit *fit, double pitch_um,
                                               double *effect, dif_error *err);

#endif
