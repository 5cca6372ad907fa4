/* The report's comparison of GPU and CPU on a surface: every method, small sizes.
 * Does not: write the page. */
#ifndef DIF_REPORT_GPU_H
#define DIF_REPORT_GPU_H

#include <jansson.h>

#include "core/status.h"

struct dif_report_job;

/* json {"device", "verdict", "cases"}, or {"text": why there is none} where there is no GPU; NULL = not asked for. */
typedef struct dif_report_gpu_data {
    json_t *json; /* owned reference */
    int n, n_failed;
} dif_report_gpu_data;

/* A missing GPU is a result, not a failure. Status as dif_regress_run; *out zeroed on failure. */
DIF_MUST_USE dif_status dif_report_gpu_make(const struct dif_report_job *job, dif_report_gpu_data *out, dif_error *err);
void dif_report_gpu_free(dif_report_gpu_data *gpu); /* accepts a zeroed struct */

#endif
