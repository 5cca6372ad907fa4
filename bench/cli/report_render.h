/* The rendering of a report's surface on the coiled snake: by the integrated table, on the CPU.
 * Does not: write the page. */
#ifndef DIF_REPORT_RENDER_H
#define DIF_REPORT_RENDER_H

#include <jansson.h>

#include "core/shade.h"

struct dif_report_job;

/* frame.nx 0 = not rendered. */
typedef struct dif_report_render_data {
    dif_frame frame; /* owned */
    int n_map, n_window;
    double exposure, tail;
} dif_report_render_data;

/* Status as dif_lut_measure, dif_shade_draw; *out zeroed on failure. */
DIF_MUST_USE dif_status dif_report_render_make(const struct dif_report_job *job, dif_report_render_data *out,
                                               dif_error *err);
void dif_report_render_free(dif_report_render_data *render); /* accepts a zeroed struct */

/* FOLDER/SLUG.render.png. */
DIF_MUST_USE dif_status dif_report_render_write(const char *folder, const struct dif_report_job *job,
                                                const dif_report_render_data *render, dif_error *err);

/* NULL = out of memory. */
json_t *dif_report_render_json(const struct dif_report_job *job, const dif_report_render_data *render);

#endif
