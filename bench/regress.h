/* Two answers to the same questions held against each other: how far apart, and where. `a` is the one under test, `b` the
 * reference; every measure but the peaks is symmetric in them.
 * Does not: measure, judge (bench/regress_limits.h), open files. */
#ifndef DIF_REGRESS_H
#define DIF_REGRESS_H

#include "core/plan.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One measure over all places; where the worst lies, and both values there. */
typedef struct dif_regress_stat {
    double median, p95, p99, worst;
    size_t worst_at;
    double worst_a, worst_b;
} dif_regress_stat;

/* Numbers. Places where both are NaN count nowhere. */
typedef struct dif_regress {
    size_t n;                  /* places compared                                                        */
    size_t n_one_sided;        /* places where exactly one is finite: a failure whatever the rest says   */
    size_t one_sided_at;       /* the first of them                                                      */
    double maximum;            /* largest |value| of either side                                         */
    double floor;              /* of the relative error                                                  */
    dif_regress_stat relative; /* |a - b| / max(|a|, |b|, floor)                                         */
    dif_regress_stat absolute; /* |a - b|                                                                */
    dif_regress_stat of_max;   /* |a - b| / maximum                                                      */
} dif_regress;

/* Compares n numbers.
 *
 * Given     floor_share  of the maximum, below which a value counts as this share; in (0, 1]
 * Status    DIF_ERR_ARG: floor_share, or n = 0; DIF_ERR_NOMEM; *out zeroed on failure.  Cost O(n log n) */
DIF_MUST_USE dif_status dif_regress_values(size_t n, const double *a, const double *b, double floor_share,
                                           dif_regress *out, dif_error *err);

/* The same of two tables. Status also DIF_ERR_SIZE (another number of angles or wavelengths) and DIF_ERR_ARG (another
 * quantity, plane, or an axis that differs by more than 1e-9), each with the place. */
DIF_MUST_USE dif_status dif_regress_tables(const dif_table *a, const dif_table *b, double floor_share, dif_regress *out,
                                           dif_error *err);

/* CIEDE2000 of two colours, XYZ under D65, at an exposure; a pair brighter than white is dimmed to it, because nothing
 * shows it brighter. Numbers that are not finite on one side differ by infinity, on both sides by nothing. */
double dif_regress_difference(const double a[3], const double b[3], double exposure);

/* The same of n pairs; those that are NaN on both sides count nowhere.
 * Status    DIF_ERR_ARG (n = 0, exposure not > 0), DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_regress_colours(size_t n, double (*a)[3], double (*b)[3], double exposure,
                                            dif_regress_stat *de, dif_error *err);

/* Maxima of two tables: each of b's above a floor, and the nearest of a's at the same wavelength. */
typedef struct dif_regress_peaks {
    int n;                  /* of b                                                                     */
    int n_lost;             /* b's that have none in a within two steps of the axis                     */
    double worst_shift_rad; /* of the others                                                            */
    double lambda_um, angle_a_rad, angle_b_rad; /* where                                                */
} dif_regress_peaks;

/* Given     floor_share  of the largest value, below which maxima are left out, [0, 1).  Status DIF_ERR_ARG, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_regress_peaks_of(const dif_table *a, const dif_table *b, double floor_share,
                                             dif_regress_peaks *out, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
