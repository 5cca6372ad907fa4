/* All methods side by side on one surface and plan: what each finds, costs and gets wrong. For the report.
 * Does not: open files, print. */
#ifndef DIF_COMPARE_METHODS_H
#define DIF_COMPARE_METHODS_H

#include "bench/measure.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_COMPARE_MAX = 9 };

typedef struct dif_compare_opts {
    int n_check;            /* random cells held against the direct sum, >= 1                              */
    unsigned seed;          /* of those cells                                                              */
    bool fit;               /* also fit the ridge model to each table (bench/fit.h)                        */
    double colour_max_deg;  /* colours: angles -max ... max of the same plane, in (0, 90)                   */
    double colour_step_deg; /* of those angles, > 0                                                        */
    double colour_step_nm;  /* wavelengths of full sampling, 380 ... 780 nm, > 0, <= 100                   */
} dif_compare_opts;

/* 100 cells, seed 1, fit, colours over +-85 deg in 0.1 deg at 1 nm. */
dif_compare_opts dif_compare_opts_default(void);

/* One method. Numbers it has none of are NaN. */
typedef struct dif_compare_row {
    dif_method method;
    const char *name;       /* "sheet", "taylor", "taylor in float", ..., static                            */
    const char *leaves_out; /* dif_method_leaves_out                                                        */
    dif_status status;      /* DIF_OK, or why there is no table: the rest is NaN then                        */
    char text[240];         /* of that failure, or of a fit that was not believed; else empty                */
    double bound;           /* of |amplitude error| / sum W                                                 */
    double build_s, eval_s; /* wall time of the table; direct: extrapolated from the checked cells            */
    double cpu_s;           /* of both                                                                      */
    double argmax_mean_um;  /* lambda / |sin theta_i + sin theta_o| at the largest value of each wavelength,  */
    double argmax_sd_um;    /* the source's statistic: mean and standard deviation over wavelengths          */
    double fit_period_um;   /* of the ridge model                                                           */
    double fit_uncertainty_um;
    double error_worst;            /* | |P| - |P_direct| | / sum W over the checked cells: largest,                  */
    double error_rms;              /* and root mean square                                                         */
    double de_median, de_p95;      /* CIEDE2000 against full sampling over the colour angles                        */
    double de_worst, de_worst_deg; /* and where the worst lies                                              */
    double shift_x, shift_y;       /* mean chromaticity minus that of full sampling, weighted by luminance  */
} dif_compare_row;

typedef struct dif_compare {
    int n;
    dif_compare_row row[DIF_COMPARE_MAX];
    double exposure; /* colours are compared times this: away from the mirror direction (|sin sum| > 0.1) the 99th
                        percentile of full sampling's Y becomes 1                                             */
} dif_compare;

/* Runs sheet, taylor (double and float), direct (on the checked cells), thesis, nmm (with its Jacobian and without), pq
 * and stam.
 *
 * The colours of thesis and stam, whose brightness means nothing, are first scaled to full sampling's mean luminance
 * away from the mirror direction. Unless n_replica says otherwise, pq's maxima come from 500 replicas, so
 * that a finite grating's shift (1/N^2) is below 0.05 nm; all else of it from as many as fill the window.
 * Full sampling is the sheet at colour_step_nm; its own row has zero difference.
 *
 * Given     plan  for tables, maxima and fits
 *           opts  what the methods share and their own options; `method`, `single`, `nmm_jacobian` and `quantity` are set
 *                 here. Without a period pq and stam say so in their rows (dif_measure_find_period gives one)
 *           how   NULL = defaults
 * Status    DIF_ERR_ARG, DIF_ERR_NOMEM, or what the sheet fails with; *out zeroed on failure. A method that fails is its
 *           row's status, not this one. */
DIF_MUST_USE dif_status dif_compare_methods(const dif_field *field, const dif_plan *plan, double tol,
                                            const dif_measure_opts *opts, const dif_compare_opts *how, dif_compare *out,
                                            dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
