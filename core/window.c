#include "core/window.h"

#include <math.h>
#include <stdbool.h>

/* Fills one axis: weights of n samples at (i - (n-1)/2) * pitch around the centre; returns sums of w and w^2. */
static dif_window_sums fill_axis(bool gauss, double sigma_um, double centre_um, int n, double pitch_um, double *w)
{
    dif_window_sums sums = {0.0, 0.0};
    for (int i = 0; i < n; i++) {
        const double r = ((i - 0.5 * (n - 1)) * pitch_um - centre_um) / sigma_um;
        w[i] = gauss ? exp(-0.5 * r * r) : 1.0;
        sums.w += w[i];
        sums.w2 += w[i] * w[i];
    }
    return sums;
}

dif_window_sums dif_window_fill(const dif_window *window, const dif_field *field, double *wx, double *wy)
{
    const bool gauss = window->kind == DIF_WINDOW_GAUSS;
    const dif_window_sums x = fill_axis(gauss, window->sigma_um, window->x_um, field->nx, field->pitch_x_um, wx);
    /* y falls with the row, so the centre changes its sign */
    const dif_window_sums y = fill_axis(gauss, window->sigma_um, -window->y_um, field->ny, field->pitch_y_um, wy);
    return (dif_window_sums){x.w * y.w, x.w2 * y.w2};
}

/* Number of centres along an axis. A spacing below one sample would add nothing, so it is never finer; this also keeps
 * the product of both axes inside an int. */
static int axis_count(double sigma_um, int n, double pitch_um)
{
    const double span_um = n * pitch_um - 2.0 * sigma_um;
    const double spacing_um = fmax(sigma_um, pitch_um);
    if (!(span_um > 1e-9 * spacing_um))
        return 1;
    return (int)ceil(span_um / spacing_um - 1e-9) + 1;
}

static double axis_centre_um(double sigma_um, int n, double pitch_um, int n_centre, int i)
{
    if (n_centre == 1)
        return 0.0;
    const double half_um = 0.5 * n * pitch_um - sigma_um;
    return half_um * (2.0 * i / (n_centre - 1) - 1.0);
}

static bool is_tiled(dif_window_kind kind, dif_average average)
{
    return kind == DIF_WINDOW_GAUSS && average == DIF_AVERAGE_WELCH;
}

int dif_window_tile_count(dif_window_kind kind, double sigma_um, dif_average average, const dif_field *field)
{
    if (!is_tiled(kind, average))
        return 1;
    return axis_count(sigma_um, field->nx, field->pitch_x_um) * axis_count(sigma_um, field->ny, field->pitch_y_um);
}

void dif_window_tile(dif_window_kind kind, double sigma_um, dif_average average, const dif_field *field,
                     dif_window *windows)
{
    const bool tiled = is_tiled(kind, average);
    const int n_x = tiled ? axis_count(sigma_um, field->nx, field->pitch_x_um) : 1;
    const int n_y = tiled ? axis_count(sigma_um, field->ny, field->pitch_y_um) : 1;
    for (int iy = 0; iy < n_y; iy++) {
        for (int ix = 0; ix < n_x; ix++) {
            windows[iy * n_x + ix] = (dif_window){
                .kind = kind,
                .sigma_um = sigma_um,
                .x_um = axis_centre_um(sigma_um, field->nx, field->pitch_x_um, n_x, ix),
                .y_um = axis_centre_um(sigma_um, field->ny, field->pitch_y_um, n_y, iy),
            };
        }
    }
}
