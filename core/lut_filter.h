/* The wavelength-integrated table averaged over a Gaussian of directions: what a pixel sees whose slopes scatter.
 *
 * Tilting a surface by a slope s moves (u, v) to (u, v) + w s, so slopes of mean 0 and covariance C blur the table by a
 * Gaussian of covariance w^2 C. It is read as graphics hardware reads textures: a few probes along the longer axis, each as
 * wide as the shorter one, from a pyramid over a square of (u, v); the polar table itself serves where the Gaussian is
 * narrower than the pyramid's finest texel. The mirror's spot, thousands of times brighter than what is around it, would
 * leak through the ends of probes or be missed by them: it is taken out of the pyramid and added in closed form, its light
 * times the Gaussian's density.
 * Does not: gains (a factor that is taken in the middle), slopes (core/slope.h, core/meso.h). */
#ifndef DIF_LUT_FILTER_H
#define DIF_LUT_FILTER_H

#include "core/lut.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_LUT_FILTER_LEVELS = 12, DIF_LUT_FILTER_PROBES = 9 };

/* Level l holds the mean coefficients over squares of side 4 / (n >> l) of [-2, 2]^2:
 * coef[l][n >> l][n >> l][n_map][3], row 0 at v = -2. */
typedef struct dif_lut_filter {
    const dif_lut *lut;                 /* not owned, outlives this */
    int n, n_level;                     /* n a power of two         */
    float *coef[DIF_LUT_FILTER_LEVELS]; /* without the spot; [0] owns them all */
    double spot_radius, spot_variance;  /* where it ends; along each axis, around (0, 0) */
    double spot[DIF_LUT_MAP_MAX][3];    /* its coefficients' integrals over (u, v) */
} dif_lut_filter;

/* Builds the pyramid. Given n a power of two, 16 ... 2048; 512 is good.
 * Status DIF_ERR_ARG, DIF_ERR_NOMEM; *out zeroed on failure. The caller frees with dif_lut_filter_free. */
DIF_MUST_USE dif_status dif_lut_filter_create(const dif_lut *lut, int n, dif_lut_filter *out, dif_error *err);
void dif_lut_filter_free(dif_lut_filter *filter);

/* How a Gaussian of covariance (uu, vv, uv) is probed: n places (u, v) + offset[i], and of which width. Also what a shader
 * does. */
typedef struct dif_lut_probes {
    int n;
    double offset[DIF_LUT_FILTER_PROBES][2], weight[DIF_LUT_FILTER_PROBES]; /* weights sum to 1 */
    double level; /* of the pyramid; below -1 the table itself, between -1 and 0 a mixture */
} dif_lut_probes;
void dif_lut_filter_probes(int n_side, const double cov[3], dif_lut_probes *out);

/* Mean colour over the Gaussian around (u, v) at fixed w.
 * Returns the number of places read (each of them (3 n_map + 3) / 4 texel reads of four numbers on a GPU). */
int dif_lut_filter_eval(const dif_lut_filter *filter, double u, double v, double w, const double cov[3], double xyz[3]);

#ifdef __cplusplus
}
#endif
#endif
