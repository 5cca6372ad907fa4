#include "core/io/text_xyz.h"

#include <math.h>
#include <stdlib.h>

#include "core/alloc.h"

static const double SAME_TOL = 0.1;  /* of the largest gap: nearer coordinates are one       */
static const double GRID_TOL = 1e-3; /* of a step: how far a point may lie from the grid */

typedef struct grid_axis {
    double min, step;
    long long n;
} grid_axis;

static int compare_double(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Distinct coordinates of component k and their mean step. */
static grid_axis find_axis(const double *point, size_t n, int k, double *sorted)
{
    for (size_t i = 0; i < n; i++)
        sorted[i] = point[3 * i + (size_t)k];
    qsort(sorted, n, sizeof *sorted, compare_double);
    const double extent = sorted[n - 1] - sorted[0];
    double gap = 0.0; /* on a grid the step */
    for (size_t i = 1; i < n; i++)
        gap = fmax(gap, sorted[i] - sorted[i - 1]);
    grid_axis axis = {.min = sorted[0], .n = 1};
    for (size_t i = 1; i < n; i++)
        axis.n += sorted[i] - sorted[i - 1] > SAME_TOL * gap;
    axis.step = axis.n > 1 ? extent / (double)(axis.n - 1) : 0.0;
    return axis;
}

/* The index of a coordinate on an axis; -1 off the grid. */
static long long index_on(const grid_axis *axis, double coordinate)
{
    const double at = (coordinate - axis->min) / axis->step;
    const double index = floor(at + 0.5);
    return fabs(at - index) <= GRID_TOL && index >= 0.0 && index < (double)axis->n ? (long long)index : -1;
}

static dif_status fail_grid(const dif_source *source, size_t n, dif_error *err)
{
    return dif_fail(
        err, DIF_ERR_FORMAT,
        "%s: 3 columns, %zu rows: neither x y z on a regular grid nor a matrix with a size (# Width: in its "
        "header)",
        source->name, n);
}

static dif_status fill(const dif_source *source, const double *point, size_t n, const grid_axis *x, const grid_axis *y,
                       dif_raw *raw, dif_error *err)
{
    /* as many points as places, so none is taken twice if none is left free; until then a place holds infinity, which is
     * no height, while a missing height is NaN */
    for (size_t i = 0; i < n; i++)
        raw->z[i] = INFINITY;
    for (size_t i = 0; i < n; i++) {
        const long long ix = index_on(x, point[3 * i]), iy = index_on(y, point[3 * i + 1]);
        if (ix < 0 || iy < 0)
            return fail_grid(source, n, err);
        double *z = &raw->z[(size_t)(y->n - 1 - iy) * (size_t)x->n + (size_t)ix];
        if (!isinf(*z))
            return fail_grid(source, n, err);
        *z = isinf(point[3 * i + 2]) ? (double)NAN : point[3 * i + 2];
    }
    return DIF_OK;
}

dif_status dif_text_xyz_read(const dif_source *source, const double *point, size_t n, dif_raw *raw, dif_error *err)
{
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(point[3 * i]) || !isfinite(point[3 * i + 1]))
            return fail_grid(source, n, err);
    }
    double *sorted = dif_alloc(n, sizeof *sorted);
    if (!sorted)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %zu points", source->name, n);
    const grid_axis x = find_axis(point, n, 0, sorted), y = find_axis(point, n, 1, sorted);
    dif_release(sorted);
    if (x.n < 2 || y.n < 2 || !(x.step > 0.0 && y.step > 0.0) || (double)x.n * (double)y.n != (double)n)
        return fail_grid(source, n, err);
    dif_status status = dif_raw_allocate(source, x.n, y.n, raw, err);
    if (!status)
        status = fill(source, point, n, &x, &y, raw, err);
    if (status) {
        dif_raw_free(raw);
        return status;
    }
    raw->step_x = x.step;
    raw->step_y = y.step;
    return DIF_OK;
}
