/* Local maxima of a table, sub-sample, and their residuals against the grating equation.
 * Does not: fit periods (bench/fit.h). */
#ifndef DIF_MAXIMA_H
#define DIF_MAXIMA_H

#include "core/plan.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dif_maximum {
    double lambda_um;
    double angle_rad;    /* refined by a parabola through three samples            */
    double value;        /* refined value                                          */
    double sin_sum;      /* sin theta_i + sin theta_o there                        */
    bool at_edge;        /* on the first or last angle: not a maximum, only the largest value */
    bool is_global;      /* the largest of its wavelength                          */
    int order;           /* nearest order of the given period, 0 if none was given */
    double residual_rad; /* angle minus the angle of that order; NaN if evanescent or no period */
    double period_um;    /* m lambda / sin_sum with that order; NaN for m = 0      */
} dif_maximum;

typedef struct dif_maxima_opts {
    double floor_share; /* ignore maxima below this share of the table's largest value, [0, 1) */
    double period_um;   /* to assign orders, or NaN                                            */
} dif_maxima_opts;

/* floor_share 0.01, no period. */
dif_maxima_opts dif_maxima_opts_default(void);

typedef struct dif_maxima {
    int n;
    dif_maximum *item; /* item[n], by wavelength then angle, owned */
} dif_maxima;

/* Finds them. NaN cells never count.  Status DIF_ERR_ARG, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_maxima_find(const dif_table *table, const dif_maxima_opts *opts, dif_maxima *out,
                                        dif_error *err);
void dif_maxima_free(dif_maxima *maxima);

/* Summary of lambda / |sin_sum| at each wavelength's largest value (order 1 by assumption): the source's statistic. */
typedef struct dif_maxima_period {
    int n;
    double mean_um, sd_um;
    double min_um, max_um;
} dif_maxima_period;
dif_maxima_period dif_maxima_first_order(const dif_maxima *maxima);

/* Residual statistics of one order. */
typedef struct dif_maxima_order {
    int order, n;
    double mean_rad, rms_rad, worst_rad;
    double period_mean_um, period_sd_um; /* NaN for order 0 */
} dif_maxima_order;

/* Statistics per order: out[n_out_max]; returns the number of orders seen (may exceed n_out_max). */
int dif_maxima_by_order(const dif_maxima *maxima, int n_out_max, dif_maxima_order *out);

#ifdef __cplusplus
}
#endif
#endif
