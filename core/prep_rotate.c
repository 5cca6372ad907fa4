/* Turning the sample, and cutting it to whole periods. */
#include "core/alloc.h"
#include "core/prep_impl.h"
#include "core/units.h"

/* A quarter turn counter-clockwise: (x, y) goes to (-y, x). */
static dif_status turn_quarter(dif_field *field, dif_error *err)
{
    dif_field out;
    const dif_status status = dif_field_create(field->ny, field->nx, field->pitch_y_um, field->pitch_x_um, &out, err);
    if (status)
        return status;
    for (int iy = 0; iy < out.ny; iy++)
        for (int ix = 0; ix < out.nx; ix++)
            out.z_um[(size_t)iy * (size_t)out.nx + (size_t)ix] =
                field->z_um[(size_t)ix * (size_t)field->nx + (size_t)(field->nx - 1 - iy)];
    dif_prep_replace(field, &out);
    return DIF_OK;
}

/* A half turn in place. */
static void turn_half(dif_field *field)
{
    const size_t n = dif_field_n(field);
    for (size_t i = 0; i < n / 2; i++) {
        const double keep = field->z_um[i];
        field->z_um[i] = field->z_um[n - 1 - i];
        field->z_um[n - 1 - i] = keep;
    }
}

/* The largest upright rectangle inside a w x h rectangle that is turned by an angle. */
static void inscribed(double w, double h, double angle_rad, double *width, double *height)
{
    const double s = fabs(sin(angle_rad)), c = fabs(cos(angle_rad));
    const double longer = fmax(w, h), shorter = fmin(w, h);
    if (shorter <= 2.0 * s * c * longer || fabs(s - c) < 1e-10) { /* two corners touch the longer side */
        const double half = 0.5 * shorter;
        *width = w >= h ? half / s : half / c;
        *height = w >= h ? half / c : half / s;
    } else {
        const double d = c * c - s * s;
        *width = (w * c - h * s) / d;
        *height = (h * c - w * s) / d;
    }
}

static double finer_pitch(const dif_field *field)
{
    return fmin(field->pitch_x_um, field->pitch_y_um);
}

dif_status dif_prep_rotate(dif_field *field, double angle_rad, dif_error *err)
{
    dif_status status = dif_prep_check(field, err);
    if (status)
        return status;
    if (!(fabs(angle_rad) <= 1e6))
        return dif_fail(err, DIF_ERR_ARG, "rotation by %g rad, want a finite angle", angle_rad);
    const double quarters = angle_rad / (0.5 * DIF_PI), nearest = floor(quarters + 0.5);
    if (fabs(quarters - nearest) < 1e-12 * fmax(fabs(quarters), 1.0)) {
        const int turns = (int)(nearest - 4.0 * floor(nearest / 4.0));
        if (turns >= 2)
            turn_half(field);
        return turns % 2 ? turn_quarter(field, err) : DIF_OK;
    }
    status = dif_prep_check_whole(field, "rotation", err);
    if (status)
        return status;
    const double pitch_um = finer_pitch(field);
    double width_um, height_um;
    inscribed(field->nx * field->pitch_x_um, field->ny * field->pitch_y_um, angle_rad, &width_um, &height_um);
    const dif_prep_grid grid = {.nx = dif_prep_samples_in(width_um, pitch_um),
                                .ny = dif_prep_samples_in(height_um, pitch_um),
                                .pitch_x_um = pitch_um,
                                .pitch_y_um = pitch_um,
                                .angle_rad = -angle_rad};
    if (grid.nx < 2 || grid.ny < 2)
        return dif_fail(err, DIF_ERR_SIZE, "rotation by %g deg leaves %d x %d samples, want at least 2 x 2",
                        dif_deg_from_rad(angle_rad), grid.nx, grid.ny);
    return dif_prep_regrid(field, &grid, err);
}

/* As many periods as an extent has room for, on samples of at most `pitch_um`; without a period, as many samples. */
static int cut_axis(double extent_um, double period_um, double pitch_um, int *n, double *pitch_out_um)
{
    const bool is_periodic = period_um > 0.0;
    const int n_period = is_periodic ? dif_prep_samples_in(extent_um, period_um) : 0;
    *n = is_periodic ? (int)ceil(n_period * period_um / pitch_um * (1.0 - 1e-9))
                     : dif_prep_samples_in(extent_um, pitch_um);
    *pitch_out_um = n_period > 0 ? n_period * period_um / *n : pitch_um;
    return n_period;
}

dif_status dif_prep_whole_periods(dif_field *field, const dif_prep_lattice *lattice, int n_period[2], dif_error *err)
{
    const dif_status status = dif_prep_check_whole(field, "cutting to whole periods", err);
    if (n_period)
        n_period[0] = n_period[1] = 0;
    if (status)
        return status;
    if (!(lattice->period_um > 0.0 && isfinite(lattice->period_um)) || !isfinite(lattice->psi_rad))
        return dif_fail(err, DIF_ERR_ARG, "lattice of period %g um at %g rad, want a finite length > 0 and an angle",
                        lattice->period_um, lattice->psi_rad);
    if (!(isnan(lattice->across_um) || (lattice->across_um > 0.0 && isfinite(lattice->across_um))))
        return dif_fail(err, DIF_ERR_ARG, "period %g um across, want a finite length > 0 or none", lattice->across_um);
    const bool to_x = fabs(cos(lattice->psi_rad)) >= fabs(sin(lattice->psi_rad));
    double turn_rad = lattice->psi_rad - (to_x ? 0.0 : 0.5 * DIF_PI), width_um, height_um;
    turn_rad -= DIF_PI * floor(turn_rad / DIF_PI + 0.5); /* the grid's x axis, within 45 degrees of the field's */
    inscribed(field->nx * field->pitch_x_um, field->ny * field->pitch_y_um, turn_rad, &width_um, &height_um);
    const double along_um = lattice->period_um, across_um = lattice->across_um, pitch_um = finer_pitch(field);
    dif_prep_grid grid = {.angle_rad = turn_rad};
    const int nx = cut_axis(width_um, to_x ? along_um : across_um, pitch_um, &grid.nx, &grid.pitch_x_um);
    const int ny = cut_axis(height_um, to_x ? across_um : along_um, pitch_um, &grid.ny, &grid.pitch_y_um);
    if ((to_x ? nx : ny) < 1 || (!isnan(across_um) && (to_x ? ny : nx) < 1))
        return dif_fail(err, DIF_ERR_SIZE, "not one period of %g um inside %g x %g um",
                        to_x == (nx < 1) ? along_um : across_um, width_um, height_um);
    if (grid.nx < 2 || grid.ny < 2)
        return dif_fail(err, DIF_ERR_SIZE, "%d x %d samples are left, want at least 2 x 2", grid.nx, grid.ny);
    if (n_period) {
        n_period[0] = to_x ? nx : ny;
        n_period[1] = to_x ? ny : nx;
    }
    return dif_prep_regrid(field, &grid, err);
}
