/* Energy checks: the integral of the BRDF over outgoing directions, and sums of order efficiencies.
 * Does not: rescale anything. */
#ifndef DIF_ENERGY_H
#define DIF_ENERGY_H

#include "bench/measure.h"
#include "core/grating.h"

#ifdef __cplusplus
extern "C" {
#endif

/* int f cos theta_o d wo over the hemisphere for one incident direction and wavelength. A flat mirror gives R up to the
 * width of its lobe: 1e-3 to 60 degrees at sigma >= 16 um; windows cut by the patch have tails and are a little worse.
 *
 * Status    DIF_ERR_ARG (direction, wavelength), DIF_ERR_SIZE above 4e6 directions (a patch or window over about 450
 *           wavelengths), else as dif_measure_queries; *albedo is 0 on failure
 * Cost      one volume transform and about (8 reach/lambda)^2 samples, reach the patch or 8 sigma */
DIF_MUST_USE dif_status dif_energy_albedo(const dif_field *field, dif_vec3 wi, double lambda_um, double tol,
                                          const dif_measure_opts *opts, double *albedo, dif_error *err);

/* Sum of the efficiencies of all propagating orders of a named profile at R = 1. Reported, never rescaled. */
double dif_energy_order_sum(const dif_grating *grating, dif_vec3 wi, double lambda_um);

#ifdef __cplusplus
}
#endif
#endif
