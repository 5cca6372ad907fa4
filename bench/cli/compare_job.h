/* The CPU/GPU comparison as result files: device, cases, limits, pictures, and an earlier run beside this one.
 * Layout of the files: reports/compare.h.
 * Does not: compare (bench/regress_run.h), write the page. */
#ifndef DIF_COMPARE_JOB_H
#define DIF_COMPARE_JOB_H

#include <jansson.h>

#include "bench/regress_limits.h"
#include "core/io/manifest.h"
#include "gpu/gpu.h"

/* The device under test: a GPU, or with gpu NULL the reference itself with coarser sheets. */
typedef struct dif_compare_device {
    dif_gpu *gpu; /* owned */
    dif_gpu_fault fault;
    bool half;
    int n_path, path[2]; /* of dif_gpu_path */
    const char *name[2];
} dif_compare_device;

/* Opens the GPU. Status as dif_gpu_open. */
DIF_MUST_USE dif_status dif_compare_device_open(bool require_hardware, dif_compare_device *device, dif_error *err);
void dif_compare_device_close(dif_compare_device *device);

/* What bench/regress_run.h takes; borrows *device. */
dif_regress_device dif_compare_device_of(dif_compare_device *device);
json_t *dif_compare_device_json(const dif_compare_device *device);

/* Adds renderer, driver and version to a manifest. */
DIF_MUST_USE dif_status dif_compare_device_describe(const dif_compare_device *device, dif_manifest *manifest,
                                                    dif_error *err);

/* Limits: the built-in ones and behind them those of a file. */
typedef struct dif_compare_limits {
    int n;
    dif_regress_limit *limit; /* owned */
} dif_compare_limits;

/* path NULL = the built-in ones. Status DIF_ERR_IO, DIF_ERR_FORMAT (with the row and what was wrong), DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_compare_limits_load(const char *path, dif_compare_limits *out, dif_error *err);
void dif_compare_limits_free(dif_compare_limits *limits);

/* The same as the file has it. NULL = out of memory. */
json_t *dif_compare_limits_json(const dif_compare_limits *limits);

/* One case; *pass says whether it keeps its limits. With timings unless SOURCE_DATE_EPOCH is set. NULL = out of memory. */
json_t *dif_compare_case_json(const dif_regress_plan *plan, const dif_compare_limits *limits,
                              const dif_regress_case *result, bool *pass);

/* Writes a case's three pictures (device, reference, difference) into the folder and names them in its JSON.
 * Status DIF_ERR_IO, DIF_ERR_NOMEM, DIF_ERR_FOREIGN */
DIF_MUST_USE dif_status dif_compare_pictures(const char *folder, const char *slug, const dif_regress_plan *plan,
                                             const dif_regress_case *result, const double *device,
                                             const double *reference, json_t *json, dif_error *err);

/* An earlier run's document (compare.json) beside this one's surfaces: what moved by more than `factor`.
 * *n_worse counts numbers that grew, verdicts that turned, and cases that are gone.
 * Status    DIF_ERR_IO, DIF_ERR_FORMAT, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_compare_baseline(const char *path, const json_t *surfaces, double factor, json_t **out,
                                             int *n_worse, dif_error *err);

#endif
