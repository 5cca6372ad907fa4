/* Images through OpenCV: grey images in (8 and 16 bit), pictures out, resampling and drawing for pictures.
 * Does not: heights or scales (field_io does). */
#ifndef DIF_IMAGE_CV_H
#define DIF_IMAGE_CV_H

#include <stdbool.h>
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

/* Decodes PNG, TIFF or BMP as 8 bit colour (grey is spread, 16 bits are cut, alpha is dropped); *rgb[ny*nx*3] is freed with
 * dif_release. Status DIF_ERR_FORMAT, DIF_ERR_SIZE, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_image_decode_rgb(const unsigned char *data, size_t n, uint8_t **rgb, int *nx, int *ny,
                                             dif_error *err);

/* A colour map's 256 entries as rgb; name "viridis", "inferno", "turbo", "gray" (OpenCV's). */
DIF_MUST_USE dif_status dif_image_colormap(const char *name, uint8_t rgb[256][3], dif_error *err);

/* Encodes rgb[ny*nx*3] as PNG; *png is freed with dif_release. */
DIF_MUST_USE dif_status dif_image_encode_png(const uint8_t *rgb, int nx, int ny, unsigned char **png, size_t *n,
                                             dif_error *err);

/* The same for grey values of 16 bits. */
DIF_MUST_USE dif_status dif_image_encode_grey(const uint16_t *value, int nx, int ny, unsigned char **png, size_t *n,
                                              dif_error *err);

/* Area-averaging reduction of a float image src[ny*nx] to dst[my*mx] (mx <= nx, my <= ny); linear if larger. */
DIF_MUST_USE dif_status dif_image_resize(const float *src, int nx, int ny, float *dst, int mx, int my, dif_error *err);

/* Something drawn on a picture, smooth at its edges. Centres of pixels are whole numbers, y runs down. */
typedef enum dif_mark_kind { DIF_MARK_LINE, DIF_MARK_CIRCLE, DIF_MARK_TEXT } dif_mark_kind;

typedef struct dif_mark {
    dif_mark_kind kind;
    double x, y;               /* a line's beginning, a circle's centre, the place of a text            */
    double x1, y1;             /* line: its end                                                         */
    double size;               /* circle: radius; text: height of a capital; > 0                        */
    double anchor_x, anchor_y; /* text: share of it that lies left of and above its place, 0 ... 1      */
    double width_max;          /* text: shrinks to this width; 0 = any                                  */
    int stroke;                /* pixels, >= 1                                                          */
    uint8_t rgb[3];
    bool halo;        /* a dark rim, for light marks on a light ground                         */
    const char *text; /* ASCII, and the degree sign in UTF-8                                   */
} dif_mark;

/* Draws n marks on rgb[ny*nx*3]; what lies outside is cut off. Status DIF_ERR_ARG, DIF_ERR_FOREIGN, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_image_draw(uint8_t *rgb, int nx, int ny, int n, const dif_mark *mark, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
