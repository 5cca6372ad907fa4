/* A wavelength-integrated table (core/lut.h) against full spectral sampling.
 * Does not: build tables, open files. */
#ifndef DIF_LUT_CHECK_H
#define DIF_LUT_CHECK_H

#include "bench/measure.h"
#include "core/lut.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Builds the table of a surface with the windows that opts asks for. Status as dif_lut_create. */
DIF_MUST_USE dif_status dif_lut_measure(const dif_field *field, int n_lambda, const double *lambda_um, double tol,
                                        const dif_measure_opts *opts, const dif_lut_opts *how, dif_lut *out,
                                        int *n_window, dif_error *err);

/* Median, 95th percentile and largest. */
typedef struct dif_lut_errors {
    double median, p95, worst;
} dif_lut_errors;

typedef struct dif_lut_check {
    int n;                       /* directions                                                                     */
    double brightest;            /* largest Y of full sampling among them                                          */
    dif_lut_errors relative;     /* |Y - Y_full| / Y_full                                                          */
    dif_lut_errors of_peak;      /* largest of |X|, |Y|, |Z| differences / brightest                               */
    dif_lut_errors de;           /* CIEDE2000, colours times `exposure`                                            */
    double exposure;             /* the 99th percentile of Y_full becomes 1                                        */
    dif_vec3 worst_wi, worst_wo; /* where of_peak is largest                                                   */
    double worst_y, worst_full_y;
} dif_lut_check;

/* Compares the table's colours (of the power) with those of the sheet transform at every wavelength.
 *
 * Given     n  random direction pairs (seeded), light and detector each even over the projected hemisphere
 *           opts  windows as the table's; a source's diameter is sampled by 64 points of the (u, v) plane each
 * Status    DIF_ERR_ARG, and those of dif_measure_queries */
DIF_MUST_USE dif_status dif_lut_check_random(const dif_field *field, const dif_lut *lut, int n_lambda,
                                             const double *lambda_um, double source_diameter_rad,
                                             const dif_measure_opts *opts, int n, unsigned seed, dif_lut_check *out,
                                             dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
