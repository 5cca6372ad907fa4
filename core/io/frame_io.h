/* Rendered frames as files: EXR for numbers, PNG to look at, contact sheets of several; base colour pictures in.
 * Does not: render. */
#ifndef DIF_FRAME_IO_H
#define DIF_FRAME_IO_H

#include <stdint.h>

#include "core/colour.h"
#include "core/io/manifest.h"
#include "core/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a frame is shown: exposure * light + base, covered pixels over a ground of linear grey. */
typedef struct dif_frame_look {
    double exposure; /* > 0 */
    dif_gamut gamut;
    double ground; /* linear, [0, 1] */
} dif_frame_look;

/* Exposure 1, desaturate, ground 0.01. */
dif_frame_look dif_frame_look_default(void);

/* Writes an EXR, whole or not at all: linear R, G, B (exposure * light + base, not clipped, nothing where the mesh is not)
 * and A, the coverage; the manifest as attributes "diffbench.KEY". Status DIF_ERR_IO, DIF_ERR_FOREIGN, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_frame_write(const char *path, const dif_frame *frame, const dif_frame_look *look,
                                        const dif_manifest *manifest, dif_error *err);

/* The same, encoded: rgb[ny*nx*3]. */
void dif_frame_paint(const dif_frame *frame, const dif_frame_look *look, uint8_t *rgb);

/* A PNG, the manifest in its texts. Status DIF_ERR_IO, DIF_ERR_FOREIGN, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_frame_write_png(const char *path, const dif_frame *frame, const dif_frame_look *look,
                                            const dif_manifest *manifest, dif_error *err);

/* A picture of a contact sheet. */
typedef struct dif_sheet_cell {
    const dif_frame *frame; /* all of one size                  */
    double exposure;
    const char *label, *note; /* two lines under it, ASCII; may be NULL */
} dif_sheet_cell;

/* Cells in rows of n_column, labelled, as a PNG. Status as above. */
DIF_MUST_USE dif_status dif_frame_write_sheet(const char *path, int n_cell, const dif_sheet_cell *cell, int n_column,
                                              const dif_frame_look *look, const dif_manifest *manifest, dif_error *err);

/* Reads a picture (PNG, TIFF, BMP; grey or colour) as linear sRGB.
 * Status DIF_ERR_IO, DIF_ERR_FORMAT, DIF_ERR_SIZE, DIF_ERR_NOMEM. The caller frees with dif_texture_free. */
DIF_MUST_USE dif_status dif_texture_load(const char *path, dif_texture *out, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
