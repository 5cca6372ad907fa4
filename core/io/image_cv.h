/* Images through OpenCV: grey images in (8 and 16 bit), pictures out, resampling for pictures.
 * Does not: heights or scales (field_io does). */
#ifndef DIF_IMAGE_CV_H
#define DIF_IMAGE_CV_H

#include <stddef.h>
#include <stdint.h>

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dif_image {
    int nx, ny, bits; /* bits 8 or 16                        */
    uint16_t *value;  /* value[ny*nx], owned (dif_release)   */
} dif_image;

/* Decodes PNG, TIFF or BMP from memory. Grey as it is; colour only if r = g = b (alpha ignored), else
 * DIF_ERR_FORMAT. */
DIF_MUST_USE dif_status dif_image_decode(const unsigned char *data, size_t n, dif_image *out, dif_error *err);

/* A colour map's 256 entries as rgb; name "viridis", "inferno", "turbo", "gray" (OpenCV's). */
DIF_MUST_USE dif_status dif_image_colormap(const char *name, uint8_t rgb[256][3], dif_error *err);

/* Encodes rgb[ny*nx*3] as PNG; *png is freed with dif_release. */
DIF_MUST_USE dif_status dif_image_encode_png(const uint8_t *rgb, int nx, int ny, unsigned char **png, size_t *n,
                                             dif_error *err);

/* Area-averaging reduction of a float image src[ny*nx] to dst[my*mx] (mx <= nx, my <= ny); linear if larger. */
DIF_MUST_USE dif_status dif_image_resize(const float *src, int nx, int ny, float *dst, int mx, int my, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
