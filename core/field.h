/* A heightfield: samples on a regular grid, their pitch, lifetime and statistics.
 * Frame and layout: core/conventions.h.
 * Does not: read or write files (core/io/field_io.h), level or repair. */
#ifndef DIF_FIELD_H
#define DIF_FIELD_H

#include <stddef.h>

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_FIELD_SIDE_MAX = 32768 }; /* largest nx or ny accepted from outside */

typedef struct dif_field {
    int nx, ny;                    /* samples along x and y, >= 1           */
    double pitch_x_um, pitch_y_um; /* distance of neighbours, > 0, finite   */
    double *z_um;                  /* heights z_um[ny*nx], owned, finite    */
} dif_field;

typedef struct dif_field_stats {
    double min_um, max_um, mean_um, rms_um; /* rms about the mean                                   */
    double slope_x_rms, slope_y_rms;        /* of central differences, ratios                       */
    double slope_max;                       /* largest |gradient|, ratio                            */
    double step_um;                         /* smallest difference of distinct heights (quantisation),
                                               0 if more than 65536 distinct values                 */
} dif_field_stats;

/* A field of zero heights.
 * Given     nx, ny in [1, DIF_FIELD_SIDE_MAX]; pitches > 0 and finite
 * Status    DIF_ERR_ARG, DIF_ERR_SIZE, DIF_ERR_NOMEM; on failure *out is zeroed
 * Owns      the caller frees with dif_field_free */
DIF_MUST_USE dif_status dif_field_create(int nx, int ny, double pitch_x_um, double pitch_y_um, dif_field *out,
                                         dif_error *err);

/* Gives the samples back and zeroes the struct; accepts NULL and a zeroed struct. */
void dif_field_free(dif_field *field);

/* DIF_OK if sizes, pitches and every height are usable; DIF_ERR_ARG or DIF_ERR_NONFINITE (with the place) otherwise. */
DIF_MUST_USE dif_status dif_field_check(const dif_field *field, dif_error *err);

/* Statistics of a valid field. Status DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_field_stats_of(const dif_field *field, dif_field_stats *out, dif_error *err);

/* Positions of sample ix or iy, see core/conventions.h. */
static inline double dif_field_x_um(const dif_field *field, int ix)
{
    return (ix - 0.5 * (field->nx - 1)) * field->pitch_x_um;
}

static inline double dif_field_y_um(const dif_field *field, int iy)
{
    return (0.5 * (field->ny - 1) - iy) * field->pitch_y_um;
}

static inline size_t dif_field_n(const dif_field *field)
{
    return (size_t)field->nx * (size_t)field->ny;
}

#ifdef __cplusplus
}
#endif
#endif
