/* Pictures of several panels side by side, each a function of two variables in false colour with axes, ellipses and a
 * few words, as PNG.
 * Does not: compute what the panels show. */
#ifndef DIF_PANEL_PICTURE_H
#define DIF_PANEL_PICTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/io/manifest.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_PANEL_ELLIPSE_MAX = 4, DIF_PANEL_TEXT = 96 };

typedef struct dif_panel {
    int nx, ny;
    const float *value;  /* value[ny * nx], row 0 on top, NaN = nothing there; or NULL with rgb. Borrowed    */
    const uint8_t *rgb;  /* rgb[ny * nx * 3] as it is, or NULL. Borrowed                                     */
    double low, high;    /* ends of the colour scale                                                         */
    bool is_log;         /* decades below high are shown down to low > 0                                     */
    double x_min, x_max; /* of the axes; equal: no axes                                                      */
    double y_min, y_max;
    const char *title;            /* above it                                                                         */
    char note[2][DIF_PANEL_TEXT]; /* two lines below it, may be empty                                         */
    int n_ellipse;
    double ellipse[DIF_PANEL_ELLIPSE_MAX][5]; /* middle x, y and variances xx, yy, covariance xy of each       */
} dif_panel;

typedef struct dif_panel_sheet {
    int n_panel, n_column;
    const dif_panel *panel; /* panel[n_panel], row after row                         */
    const char *heading;    /* above all, may be NULL                                */
    const char *colour_map; /* of values: "viridis", "inferno", ...                  */
    int side;               /* pixels of the longer side of a panel, 64 ... 4096     */
} dif_panel_sheet;

/* Draws the sheet. Values are shown as blocks, pictures enlarged by whole numbers if they fit.
 *
 * Gives     rgb[*ny * *nx * 3], freed with dif_release
 * Status    DIF_ERR_ARG, DIF_ERR_FOREIGN, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_panel_draw(const dif_panel_sheet *sheet, uint8_t **rgb, int *nx, int *ny, dif_error *err);

/* The same as a PNG, whole or not at all, with the manifest in its texts. Status also DIF_ERR_IO. */
DIF_MUST_USE dif_status dif_panel_write_png(const char *path, const dif_panel_sheet *sheet,
                                            const dif_manifest *manifest, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
