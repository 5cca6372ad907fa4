/* What the benchmark programs share: repetitions, clocks, medians and the CSV line.
 * Does not: decide anything by time. */
#ifndef DIF_SPEED_H
#define DIF_SPEED_H

#include <stdbool.h>
#include <stddef.h>

#include "bench/measure.h"
#include "core/field.h"
#include "fixtures/surfaces.h"

enum { DIF_SPEED_REPS = 7 };

/* The seconds of the counted runs of one case. */
typedef struct dif_speed {
    double wall_s[DIF_SPEED_REPS], cpu_s[DIF_SPEED_REPS];
    double build_cpu_s[DIF_SPEED_REPS], eval_cpu_s[DIF_SPEED_REPS];
    int n;
} dif_speed;

/* Adds a run. */
void dif_speed_add(dif_speed *speed, const dif_measure_stats *stats);

/* Prints the header line, or one case: name,n,tol,err_reached,reps,min_s,median_s,per_s, then the processor seconds by
 * stage and how many times faster than the direct sum per sample (0 = not measured). */
void dif_speed_header(void);
void dif_speed_print(const dif_speed *speed, const char *name, size_t n, double tol, double err_reached,
                     double direct_s_per_sample);

/* A measured scan of the data folder, or its synthetic look-alike with a line on stderr. */
void dif_speed_surface(const char *file, double height_um, dif_surface_kind kind, int n_side, dif_field *out);

/* Ends the program with the message of a failed call. */
void dif_speed_must(dif_status status, const dif_error *err);

/* Peak resident memory of this process in MiB. */
double dif_speed_peak_mib(void);

#endif
