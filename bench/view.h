/* False-colour views of a heightfield from any distance: colour by height, filtered over each pixel's footprint; and the
 * same without filtering, with plain mip-mapping, and supersampled as the truth.
 * Does not: light, perspective, files. */
#ifndef DIF_VIEW_H
#define DIF_VIEW_H

#include <stdint.h>

#include "core/pyramid.h"
#include "core/transfer.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_view_filter {
    DIF_VIEW_POINT,    /* the colour of the height at the pixel's middle: aliases                               */
    DIF_VIEW_MEAN,     /* the colour of the mean height, as a mip-mapped height does: loses what colours scatter */
    DIF_VIEW_FILTERED, /* the mean colour of a Gaussian of heights with the footprint's mean and variance        */
    DIF_VIEW_TRUTH     /* the mean of the colours at n_sample x n_sample jittered places                         */
} dif_view_filter;
enum { DIF_VIEW_FILTERS = 4 };

/* Orthographic view; the viewer stands at azimuth phi, so that the picture's up is the other way. */
typedef struct dif_view_plan {
    double zoom;      /* pixels per sample along x, seen from above: below 1 is far away, > 0             */
    double theta_rad; /* 0 ... 89 degrees                                                                 */
    double phi_rad;   /* 3 pi / 2 shows x to the right, y up                                              */
    int n_across;     /* places read across a footprint, 2 ... 16                                         */
    int n_sample;     /* truth: samples on a side of the pixel, 1 ... 256                                 */
    unsigned seed;
} dif_view_plan;

/* zoom 1, from above with y up, 8 places across, 32 samples. */
dif_view_plan dif_view_plan_default(void);

enum { DIF_VIEW_SIDE_MAX = 8192 };

typedef struct dif_view {
    int nx, ny;
    float *rgb;      /* rgb[ny * nx][3], linear light, row 0 on top; white beside the surface; owned      */
    uint8_t *inside; /* inside[ny * nx]: 0 beside the surface, 1 on it, 2 its whole footprint on it; owned */
    double n_read;   /* mean number of places read for a pixel on the surface                             */
} dif_view;

/* Makes a view of the heights in a pyramid, coloured by a table.
 *
 * Given     pitch_ratio  pitch_y / pitch_x of the samples
 * Status    DIF_ERR_ARG (plan), DIF_ERR_SIZE (a picture of more than DIF_VIEW_SIDE_MAX on a side), DIF_ERR_NOMEM; *out
 *           zeroed on failure
 * Owns      the caller frees with dif_view_free
 * Cost      filtered: n_across^2 reads a pixel, more where footprints are long; truth: n_sample^2 */
DIF_MUST_USE dif_status dif_view_make(const dif_pyramid *pyramid, double pitch_ratio, const dif_transfer *transfer,
                                      const dif_view_plan *plan, dif_view_filter filter, dif_view *out, dif_error *err);
void dif_view_free(dif_view *view); /* accepts a zeroed struct */

/* How far a view is from another one, over the pixels whose footprint lies on the surface. */
typedef struct dif_view_difference {
    size_t n;                                    /* pixels compared; 0: nothing below counts     */
    double de_mean, de_median, de_p95, de_worst; /* CIEDE2000                              */
    int worst_x, worst_y;
    double rms; /* of the linear channels */
} dif_view_difference;

/* Status DIF_ERR_ARG (sizes differ), DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_view_compare(const dif_view *view, const dif_view *truth, dif_view_difference *out,
                                         dif_error *err);

/* A colour map of core/io/image_cv.h as a table: decoded to linear light and blurred. Status as dif_image_colormap. */
DIF_MUST_USE dif_status dif_view_transfer(const char *colour_map, dif_transfer *out, dif_error *err);

/* Encoded sRGB of a view: bytes[ny * nx * 3]. */
void dif_view_encode(const dif_view *view, uint8_t *bytes);

#ifdef __cplusplus
}
#endif
#endif
