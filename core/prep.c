#include "core/prep.h"

#include <stdbool.h>
#include <string.h>

#include "core/alloc.h"
#include "core/prep_impl.h"

dif_status dif_prep_check(const dif_field *field, dif_error *err)
{
    const dif_status status = dif_field_check(field, err);
    return status == DIF_ERR_NONFINITE ? DIF_OK : status;
}

dif_status dif_prep_check_whole(const dif_field *field, const char *what, dif_error *err)
{
    const dif_status status = dif_field_check(field, err);
    if (status != DIF_ERR_NONFINITE)
        return status;
    return dif_fail(err, status, "%s needs every height, and %zu of %zu are missing: fill them first", what,
                    dif_prep_state_of(field).n_missing, dif_field_n(field));
}

dif_prep_state dif_prep_state_of(const dif_field *field)
{
    const size_t n = dif_field_n(field);
    dif_prep_state state = {0};
    double first = 0.0, sum = 0.0, sum2 = 0.0;
    bool has_first = false;
    for (size_t i = 0; i < n; i++) {
        const double z = field->z_um[i];
        if (!isfinite(z)) {
            state.n_missing++;
            continue;
        }
        first = has_first ? first : z;
        has_first = true;
        sum += z - first;
    }
    const double there = (double)(n - state.n_missing), mean = there > 0.0 ? sum / there : 0.0;
    for (size_t i = 0; i < n; i++) {
        const double d = field->z_um[i] - first - mean;
        sum2 += isfinite(d) ? d * d : 0.0;
    }
    state.mean_um = first + mean;
    state.rms_um = there > 0.0 ? sqrt(sum2 / there) : 0.0;
    return state;
}

static void swap(double *a, double *b)
{
    const double keep = *a;
    *a = *b;
    *b = keep;
}

/* Puts the k-th smallest of v[n] at v[k], nothing larger before it and nothing smaller behind. */
static void select_nth(double *v, size_t n, size_t k)
{
    size_t low = 0, high = n - 1;
    while (low < high) {
        /* the median of three in the middle */
        const size_t middle = low + (high - low) / 2;
        if (v[middle] < v[low])
            swap(&v[middle], &v[low]);
        if (v[high] < v[low])
            swap(&v[high], &v[low]);
        if (v[high] < v[middle])
            swap(&v[high], &v[middle]);
        const double pivot = v[middle];
        size_t i = low, j = high;
        for (;;) {
            while (v[i] < pivot)
                i++;
            while (pivot < v[j])
                j--;
            if (i >= j)
                break;
            swap(&v[i++], &v[j--]);
        }
        if (k <= j)
            high = j;
        else
            low = j + 1;
    }
}

double dif_prep_median(double *v, size_t n)
{
    if (n == 0)
        return (double)NAN;
    select_nth(v, n, n / 2);
    if (n % 2)
        return v[n / 2];
    double below = v[0];
    for (size_t i = 1; i < n / 2; i++)
        below = fmax(below, v[i]);
    return 0.5 * (below + v[n / 2]);
}

void dif_prep_replace(dif_field *field, dif_field *by)
{
    dif_release(field->z_um);
    *field = *by;
    *by = (dif_field){0};
}

/* First sample whose centre is at or right of `at`, in pitches from the edge. */
static int first_from(double at)
{
    return (int)ceil(at - 0.5 - 1e-9);
}

dif_status dif_prep_crop(dif_field *field, const dif_prep_box *box, dif_error *err)
{
    const dif_status status = dif_prep_check(field, err);
    if (status)
        return status;
    const double width_um = field->nx * field->pitch_x_um, height_um = field->ny * field->pitch_y_um;
    if (!(box->x0_um >= 0.0 && box->x0_um < box->x1_um && box->x1_um <= width_um * (1.0 + 1e-9)))
        return dif_fail(err, DIF_ERR_ARG, "crop from x = %.6g to %.6g um, want a part of 0 to %.6g um", box->x0_um,
                        box->x1_um, width_um);
    if (!(box->y0_um >= 0.0 && box->y0_um < box->y1_um && box->y1_um <= height_um * (1.0 + 1e-9)))
        return dif_fail(err, DIF_ERR_ARG, "crop from y = %.6g to %.6g um, want a part of 0 to %.6g um", box->y0_um,
                        box->y1_um, height_um);
    const int ix0 = first_from(box->x0_um / field->pitch_x_um), ix1 = first_from(box->x1_um / field->pitch_x_um);
    const int low = first_from(box->y0_um / field->pitch_y_um), high = first_from(box->y1_um / field->pitch_y_um);
    const int nx = ix1 - ix0, ny = high - low;
    if (nx < 2 || ny < 2)
        return dif_fail(err, DIF_ERR_ARG, "crop to %d x %d samples, want at least 2 x 2", nx, ny);
    dif_field part;
    const dif_status made = dif_field_create(nx, ny, field->pitch_x_um, field->pitch_y_um, &part, err);
    if (made)
        return made;
    for (int iy = 0; iy < ny; iy++) { /* row 0 is the top, y counts from the bottom */
        const size_t from = (size_t)(field->ny - high + iy) * (size_t)field->nx + (size_t)ix0;
        memcpy(part.z_um + (size_t)iy * (size_t)nx, field->z_um + from, (size_t)nx * sizeof *part.z_um);
    }
    dif_prep_replace(field, &part);
    return DIF_OK;
}
