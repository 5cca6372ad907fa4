/* The slopes' part of a report: what is seen of them along the plan's fixed direction, the normals' masking, and a
 * distant false-colour view.
 * Does not: write the page (reports/page_slopes.c). */
#ifndef DIF_REPORT_SLOPES_H
#define DIF_REPORT_SLOPES_H

#include <jansson.h>

#include "bench/cli/slopes_figure.h"
#include "bench/cli/view_figure.h"

struct dif_report_job;

/* slopes.square.n 0 = not measured. */
typedef struct dif_report_slopes_data {
    dif_slopes slopes; /* owned, as the others                                        */
    dif_ndf ndf;
    float *masking;     /* [ndf.n^2]                                                  */
    double smith_worst; /* largest difference of the two maskings up to 85 degrees; known once it is written */
    dif_view_set view;
    double zoom;
} dif_report_slopes_data;

/* Status as dif_slopes_of_field, dif_view_make; *out zeroed on failure. */
DIF_MUST_USE dif_status dif_report_slopes_make(const struct dif_report_job *job, dif_report_slopes_data *out,
                                               dif_error *err);
void dif_report_slopes_free(dif_report_slopes_data *slopes); /* accepts a zeroed struct */

/* FOLDER/SLUG.slopes.png, .normals.png and .view.png. */
DIF_MUST_USE dif_status dif_report_slopes_write(const char *folder, const struct dif_report_job *job,
                                                dif_report_slopes_data *slopes, dif_error *err);

/* NULL = out of memory. */
json_t *dif_report_slopes_json(const struct dif_report_job *job, const dif_report_slopes_data *slopes);

#endif
