#include "bench/slopes.h"

#include <math.h>

#include "core/alloc.h"
#include "core/units.h"

static const double reach = 3.5; /* standard deviations that the square shows */
enum { BINS_MIN = 24, PER_BIN = 16 };

static const dif_slopes_case CASES[DIF_SLOPES_CASES] = {
    {"isotropic, oblique", {0.0, 0.0, 0.09, 0.09, 0.0}, 45.0, 0.0},
    {"isotropic, grazing", {0.0, 0.0, 0.25, 0.25, 0.0}, 80.0, 0.0},
    {"stretched", {0.0, 0.0, 0.36, 0.04, 0.0}, 70.0, 0.0},
    {"correlated", {0.0, 0.0, 0.25, 0.16, 0.14}, 75.0, 60.0},
    {"off centre, grazing", {0.5, -0.2, 0.16, 0.09, -0.048}, 85.0, 120.0},
};

dif_slopes_case dif_slopes_case_at(int i)
{
    return CASES[i];
}

void dif_slopes_free(dif_slopes *slopes)
{
    dif_release(slopes->unseen);
    *slopes = (dif_slopes){0};
}

static void widen(double range[2], double mean, double var)
{
    range[0] = fmin(range[0], mean - reach * sqrt(fmax(var, 0.0)));
    range[1] = fmax(range[1], mean + reach * sqrt(fmax(var, 0.0)));
}

/* A square that shows the slopes and what is seen of them; a flat surface's shows +-0.01. */
static dif_slope_square square_of(const dif_slope_gauss *a, const dif_slope_gauss *b)
{
    double x[2] = {(double)INFINITY, -(double)INFINITY}, y[2] = {(double)INFINITY, -(double)INFINITY};
    widen(x, a->mean_x, a->var_x);
    widen(x, b->mean_x, b->var_x);
    widen(y, a->mean_y, a->var_y);
    widen(y, b->mean_y, b->var_y);
    return (dif_slope_square){.n = DIF_SLOPES_BINS_MAX,
                              .mid_x = 0.5 * (x[0] + x[1]),
                              .mid_y = 0.5 * (y[0] + y[1]),
                              .half = fmax(0.5 * fmax(x[1] - x[0], y[1] - y[0]), 0.01)};
}

/* Bins that are not emptier than the number of cells allows. Quantised heights give slopes on a lattice of half steps of
 * which every other place is empty (both slopes of a cell are sums of the same four heights), so bins hold an even
 * number of half steps and end between them. */
static void choose_bins(const dif_field *field, double step_um, dif_slope_square *square)
{
    const double n_cell = (double)(field->nx - 1) * (double)(field->ny - 1);
    square->n = (int)fmin(fmax(sqrt(n_cell / PER_BIN), BINS_MIN), DIF_SLOPES_BINS_MAX);
    const double step = 0.5 * step_um / field->pitch_x_um; /* a cell's slope is half a sum of two differences */
    if (!(step > 0.0) || fabs(field->pitch_y_um / field->pitch_x_um - 1.0) > 1e-9)
        return;
    const double bin = 2.0 * square->half / square->n;
    const double even = 2.0 * fmax(ceil(0.5 * bin / step), 1.0);
    square->n = (int)fmin(ceil(2.0 * square->half / (even * step)), DIF_SLOPES_BINS_MAX);
    square->half = 0.5 * square->n * even * step;
    square->mid_x = step * (floor(square->mid_x / step) + 0.5);
    square->mid_y = step * (floor(square->mid_y / step) + 0.5);
}

static dif_status make_room(dif_slopes *slopes, dif_error *err)
{
    const size_t n = (size_t)slopes->square.n * (size_t)slopes->square.n;
    slopes->unseen = dif_alloc(n, 3 * sizeof *slopes->unseen);
    if (!slopes->unseen)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu bins of slopes", n);
    slopes->visible = slopes->unseen + n;
    slopes->gauss = slopes->visible + n;
    return DIF_OK;
}

/* Mean of the Gaussian over bin (ix, iy), by 2 x 2 places. */
static double gauss_in_bin(const dif_slopes *slopes, const dif_slope_gauss *gauss, int ix, int iy)
{
    const double quarter = 0.5 * slopes->square.half / slopes->square.n;
    double sum = 0.0, s[2], at[2];
    dif_slope_bin(&slopes->square, ix, iy, s);
    for (int k = 0; k < 4; k++) {
        at[0] = s[0] + (k & 1 ? quarter : -quarter);
        at[1] = s[1] + (k >> 1 ? quarter : -quarter);
        sum += dif_slope_density(gauss, at);
    }
    return 0.25 * sum;
}

static void fill_gauss(dif_slopes *slopes)
{
    const int n = slopes->square.n;
    const double side = 2.0 * slopes->square.half / n;
    double difference = 0.0, model_inside = 0.0, seen_inside = 0.0;
    for (int i = 0; i < n * n; i++) {
        const double g = gauss_in_bin(slopes, &slopes->model.gauss, i % n, i / n);
        slopes->gauss[i] = (float)g;
        difference += fabs(g - (double)slopes->visible[i]) * side * side;
        model_inside += g * side * side;
        seen_inside += (double)slopes->visible[i] * side * side;
    }
    /* what lies beyond the square is taken to differ wholly */
    difference += fmax(1.0 - model_inside, 0.0) + fmax(1.0 - seen_inside, 0.0);
    slopes->overlap = 1.0 - 0.5 * difference;
}

static dif_status check_view(double theta_rad, double phi_rad, dif_error *err)
{
    if (!(theta_rad >= 0.0 && theta_rad <= 0.5 * DIF_PI))
        return dif_fail(err, DIF_ERR_ARG, "view at theta = %g rad, want 0 ... pi/2", theta_rad);
    if (!isfinite(phi_rad))
        return dif_fail(err, DIF_ERR_ARG, "view at azimuth %g rad, want a number", phi_rad);
    return DIF_OK;
}

static dif_status fill_histograms(const dif_field *field, dif_slopes *slopes, dif_error *err)
{
    const size_t n = (size_t)slopes->square.n * (size_t)slopes->square.n;
    double *density = dif_alloc(n, sizeof *density);
    if (!density)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu bins of slopes", n);
    dif_status status = dif_slope_histogram(field, 0.0, 0.0, &slopes->square, density, NULL, err);
    for (size_t i = 0; i < n; i++)
        slopes->unseen[i] = (float)density[i];
    if (!status)
        status = dif_slope_histogram(field, slopes->theta_rad, slopes->phi_rad, &slopes->square, density,
                                     &slopes->inside, err);
    for (size_t i = 0; i < n; i++)
        slopes->visible[i] = (float)density[i];
    dif_release(density);
    return status;
}

dif_status dif_slopes_of_field(const dif_field *field, double step_um, double theta_rad, double phi_rad,
                               dif_slopes *out, dif_error *err)
{
    *out = (dif_slopes){.theta_rad = theta_rad, .phi_rad = phi_rad};
    dif_status status = check_view(theta_rad, phi_rad, err);
    if (!status)
        status = dif_slope_of_field(field, &out->surface, err);
    if (!status)
        status = dif_slope_of_field_visible(field, theta_rad, phi_rad, &out->seen, err);
    if (!status) {
        out->model = dif_slope_visible_of(&out->surface, theta_rad, phi_rad);
        out->square = square_of(&out->surface, &out->seen.gauss);
        choose_bins(field, step_um, &out->square);
        status = make_room(out, err);
    }
    if (!status)
        status = fill_histograms(field, out, err);
    if (!status)
        fill_gauss(out);
    else
        dif_slopes_free(out);
    return status;
}

/* p and p times the weight at the middles of bins; 160 bins over 7 standard deviations integrate a Gaussian to rounding,
 * the kink of the weight to 1e-4. */
static void fill_densities(dif_slopes *slopes)
{
    const int n = slopes->square.n;
    for (int iy = 0; iy < n; iy++)
        for (int ix = 0; ix < n; ix++) {
            double s[2];
            dif_slope_bin(&slopes->square, ix, iy, s);
            const double p = dif_slope_density(&slopes->surface, s);
            slopes->unseen[iy * n + ix] = (float)p;
            slopes->visible[iy * n + ix] =
                (float)(p * dif_slope_weight(slopes->theta_rad, slopes->phi_rad, s) / slopes->model.norm);
        }
}

dif_status dif_slopes_of_gauss(const dif_slope_gauss *gauss, double theta_rad, double phi_rad, dif_slopes *out,
                               dif_error *err)
{
    *out = (dif_slopes){.theta_rad = theta_rad, .phi_rad = phi_rad, .surface = *gauss};
    dif_status status = check_view(theta_rad, phi_rad, err);
    if (!status)
        status = dif_slope_check(gauss, err);
    if (!status && !(gauss->var_x * gauss->var_y > gauss->cov_xy * gauss->cov_xy))
        status = dif_fail(err, DIF_ERR_ARG, "slopes without spread along a direction have no density");
    if (!status) {
        out->seen = out->model = dif_slope_visible_of(gauss, theta_rad, phi_rad);
        out->square = square_of(gauss, &out->model.gauss);
        status = make_room(out, err);
    }
    if (status) {
        dif_slopes_free(out);
        return status;
    }
    fill_densities(out);
    fill_gauss(out);
    const int n = out->square.n;
    for (int i = 0; i < n * n; i++)
        out->inside += (double)out->visible[i] * 4.0 * out->square.half * out->square.half / ((double)n * n);
    return DIF_OK;
}
