#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/image_cv.h"
#include "core/units.h"
#include "reports/figures.h"
#include "reports/plot.h"

enum { PICTURE_SIDE_MAX = 560, PROFILE_N = 700 };

/* Largest 1, 2 or 5 times a power of ten that is at most x. */
static double nice_below(double x)
{
    const double decade = pow(10.0, floor(log10(x)));
    return x >= 5.0 * decade ? 5.0 * decade : x >= 2.0 * decade ? 2.0 * decade : decade;
}

/* The field reduced to mx x my pixels of nm, bottom row first; the caller releases. */
static dif_status reduce_heights(const dif_field *field, int mx, int my, float **out, dif_error *err)
{
    const size_t n = dif_field_n(field), row = (size_t)mx, m = row * (size_t)my;
    float *full = dif_alloc(n, sizeof(float)), *small = dif_alloc(m, sizeof(float)), *up = dif_alloc(m, sizeof(float));
    dif_status status = DIF_OK;
    *out = NULL;
    if (!full || !small || !up) {
        status = dif_fail(err, DIF_ERR_NOMEM, "picture of %d x %d heights", field->nx, field->ny);
    } else {
        for (size_t i = 0; i < n; i++)
            full[i] = (float)dif_nm_from_um(field->z_um[i]);
        status = dif_image_resize(full, field->nx, field->ny, small, mx, my, err);
    }
    for (size_t iy = 0; status == DIF_OK && iy < (size_t)my; iy++)
        memcpy(up + ((size_t)my - 1 - iy) * row, small + iy * row, row * sizeof(float));
    dif_release(full);
    dif_release(small);
    if (status == DIF_OK)
        *out = up;
    else
        dif_release(up);
    return status;
}

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Ends of the colour scale: all heights, or the middle 99 % of them if a few specks would take most of the colours. */
static dif_status height_scale(const float *pixels, size_t n, dif_figure_notes *notes, dif_error *err)
{
    float *sorted = dif_alloc(n, sizeof(float));
    if (!sorted)
        return dif_fail(err, DIF_ERR_NOMEM, "picture of %zu heights", n);
    memcpy(sorted, pixels, n * sizeof(float));
    qsort(sorted, n, sizeof(float), by_value);
    double low = (double)sorted[0], high = (double)sorted[n - 1];
    const double low_most = (double)sorted[(size_t)(0.005 * (double)n)];
    const double high_most = (double)sorted[(size_t)(0.995 * (double)(n - 1))];
    if (high_most - low_most < 0.6 * (high - low) && high_most > low_most) {
        low = low_most;
        high = high_most;
    }
    size_t outside = 0;
    for (size_t i = 0; i < n; i++)
        outside += (double)sorted[i] < low || (double)sorted[i] > high;
    dif_release(sorted);
    notes->height_low_nm = low;
    notes->height_high_nm = high > low ? high : low + 1.0;
    notes->height_outside = (double)outside / (double)n;
    return DIF_OK;
}

static void write_scale_bar(FILE *script, double width_um, double height_um)
{
    const double bar_um = nice_below(0.28 * width_um), x = -0.46 * width_um, y = -0.455 * height_um;
    fprintf(script,
            "set object 1 rect from %.9g,%.9g to %.9g,%.9g front fc rgb '#55000000' fs solid noborder\n"
            "set arrow 1 from %.9g,%.9g to %.9g,%.9g nohead front lw 4 lc rgb 'white'\n"
            "set label 1 '%g µm' at %.9g,%.9g center front tc rgb 'white'\n",
            x - 0.02 * width_um, y - 0.025 * height_um, x + bar_um + 0.02 * width_um, y + 0.085 * height_um, x, y,
            x + bar_um, y, bar_um, x + 0.5 * bar_um, y + 0.042 * height_um);
}

/* The light's way across the picture, in the upper right corner. */
static void write_light(FILE *script, const dif_plan *plan, double width_um, double height_um)
{
    const double side = fmin(width_um, height_um), cx = 0.5 * width_um - 0.12 * side,
                 cy = 0.5 * height_um - 0.12 * side;
    const double turn = !plan->fixed_is_wo && plan->fixed_rad < 0.0 ? -1.0 : 1.0;
    const double dx = 0.075 * side * turn * cos(plan->azimuth_rad), dy = 0.075 * side * turn * sin(plan->azimuth_rad);
    fprintf(script,
            "set object 2 circle at %.9g,%.9g size %.9g front fc rgb '#55000000' fs solid noborder\n"
            "set arrow 2 from %.9g,%.9g to %.9g,%.9g front head filled size %.9g,22 lw 2 lc rgb 'white'\n",
            cx, cy, 0.1 * side, cx + dx, cy + dy, cx - dx, cy - dy, 0.05 * side);
}

dif_status dif_figure_height(const dif_result *result, const char *prefix, FILE *html, dif_figure_notes *notes,
                             dif_error *err)
{
    const dif_field *field = &result->field;
    const double width_um = field->nx * field->pitch_x_um, height_um = field->ny * field->pitch_y_um;
    int mx = field->nx, my = field->ny;
    if (mx > PICTURE_SIDE_MAX)
        mx = PICTURE_SIDE_MAX;
    if (my > PICTURE_SIDE_MAX)
        my = PICTURE_SIDE_MAX;
    float *pixels = NULL;
    FILE *script;
    dif_status status = reduce_heights(field, mx, my, &pixels, err);
    if (status == DIF_OK)
        status = height_scale(pixels, (size_t)mx * (size_t)my, notes, err);
    if (status == DIF_OK)
        status = dif_plot_open(520, 430, &script, err);
    if (status != DIF_OK) {
        dif_release(pixels);
        return status;
    }
    const double dx = width_um / mx, dy = height_um / my;
    fprintf(script,
            "set xlabel 'x / µm'\nset ylabel 'y / µm'\nset cblabel 'height / nm'\n"
            "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\nset tics out nomirror\nset cbrange [%.9g:%.9g]\n",
            -0.5 * width_um, 0.5 * width_um, -0.5 * height_um, 0.5 * height_um, notes->height_low_nm,
            notes->height_high_nm);
    /* equal scales, unless the patch is so narrow that nothing would be seen */
    if (width_um < 6.0 * height_um && height_um < 6.0 * width_um)
        fputs("set size ratio -1\n", script);
    write_scale_bar(script, width_um, height_um);
    write_light(script, &result->table.plan, width_um, height_um);
    dif_plot_image(script, 0.5 * dx - 0.5 * width_um, dx, 0.5 * dy - 0.5 * height_um, dy, mx, my);
    fputc('\n', script);
    fwrite(pixels, sizeof(float), (size_t)mx * (size_t)my, script);
    dif_release(pixels);
    return dif_plot_close(script, prefix, "Heights of the surface seen from above", html, err);
}

/* Height at (x, y), bilinear; NaN outside. */
static double height_at_um(const dif_field *field, double x_um, double y_um)
{
    const double fx = x_um / field->pitch_x_um + 0.5 * (field->nx - 1);
    const double fy = 0.5 * (field->ny - 1) - y_um / field->pitch_y_um;
    if (!(fx >= 0.0 && fy >= 0.0 && fx <= field->nx - 1 && fy <= field->ny - 1))
        return NAN;
    const int ix = fx >= field->nx - 1 ? field->nx - 2 : (int)fx, iy = fy >= field->ny - 1 ? field->ny - 2 : (int)fy;
    const int x0 = ix < 0 ? 0 : ix, y0 = iy < 0 ? 0 : iy;
    const int x1 = x0 + 1 < field->nx ? x0 + 1 : x0, y1 = y0 + 1 < field->ny ? y0 + 1 : y0;
    const double ax = fx - x0, ay = fy - y0;
    const double *row0 = field->z_um + (size_t)y0 * (size_t)field->nx,
                 *row1 = field->z_um + (size_t)y1 * (size_t)field->nx;
    return (1.0 - ay) * ((1.0 - ax) * row0[x0] + ax * row0[x1]) + ay * ((1.0 - ax) * row1[x0] + ax * row1[x1]);
}

/* Length shown: eight periods where one is known, within the patch. */
static double profile_length_um(const dif_result *result)
{
    const dif_field *field = &result->field;
    const double longest = fmin(field->nx * field->pitch_x_um, field->ny * field->pitch_y_um);
    double period_um = dif_um_from_nm(dif_result_number(result->doc, "fit_table.period_nm"));
    if (!isfinite(period_um))
        period_um = dif_um_from_nm(dif_result_number(result->doc, "fit_surface.period_nm"));
    return isfinite(period_um) && 8.0 * period_um < longest ? 8.0 * period_um : longest;
}

dif_status dif_figure_profile(const dif_result *result, const char *prefix, FILE *html, dif_figure_notes *notes,
                              dif_error *err)
{
    FILE *script;
    const dif_status status = dif_plot_open(520, 430, &script, err);
    if (status != DIF_OK)
        return status;
    const double length_um = notes->profile_um = profile_length_um(result);
    const double azimuth_rad = result->table.plan.azimuth_rad;
    fputs("$profile << EOD\n", script);
    for (int i = 0; i < PROFILE_N; i++) {
        const double s_um = length_um * ((double)i / (PROFILE_N - 1) - 0.5);
        const double z_um = height_at_um(&result->field, s_um * cos(azimuth_rad), s_um * sin(azimuth_rad));
        if (isfinite(z_um))
            fprintf(script, "%.6g %.6g\n", s_um, dif_nm_from_um(z_um));
    }
    fprintf(script,
            "EOD\n"
            "set xlabel 'distance along the plane of incidence / µm'\nset ylabel 'height / nm'\n"
            "set xrange [%.9g:%.9g]\nset offsets 0, 0, graph 0.08, graph 0.08\n"
            "set grid lt 1 lw 0.5 lc rgb '#dddddd'\n"
            "plot $profile using 1:2 with lines lw 1.6 lc rgb '#31688e' notitle\n",
            -0.5 * length_um, 0.5 * length_um);
    return dif_plot_close(script, prefix, "Height profile through the centre", html, err);
}
