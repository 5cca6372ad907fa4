/* Mesostructure: relief between the mesh and the measured surface (scales, wrinkles), as slopes that tilt the surface, and
 * their moments over a pixel's footprint.
 * Does not: displace the mesh, shade (core/shade.h). */
#ifndef DIF_MESO_H
#define DIF_MESO_H

#include "core/field.h"
#include "core/footprint.h"
#include "core/slope.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_MESO_LEVELS = 13, DIF_MESO_MOMENTS = 5, DIF_MESO_PROBES = 16 };

/* A tile of slopes that repeats, linear between texels, and its moments over blocks: level l has blocks of 2^l x 2^l
 * texels. moment[l][ny][nx][5] is mean x, mean y, variance x, variance y, covariance of the slopes within the block, row 0
 * at the top (y up); at level 0 the slope itself stands for the mean. Covariances are kept and not mean squares because
 * blocks are read linearly: mean squares would add the difference of their means, which for an even slope makes up to
 * three times the variance. */
typedef struct dif_meso {
    int n_level, nx, ny;            /* of level 0: powers of two */
    double tiles;                   /* tiles in a unit of texture coordinates */
    float *moment[DIF_MESO_LEVELS]; /* [0] owns them all    */
} dif_meso;

/* Slopes of a heightfield, resampled linearly to powers of two. The tile repeats: heights that do not, do not make a wall;
 * across the seam the nearest inner slope goes on.
 *
 * Given     scale  factor on the slopes, finite;  tiles  > 0
 * Status    DIF_ERR_ARG, DIF_ERR_SIZE (less than 2 x 2), DIF_ERR_NOMEM; *out zeroed on failure
 * Owns      the caller frees with dif_meso_free */
DIF_MUST_USE dif_status dif_meso_create(const dif_field *field, double scale, double tiles, dif_meso *out,
                                        dif_error *err);
void dif_meso_free(dif_meso *meso); /* accepts a zeroed struct */

/* Slope at texture coordinates, linear between texels. */
void dif_meso_slope(const dif_meso *meso, const double uv[2], double s[2]);

/* Mean and covariance of the slopes in a footprint around uv; both in texture coordinates.
 *
 * As graphics hardware would: up to DIF_MESO_PROBES places along the longer axis, each linear between two levels whose
 * blocks are as wide as the shorter one, narrower for the means, which a linear read widens. The covariance is that
 * within the blocks and that of the places' means: right where slopes change evenly, and from afar.
 * Returns   the number of reads: one a place, two where means and covariances are at different levels */
int dif_meso_moments(const dif_meso *meso, const double uv[2], const dif_footprint *footprint, dif_slope_gauss *out);

#ifdef __cplusplus
}
#endif
#endif
