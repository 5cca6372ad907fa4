/* The measurement: a heightfield, a plan and a tolerance in; a response table and what it cost out.
 * Does not: open files, print. */
#ifndef DIF_MEASURE_H
#define DIF_MEASURE_H

#include <stdbool.h>

#include "core/brdf.h"
#include "core/field.h"
#include "core/plan.h"
#include "core/shadow.h"
#include "core/window.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_method {
    DIF_METHOD_SHEET,
    DIF_METHOD_TAYLOR,
    DIF_METHOD_DIRECT,
    DIF_METHOD_THESIS, /* core/thesis.h: the source's program            */
    DIF_METHOD_NMM,    /* core/nmm.h: few wavelengths                    */
    DIF_METHOD_PQ,     /* core/replica.h: one period patch, replicated   */
    DIF_METHOD_STAM    /* core/stam.h: periodic bumps in closed form     */
} dif_method;

/* "sheet", "taylor", "direct", "thesis", "nmm", "pq", "stam". */
const char *dif_method_name(dif_method method);
bool dif_method_from_name(const char *name, dif_method *out);

/* What a method leaves out, one sentence; empty for those that are exact to tol. */
const char *dif_method_leaves_out(dif_method method);

#define DIF_REPLICAS_FROM_WINDOW (-1)

typedef struct dif_measure_opts {
    dif_method method;
    int n_terms; /* taylor: fixed number of terms, or DIF_TERMS_FROM_TOL */
    dif_window_kind window;
    double sigma_um;
    dif_average average;
    dif_quantity quantity;
    dif_index index;
    const dif_shadow *shadow; /* S in rho and brdf, prepared for this surface; NULL = 1. Borrowed. Not with thesis */
    bool single;              /* taylor, thesis: sums in float whatever tol says, to show where that breaks           */
    int thesis_terms;         /* thesis: terms of the series, 1 ... DIF_THESIS_TERMS_MAX                            */

    /* pq, stam, nmm with lines: the period along the groove normal psi, and across it or NaN. A patch is cut from the
     * middle of the surface along that one of x and y which is nearer to the normal, where the period is
     * period / |cos psi| (or / |sin psi|); across it the patch keeps the surface's extent unless period_across_um says
     * otherwise (then psi must be a multiple of 90 degrees). */
    double period_um, period_across_um, psi_rad;
    int n_replica, n_replica_across; /* pq: 1 ... DIF_REPLICA_MAX, or DIF_REPLICAS_FROM_WINDOW: as many as fill
                                        4 sigma (a flat window: the surface). They take the window's place            */
    bool nmm_jacobian;               /* nmm: false = the source's version, which turned its pictures purple           */
    bool nmm_lines; /* nmm: the surface is exactly periodic; bins are the orders of period_um         */
    int nmm_fixed;  /* nmm: fixed wavelengths where fewer bins are seen, 1 ... DIF_NMM_FIXED_MAX      */

    int n_thread;                               /* 0 = all */
    void (*progress)(void *self, double share); /* may be NULL; called from the calling thread */
    void *progress_self;
} dif_measure_opts;

/* sheet, Gaussian of DIF_SIGMA_DEFAULT_UM, average none, rho, n = 1.5, no shadowing, all threads; DIF_THESIS_TERMS terms, no period,
 * replicas from the window, nmm with its Jacobian, over the patch's extent, 16 fixed wavelengths. */
dif_measure_opts dif_measure_opts_default(void);

/* What a measurement cost and reached. */
typedef struct dif_measure_stats {
    double bound;                     /* of |amplitude error| / sum W; NaN: no bound              */
    double build_wall_s, build_cpu_s; /* planes and transforms                      */
    double eval_wall_s, eval_cpu_s;   /* samples                                    */
    int n_window;                     /* windows averaged                                         */
    int n_plane, n_tap;               /* of the (last) sheet; 0 for direct                        */
    size_t n_sample;                  /* samples evaluated                                        */
    bool single;                      /* stored in float                                          */
    double area_um2;                  /* effective area (T^2 sum W)^2/(T^2 sum W^2)               */
    int n_replica_x, n_replica_y;     /* pq: replicas used, else 0                                */
} dif_measure_stats;

/* Measures an in-plane table.
 *
 * Methods  sheet, taylor and direct are exact to tol. pq is exact to tol for the surface that its replicas make, which
 *          ignores `window` and `average`. nmm gives each cell the power at the wavelength that stands for it, thesis
 *          and stam ignore tol, `window` (but sigma) and `average`; for thesis rho is the power (gain 1) and there is no
 *          brdf. These three have no bound.
 * Given     tol  wanted |amplitude error| / sum W, 1e-14 <= tol < 1
 *           opts NULL = defaults, here and below
 *           stats may be NULL
 * Status    DIF_ERR_ARG, DIF_ERR_TOL, DIF_ERR_SIZE, DIF_ERR_NOMEM, DIF_ERR_FOREIGN, DIF_ERR_UNSUPPORTED (brdf or
 *           shadowing by thesis, two periods off the axes); *out zeroed on failure
 * Owns      the caller frees *out with dif_table_free */
DIF_MUST_USE dif_status dif_measure_table(const dif_field *field, const dif_plan *plan, double tol,
                                          const dif_measure_opts *opts, dif_table *out, dif_measure_stats *stats,
                                          dif_error *err);

/* One measured query. */
typedef struct dif_sample {
    double power, rho, brdf_per_sr; /* thesis: rho = power, no brdf (NaN)                              */
    double amp_re, amp_im;          /* P / sum W, NaN if several windows were averaged, and for stam   */
} dif_sample;

/* Measures arbitrary directions: out[n]. Status as dif_measure_table. */
DIF_MUST_USE dif_status dif_measure_queries(const dif_field *field, size_t n, const dif_query *query, double tol,
                                            const dif_measure_opts *opts, dif_sample *out, dif_measure_stats *stats,
                                            dif_error *err);

/* Colours of a plan's angles: XYZ of the quantity under D65 (core/spectrum.h), xyz[n_angle][3]. Full sampling of the
 * plan's wavelengths (ascending), which are few or many as the plan says; nmm takes its own over 380 ... 780 nm. Status as
 * dif_measure_table. */
DIF_MUST_USE dif_status dif_measure_colours(const dif_field *field, const dif_plan *plan, double tol,
                                            const dif_measure_opts *opts, double (*xyz)[3], dif_measure_stats *stats,
                                            dif_error *err);

/* Sets period_um and psi_rad of options from a harmonic fit of the heights (bench/fit.h), the means of pq and stam to
 * find them by themselves. Status of dif_fit_surface; DIF_ERR_ARG if opts is NULL. */
DIF_MUST_USE dif_status dif_measure_find_period(const dif_field *field, dif_measure_opts *opts, dif_error *err);

/* The period patch that pq replicates and how often, as dif_measure_table makes it.
 * Heights are interpolated linearly to a whole number of samples a period.
 * Status    DIF_ERR_ARG: no period, one not > 0, larger than the patch or below two samples; bad replica counts;
 *           DIF_ERR_UNSUPPORTED, DIF_ERR_NOMEM; *cell zeroed on failure
 * Owns      the caller frees *cell with dif_field_free */
struct dif_replica;
DIF_MUST_USE dif_status dif_measure_cell(const dif_field *field, const dif_measure_opts *opts, dif_field *cell,
                                         struct dif_replica *replica, dif_error *err);

/* Largest error of a table against the direct sum on a random subset. */
typedef struct dif_measure_check {
    int n_sample;
    double worst_amplitude;                  /* largest | |P| - |P_direct| | / sum W                      */
    double worst_angle_deg, worst_lambda_nm; /* where                                         */
    double worst_value, worst_direct;        /* both values, in the table's quantity          */
    double direct_s_per_sample;              /* wall seconds the direct sum took per sample               */
} dif_measure_check;

/* Compares n random cells (seeded) of a measured table with the direct sum: of the surface, whatever the method. */
DIF_MUST_USE dif_status dif_measure_check_table(const dif_field *field, const dif_table *table,
                                                const dif_measure_opts *opts, int n, unsigned seed,
                                                dif_measure_check *out, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
