/* Slopes of a heightfield: statistics and histogram over its cells. */
#include <math.h>
#include <string.h>

#include "core/slope.h"

static dif_status check_field(const dif_field *field, dif_error *err)
{
    const dif_status status = dif_field_check(field, err);
    if (status)
        return status;
    if (field->nx < 2 || field->ny < 2)
        return dif_fail(err, DIF_ERR_SIZE, "%d x %d samples have no slopes, want at least 2 x 2", field->nx, field->ny);
    return DIF_OK;
}

/* A view as the weights need it: (vx, vy, vz) with weight max(0, vz - s.(vx, vy)). */
static dif_vec3 view_of(double theta_rad, double phi_rad)
{
    return theta_rad == 0.0 ? (dif_vec3){0.0, 0.0, 1.0} : dif_vec3_from_angles_rad(theta_rad, phi_rad);
}

static double weight_of(dif_vec3 view, const double s[2])
{
    return fmax(view.z - view.x * s[0] - view.y * s[1], 0.0);
}

/* Weighted sums of 1, s and (s - origin)(s - origin)^T. */
typedef struct moments {
    double w, x, y, xx, yy, xy;
} moments;

/* Row by row, so that long sums keep their digits. */
static moments moments_of(const dif_field *field, dif_vec3 view, const double origin[2])
{
    moments all = {0};
    for (int iy = 0; iy < field->ny - 1; iy++) {
        moments row = {0};
        for (int ix = 0; ix < field->nx - 1; ix++) {
            double s[2];
            dif_slope_of_cell(field, ix, iy, s);
            const double w = weight_of(view, s), x = s[0] - origin[0], y = s[1] - origin[1];
            row.w += w;
            row.x += w * x;
            row.y += w * y;
            row.xx += w * x * x;
            row.yy += w * y * y;
            row.xy += w * x * y;
        }
        all.w += row.w;
        all.x += row.x;
        all.y += row.y;
        all.xx += row.xx;
        all.yy += row.yy;
        all.xy += row.xy;
    }
    return all;
}

static double cells_of(const dif_field *field)
{
    return (double)(field->nx - 1) * (double)(field->ny - 1);
}

dif_status dif_slope_of_field_visible(const dif_field *field, double theta_rad, double phi_rad, dif_slope_visible *out,
                                      dif_error *err)
{
    const dif_vec3 view = view_of(theta_rad, phi_rad);
    *out = (dif_slope_visible){0};
    const dif_status status = check_field(field, err);
    if (status)
        return status;
    const double zero[2] = {0.0, 0.0};
    const moments first = moments_of(field, view, zero);
    out->norm = first.w / cells_of(field);
    out->ln_norm = log(out->norm);
    if (!(first.w > 0.0))
        return DIF_OK;
    const double mean[2] = {first.x / first.w, first.y / first.w};
    const moments central = moments_of(field, view, mean);
    out->gauss =
        (dif_slope_gauss){mean[0], mean[1], central.xx / central.w, central.yy / central.w, central.xy / central.w};
    return DIF_OK;
}

dif_status dif_slope_of_field(const dif_field *field, dif_slope_gauss *out, dif_error *err)
{
    dif_slope_visible all;
    const dif_status status = dif_slope_of_field_visible(field, 0.0, 0.0, &all, err);
    *out = all.gauss;
    return status;
}

void dif_slope_bin(const dif_slope_square *square, int ix, int iy, double s[2])
{
    s[0] = square->mid_x + square->half * ((2.0 * ix + 1.0) / square->n - 1.0);
    s[1] = square->mid_y - square->half * ((2.0 * iy + 1.0) / square->n - 1.0);
}

/* Index of the bin, or -1 outside the square. */
static long bin_of(const dif_slope_square *square, const double s[2])
{
    const double scale = 0.5 * square->n / square->half;
    const double x = floor((s[0] - square->mid_x + square->half) * scale);
    const double y = floor((square->mid_y + square->half - s[1]) * scale);
    if (!(x >= 0.0 && x < square->n && y >= 0.0 && y < square->n))
        return -1;
    return (long)y * square->n + (long)x;
}

dif_status dif_slope_histogram(const dif_field *field, double theta_rad, double phi_rad, const dif_slope_square *square,
                               double *density, double *inside, dif_error *err)
{
    const dif_vec3 view = view_of(theta_rad, phi_rad);
    double total = 0.0, within = 0.0;
    if (!(square->n >= 1 && square->n <= 8192 && square->half > 0.0 && isfinite(square->half) &&
          isfinite(square->mid_x) && isfinite(square->mid_y)))
        return dif_fail(err, DIF_ERR_ARG, "%d bins over slopes (%g, %g) +- %g, want 1 ... 8192 and a half width > 0",
                        square->n, square->mid_x, square->mid_y, square->half);
    const size_t n = (size_t)square->n * (size_t)square->n;
    memset(density, 0, n * sizeof *density);
    if (inside)
        *inside = 0.0;
    const dif_status status = check_field(field, err);
    if (status)
        return status;
    for (int iy = 0; iy < field->ny - 1; iy++)
        for (int ix = 0; ix < field->nx - 1; ix++) {
            double s[2];
            dif_slope_of_cell(field, ix, iy, s);
            const double w = weight_of(view, s);
            const long bin = bin_of(square, s);
            total += w;
            within += bin >= 0 ? w : 0.0;
            if (bin >= 0)
                density[bin] += w;
        }
    const double side = 2.0 * square->half / square->n;
    for (size_t i = 0; i < n && total > 0.0; i++)
        density[i] /= total * side * side;
    if (inside && total > 0.0)
        *inside = within / total;
    return DIF_OK;
}
