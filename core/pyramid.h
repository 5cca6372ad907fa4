/* A pyramid of the first and second moments of a heightfield: how heights scatter over a footprint of any size.
 * Does not: colours (core/transfer.h), slopes (core/slope.h). */
#ifndef DIF_PYRAMID_H
#define DIF_PYRAMID_H

#include "core/field.h"
#include "core/footprint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* First and second moments of heights over ever larger blocks: level l holds the means of z and z^2 over blocks of
 * 2^l x 2^l samples, those at the right and lower edges smaller. z is the height as a map position,
 * (h - low_um) / (high_um - low_um). */
enum { DIF_PYRAMID_LEVELS = 16 };
typedef struct dif_pyramid {
    int n_level;
    int nx[DIF_PYRAMID_LEVELS], ny[DIF_PYRAMID_LEVELS]; /* blocks of each level                       */
    float *moment[DIF_PYRAMID_LEVELS];                  /* moment[l][ny * nx][2]; [0] owns them all   */
} dif_pyramid;

/* Status as dif_field_check, DIF_ERR_ARG (low_um < high_um fails), DIF_ERR_NOMEM; *out zeroed on failure. */
DIF_MUST_USE dif_status dif_pyramid_create(const dif_field *field, double low_um, double high_um, dif_pyramid *out,
                                           dif_error *err);
void dif_pyramid_free(dif_pyramid *pyramid); /* accepts a zeroed struct */

/* Height at (u, v) in samples, linear between them, cut at the edges; as a map position. */
double dif_pyramid_height(const dif_pyramid *pyramid, double u, double v);

/* Mean and standard deviation of the heights in a footprint around (u, v), in samples.
 *
 * Reads about n_across x n_across places spread over the parallelogram (more along the longer axis, at most 64), in the
 * level whose blocks are 1 / n_across of its shorter axis; below n_across samples the heights themselves.
 * Given     n_across  2 ... 16
 * Returns   the number of places read */
int dif_pyramid_footprint(const dif_pyramid *pyramid, double u, double v, const dif_footprint *footprint, int n_across,
                          double *mean, double *sigma);

#ifdef __cplusplus
}
#endif
#endif
