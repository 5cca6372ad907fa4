/* Views of a surface by several filters, their differences and pictures, for the verb and for reports.
 * Does not: read surfaces. */
#ifndef DIF_VIEW_FIGURE_H
#define DIF_VIEW_FIGURE_H

#include <jansson.h>

#include "bench/view.h"
#include "core/io/manifest.h"

#define DIF_VIEW_ALL ((1u << DIF_VIEW_FILTERS) - 1u)

typedef struct dif_view_set {
    double low_um, high_um;                         /* ends of the colour map: lowest and highest sample   */
    int n_sample;                                   /* of the truth, on a side of a pixel                  */
    dif_view view[DIF_VIEW_FILTERS];                /* by dif_view_filter; zeroed if not wanted; owned     */
    dif_view_difference difference[DIF_VIEW_TRUTH]; /* of each from the truth, if all are there           */
} dif_view_set;

/* Makes the views whose bits (1 << dif_view_filter) are set in `wanted`. Status as dif_view_make, dif_image_colormap. */
DIF_MUST_USE dif_status dif_view_set_make(const dif_field *field, const char *colour_map, const dif_view_plan *plan,
                                          unsigned wanted, dif_view_set *out, dif_error *err);
void dif_view_set_free(dif_view_set *set);

/* One view as it is. */
DIF_MUST_USE dif_status dif_view_write_png(const char *path, const dif_view *view, const dif_manifest *manifest,
                                           dif_error *err);

/* All four side by side, small ones enlarged, with their differences below. */
DIF_MUST_USE dif_status dif_view_set_write_png(const char *path, const dif_view_set *set, double zoom,
                                               const dif_manifest *manifest, dif_error *err);

json_t *dif_view_difference_json(const dif_view_set *set, int filter);

#endif
