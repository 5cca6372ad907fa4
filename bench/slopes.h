/* What a surface's slopes look like from a direction: measured over its cells, and as the Gaussian that stands for them;
 * with the masking that follows. And the same for Gaussians of slopes alone, where the truth is known.
 * Does not: open files, draw. */
#ifndef DIF_SLOPES_H
#define DIF_SLOPES_H

#include "core/slope.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A view of slopes. Densities over `square`, integral over all slopes 1. */
typedef struct dif_slopes {
    double theta_rad, phi_rad;
    dif_slope_gauss surface; /* mean and covariance, unseen                                                 */
    dif_slope_visible seen;  /* of the visible slopes: measured, or model for a Gaussian                     */
    dif_slope_visible model; /* of the Gaussian with the surface's moments, in closed form                  */
    double overlap;          /* of what is seen and the model: 1 - half the integral of |difference|; 1 = alike */
    double inside;           /* share of what is seen that lies in the square                               */
    dif_slope_square square; /* of all three                                                                */
    float *unseen;           /* [n * n] slopes from above; owns all three                                   */
    float *visible;          /* [n * n] seen from (theta, phi)                                              */
    float *gauss;            /* [n * n] the Gaussian of model                                               */
} dif_slopes;

enum { DIF_SLOPES_BINS_MAX = 160 };

/* A heightfield's.
 *
 * Given     step_um  height of a quantisation step (0 = none): bins then hold whole steps of slope, or they would beat
 * Status    DIF_ERR_ARG (angles), as dif_slope_of_field, DIF_ERR_NOMEM; *out zeroed on failure
 * Owns      the caller frees with dif_slopes_free */
DIF_MUST_USE dif_status dif_slopes_of_field(const dif_field *field, double step_um, double theta_rad, double phi_rad,
                                            dif_slopes *out, dif_error *err);

/* Those of a Gaussian: what is seen is p max(0, cos - s.v sin) itself, without bins. Status DIF_ERR_ARG, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_slopes_of_gauss(const dif_slope_gauss *gauss, double theta_rad, double phi_rad,
                                            dif_slopes *out, dif_error *err);

void dif_slopes_free(dif_slopes *slopes); /* accepts a zeroed struct */

/* Five surfaces and views from gentle to hard: isotropic at 45 and 80 degrees, stretched, correlated, off centre. */
enum { DIF_SLOPES_CASES = 5 };
typedef struct dif_slopes_case {
    const char *name;
    dif_slope_gauss gauss;
    double theta_deg, phi_deg;
} dif_slopes_case;
dif_slopes_case dif_slopes_case_at(int i);

#ifdef __cplusplus
}
#endif
#endif
