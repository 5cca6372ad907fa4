/* The measurement: a heightfield, a plan and a tolerance in; a response table and what it cost out.
 * Does not: open files, print. */
#ifndef DIF_MEASURE_H
#define DIF_MEASURE_H

#include <stdbool.h>

#include "core/brdf.h"
#include "core/field.h"
#include "core/plan.h"
#include "core/window.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_method { DIF_METHOD_SHEET, DIF_METHOD_TAYLOR, DIF_METHOD_DIRECT } dif_method;

/* "sheet", "taylor", "direct". */
const char *dif_method_name(dif_method method);
bool dif_method_from_name(const char *name, dif_method *out);

typedef struct dif_measure_opts {
    dif_method method;
    int n_terms; /* taylor: fixed number of terms, or DIF_TERMS_FROM_TOL */
    dif_window_kind window;
    double sigma_um;
    dif_average average;
    dif_quantity quantity;
    dif_index index;
    int n_thread;                               /* 0 = all */
    void (*progress)(void *self, double share); /* may be NULL; called from the calling thread */
    void *progress_self;
} dif_measure_opts;

/* sheet, Gaussian of DIF_SIGMA_DEFAULT_UM, average none, rho, n = 1.5, all threads. */
dif_measure_opts dif_measure_opts_default(void);

/* What a measurement cost and reached. */
typedef struct dif_measure_stats {
    double bound;                     /* of |amplitude error| / sum W                             */
    double build_wall_s, build_cpu_s; /* planes and transforms                      */
    double eval_wall_s, eval_cpu_s;   /* samples                                    */
    int n_window;                     /* windows averaged                                         */
    int n_plane, n_tap;               /* of the (last) sheet; 0 for direct                        */
    size_t n_sample;                  /* samples evaluated                                        */
    bool single;                      /* stored in float                                          */
    double area_um2;                  /* effective area (T^2 sum W)^2/(T^2 sum W^2)               */
} dif_measure_stats;

/* Measures an in-plane table.
 *
 * Given     tol  wanted |amplitude error| / sum W, 1e-14 <= tol < 1
 * Status    DIF_ERR_ARG, DIF_ERR_TOL, DIF_ERR_SIZE, DIF_ERR_NOMEM, DIF_ERR_FOREIGN; *out zeroed on failure
 * Owns      the caller frees *out with dif_table_free */
DIF_MUST_USE dif_status dif_measure_table(const dif_field *field, const dif_plan *plan, double tol,
                                          const dif_measure_opts *opts, dif_table *out, dif_measure_stats *stats,
                                          dif_error *err);

/* One measured query. */
typedef struct dif_sample {
    double power, rho, brdf_per_sr;
    double amp_re, amp_im; /* P / sum W, NaN if several windows were averaged */
} dif_sample;

/* Measures arbitrary directions: out[n]. Status as dif_measure_table. */
DIF_MUST_USE dif_status dif_measure_queries(const dif_field *field, size_t n, const dif_query *query, double tol,
                                            const dif_measure_opts *opts, dif_sample *out, dif_measure_stats *stats,
                                            dif_error *err);

/* Largest error of a table against the direct sum on a random subset. */
typedef struct dif_measure_check {
    int n_sample;
    double worst_amplitude;                  /* largest | |P| - |P_direct| | / sum W                      */
    double worst_angle_deg, worst_lambda_nm; /* where                                         */
    double worst_value, worst_direct;        /* both values, in the table's quantity          */
    double direct_s_per_sample;              /* wall seconds the direct sum took per sample               */
} dif_measure_check;

/* Compares n random cells (seeded) of a measured table with the direct sum. */
DIF_MUST_USE dif_status dif_measure_check_table(const dif_field *field, const dif_table *table,
                                                const dif_measure_opts *opts, int n, unsigned seed,
                                                dif_measure_check *out, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
