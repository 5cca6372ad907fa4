/* The gains that turn the normalised power p into what a user asks for: rho, the absolute BRDF, efficiencies.
 * Source: Stam 1999 (Kirchhoff, far field); DESIGN's quantities.
 * Does not: shadowing (a factor of 1). */
#ifndef DIF_BRDF_H
#define DIF_BRDF_H

#include "core/fresnel.h"
#include "core/plan.h"

#ifdef __cplusplus
extern "C" {
#endif

/* R(theta_h) of a direction pair: Schlick at c = wo . half vector. */
double dif_brdf_reflectance(dif_index index, dif_vec3 wi, dif_vec3 wo);

/* rho / p = R(theta_h)/R(0) (1 + wi.wo)^2 / ((cos_i + cos_o)^2 cos_o), no unit.
 * Valid     wi.z, wo.z > 0;  infinite as wo grazes */
double dif_brdf_gain_rho(dif_index index, dif_vec3 wi, dif_vec3 wo);

/* brdf / p = R (1 + wi.wo)^2 / (cos_i cos_o w^2) (T^2 sum W)^2 / (lambda^2 A_eff), per sr,
 *   with A_eff = T^2 sum W^2, so that a flat mirror has integral f cos_o d wo = R.
 *
 * Given     area_um2  (T^2 sum W)^2 / (T^2 sum W^2), > 0 */
double dif_brdf_gain_per_sr(dif_index index, dif_vec3 wi, dif_vec3 wo, double lambda_um, double area_um2);

/* The gain of a quantity: 1, rho/p or brdf/p. */
double dif_brdf_gain(dif_quantity quantity, dif_index index, dif_vec3 wi, dif_vec3 wo, double lambda_um,
                     double area_um2);

/* eta_m / |c_m|^2 = R (1 + wi.wm)^2 / (cos_i cos_m w^2): share of incident power that order m carries. */
double dif_brdf_gain_efficiency(double reflectance, dif_vec3 wi, dif_vec3 wm);

#ifdef __cplusplus
}
#endif
#endif
