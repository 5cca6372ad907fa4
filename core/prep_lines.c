/* Offsets of scan lines. */
#include "core/alloc.h"
#include "core/prep_impl.h"

/* Median of a row's heights, or of its steps from the row before; NaN if nothing is there. */
static double row_median(const double *z, const double *before, int nx, double *room)
{
    size_t n = 0;
    for (int ix = 0; ix < nx; ix++) {
        const double value = before ? z[ix] - before[ix] : z[ix];
        if (isfinite(value))
            room[n++] = value;
    }
    return dif_prep_median(room, n);
}

/* What each row is too high by. A row with nothing in it goes on with the offset of the one before; steps are taken
 * from the last row that shares a column with this one. */
static void find_offsets(const dif_field *field, dif_prep_lines_method method, double *offset, double *room)
{
    const size_t nx = (size_t)field->nx;
    int last = -1;
    for (int iy = 0; iy < field->ny; iy++) {
        const double *z = field->z_um + (size_t)iy * nx;
        const double *before = method == DIF_LINES_DIFF && last >= 0 ? field->z_um + (size_t)last * nx : NULL;
        double median = row_median(z, before, field->nx, room);
        if (method == DIF_LINES_DIFF)
            median = last >= 0 ? median + offset[last] : isfinite(median) ? 0.0 : median;
        offset[iy] = isfinite(median) ? median : iy > 0 ? offset[iy - 1] : 0.0;
        last = isfinite(median) ? iy : last;
    }
}

/* Mean of the offsets over all heights that are there. */
static double mean_offset(const dif_field *field, const double *offset)
{
    double sum = 0.0, n = 0.0;
    for (int iy = 0; iy < field->ny; iy++)
        for (int ix = 0; ix < field->nx; ix++)
            if (isfinite(field->z_um[(size_t)iy * (size_t)field->nx + (size_t)ix])) {
                sum += offset[iy];
                n += 1.0;
            }
    return n > 0.0 ? sum / n : 0.0;
}

dif_status dif_prep_lines(dif_field *field, dif_prep_lines_method method, dif_error *err)
{
    dif_status status = dif_prep_check(field, err);
    if (status)
        return status;
    if (method != DIF_LINES_MEDIAN && method != DIF_LINES_DIFF)
        return dif_fail(err, DIF_ERR_ARG, "line correction %d, want median or diff", (int)method);
    double *offset = dif_alloc((size_t)field->ny, sizeof *offset);
    double *room = dif_alloc((size_t)field->nx, sizeof *room);
    if (offset && room) {
        find_offsets(field, method, offset, room);
        const double mean = mean_offset(field, offset);
        for (int iy = 0; iy < field->ny; iy++)
            for (int ix = 0; ix < field->nx; ix++)
                field->z_um[(size_t)iy * (size_t)field->nx + (size_t)ix] -= offset[iy] - mean;
    } else {
        status = dif_fail(err, DIF_ERR_NOMEM, "offsets of %d lines", field->ny);
    }
    dif_release(offset);
    dif_release(room);
    return status;
}
