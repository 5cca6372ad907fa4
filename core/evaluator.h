/* What the CPU and the GPU both do: read a model (core/model.h) at wanted directions. One interface, so that a comparison
 * asks both the same questions.
 * Does not: measure a surface (bench/measure.h builds sheets and picks methods). */
#ifndef DIF_EVALUATOR_H
#define DIF_EVALUATOR_H

#include "core/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where the time of a call went, wall seconds. On the CPU all of it is run_s. */
typedef struct dif_eval_cost {
    double upload_s;   /* model and queries to the device: what this call moved       */
    double run_s;      /* shaders, by timer query where the driver has one            */
    double download_s; /* results back                                                */
} dif_eval_cost;

/* An evaluator of one model. A function that the kind cannot answer returns DIF_ERR_UNSUPPORTED (values of a lut, tables
 * of another azimuth than a line sheet's). `cost` may be NULL. */
typedef struct dif_evaluator {
    const char *name; /* "cpu", or renderer and path of a GPU; lives as long as self */
    void *self;

    /* The model's quantity at n queries: value[n]. Wants volume sheets. */
    dif_status (*values)(void *self, size_t n, const dif_query *query, double *value, dif_eval_cost *cost,
                         dif_error *err);

    /* The model's quantity over a plan: value[n_lambda * n_angle], as dif_table. Lines or volumes. */
    dif_status (*table)(void *self, const dif_plan *plan, double *value, dif_eval_cost *cost, dif_error *err);

    /* XYZ under D65 (core/spectrum.h) of n direction pairs: xyz[n][3]. A map is this over dif_map_direction's pixels. */
    dif_status (*colours)(void *self, size_t n, const dif_vec3 *wi, const dif_vec3 *wo, double (*xyz)[3],
                          dif_eval_cost *cost, dif_error *err);

    void (*close)(void *self);
} dif_evaluator;

/* The reference: double precision, core/response.h. The model must outlive it.
 * Status DIF_ERR_ARG, DIF_ERR_UNSUPPORTED, DIF_ERR_NOMEM; *out zeroed on failure.  Owns: dif_evaluator_close */
DIF_MUST_USE dif_status dif_cpu_evaluator_open(const dif_model *model, dif_evaluator *out, dif_error *err);

/* Calls close and zeroes; accepts a zeroed one. */
void dif_evaluator_close(dif_evaluator *evaluator);

#ifdef __cplusplus
}
#endif
#endif
