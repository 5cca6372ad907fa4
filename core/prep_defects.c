/* Spikes and scars: found against robust statistics, made missing, filled. */
#include <string.h>

#include "core/alloc.h"
#include "core/prep_impl.h"

enum { REACH = 2, WINDOW = (2 * REACH + 1) * (2 * REACH + 1) };
static const double SIGMA_OF_MEDIAN = 1.4826; /* of a normal distribution */

static dif_status check(const dif_field *field, dif_prep_limit limit, dif_error *err)
{
    const dif_status status = dif_prep_check(field, err);
    if (!status && !(limit.value > 0.0 && isfinite(limit.value)))
        return dif_fail(err, DIF_ERR_ARG, "limit %g %s, want a finite number > 0", limit.value,
                        limit.in_sigma ? "sigma" : "um");
    return status;
}

/* The limit in um: sigma from the deviations v[n] (missing ones skipped), which are reordered. */
static double limit_um(dif_prep_limit limit, double *v, size_t n)
{
    size_t n_there = 0;
    double sum2 = 0.0;
    if (!limit.in_sigma)
        return limit.value;
    for (size_t i = 0; i < n; i++)
        if (isfinite(v[i])) {
            sum2 += v[i] * v[i];
            v[n_there++] = fabs(v[i]);
        }
    const double median = dif_prep_median(v, n_there);
    return limit.value * (median > 0.0 ? SIGMA_OF_MEDIAN * median : n_there ? sqrt(sum2 / (double)n_there) : 0.0);
}

/* Reach of a window along one axis that stays symmetric and inside. */
static int reach_at(int i, int n)
{
    const int edge = i < n - 1 - i ? i : n - 1 - i;
    return edge < REACH ? edge : REACH;
}

/* A height minus the median of the window around it; NaN for a missing one. */
static double off_median(const dif_field *field, int ix, int iy)
{
    const int rx = reach_at(ix, field->nx), ry = reach_at(iy, field->ny);
    double window[WINDOW];
    size_t n = 0;
    for (int y = iy - ry; y <= iy + ry; y++)
        for (int x = ix - rx; x <= ix + rx; x++) {
            const double z = field->z_um[(size_t)y * (size_t)field->nx + (size_t)x];
            if (isfinite(z))
                window[n++] = z;
        }
    return field->z_um[(size_t)iy * (size_t)field->nx + (size_t)ix] - dif_prep_median(window, n);
}

/* Points of a second field marked missing are filled in it and put into the first. */
static dif_status replace_marked(dif_field *field, dif_field *marked, size_t *n_found, dif_error *err)
{
    const size_t n = dif_field_n(field);
    size_t n_marked = 0, n_there = 0;
    for (size_t i = 0; i < n; i++) {
        n_there += isfinite(field->z_um[i]) ? 1 : 0;
        n_marked += isfinite(field->z_um[i]) && !isfinite(marked->z_um[i]) ? 1 : 0;
    }
    if (n_marked == 0)
        return DIF_OK;
    if (n_marked == n_there)
        return dif_fail(err, DIF_ERR_ARG, "every height is beyond the limit");
    const dif_status status = dif_prep_fill(marked, DIF_FILL_PLATE, NULL, err);
    if (status)
        return status;
    for (size_t i = 0; i < n; i++)
        if (isfinite(field->z_um[i])) /* what was missing before stays so */
            field->z_um[i] = marked->z_um[i];
    if (n_found)
        *n_found = n_marked;
    return DIF_OK;
}

dif_status dif_prep_despike(dif_field *field, dif_prep_limit limit, size_t *n_found, dif_error *err)
{
    if (n_found)
        *n_found = 0;
    dif_status status = check(field, limit, err);
    if (status)
        return status;
    const size_t n = dif_field_n(field), nx = (size_t)field->nx;
    dif_field marked = {0};
    double *off = dif_alloc(n, sizeof *off), *room = dif_alloc(n, sizeof *room);
    if (!off || !room)
        status = dif_fail(err, DIF_ERR_NOMEM, "deviations of %zu heights", n);
    if (!status)
        status = dif_field_create(field->nx, field->ny, field->pitch_x_um, field->pitch_y_um, &marked, err);
    if (status)
        goto cleanup;
    for (int iy = 0; iy < field->ny; iy++)
        for (int ix = 0; ix < field->nx; ix++)
            off[(size_t)iy * nx + (size_t)ix] = off_median(field, ix, iy);
    memcpy(room, off, n * sizeof *off);
    const double most_um = limit_um(limit, room, n);
    for (size_t i = 0; i < n; i++)
        marked.z_um[i] = fabs(off[i]) > most_um ? (double)NAN : field->z_um[i];
    status = replace_marked(field, &marked, n_found, err);
cleanup:
    dif_release(off);
    dif_release(room);
    dif_field_free(&marked);
    return status;
}

/* Sign of the deviation of rows iy ... iy + n_row - 1 at one column from both rows around them: 0 within the limit. */
static int scar_sign(const dif_field *field, int ix, int iy, int n_row, double most_um)
{
    const size_t nx = (size_t)field->nx, at = (size_t)iy * nx + (size_t)ix;
    const double above = field->z_um[at - nx], below = field->z_um[at + (size_t)n_row * nx];
    double low = field->z_um[at], high = low;
    for (int k = 1; k < n_row; k++) {
        low = fmin(low, field->z_um[at + (size_t)k * nx]);
        high = fmax(high, field->z_um[at + (size_t)k * nx]);
    }
    if (!isfinite(above + below + low + high))
        return 0;
    return low - fmax(above, below) > most_um ? 1 : fmin(above, below) - high > most_um ? -1 : 0;
}

static void mark_scars(const dif_field *field, int iy, int n_row, double most_um, dif_field *marked)
{
    int from = 0, sign = 0;
    for (int ix = 0; ix <= field->nx; ix++) {
        const int here = ix < field->nx ? scar_sign(field, ix, iy, n_row, most_um) : 0;
        if (here == sign)
            continue;
        for (int k = from; sign != 0 && ix - from >= DIF_SCAR_SAMPLES_MIN && k < ix; k++)
            for (int y = iy; y < iy + n_row; y++)
                marked->z_um[(size_t)y * (size_t)field->nx + (size_t)k] = (double)NAN;
        from = ix;
        sign = here;
    }
}

dif_status dif_prep_scars(dif_field *field, dif_prep_limit limit, size_t *n_found, dif_error *err)
{
    if (n_found)
        *n_found = 0;
    dif_status status = check(field, limit, err);
    if (status || field->ny < 3)
        return status;
    const size_t nx = (size_t)field->nx, n_step = dif_field_n(field) - nx;
    dif_field marked = {0};
    double *step = dif_alloc(n_step, sizeof *step);
    if (!step)
        status = dif_fail(err, DIF_ERR_NOMEM, "steps of %zu heights", n_step);
    if (!status)
        status = dif_field_create(field->nx, field->ny, field->pitch_x_um, field->pitch_y_um, &marked, err);
    if (!status) {
        for (size_t i = 0; i < n_step; i++)
            step[i] = field->z_um[i + nx] - field->z_um[i];
        const double most_um = limit_um(limit, step, n_step);
        memcpy(marked.z_um, field->z_um, dif_field_n(field) * sizeof *marked.z_um);
        for (int n_row = 1; n_row <= DIF_SCAR_ROWS_MAX; n_row++)
            for (int iy = 1; iy + n_row < field->ny; iy++)
                mark_scars(field, iy, n_row, most_um, &marked);
        status = replace_marked(field, &marked, n_found, err);
    }
    dif_release(step);
    dif_field_free(&marked);
    return status;
}
