/* Periods with uncertainties: the ridge model on tables, the harmonic model on surfaces (Ceres, in fit_ceres.cpp).
 * A period that the data do not determine is DIF_ERR_FIT, never a number.
 * Does not: open files. */
#ifndef DIF_FIT_H
#define DIF_FIT_H

#include <stdbool.h>

#include "core/brdf.h"
#include "core/field.h"
#include "core/plan.h"
#include "core/window.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_FIT_RIDGE_MAX = 16, DIF_FIT_HARMONIC_MAX = 32 };

/* The line shape that one order has in f: |W^(f)|^2 of the coherence window. */
typedef struct dif_fit_line {
    bool known;                  /* false: a Gaussian of free width (a real instrument)                         */
    dif_window window;           /* known: the window that made the table,                                      */
    double size_x_um, size_y_um; /* and the patch that cuts it                                             */
    dif_average average;         /* known: how windows were averaged (welch tiles `window.sigma_um` itself)     */
    double pitch_um;             /* known: of the samples along the plane, or NaN; tells where their ghosts lie     */
} dif_fit_line;

typedef struct dif_fit_table_opts {
    dif_fit_line line;
    dif_index index;        /* of the sample, to divide the gain out when the quantity is rho or brdf       */
    int n_ridge_max;        /* ridges to try, 1 ... DIF_FIT_RIDGE_MAX; an information criterion decides     */
    int order;              /* order of the strongest ridge, or DIF_FIT_ORDER_FIND                          */
    double period_start_um; /* start value, or NaN to take it from the data                                 */
    bool offset_free;       /* fit an angular offset of the goniometer                                      */
    int n_part;             /* disjoint parts (bands of wavelengths) for the scatter, >= 2                  */
    bool common_period;     /* all ridges are orders of one period (a grating); false: each its own (a scan) */
} dif_fit_table_opts;

#define DIF_FIT_ORDER_FIND (-1000000)

/* Line unknown, n_ridge_max 8, order found, no offset, 4 parts, common_period false. */
dif_fit_table_opts dif_fit_table_opts_default(void);

typedef struct dif_fit_ridge {
    int order;
    double f_per_um, f_sd_per_um; /* centre, signed as -(u,v).s/lambda; from the covariance          */
    double period_um;             /* |order / f|, NaN for order 0                                    */
    double period_sd_um;          /* from the covariance                                             */
    double period_scatter_um;     /* standard error from the scatter over disjoint parts             */
    double weight;                /* share of the fitted power, sums to 1 over ridges                 */
    double width_per_um;          /* rms width in f (line shape, or the fitted one)                    */
} dif_fit_ridge;

typedef struct dif_fit_result {
    int n_ridge;
    dif_fit_ridge ridge[DIF_FIT_RIDGE_MAX]; /* strongest first                                            */
    double period_um;                       /* of the grating (common period) or of the strongest ridge   */
    double period_sd_um, period_scatter_um; /* from the covariance; from disjoint parts                   */
    double period_model_um;                 /* of a refined model: 3 times its last step, 2 % of all at least */
    double period_uncertainty_um;           /* the stated one: the largest of the three                  */
    double offset_rad, offset_sd_rad;       /* 0 and 0 if not fitted                                      */
    double residual_rms, residual_share;    /* recomputed outside the solver: rms; rms / rms of the data   */
    double criterion;                       /* BIC of the accepted model                                  */
    int n_data, n_parameter, n_iteration, n_part;
    char note[320]; /* what a reader must know, or empty                          */
} dif_fit_result;

/* Fits ridges  R = sum_m C_m(kappa_z) L(f - m/d) + background  to a table.
 * Status    DIF_ERR_ARG; DIF_ERR_FIT with the reason: not converged, not determined, residuals not believed;
 *           DIF_ERR_NOMEM, DIF_ERR_FOREIGN */
DIF_MUST_USE dif_status dif_fit_table(const dif_table *table, const dif_fit_table_opts *opts, dif_fit_result *out,
                                      dif_error *err);

typedef struct dif_fit_surface_opts {
    int n_harmonic;         /* 1 ... DIF_FIT_HARMONIC_MAX, or 0 = the criterion decides     */
    double period_start_um; /* or NaN to take it from the power spectrum                    */
    int n_part;             /* bands of the scan, 2 ... DIF_FIT_BAND_MAX                    */
    double psi_start_rad;   /* direction to start from (modulo pi), or NaN for any          */
} dif_fit_surface_opts;

enum { DIF_FIT_BAND_MAX = 100 };

/* One band of lines: its middle along the slow axis and the period that it has by itself. */
typedef struct dif_fit_band {
    double y_um, period_um, period_sd_um; /* the error is that of the covariance */
} dif_fit_band;

/* How the period changes along y, the slow axis of a scan: a straight line through the bands' periods. */
typedef struct dif_fit_drift {
    int n_band;
    dif_fit_band band[DIF_FIT_BAND_MAX];
    double slope, slope_sd; /* change of the period per um of y, um/um; NaN for fewer than 3 bands    */
    double share;           /* change over the patch's height, relative to the period                 */
    bool is_significant;    /* the slope differs from 0 at a level of 1 % (Student's t)                */
} dif_fit_drift;

dif_fit_surface_opts dif_fit_surface_opts_default(void);

typedef struct dif_fit_surface_result {
    double period_um;
    double period_sd_um;          /* from the covariance (white noise)              */
    double period_scatter_um;     /* standard error from the scatter over bands     */
    double band_sd_um;            /* standard deviation of the bands' periods       */
    double period_profile_um;     /* from the covariance, counting a misfit that repeats in every line once */
    double period_uncertainty_um; /* the largest of the three standard errors       */
    double psi_rad, psi_sd_rad;   /* azimuth of the groove normal, [0, pi)          */
    int n_harmonic, n_part, n_iteration;
    double amplitude_um[DIF_FIT_HARMONIC_MAX]; /* of harmonic 1 ... n_harmonic     */
    double residual_rms_um, residual_share;    /* recomputed outside the solver    */
    dif_fit_drift drift;
    char note[160];
} dif_fit_surface_result;

/* Fits  h = plane + sum_n a_n cos(2 pi n g) + b_n sin(2 pi n g),  g = (x cos psi + y sin psi) / d  to the heights. */
DIF_MUST_USE dif_status dif_fit_surface(const dif_field *field, const dif_fit_surface_opts *opts,
                                        dif_fit_surface_result *out, dif_error *err);

/* The strongest lateral periods of a surface from its windowed power spectrum (for `info` and start values). */
typedef struct dif_spectrum_peak {
    double period_um, psi_rad, share; /* share of the variance in the peak's neighbourhood */
} dif_spectrum_peak;
DIF_MUST_USE dif_status dif_fit_spectrum_peaks(const dif_field *field, int n_max, dif_spectrum_peak *peak, int *n_out,
                                               dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
