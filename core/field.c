#include "core/field.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/alloc.h"

enum { DISTINCT_MAX = 65536, TABLE_BITS = 18, TABLE_SIZE = 1 << TABLE_BITS };

static dif_status check_shape(int nx, int ny, double pitch_x_um, double pitch_y_um, dif_error *err)
{
    if (!(nx >= 1 && ny >= 1))
        return dif_fail(err, DIF_ERR_ARG, "field of %d x %d samples, want at least 1 x 1", nx, ny);
    if (!(nx <= DIF_FIELD_SIDE_MAX && ny <= DIF_FIELD_SIDE_MAX))
        return dif_fail(err, DIF_ERR_SIZE, "field of %d x %d samples, want at most %d a side", nx, ny,
                        (int)DIF_FIELD_SIDE_MAX);
    if (!(pitch_x_um > 0.0 && isfinite(pitch_x_um)))
        return dif_fail(err, DIF_ERR_ARG, "pitch_x = %g um, want a finite number > 0", pitch_x_um);
    if (!(pitch_y_um > 0.0 && isfinite(pitch_y_um)))
        return dif_fail(err, DIF_ERR_ARG, "pitch_y = %g um, want a finite number > 0", pitch_y_um);
    return DIF_OK;
}

dif_status dif_field_create(int nx, int ny, double pitch_x_um, double pitch_y_um, dif_field *out, dif_error *err)
{
    *out = (dif_field){0};
    const dif_status status = check_shape(nx, ny, pitch_x_um, pitch_y_um, err);
    if (status)
        return status;
    double *z_um = dif_alloc((size_t)nx * (size_t)ny, sizeof *z_um);
    if (!z_um)
        return dif_fail(err, DIF_ERR_NOMEM, "field of %d x %d samples", nx, ny);
    *out = (dif_field){.nx = nx, .ny = ny, .pitch_x_um = pitch_x_um, .pitch_y_um = pitch_y_um, .z_um = z_um};
    return DIF_OK;
}

void dif_field_free(dif_field *field)
{
    if (!field)
        return;
    dif_release(field->z_um);
    *field = (dif_field){0};
}

dif_status dif_field_check(const dif_field *field, dif_error *err)
{
    const dif_status status = check_shape(field->nx, field->ny, field->pitch_x_um, field->pitch_y_um, err);
    if (status)
        return status;
    if (!field->z_um)
        return dif_fail(err, DIF_ERR_ARG, "field without heights");
    for (int iy = 0; iy < field->ny; iy++) {
        const double *row = field->z_um + (size_t)iy * (size_t)field->nx;
        for (int ix = 0; ix < field->nx; ix++) {
            if (!isfinite(row[ix]))
                return dif_fail(err, DIF_ERR_NONFINITE, "height at column %d, row %d is %g, want a finite number", ix,
                                iy, row[ix]);
        }
    }
    return DIF_OK;
}

/* Derivative along one axis at i: central inside, one-sided at the ends, 0 on a single sample. */
static double slope_at(const double *z, size_t stride, int i, int n, double pitch_um)
{
    const int lo = i > 0 ? i - 1 : i;
    const int hi = i < n - 1 ? i + 1 : i;
    if (lo == hi)
        return 0.0;
    return (z[(size_t)hi * stride] - z[(size_t)lo * stride]) / ((hi - lo) * pitch_um);
}

static void add_slopes(const dif_field *field, dif_field_stats *out)
{
    const size_t nx = (size_t)field->nx;
    double sum_x2 = 0.0, sum_y2 = 0.0, max2 = 0.0;
    for (int iy = 0; iy < field->ny; iy++) {
        for (int ix = 0; ix < field->nx; ix++) {
            const double sx = slope_at(field->z_um + (size_t)iy * nx, 1, ix, field->nx, field->pitch_x_um);
            const double sy = slope_at(field->z_um + ix, nx, iy, field->ny, field->pitch_y_um);
            sum_x2 += sx * sx;
            sum_y2 += sy * sy;
            max2 = fmax(max2, sx * sx + sy * sy);
        }
    }
    const double n = (double)dif_field_n(field);
    out->slope_x_rms = sqrt(sum_x2 / n);
    out->slope_y_rms = sqrt(sum_y2 / n);
    out->slope_max = sqrt(max2);
}

static void add_moments(const dif_field *field, dif_field_stats *out)
{
    const size_t n = dif_field_n(field);
    const double *z = field->z_um;
    double sum = 0.0, sum2 = 0.0;
    out->min_um = out->max_um = z[0];
    for (size_t i = 0; i < n; i++) {
        out->min_um = fmin(out->min_um, z[i]);
        out->max_um = fmax(out->max_um, z[i]);
        sum += z[i] - z[0]; /* about the first height, so that a large offset costs no digits */
    }
    const double mean = sum / (double)n;
    for (size_t i = 0; i < n; i++) {
        const double d = z[i] - z[0] - mean;
        sum2 += d * d;
    }
    out->mean_um = z[0] + mean;
    out->rms_um = sqrt(sum2 / (double)n);
}

/* Puts value into an open-addressed set (used[] marks taken slots); true if it was new. */
static bool set_insert(double *slot, unsigned char *used, double value)
{
    uint64_t bits;
    const double key = value + 0.0; /* one zero only */
    memcpy(&bits, &key, sizeof bits);
    size_t at = (size_t)((bits * 0x9e3779b97f4a7c15u) >> (64 - TABLE_BITS));
    while (used[at]) {
        if (slot[at] == key)
            return false;
        at = (at + 1) & (TABLE_SIZE - 1);
    }
    used[at] = 1;
    slot[at] = key;
    return true;
}

static int compare_double(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Smallest gap between the values kept in the set; 0 for a single value. Reorders the slots. */
static double smallest_gap(double *slot, const unsigned char *used)
{
    size_t n = 0;
    for (size_t at = 0; at < TABLE_SIZE; at++) {
        if (used[at])
            slot[n++] = slot[at];
    }
    qsort(slot, n, sizeof *slot, compare_double);
    double gap = 0.0;
    for (size_t i = 1; i < n; i++) {
        const double d = slot[i] - slot[i - 1];
        if (gap == 0.0 || d < gap)
            gap = d;
    }
    return gap;
}

dif_status dif_field_stats_of(const dif_field *field, dif_field_stats *out, dif_error *err)
{
    *out = (dif_field_stats){0};
    double *slot = dif_alloc(TABLE_SIZE, sizeof *slot);
    unsigned char *used = dif_alloc(TABLE_SIZE, sizeof *used);
    dif_status status = DIF_OK;
    if (!slot || !used) {
        status = dif_fail(err, DIF_ERR_NOMEM, "table of distinct heights");
        goto cleanup;
    }
    add_moments(field, out);
    add_slopes(field, out);
    const size_t n = dif_field_n(field);
    int n_distinct = 0;
    for (size_t i = 0; i < n && n_distinct <= DISTINCT_MAX; i++)
        n_distinct += set_insert(slot, used, field->z_um[i]);
    if (n_distinct <= DISTINCT_MAX)
        out->step_um = smallest_gap(slot, used);
cleanup:
    dif_release(slot);
    dif_release(used);
    return status;
}
