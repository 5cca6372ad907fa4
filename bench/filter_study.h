/* Filters of a rendering against many samples a pixel: colour differences and what they cost.
 * Does not: open files, draw. */
#ifndef DIF_FILTER_STUDY_H
#define DIF_FILTER_STUDY_H

#include "core/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How two frames differ, at one exposure, where both see the mesh in the whole pixel. */
typedef struct dif_frame_difference {
    int n;                           /* pixels compared */
    double median, mean, p95, worst; /* CIEDE2000 of what is shown                                     */
    double light_ratio;              /* light of a over light of b, luminance, before exposure and clipping     */
    double blurred_mean;             /* the same after a blur by one pixel, as an eye would at a distance */
} dif_frame_difference;

/* Compares frames of one size as they are shown (exposed, brought into the gamut).
 *
 * Gives     map[ny*nx] (may be NULL): CIEDE2000 after the blur, 0 where nothing is compared
 * Status    DIF_ERR_ARG (sizes differ), DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_frame_differ(const dif_frame *a, const dif_frame *b, double exposure, float *map,
                                         dif_frame_difference *out, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
