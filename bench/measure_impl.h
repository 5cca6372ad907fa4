/* What table and query measurements share: clocks, windows, checks. Not installed. */
#ifndef DIF_MEASURE_IMPL_H
#define DIF_MEASURE_IMPL_H

#include "bench/measure.h"
#include "core/sheet.h"

/* Double rounding of a direct sum's phases (up to a few thousand radians). */
#define DIF_DIRECT_BOUND 1e-12

/* Wall and processor time, both in seconds. */
typedef struct dif_stopwatch {
    double wall_s, cpu_s;
} dif_stopwatch;

dif_stopwatch dif_stopwatch_start(void);

/* Adds the time since *since to the two sums and restarts. */
void dif_stopwatch_lap(dif_stopwatch *since, double *wall_s, double *cpu_s);

/* The windows of a measurement, and the share that each has in the average. */
typedef struct dif_window_set {
    int n;
    dif_window *window;
    double *share;   /* (sum W_s)^2 / sum_s (sum W_s)^2                                      */
    double area_um2; /* T^2 sum_s (sum W_s)^2 / sum_s sum W_s^2                              */
} dif_window_set;

DIF_MUST_USE dif_status dif_window_set_make(const dif_field *field, const dif_measure_opts *opts, dif_window_set *set,
                                            dif_error *err);
void dif_window_set_free(dif_window_set *set);

/* Field, tolerance and options. */
DIF_MUST_USE dif_status dif_measure_check_opts(const dif_field *field, double tol, const dif_measure_opts *opts,
                                               dif_error *err);

dif_sheet_opts dif_measure_sheet_opts(const dif_measure_opts *opts);

/* Records what a sheet reached. */
void dif_measure_note_sheet(dif_measure_stats *stats, const dif_sheet *sheet);

/* kappa = k (u, v, w) of a query. */
dif_vec3 dif_measure_kappa(const dif_query *query);

/* Sets the number of threads of this call; returns the number to restore. */
int dif_measure_threads(const dif_measure_opts *opts);

void dif_measure_progress(const dif_measure_opts *opts, double share);

#endif
