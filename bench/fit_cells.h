/* A table seen by spatial frequency: power without the gain, its mean over wavelengths, the peaks of that, and the
 * cells near them; for bench/fit only.
 * Does not: fit. */
#ifndef DIF_FIT_CELLS_H
#define DIF_FIT_CELLS_H

#include "bench/fit.h"
#include "bench/fit_model.h"

/* A table with what each angle contributes; f = sin_sum / lambda. */
typedef struct dif_fit_view {
    const dif_table *table;
    double *sin_sum, *cos_sum, *sin_run, *cos_run; /* per angle: transfer, running angle; owned (one block) */
    double *ungain;                                /* per angle: power / value at lambda = 1 um             */
    double y_max;                                  /* largest power                                         */
    double f_low, f_high;                          /* range over all cells                                  */
    double f_step;                                 /* median step of f from angle to angle, middle lambda   */
    size_t n_valid;
    int n_lambda_valid; /* wavelengths with any valid cell                       */
} dif_fit_view;

/* Status DIF_ERR_ARG, DIF_ERR_NOMEM; DIF_ERR_FIT if there is nothing to fit (no finite cell, all alike). */
DIF_MUST_USE dif_status dif_fit_view_create(const dif_table *table, dif_index index, dif_fit_view *out, dif_error *err);
void dif_fit_view_free(dif_fit_view *view);

/* Power of a cell in units of y_max, NaN if not measured. */
double dif_fit_view_power(const dif_fit_view *view, int i_lambda, int i_angle);

/* Mean power over the table's cells, by f. */
typedef struct dif_fit_spectrum {
    int n;
    double f_low, step_per_um;
    double *mean; /* mean[n], owned; NaN: no cell           */
    int *count;   /* cells, owned                           */
} dif_fit_spectrum;

DIF_MUST_USE dif_status dif_fit_spectrum_create(const dif_fit_view *view, double step_per_um, dif_fit_spectrum *out,
                                                dif_error *err);
void dif_fit_spectrum_free(dif_fit_spectrum *spectrum);

/* Half width at half maximum of the highest peak / sqrt(2 ln 2), for a line that is not known; NaN if the peak is not
 * inside the range. */
double dif_fit_spectrum_peak_sigma(const dif_fit_spectrum *spectrum);

typedef struct dif_fit_candidate {
    double f_per_um, height;
} dif_fit_candidate;

/* The highest peaks, one after the other with the line subtracted each time (CLEAN), strongest first; none at the ends
 * of the range. Changes the spectrum. Returns their number, at most n_max. */
int dif_fit_spectrum_candidates(dif_fit_spectrum *spectrum, const dif_fit_lineshape *line, int n_max,
                                dif_fit_candidate *out);

/* Which cells to take. */
typedef struct dif_fit_selection {
    int n_group;
    const dif_fit_group *group; /* f_low, f_high                                                */
    double step_per_um;         /* wanted distance of neighbours in f                           */
    int n_max;                  /* more cells than this: wavelengths are thinned out            */
    bool between;               /* take cells half way between those of the other value instead */
} dif_fit_selection;

/* Selects cells, by wavelength, then angle. n = 0 and *out NULL if there are none (or none between).
 * Owns      the caller releases *out with dif_release */
DIF_MUST_USE dif_status dif_fit_view_select(const dif_fit_view *view, const dif_fit_selection *selection,
                                            dif_fit_cell **out, int *n, dif_error *err);

#endif
