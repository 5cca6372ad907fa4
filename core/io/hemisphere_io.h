/* Images of a hemisphere as files: a distribution of normals with its masking and its texels' solid angles, as EXR.
 * Does not: compute them (core/hemisphere.h). */
#ifndef DIF_HEMISPHERE_IO_H
#define DIF_HEMISPHERE_IO_H

#include "core/hemisphere.h"
#include "core/io/manifest.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes an orthographic EXR, whole or not at all, n x n pixels laid out as in core/hemisphere.h: channels `ndf` (per
 * sr, normalised so that its sum times texel_area is 1), `masking` (G of the texel's middle direction), `texel_sr` and
 * `texel_area`; axes and manifest as attributes "diffbench.KEY".
 *
 * Given     masking  masking[n * n], as by dif_hemisphere_masking_image
 * Status    DIF_ERR_IO, DIF_ERR_FOREIGN, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_hemisphere_write(const char *path, const dif_ndf *ndf, const float *masking,
                                             const dif_manifest *manifest, dif_error *err);

/* Reads the distribution back; what the image lacks to int D cos = 1 is made up.
 * Status    DIF_ERR_IO, DIF_ERR_FORMAT, DIF_ERR_SIZE, DIF_ERR_ARG (values below 0 or not finite), DIF_ERR_NOMEM; *ndf
 *           zeroed on failure
 * Owns      the caller frees with dif_hemisphere_ndf_free */
DIF_MUST_USE dif_status dif_hemisphere_read(const char *path, dif_ndf *ndf, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
