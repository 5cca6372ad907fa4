/* Models (core/model.h) of a surface: the windows, sheets, period patch or integrated table that a kind needs.
 * Does not: evaluate them (core/evaluator.h). */
#ifndef DIF_MODEL_BUILD_H
#define DIF_MODEL_BUILD_H

#include "bench/measure.h"
#include "core/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A model and what it points to. */
typedef struct dif_model_built {
    dif_model model; /* points into `own`; stays valid when this struct is moved */
    double bound;    /* of |amplitude error| / sum W; NaN: no bound              */
    int n_window;
    struct dif_model_own *own; /* owned */
} dif_model_built;

/* Where a volume model will be read. */
typedef struct dif_model_reach {
    double s_max;        /* largest |(u, v)|, in (0, 2]          */
    double c_min, c_max; /* range of -w, 0 <= min <= max <= 2    */
} dif_model_reach;

/* Any two directions. */
dif_model_reach dif_model_reach_default(void);

/* One direction fixed, the other anywhere: what a map needs. */
dif_model_reach dif_model_reach_of_fixed(dif_vec3 fixed);

/* The model of a kind for the tables of one plan: line sheets.
 *
 * Given     tol  as for dif_measure_table;  opts  as there but for `method`, which the kind sets; NULL = defaults
 * Status    as dif_measure_table; DIF_ERR_UNSUPPORTED: a lut has no tables; *out zeroed on failure
 * Owns      the caller frees with dif_model_built_free; the field may go before, opts->shadow must stay */
DIF_MUST_USE dif_status dif_model_build_table(const dif_field *field, dif_model_kind kind, const dif_plan *plan,
                                              double tol, const dif_measure_opts *opts, dif_model_built *out,
                                              dif_error *err);

/* The model of a kind for values and colours in any direction within reach: volume sheets, or the integrated table.
 *
 * Given     lambda_um[n_lambda], ascending: the wavelengths that colours sum; values may be asked for between the first
 *           and the last. nmm has its own.
 *           tol   sheets: as for dif_measure_queries; lut: as dif_lut_create
 *           reach NULL = any;  opts NULL = defaults;  lut NULL = defaults */
DIF_MUST_USE dif_status dif_model_build_volume(const dif_field *field, dif_model_kind kind, int n_lambda,
                                               const double *lambda_um, const dif_model_reach *reach, double tol,
                                               const dif_measure_opts *opts, const dif_lut_opts *lut,
                                               dif_model_built *out, dif_error *err);

void dif_model_built_free(dif_model_built *built);

#ifdef __cplusplus
}
#endif
#endif
