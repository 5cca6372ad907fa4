/* Slopes of a surface: their statistics on a heightfield, their histogram, and the Gaussian of the slopes that are seen
 * from a direction.
 * Source: Heitz, Nowrouzezahrai, Poulin, Neyret 2014, in a form without its cancellations and misprints.
 * Does not: shadows that one part of a surface throws on another beyond facets turned away (core/shadow.h). */
#ifndef DIF_SLOPE_H
#define DIF_SLOPE_H

#include "core/field.h"
#include "core/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Mean and covariance of slopes (dz/dx, dz/dy), ratios: all that a Gaussian of slopes is. */
typedef struct dif_slope_gauss {
    double mean_x, mean_y;
    double var_x, var_y, cov_xy; /* positive semi-definite: var >= 0, cov_xy^2 <= var_x var_y */
} dif_slope_gauss;

/* Slopes as they are seen from a direction. */
typedef struct dif_slope_visible {
    dif_slope_gauss gauss; /* mean and covariance of the visible slopes                                       */
    double norm;           /* visible area of the facets, per unit area of the mean plane: int p max(0, n.v) / n.z */
    double ln_norm;        /* its logarithm, which does not underflow; -inf if nothing is seen                 */
} dif_slope_visible;

/* Slope of cell (ix, iy) between samples ix, ix + 1 and iy, iy + 1: the gradient of the bilinear patch at its middle.
 *
 * Given     0 <= ix < nx - 1, 0 <= iy < ny - 1
 * Returns   s[0] = dz/dx, s[1] = dz/dy, y up (core/conventions.h) */
static inline void dif_slope_of_cell(const dif_field *field, int ix, int iy, double s[2])
{
    const double *top = field->z_um + (size_t)iy * (size_t)field->nx + ix, *bottom = top + field->nx;
    s[0] = 0.5 * ((top[1] - top[0]) + (bottom[1] - bottom[0])) / field->pitch_x_um;
    s[1] = 0.5 * ((top[0] - bottom[0]) + (top[1] - bottom[1])) / field->pitch_y_um;
}

/* Mean and covariance over all cells.
 * Status    DIF_ERR_SIZE (less than 2 x 2 samples), DIF_ERR_NONFINITE; *out zeroed on failure */
DIF_MUST_USE dif_status dif_slope_of_field(const dif_field *field, dif_slope_gauss *out, dif_error *err);

/* Mean and covariance of the slopes seen from (theta, phi), measured over the cells: each weighs max(0, n.v) / n.z.
 * norm is the mean weight. Where nothing is seen the Gaussian is zero. Status as dif_slope_of_field. */
DIF_MUST_USE dif_status dif_slope_of_field_visible(const dif_field *field, double theta_rad, double phi_rad,
                                                   dif_slope_visible *out, dif_error *err);

/* DIF_OK if every member is finite and the covariance positive semi-definite (to rounding); DIF_ERR_ARG otherwise. */
DIF_MUST_USE dif_status dif_slope_check(const dif_slope_gauss *gauss, dif_error *err);

/* The visible slopes of a Gaussian of slopes.
 *
 *   a = cos t - m_o sin t,  b = sqrt(v_o) sin t,  z = a / b:  T ~ N(0, 1) weighted by max(0, z - T) has mean E and
 *   variance V;  norm = b (z Phi(z) + phi(z)),  mean_o = m_o + sqrt(v_o) E,  var_o = v_o V, and what is correlated
 *   with o follows.
 *
 * Given     gauss      slopes of the surface, valid
 *           theta_rad  polar angle of the view, 0 ... pi/2
 *           phi_rad    its azimuth
 * Returns   mean, covariance and norm; at theta = 0 the slopes themselves and norm 1. Where norm is exactly 0 (no
 *           slope but ones turned away) the slopes themselves.
 * Valid     everywhere, z down to -1e4 and beyond.  Accuracy 1e-12 relative (of norm: of its logarithm) */
dif_slope_visible dif_slope_visible_of(const dif_slope_gauss *gauss, double theta_rad, double phi_rad);

/* The weight of a slope in the view from (theta, phi): max(0, cos t - s.v sin t), without unit. */
double dif_slope_weight(double theta_rad, double phi_rad, const double s[2]);

/* Density of the Gaussian at a slope; 0 if its covariance has no area. */
double dif_slope_density(const dif_slope_gauss *gauss, const double s[2]);

/* The standard normal weighted by max(0, z - T), for z of any size.
 *
 *   Psi = z Phi(z) + phi(z),  ratio = Phi / Psi = -mean,  variance = 2 - z ratio - ratio^2
 *
 * For z < -2 by the continued fraction r_n = 1 / (x + (n + 1) r_{n+1}), x = -z, run backwards: nothing cancels. */
typedef struct dif_slope_cut {
    double psi, ln_psi, mean, variance;
} dif_slope_cut;
dif_slope_cut dif_slope_cut_at(double z);

/* A square of slope space around (mid_x, mid_y), in n x n bins: bin (ix, iy), row 0 on top, is centred on
 *   s_x = mid_x + half ((2 ix + 1) / n - 1),  s_y = mid_y - half ((2 iy + 1) / n - 1). */
typedef struct dif_slope_square {
    int n;
    double mid_x, mid_y, half; /* half > 0 */
} dif_slope_square;

/* Centre of bin (ix, iy). */
void dif_slope_bin(const dif_slope_square *square, int ix, int iy, double s[2]);

/* Histogram of the slopes seen from (theta, phi) (theta = 0: of all), as a density: the integral over all of slope space
 * is 1.
 *
 * Gives     density[n * n], inside[0] the share that falls into the square (may be NULL)
 * Status    DIF_ERR_ARG (square), as dif_slope_of_field; all zero where nothing is seen */
DIF_MUST_USE dif_status dif_slope_histogram(const dif_field *field, double theta_rad, double phi_rad,
                                            const dif_slope_square *square, double *density, double *inside,
                                            dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
