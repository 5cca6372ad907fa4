/* Energy checks: the integral of the BRDF over outgoing directions, and sums of order efficiencies.
 * Does not: rescale anything. */
#ifndef DIF_ENERGY_H
#define DIF_ENERGY_H

#include "bench/measure.h"
#include "core/grating.h"

#ifdef __cplusplus
extern "C" {
#endif

/* int f cos theta_o d wo over the hemisphere for one incident direction and wavelength.
 * Status as dif_measure_queries. */
DIF_MUST_USE dif_status dif_energy_albedo(const dif_field *field, dif_vec3 wi, double lambda_um, double tol,
                                          const dif_measure_opts *opts, double *albedo, dif_error *err);

/* Sum of the efficiencies of all propagating orders of a named profile at R = 1. Reported, never rescaled. */
double dif_energy_order_sum(const dif_grating *grating, dif_vec3 wi, double lambda_um);

#ifdef __cplusplus
}
#endif
#endif
