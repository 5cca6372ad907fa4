/* The closed-form shader of periodic bumps that games use: bright wherever the grating equation holds, with no phase
 * profile.
 *
 *   p = exp(-(2 pi sigma)^2 ((f_s - m/d)^2 + (f_t - m'/d')^2)),   m, m' the nearest orders
 *
 * f_s, f_t are the lateral frequencies kappa/2 pi along and across the groove normal. After Stam, Diffraction Shaders
 * (SIGGRAPH 1999), whose periodic heights give spikes at u = m lambda/d under the spectrum of one bump; the shaders made
 * from it set that spectrum to 1, so every order is as bright as the mirror. The width of a spike is that of the
 * Gaussian coherence window's line, |W^|^2.
 * Leaves out: heights, hence blaze, order strengths and energy; everything that depends on w. Its error has no bound,
 * and its brightness no meaning: only where light goes can be compared.
 * Does not: gains. */
#ifndef DIF_STAM_H
#define DIF_STAM_H

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dif_stam {
    double period_um;        /* d along the groove normal, > 0                           */
    double period_across_um; /* d' across it, > 0, or NaN: only m' = 0                   */
    double psi_rad;          /* azimuth of the groove normal                             */
    double sigma_um;         /* of the coherence window, > 0                             */
} dif_stam;

/* DIF_OK, or DIF_ERR_ARG if a period or sigma is not positive. */
DIF_MUST_USE dif_status dif_stam_check(const dif_stam *stam, dif_error *err);

/* p at lateral kappa, rad/um: in [0, 1], 1 on every order. */
double dif_stam_power(const dif_stam *stam, double kappa_x, double kappa_y);

#ifdef __cplusplus
}
#endif
#endif
