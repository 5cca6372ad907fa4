/* The part of a table that a fit or a search for maxima should see.
 * Does not: choose it. */
#ifndef DIF_TABLE_CUT_H
#define DIF_TABLE_CUT_H

#include "core/plan.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A copy in which cells outside f_min ... f_max of |f| = |sin theta_i + sin theta_o| / lambda, or beyond an angle, are NaN.
 * f_max may be infinite.  Status DIF_ERR_NOMEM; *out zeroed on failure.  Owns: dif_table_free */
DIF_MUST_USE dif_status dif_table_cut(const dif_table *table, double f_min_per_um, double f_max_per_um,
                                      double angle_max_rad, dif_table *out, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
