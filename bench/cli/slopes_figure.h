/* Pictures of slopes and normals, for the verb and for reports.
 * Does not: compute them. */
#ifndef DIF_SLOPES_FIGURE_H
#define DIF_SLOPES_FIGURE_H

#include "bench/slopes.h"
#include "core/io/manifest.h"
#include "core/shadow.h"

/* Three panels: all slopes, those seen, and the Gaussian that stands for them, one colour scale. */
DIF_MUST_USE dif_status dif_slopes_write_png(const char *path, const char *heading, const dif_slopes *slopes,
                                             const dif_manifest *manifest, dif_error *err);

/* The five cases of bench/slopes.h, a column each: slopes, what is seen of them, the Gaussian. */
DIF_MUST_USE dif_status dif_slopes_write_cases_png(const char *path, const dif_manifest *manifest, dif_error *err);

/* Three discs: the distribution of normals (decades), its masking, and what Smith's differs from it.
 *
 * Given     masking  [ndf->n^2], as by dif_hemisphere_masking_image
 *           slopes   covariance that Smith's stands on
 * Gives     *worst   largest |difference| up to 85 degrees (may be NULL) */
DIF_MUST_USE dif_status dif_ndf_write_png(const char *path, const char *heading, const dif_ndf *ndf,
                                          const float *masking, const dif_slope_gauss *slopes,
                                          const dif_manifest *manifest, double *worst, dif_error *err);

#endif
