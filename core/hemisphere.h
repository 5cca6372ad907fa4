/* The hemisphere as an orthographic image: exact solid angles of its texels, the distribution of a surface's normals on
 * it, and the masking that follows from them.
 *
 * Layout: n x n texels over the square [-1, 1]^2 of direction cosines, row 0 on top (y up): texel (ix, iy) covers
 *   x in [2 ix / n - 1, 2 (ix + 1) / n - 1],  y in [1 - 2 (iy + 1) / n, 1 - 2 iy / n],  cut by the unit disc.
 * Does not: shadowing of direction pairs (core/shadow.h), files. */
#ifndef DIF_HEMISPHERE_H
#define DIF_HEMISPHERE_H

#include <stdbool.h>

#include "core/field.h"
#include "core/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_HEMISPHERE_MAX = 8192 };

/* Signed solid angle above the rectangle [0, x] x [0, y] of the unit disc, odd in x and in y.
 *
 *   A = x atan2(y, s) + y atan2(x, s) - atan2(x y, s),  s = sqrt(1 - x^2 - y^2);  outside (pi/2) (|x| + |y| - 1)
 *
 * Given     |x|, |y| <= 1
 * Accuracy  4e-16 absolute */
double dif_hemisphere_solid_angle_sr(double x, double y);

/* What one texel holds of the hemisphere: solid angle and first moments, integrals of 1, x, y, z over its directions.
 * The integral of z is the texel's area inside the disc. All 0 outside the disc; all exact where the rim cuts. */
typedef struct dif_hemisphere_texel {
    double sr;
    double x, y, area;
} dif_hemisphere_texel;

/* Given     n in [1, DIF_HEMISPHERE_MAX], 0 <= ix, iy < n
 * Returns   moments; the solid angles of all texels add up to 2 pi, the areas to pi, x and y to 0
 * Accuracy  3e-15 absolute each; sums to 1e-12 for n <= 4096 */
dif_hemisphere_texel dif_hemisphere_texel_at(int n, int ix, int iy);

/* Solid angles of row iy alone: sr[n]. */
void dif_hemisphere_row_sr(int n, int iy, double *sr);

/* A distribution of normals: D per sr, constant on each texel, with int D cos d omega = 1 over the image. */
typedef struct dif_ndf {
    int n;
    double *d;         /* d[n * n], 0 outside the disc; owned                                              */
    size_t n_used;     /* texels with D > 0                                                                */
    double *vector[3]; /* vector[c][n_used]: int D h d omega over each of them; vector[0] owns all three */
    double slope_rms;  /* root mean square of the slopes it was made from                                  */
} dif_ndf;

/* The normals of a heightfield: those of its cells (core/slope.h), each weighing its area.
 *
 * Each cell is shared out among the four texels around its normal, in proportion to how near it is to their centres,
 * so that the mean normal stays put although the image is coarse.
 * Given     n      texels across, 3 ... DIF_HEMISPHERE_MAX
 *           level  subtract the mean slope first, so that z is the normal of the mean plane
 * Status    DIF_ERR_ARG, DIF_ERR_SIZE (less than 2 x 2 samples), DIF_ERR_NONFINITE, DIF_ERR_NOMEM; *out zeroed on failure
 * Owns      the caller frees with dif_hemisphere_ndf_free */
DIF_MUST_USE dif_status dif_hemisphere_ndf_create(const dif_field *field, int n, bool level, dif_ndf *out,
                                                  dif_error *err);

/* The same from an image: d[n * n] >= 0, of any scale; it is normalised. Status also DIF_ERR_ARG (no light at all, or a
 * negative value). slope_rms is that of the image. */
DIF_MUST_USE dif_status dif_hemisphere_ndf_from_image(const double *d, int n, dif_ndf *out, dif_error *err);

void dif_hemisphere_ndf_free(dif_ndf *ndf); /* accepts a zeroed struct */

/* The integral of D cos over the image: 1. */
double dif_hemisphere_ndf_projected(const dif_ndf *ndf);

/* Share of a direction that facets turned away and their shadows leave visible.
 *
 *   G(k) = cos_k / int max(0, k.h) D(h) d omega                     Smith 1967, Ashikhmin et al. 2000
 *
 * Given     k  unit, k.z >= 0
 * Returns   G in [0, 1]: G((0,0,1)) = 1; cut at 1, which only a mean normal beside z can exceed
 * Valid     heights and slopes uncorrelated. Texels that the horizon of k cuts count as the positive part of their mean:
 *           error O(1/n^2).  Cost O(texels in use) */
double dif_hemisphere_masking(const dif_ndf *ndf, dif_vec3 k);

/* G(k) for the directions of m x m texel centres, 0 outside the disc: g[m * m]. Threads over rows. */
void dif_hemisphere_masking_image(const dif_ndf *ndf, int m, float *g);

#ifdef __cplusplus
}
#endif
#endif
