/* Which orders the ridges are: integers m_k with f_k = m_k g; for bench/fit only.
 * Does not: fit. */
#ifndef DIF_FIT_ORDER_H
#define DIF_FIT_ORDER_H

#include <stdbool.h>

#include "bench/fit.h"

enum { DIF_FIT_ORDER_STRONGEST_MAX = 8 }; /* highest order that the strongest ridge is tried as */

typedef struct dif_fit_order_input {
    int n;
    const double *f_per_um, *weight; /* [n] */
    double sigma_per_um;             /* width of the line: centres are trusted to a share of it */
    double f_low, f_high;            /* what the scan covers                                    */
    int order;                       /* of the strongest ridge, or DIF_FIT_ORDER_FIND           */
    double period_start_um;          /* or NaN                                                  */
    bool loose;                      /* an angular offset may move the centres                  */
} dif_fit_order_input;

/* Marks ridges that no order of the period explains. */
#define DIF_FIT_ORDER_NONE (-2000000)

/* Assigns orders of one common period.
 *
 * Gives     order[n] (DIF_FIT_ORDER_NONE: left over, below 5 % of the weight in all), g = 1/period, text for the note
 * Status    DIF_ERR_FIT with the reason */
DIF_MUST_USE dif_status dif_fit_order_assign(const dif_fit_order_input *in, int *order, double *g_per_um,
                                             char note[160], dif_error *err);

#endif
