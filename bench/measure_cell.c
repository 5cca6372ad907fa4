/* pq: the period patch cut from a surface, and how often it is replicated. */
#include <math.h>

#include "bench/fit.h"
#include "bench/measure_impl.h"
#include "core/units.h"

/* Patch and replicas along one axis. */
typedef struct span {
    int n, n_replica;
    double first, step; /* in samples of the surface */
    double period_um;
} span;

static int replicas(int asked, const dif_measure_opts *opts, double period_um, double extent_um)
{
    if (asked != DIF_REPLICAS_FROM_WINDOW)
        return asked;
    const double wanted_um = opts->window == DIF_WINDOW_GAUSS ? 4.0 * opts->sigma_um : extent_um;
    return (int)fmin(fmax(rint(wanted_um / period_um), 1.0), DIF_REPLICA_MAX);
}

/* A patch of one period, centred, its samples counted from one of the surface's. */
static dif_status cut(char axis, int n, double pitch_um, double period_um, span *out, dif_error *err)
{
    const double samples = period_um / pitch_um;
    if (samples > n * (1.0 + 1e-9))
        return dif_fail(err, DIF_ERR_ARG, "a period of %g um along %c is larger than the patch of %g um", period_um,
                        axis, n * pitch_um);
    if (samples < 2.0)
        return dif_fail(err, DIF_ERR_ARG, "a period of %g um along %c is below two samples of %g um", period_um, axis,
                        pitch_um);
    out->n = (int)fmin(ceil(samples - 1e-6), n);
    out->step = samples / out->n;
    out->first = (n - out->n) / 2;
    out->period_um = period_um;
    return DIF_OK;
}

static void whole(int n, double pitch_um, span *out)
{
    *out = (span){.n = n, .step = 1.0, .period_um = n * pitch_um};
}

static dif_status check_periods(const dif_measure_opts *opts, dif_error *err)
{
    if (isnan(opts->period_um))
        return dif_fail(err, DIF_ERR_ARG, "%s needs the surface's period, and none was given",
                        dif_method_name(opts->method));
    if (!(opts->period_um > 0.0 && opts->period_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "a period of %g um, want > 0", opts->period_um);
    if (!isnan(opts->period_across_um) && !(opts->period_across_um > 0.0 && opts->period_across_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "a period of %g um across, want > 0", opts->period_across_um);
    if (!isfinite(opts->psi_rad))
        return dif_fail(err, DIF_ERR_ARG, "a groove normal at azimuth %g, want a finite angle", opts->psi_rad);
    return DIF_OK;
}

static dif_status check_replicas(int n, dif_error *err)
{
    if (n == DIF_REPLICAS_FROM_WINDOW || (n >= 1 && n <= DIF_REPLICA_MAX))
        return DIF_OK;
    return dif_fail(err, DIF_ERR_ARG, "%d replicas, want 1 ... %d", n, DIF_REPLICA_MAX);
}

dif_status dif_cell_layout_make(const dif_field *field, const dif_measure_opts *opts, dif_cell_layout *out,
                                dif_error *err)
{
    span x = {0}, y = {0};
    *out = (dif_cell_layout){0};
    dif_status status = check_periods(opts, err);
    if (status == DIF_OK)
        status = check_replicas(opts->n_replica, err);
    if (status == DIF_OK)
        status = check_replicas(opts->n_replica_across, err);
    if (status != DIF_OK)
        return status;
    const double c = fabs(cos(opts->psi_rad)), s = fabs(sin(opts->psi_rad));
    const bool along_x = c >= s;
    if (!isnan(opts->period_across_um) && fmin(c, s) > 1e-6)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "two periods need grooves along x or y, these are turned by %g deg",
                        dif_deg_from_rad(opts->psi_rad));
    whole(field->nx, field->pitch_x_um, &x);
    whole(field->ny, field->pitch_y_um, &y);
    const double period_x_um = along_x ? opts->period_um / c : opts->period_across_um;
    const double period_y_um = along_x ? opts->period_across_um : opts->period_um / s;
    if (!isnan(period_x_um))
        status = cut('x', field->nx, field->pitch_x_um, period_x_um, &x, err);
    if (!isnan(period_y_um) && status == DIF_OK)
        status = cut('y', field->ny, field->pitch_y_um, period_y_um, &y, err);
    if (status != DIF_OK)
        return status;
    x.n_replica =
        replicas(along_x ? opts->n_replica : opts->n_replica_across, opts, x.period_um, field->nx * field->pitch_x_um);
    y.n_replica =
        replicas(along_x ? opts->n_replica_across : opts->n_replica, opts, y.period_um, field->ny * field->pitch_y_um);
    *out = (dif_cell_layout){.nx = x.n,
                             .ny = y.n,
                             .first_x = x.first,
                             .first_y = y.first,
                             .step_x = x.step,
                             .step_y = y.step,
                             .replica = {x.n_replica, y.n_replica, x.period_um, y.period_um}};
    return DIF_OK;
}

/* Linear interpolation at a place in samples: index of the lower neighbour and the upper one's share. */
static size_t neighbour(double at, int n, double *share)
{
    /* a place that should be a sample's is one: a jump there must not be smeared by rounding */
    const double snapped = fabs(at - rint(at)) < 1e-6 ? rint(at) : at;
    const double low = fmin(floor(snapped), n - 1.0);
    *share = low < n - 1.0 ? snapped - low : 0.0;
    return (size_t)low;
}

dif_status dif_measure_cell(const dif_field *field, const dif_measure_opts *opts, dif_field *cell,
                            struct dif_replica *replica, dif_error *err)
{
    const dif_measure_opts defaults = dif_measure_opts_default();
    dif_cell_layout l;
    *cell = (dif_field){0};
    *replica = (dif_replica){0};
    dif_status status = dif_cell_layout_make(field, opts ? opts : &defaults, &l, err);
    if (status == DIF_OK)
        status = dif_field_create(l.nx, l.ny, l.step_x * field->pitch_x_um, l.step_y * field->pitch_y_um, cell, err);
    if (status != DIF_OK)
        return status;
    const size_t nx = (size_t)field->nx;
    for (int iy = 0; iy < l.ny; iy++)
        for (int ix = 0; ix < l.nx; ix++) {
            double sx, sy;
            const size_t x = neighbour(l.first_x + l.step_x * ix, field->nx, &sx);
            const size_t y = neighbour(l.first_y + l.step_y * iy, field->ny, &sy);
            const double *row = field->z_um + y * nx, *below = sy > 0.0 ? row + nx : row;
            const size_t right = sx > 0.0 ? x + 1 : x;
            const double top = (1.0 - sx) * row[x] + sx * row[right];
            const double low = (1.0 - sx) * below[x] + sx * below[right];
            cell->z_um[(size_t)iy * (size_t)l.nx + (size_t)ix] = (1.0 - sy) * top + sy * low;
        }
    *replica = l.replica;
    return DIF_OK;
}

dif_status dif_measure_find_period(const dif_field *field, dif_measure_opts *opts, dif_error *err)
{
    dif_fit_surface_result fit, sharp;
    dif_fit_surface_opts how = dif_fit_surface_opts_default();
    if (!opts)
        return dif_fail(err, DIF_ERR_ARG, "no options to put the period into");
    const dif_status status = dif_fit_surface(field, &how, &fit, err);
    if (status != DIF_OK)
        return status;
    /* A wall has more harmonics than the criterion grants, and those left out pull at the period (by 0.3 nm on a blazed
     * grating of 26 periods of 2500 nm); so ask once more with all of them and take the answer that is surer. */
    how.n_harmonic = DIF_FIT_HARMONIC_MAX;
    how.period_start_um = fit.period_um;
    if (dif_fit_surface(field, &how, &sharp, NULL) == DIF_OK && sharp.period_uncertainty_um < fit.period_uncertainty_um)
        fit = sharp;
    opts->period_um = fit.period_um;
    opts->psi_rad = fit.psi_rad;
    return DIF_OK;
}
