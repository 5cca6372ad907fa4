/* Periodic gratings: diffracted directions and the closed scalar forms of their order amplitudes.
 * Signs of orders: core/conventions.h.
 * Does not: sample heights (fixtures/surfaces.h), shadowing, polarisation. */
#ifndef DIF_GRATING_H
#define DIF_GRATING_H

#include <stdbool.h>

#include "core/status.h"
#include "core/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_profile {
    DIF_PROFILE_SINE,     /* h = (H/2) sin(2 pi x/d)                                     */
    DIF_PROFILE_BLAZED,   /* h = H x/d for 0 <= x < d, the drop at x = d                 */
    DIF_PROFILE_TRIANGLE, /* symmetric roof of height H, apex in the middle of a period  */
    DIF_PROFILE_LAMELLAR  /* h = H on the share `duty` of the period, else 0             */
} dif_profile;

typedef struct dif_grating {
    dif_profile profile;
    double period_um; /* d > 0                                          */
    double height_um; /* H >= 0, peak to valley                         */
    double duty;      /* lamellar only, in (0, 1)                       */
    double psi_rad;   /* azimuth of the groove normal                   */
} dif_grating;

/* Finds a profile by name (sine, blazed, triangle, lamellar); false if there is none. */
bool dif_profile_from_name(const char *name, dif_profile *out);
const char *dif_profile_name(dif_profile profile);

/* Direction of order m, conical diffraction included: -(u, v) = (m lambda/d)(cos psi, sin psi).
 *
 * Given     wi unit, away from the surface; period_um, lambda_um > 0
 * Returns   true and the unit wo if the order propagates; false (evanescent, *wo has z = 0) otherwise. An order within
 *           1e-7 rad of grazing (cos^2 <= 1e-14, all that rounding leaves of a Rayleigh anomaly) counts as evanescent */
bool dif_grating_direction(dif_vec3 wi, double period_um, double psi_rad, double lambda_um, int m, dif_vec3 *wo);

/* Lowest and highest propagating order; false if none (wi below the plane). */
bool dif_grating_order_range(dif_vec3 wi, double period_um, double psi_rad, double lambda_um, int *m_min, int *m_max);

/* |c_m|^2 of one period: c_m = (1/d) int_0^d exp(i k w h(x)) exp(-i 2 pi m x/d) dx with the sign of m that puts order
 * m at -(u, v) = m lambda/d.
 *
 *   sine      J_m(k w H/2)^2
 *   blazed    sinc^2(m - k w H/(2 pi)), sinc(x) = sin(pi x)/(pi x): in reflection (w < 0) negative m are favoured
 *   lamellar  m = 0: |1 + D (e^{i k w H} - 1)|^2;   else 4 sin^2(k w H/2) sin^2(pi m D) / (pi m)^2
 *   triangle  (1/4) [sinc(a/2 - m/2) + (-1)^m sinc(a/2 + m/2)]^2,  a = k w H/pi
 *
 * Given     kw_rad_per_um  k w = 2 pi w / lambda, w <= 0 in reflection
 * Returns   |c_m|^2 in [0, 1].  Accuracy 1e-13 absolute for |m| <= 200 */
double dif_grating_power(const dif_grating *grating, int m, double kw_rad_per_um);

/* Efficiency of order m (share of incident power) at reflectance R: R (1 + wi.wm)^2 / (cos_i cos_m w^2) |c_m|^2.
 * Returns   0 for an evanescent order */
double dif_grating_efficiency(const dif_grating *grating, dif_vec3 wi, double lambda_um, double reflectance, int m);

#ifdef __cplusplus
}
#endif
#endif
