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

/* A tile of slopes that repeats, and means over its blocks: level l has blocks of 2^l x 2^l texels.
 * Moments are (E s_x, E s_y, E s_x^2, E s_y^2, E s_x s_y) at moment[l][ny][nx][5], row 0 at the top (y up). */
typedef struct dif_meso {
    int n_level, nx, ny;            /* of level 0: powers of two */
    double tiles;                   /* tiles in a unit of texture coordinates */
    float *moment[DIF_MESO_LEVELS]; /* [0] owns them all */
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
 * As graphics hardware would: up to DIF_MESO_PROBES reads along the longer axis, each linear between two levels whose
 * blocks are as wide as the shorter one. Below a texel the covariance fades to 0.
 * Returns   the number of reads */
int dif_meso_moments(const dif_meso *meso, const double uv[2], const dif_footprint *footprint, dif_slope_gauss *out);

#ifdef __cplusplus
}
#endif
#endif
