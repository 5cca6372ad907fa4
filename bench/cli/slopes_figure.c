#include "bench/cli/slopes_figure.h"

#include <math.h>
#include <stdio.h>

#include "core/alloc.h"
#include "core/io/panel_picture.h"
#include "core/units.h"

enum { SIDE = 320, CASE_SIDE = 320 };

static void add_ellipse(dif_panel *panel, const dif_slope_gauss *g)
{
    double *e = panel->ellipse[panel->n_ellipse++];
    e[0] = g->mean_x;
    e[1] = g->mean_y;
    e[2] = g->var_x;
    e[3] = g->var_y;
    e[4] = g->cov_xy;
}

/* A density over the square, with the ellipse of one standard deviation. */
static dif_panel panel_of(const dif_slopes *slopes, const float *density, double high, const dif_slope_gauss *gauss)
{
    const dif_slope_square *s = &slopes->square;
    dif_panel panel = {.nx = s->n,
                       .ny = s->n,
                       .value = density,
                       .high = high > 0.0 ? high : 1.0,
                       .x_min = s->mid_x - s->half,
                       .x_max = s->mid_x + s->half,
                       .y_min = s->mid_y - s->half,
                       .y_max = s->mid_y + s->half};
    add_ellipse(&panel, gauss);
    snprintf(panel.note[0], DIF_PANEL_TEXT, "mean %.3f, %.3f   sd %.3f, %.3f", gauss->mean_x, gauss->mean_y,
             sqrt(fmax(gauss->var_x, 0.0)), sqrt(fmax(gauss->var_y, 0.0)));
    return panel;
}

/* The largest density of the two that are compared, so that both have one scale. A histogram's few fullest bins may
 * tower above all others (flats of a quantised scan): they are left to saturate. */
static double scale_of(const dif_slopes *slopes, const float *density)
{
    const int n = slopes->square.n * slopes->square.n;
    double peak = 0.0, model = 0.0;
    for (int i = 0; i < n; i++) {
        peak = fmax(peak, (double)density[i]);
        model = fmax(model, (double)slopes->gauss[i]);
    }
    return model > 0.0 ? fmin(peak, 3.0 * model) : peak;
}

dif_status dif_slopes_write_png(const char *path, const char *heading, const dif_slopes *slopes,
                                const dif_manifest *manifest, dif_error *err)
{
    const double high = scale_of(slopes, slopes->visible);
    char title[64];
    snprintf(title, sizeof title, "seen from %.4g°, azimuth %.4g°", dif_deg_from_rad(slopes->theta_rad),
             dif_deg_from_rad(slopes->phi_rad));
    dif_panel panel[] = {panel_of(slopes, slopes->unseen, scale_of(slopes, slopes->unseen), &slopes->surface),
                         panel_of(slopes, slopes->visible, high, &slopes->seen.gauss),
                         panel_of(slopes, slopes->gauss, high, &slopes->model.gauss)};
    for (int i = 0; i < 3; i++) {
        panel[i].is_log = true;
        panel[i].low = 1e-3 * panel[i].high;
    }
    panel[0].title = "all slopes (dz/dx to the right, dz/dy up)";
    snprintf(panel[0].note[1], DIF_PANEL_TEXT, "density, three decades; ellipse: one sd");
    panel[1].title = title;
    panel[2].title = "Gaussian from the surface's moments";
    snprintf(panel[1].note[1], DIF_PANEL_TEXT, "visible area %.4g", slopes->seen.norm);
    snprintf(panel[2].note[1], DIF_PANEL_TEXT, "visible area %.4g, overlap %.1f %%", slopes->model.norm,
             100.0 * slopes->overlap);
    const dif_panel_sheet sheet = {
        .n_panel = 3, .n_column = 3, .panel = panel, .heading = heading, .colour_map = "viridis", .side = SIDE};
    return dif_panel_write_png(path, &sheet, manifest, err);
}

dif_status dif_slopes_write_cases_png(const char *path, const dif_manifest *manifest, dif_error *err)
{
    dif_slopes slopes[DIF_SLOPES_CASES] = {{0}};
    dif_panel panel[3 * DIF_SLOPES_CASES];
    char title[DIF_SLOPES_CASES][2][64];
    dif_status status = DIF_OK;
    for (int i = 0; i < DIF_SLOPES_CASES && !status; i++) {
        const dif_slopes_case at = dif_slopes_case_at(i);
        status = dif_slopes_of_gauss(&at.gauss, dif_rad_from_deg(at.theta_deg), dif_rad_from_deg(at.phi_deg),
                                     slopes + i, err);
        if (status)
            break;
        const double high = scale_of(slopes + i, slopes[i].visible);
        dif_panel *top = panel + i, *middle = top + DIF_SLOPES_CASES, *low = middle + DIF_SLOPES_CASES;
        *top = panel_of(slopes + i, slopes[i].unseen, scale_of(slopes + i, slopes[i].unseen), &slopes[i].surface);
        *middle = panel_of(slopes + i, slopes[i].visible, high, &slopes[i].model.gauss);
        *low = panel_of(slopes + i, slopes[i].gauss, high, &slopes[i].model.gauss);
        snprintf(title[i][0], sizeof title[i][0], "%s: slopes", at.name);
        snprintf(title[i][1], sizeof title[i][1], "seen from %.4g°, azimuth %.4g°", at.theta_deg, at.phi_deg);
        top->title = title[i][0];
        middle->title = title[i][1];
        low->title = "Gaussian, closed form";
        snprintf(middle->note[0], DIF_PANEL_TEXT, "visible area %.4g", slopes[i].model.norm);
        snprintf(low->note[1], DIF_PANEL_TEXT, "overlap %.1f %%", 100.0 * slopes[i].overlap);
    }
    const dif_panel_sheet sheet = {
        .n_panel = 3 * DIF_SLOPES_CASES,
        .n_column = DIF_SLOPES_CASES,
        .panel = panel,
        .heading = "Gaussian slopes, what is seen of them exactly, and the Gaussian of the same moments",
        .colour_map = "viridis",
        .side = CASE_SIDE};
    if (!status)
        status = dif_panel_write_png(path, &sheet, manifest, err);
    for (int i = 0; i < DIF_SLOPES_CASES; i++)
        dif_slopes_free(slopes + i);
    return status;
}

/* The three discs as floats: value[3][n * n], NaN outside. Returns the largest difference up to 85 degrees; *peak: the
 * largest D. */
static double fill_discs(const dif_ndf *ndf, const float *masking, const dif_slope_gauss *slopes, float *value,
                         double *peak)
{
    const int n = ndf->n;
    const size_t n_pixel = (size_t)n * (size_t)n;
    double worst = 0.0;
    *peak = 0.0;
    for (size_t i = 0; i < n_pixel; i++) {
        const double x = (2.0 * (double)(i % (size_t)n) + 1.0) / n - 1.0;
        const double y = 1.0 - (2.0 * (double)(i / (size_t)n) + 1.0) / n, z2 = 1.0 - x * x - y * y;
        const bool inside = z2 > 0.0;
        const dif_vec3 k = {x, y, inside ? sqrt(z2) : 0.0};
        const double difference = inside ? (double)masking[i] - dif_shadow_smith(slopes, k) : (double)NAN;
        value[i] = inside ? (float)ndf->d[i] : NAN;
        value[n_pixel + i] = inside ? masking[i] : NAN;
        value[2 * n_pixel + i] = (float)difference;
        *peak = fmax(*peak, inside ? ndf->d[i] : 0.0);
        if (k.z > cos(dif_rad_from_deg(85.0)))
            worst = fmax(worst, fabs(difference));
    }
    return worst;
}

dif_status dif_ndf_write_png(const char *path, const char *heading, const dif_ndf *ndf, const float *masking,
                             const dif_slope_gauss *slopes, const dif_manifest *manifest, double *worst, dif_error *err)
{
    const size_t n_pixel = (size_t)ndf->n * (size_t)ndf->n;
    float *value = dif_alloc(n_pixel, 3 * sizeof *value);
    double peak;
    if (!value)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu pixels", n_pixel);
    const double largest = fill_discs(ndf, masking, slopes, value, &peak);
    const double span = fmax(largest, 1e-3);
    dif_panel panel[3];
    for (int i = 0; i < 3; i++)
        panel[i] = (dif_panel){.nx = ndf->n, .ny = ndf->n, .value = value + (size_t)i * n_pixel};
    panel[0].title = "normals, D per sr";
    panel[0].low = 1e-4 * peak;
    panel[0].high = peak;
    panel[0].is_log = true;
    snprintf(panel[0].note[0], DIF_PANEL_TEXT, "%.3g (yellow) and four decades down", peak);
    panel[1].title = "masking G";
    panel[1].high = 1.0;
    snprintf(panel[1].note[0], DIF_PANEL_TEXT, "0 (dark) ... 1 (yellow)");
    panel[2].title = "masking - Smith's";
    panel[2].low = -span;
    panel[2].high = span;
    snprintf(panel[2].note[0], DIF_PANEL_TEXT, "-%.3g ... %.3g; largest up to 85°: %.3g", span, span, largest);
    const dif_panel_sheet sheet = {
        .n_panel = 3, .n_column = 3, .panel = panel, .heading = heading, .colour_map = "viridis", .side = SIDE};
    const dif_status status = dif_panel_write_png(path, &sheet, manifest, err);
    if (worst)
        *worst = largest;
    dif_release(value);
    return status;
}
