/* What the headers of PNG, TIFF and BMP say, and whether the file is whole: looked at before a decoder allocates.
 * Internal to core/io. Does not: decode pixels. Messages carry no file name. */
#ifndef DIF_IMAGE_HEAD_H
#define DIF_IMAGE_HEAD_H

#include <stdbool.h>
#include <stddef.h>

#include "core/io/manifest.h"

typedef struct dif_image_head {
    long long nx, ny;
    char format[8]; /* "png", "tiff", "bmp" */
} dif_image_head;

/* True for the magic bytes of one of the three. */
bool dif_image_is(const unsigned char *data, size_t n);

/* Status DIF_ERR_FORMAT (truncated, broken), DIF_ERR_UNSUPPORTED (a kind that holds no plain grey heights). */
DIF_MUST_USE dif_status dif_image_head_read(const unsigned char *data, size_t n, dif_image_head *out, dif_error *err);

/* The text of a PNG's tEXt chunk with this key (checked file); copies at most size - 1 bytes. False if there is none. */
bool dif_png_text(const unsigned char *data, size_t n, const char *key, char *text, size_t size);

/* Puts texts "diffbench.KEY" (iTXt) and the mark of sRGB into a PNG that dif_image_encode_png made; *png is replaced.
 * Status DIF_ERR_NOMEM, *png and *n as they were then. */
DIF_MUST_USE dif_status dif_png_add_texts(const dif_manifest *manifest, unsigned char **png, size_t *n, dif_error *err);

/* A text of a PNG: keyword (1 to 79 bytes) and text, both Latin-1. */
typedef struct dif_png_key {
    const char *key, *text;
} dif_png_key;

/* Puts texts (tEXt) and, if it is not NULL, a manifest (iTXt) into such a PNG. Status DIF_ERR_NOMEM, as before. */
DIF_MUST_USE dif_status dif_png_add_keys(int n_key, const dif_png_key *key, const dif_manifest *manifest,
                                         unsigned char **png, size_t *n, dif_error *err);

/* The two parts, by format (image_tiff.c). */
DIF_MUST_USE dif_status dif_tiff_head_read(const unsigned char *data, size_t n, dif_image_head *out, dif_error *err);

#endif
