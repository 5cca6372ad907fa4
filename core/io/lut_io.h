/* The wavelength-integrated table (core/lut.h) as one EXR: x = azimuth, y = radius, channels c00.X c00.Y c00.Z c01.X ...
 * (float, not compressed), what is needed to evaluate it as attributes.
 * Does not: build or evaluate tables. */
#ifndef DIF_LUT_IO_H
#define DIF_LUT_IO_H

#include "core/io/manifest.h"
#include "core/lut.h"

#ifdef __cplusplus
extern "C" {
#endif

#define DIF_LUT_VERSION "1" /* of the file */

/* Writes a table, whole or not at all. Attributes "diffbench.KEY": layout, lut_version, n_map, s0, tail, the axes in
 * words, and the manifest. Status DIF_ERR_IO, DIF_ERR_FOREIGN, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_lut_write(const char *path, const dif_lut *lut, const dif_manifest *manifest,
                                      dif_error *err);

/* Reads one: every number as it was written, to the last bit; *manifest (may be NULL) becomes its text attributes.
 *
 * Status    DIF_ERR_IO; DIF_ERR_FORMAT: no table, another version, wrong sizes or channels, truncated; DIF_ERR_NONFINITE;
 *           DIF_ERR_SIZE; DIF_ERR_NOMEM; *lut zeroed on failure
 * Owns      the caller frees with dif_lut_free */
DIF_MUST_USE dif_status dif_lut_read(const char *path, dif_lut *lut, dif_manifest *manifest, dif_error *err);
DIF_MUST_USE dif_status dif_lut_parse(const unsigned char *data, size_t n, const char *name, dif_lut *lut,
                                      dif_manifest *manifest, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
