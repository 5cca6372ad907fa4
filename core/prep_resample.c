/* Quintic splines over a field: reading it between its samples. */
#include <string.h>

#include "core/alloc.h"
#include "core/prep_impl.h"
#include "core/units.h"

enum {
    DEGREE = 5,
    PAD = 32,         /* samples added on each side: the filter's memory is 0.43 a sample, 2e-12 over all of them */
    LOWPASS_REACH = 8 /* of the low-pass, in new pitches */
};

/* Poles of the quintic spline's inverse filter: roots of z^4 + 26 z^3 + 66 z^2 + 26 z + 1 inside the unit circle. */
static const double POLES[2] = {-0.43057534709997379, -0.04309628820326465};

/* Kaiser's parameter for side lobes of -80 dB, and the middle of its edge in new Nyquist frequencies. */
static const double KAISER_BETA = 7.857, LOWPASS_EDGE = 0.85;

/* Continues a line of n samples that begins at line[pad], point-symmetrically about its ends. */
static void continue_line(double *line, int n, int pad)
{
    double *first = line + pad, *last = line + pad + n - 1;
    for (int k = 1; k <= pad; k++) {
        first[-k] = n > 1 ? 2.0 * first[0] - first[k] : first[0];
        last[k] = n > 1 ? 2.0 * last[0] - last[-k] : last[0];
    }
}

/* Spline coefficients of a padded line, in place. Beyond its ends the line is taken as constant. */
static void filter_line(double *c, int n)
{
    double gain = 1.0;
    for (int k = 0; k < 2; k++)
        gain *= (1.0 - POLES[k]) * (1.0 - 1.0 / POLES[k]);
    for (int i = 0; i < n; i++)
        c[i] *= gain;
    for (int k = 0; k < 2; k++) {
        const double z = POLES[k];
        c[0] /= 1.0 - z;
        for (int i = 1; i < n; i++)
            c[i] += z * c[i - 1];
        c[n - 1] *= z / (z - 1.0);
        for (int i = n - 2; i >= 0; i--)
            c[i] = z * (c[i + 1] - c[i]);
    }
}

/* Coefficients c[ny + 2 PAD][nx + 2 PAD]. */
typedef struct spline {
    int nx, ny;
    double *c;
} spline;

static dif_status spline_make(const dif_field *field, spline *s, dif_error *err)
{
    const int nx = field->nx + 2 * PAD, ny = field->ny + 2 * PAD;
    *s = (spline){.nx = field->nx, .ny = field->ny, .c = dif_alloc((size_t)nx * (size_t)ny, sizeof *s->c)};
    double *line = dif_alloc((size_t)ny, sizeof *line);
    if (!s->c || !line) {
        dif_release(line);
        return dif_fail(err, DIF_ERR_NOMEM, "spline of %d x %d samples", field->nx, field->ny);
    }
    for (int iy = 0; iy < field->ny; iy++) {
        double *row = s->c + (size_t)(iy + PAD) * (size_t)nx;
        memcpy(row + PAD, field->z_um + (size_t)iy * (size_t)field->nx, (size_t)field->nx * sizeof *row);
        continue_line(row, field->nx, PAD);
        filter_line(row, nx);
    }
    for (int ix = 0; ix < nx; ix++) {
        for (int iy = 0; iy < field->ny; iy++)
            line[iy + PAD] = s->c[(size_t)(iy + PAD) * (size_t)nx + (size_t)ix];
        continue_line(line, field->ny, PAD);
        filter_line(line, ny);
        for (int iy = 0; iy < ny; iy++)
            s->c[(size_t)iy * (size_t)nx + (size_t)ix] = line[iy];
    }
    dif_release(line);
    return DIF_OK;
}

/* The six weights of a place at a share t between two samples. */
static void weights_at(double t, double w[DEGREE + 1])
{
    w[0] = 1.0;
    for (int d = 1; d <= DEGREE; d++) {
        w[d] = t * w[d - 1] / d;
        for (int k = d - 1; k >= 1; k--)
            w[k] = ((t + d - k) * w[k - 1] + (k + 1 - t) * w[k]) / d;
        w[0] = (1.0 - t) * w[0] / d;
    }
}

/* First of the six samples around a place, as an index into the padded line; places outside are moved inside. */
static size_t taps_at(double at, int n, double w[DEGREE + 1])
{
    const double inside = fmin(fmax(at, -0.5 * PAD), n - 1 + 0.5 * PAD), low = floor(inside);
    weights_at(inside - low, w);
    return (size_t)((int)low + PAD - DEGREE / 2);
}

/* The height at a place in samples from the first column and row. */
static double spline_at(const spline *s, double ix, double iy)
{
    double wx[DEGREE + 1], wy[DEGREE + 1], sum = 0.0;
    const size_t x = taps_at(ix, s->nx, wx), y = taps_at(iy, s->ny, wy), stride = (size_t)s->nx + 2 * PAD;
    for (size_t j = 0; j <= DEGREE; j++) {
        const double *row = s->c + (y + j) * stride + x;
        double along = 0.0;
        for (size_t i = 0; i <= DEGREE; i++)
            along += wx[i] * row[i];
        sum += wy[j] * along;
    }
    return sum;
}

dif_status dif_prep_regrid(dif_field *field, const dif_prep_grid *grid, dif_error *err)
{
    spline s = {0};
    dif_field out = {0};
    dif_status status = dif_field_create(grid->nx, grid->ny, grid->pitch_x_um, grid->pitch_y_um, &out, err);
    if (!status)
        status = spline_make(field, &s, err);
    const double c = cos(grid->angle_rad), sine = sin(grid->angle_rad);
    for (int iy = 0; iy < grid->ny && !status; iy++)
        for (int ix = 0; ix < grid->nx; ix++) {
            const double x = dif_field_x_um(&out, ix), y = dif_field_y_um(&out, iy);
            const double from_x = grid->x_um + c * x - sine * y, from_y = grid->y_um + sine * x + c * y;
            out.z_um[(size_t)iy * (size_t)grid->nx + (size_t)ix] =
                spline_at(&s, from_x / field->pitch_x_um + 0.5 * (field->nx - 1),
                          0.5 * (field->ny - 1) - from_y / field->pitch_y_um);
        }
    if (!status)
        dif_prep_replace(field, &out);
    dif_field_free(&out);
    dif_release(s.c);
    return status;
}

/* Modified Bessel function I0 by its series. */
static double bessel_i0(double x)
{
    double term = 1.0, sum = 1.0;
    for (int k = 1; k < 60; k++) {
        term *= 0.25 * x * x / (k * k);
        sum += term;
    }
    return sum;
}

/* Windowed sinc of 2 reach + 1 taps for a pitch `ratio` times as coarse; sums to 1. */
static void lowpass_taps(double ratio, int reach, double *tap)
{
    double sum = 0.0;
    for (int i = -reach; i <= reach; i++) {
        const double u = LOWPASS_EDGE * i / ratio, v = i / (LOWPASS_REACH * ratio);
        const double sinc = i == 0 ? 1.0 : sin(DIF_PI * u) / (DIF_PI * u);
        tap[i + reach] = fabs(v) < 1.0 ? sinc * bessel_i0(KAISER_BETA * sqrt(1.0 - v * v)) : 0.0;
        sum += tap[i + reach];
    }
    for (int i = 0; i <= 2 * reach; i++)
        tap[i] /= sum;
}

/* Low-pass along one axis: n_line lines of n samples, `step` apart within a line and `jump` from line to line. */
static dif_status lowpass_axis(double *z, int n_line, size_t jump, int n, size_t step, double ratio, dif_error *err)
{
    const int reach = (int)ceil(LOWPASS_REACH * ratio);
    double *tap = dif_alloc(2 * (size_t)reach + 1, sizeof *tap);
    double *line = dif_alloc((size_t)n + 2 * (size_t)reach, sizeof *line);
    const dif_status status = tap && line ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "low-pass of %d taps", 2 * reach + 1);
    if (!status)
        lowpass_taps(ratio, reach, tap);
    for (int k = 0; k < n_line && !status; k++) {
        double *from = z + (size_t)k * jump;
        for (int i = 0; i < n; i++)
            line[i + reach] = from[(size_t)i * step];
        continue_line(line, n, reach);
        for (int i = 0; i < n; i++) {
            double sum = 0.0;
            for (int j = 0; j <= 2 * reach; j++)
                sum += tap[j] * line[i + j];
            from[(size_t)i * step] = sum;
        }
    }
    dif_release(tap);
    dif_release(line);
    return status;
}

dif_status dif_prep_resample(dif_field *field, double pitch_x_um, double pitch_y_um, dif_error *err)
{
    dif_status status = dif_prep_check_whole(field, "resampling", err);
    if (status)
        return status;
    if (!(pitch_x_um > 0.0 && isfinite(pitch_x_um) && pitch_y_um > 0.0 && isfinite(pitch_y_um)))
        return dif_fail(err, DIF_ERR_ARG, "new pitch %g x %g um, want finite numbers > 0", pitch_x_um, pitch_y_um);
    const dif_prep_grid grid = {.nx = dif_prep_samples_in(field->nx * field->pitch_x_um, pitch_x_um),
                                .ny = dif_prep_samples_in(field->ny * field->pitch_y_um, pitch_y_um),
                                .pitch_x_um = pitch_x_um,
                                .pitch_y_um = pitch_y_um};
    if (grid.nx < 2 || grid.ny < 2)
        return dif_fail(err, DIF_ERR_ARG, "new pitch %g x %g um leaves %d x %d samples, want at least 2 x 2",
                        pitch_x_um, pitch_y_um, grid.nx, grid.ny);
    const double ratio_x = pitch_x_um / field->pitch_x_um, ratio_y = pitch_y_um / field->pitch_y_um;
    const size_t n = dif_field_n(field), nx = (size_t)field->nx;
    dif_field smooth = {0};
    status = dif_field_create(field->nx, field->ny, field->pitch_x_um, field->pitch_y_um, &smooth, err);
    if (status)
        return status;
    memcpy(smooth.z_um, field->z_um, n * sizeof *smooth.z_um);
    if (ratio_x > 1.0 + 1e-9)
        status = lowpass_axis(smooth.z_um, field->ny, nx, field->nx, 1, ratio_x, err);
    if (!status && ratio_y > 1.0 + 1e-9)
        status = lowpass_axis(smooth.z_um, field->nx, 1, field->ny, nx, ratio_y, err);
    if (!status)
        status = dif_prep_regrid(&smooth, &grid, err);
    if (!status)
        dif_prep_replace(field, &smooth);
    dif_field_free(&smooth);
    return status;
}
