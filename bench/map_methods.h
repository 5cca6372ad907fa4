/* Maps by the methods beyond sheet and direct. Not installed. */
#ifndef DIF_MAP_METHODS_H
#define DIF_MAP_METHODS_H

#include "bench/map.h"
#include "bench/measure_impl.h"

/* Where the powers of a map are added up. */
typedef struct dif_map_sums {
    const dif_map_plan *plan;
    const double (*weight)[3]; /* weight[n_lambda], for XYZ                              */
    const float *gain;         /* gain[n_pixel^2]: quantity / power (at 1 um for the BRDF) */
    bool per_lambda2;          /* the quantity is the BRDF                               */
    double *sums;              /* sums[n_pixel^2][3], without the gain                   */
    float *layer;              /* layer[n_lambda][n_pixel^2], with it, or NULL           */
} dif_map_sums;

/* DIF_ERR_UNSUPPORTED where a method cannot make the map. */
DIF_MUST_USE dif_status dif_map_check_method(const dif_map_plan *plan, const dif_measure_opts *opts, dif_error *err);

/* Adds all windows. Status as dif_map_measure. */
DIF_MUST_USE dif_status dif_map_by_method(const dif_map_sums *to, const dif_field *field, double tol,
                                          const dif_measure_opts *opts, const dif_window_set *set,
                                          dif_measure_stats *stats, dif_error *err);

#endif
