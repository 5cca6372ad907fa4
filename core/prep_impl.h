/* Shared by the files of prep. Not installed. */
#ifndef DIF_PREP_IMPL_H
#define DIF_PREP_IMPL_H

#include <math.h>

#include "core/prep.h"

/* Shape and pitches, as dif_field_check, but heights may be missing. */
dif_status dif_prep_check(const dif_field *field, dif_error *err);

/* The same, and no height is missing. `what` needs them. */
dif_status dif_prep_check_whole(const dif_field *field, const char *what, dif_error *err);

/* Median of v[n], which it reorders; NaN for n = 0. */
double dif_prep_median(double *v, size_t n);

/* Puts a new field in the place of the old one. */
void dif_prep_replace(dif_field *field, dif_field *by);

/* Whole pieces of a length in an extent; one that is full but for rounding counts. */
static inline int dif_prep_samples_in(double extent_um, double length_um)
{
    return (int)fmin(floor(extent_um / length_um * (1.0 + 1e-9)), 1e9);
}

/* A grid to read a field on: its centre at (x_um, y_um) of the field's frame, its x axis turned by angle_rad. */
typedef struct dif_prep_grid {
    int nx, ny;
    double pitch_x_um, pitch_y_um;
    double x_um, y_um, angle_rad;
} dif_prep_grid;

/* Reads the field on a grid by quintic splines and replaces it. The field is whole. */
dif_status dif_prep_regrid(dif_field *field, const dif_prep_grid *grid, dif_error *err);

#endif
