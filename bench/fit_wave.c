#include "bench/fit_wave.h"

#include <math.h>

#include "bench/fit_ceres.h"
#include "core/alloc.h"
#include "core/units.h"

void dif_wave_data_free(dif_wave_data *data)
{
    dif_release(data->along);
    dif_release(data->across);
    dif_release(data->z);
}

/* Below this rms there is nothing but rounding. */
#define HEIGHT_MIN_UM 1e-9

/* Subtracts the least-squares plane of z[ny][nx] (about the grid's middle its three terms are orthogonal) and returns
 * the rms that is left: a tilt must not count as explained by a wave. */
static double level(int nx, int ny, double *z)
{
    double sum = 0.0, sx = 0.0, sy = 0.0, xx = 0.0, yy = 0.0, left = 0.0;
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) {
            const double x = i - 0.5 * (nx - 1), y = j - 0.5 * (ny - 1), h = z[(size_t)j * (size_t)nx + (size_t)i];
            sum += h;
            sx += h * x;
            sy += h * y;
            xx += x * x;
            yy += y * y;
        }
    const double n = (double)nx * ny, slope_x = xx > 0.0 ? sx / xx : 0.0, slope_y = yy > 0.0 ? sy / yy : 0.0;
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) {
            double *h = z + (size_t)j * (size_t)nx + (size_t)i;
            *h -= sum / n + slope_x * (i - 0.5 * (nx - 1)) + slope_y * (j - 0.5 * (ny - 1));
            left += *h * *h;
        }
    return sqrt(left / n);
}

dif_status dif_wave_data_make(const dif_field *field, const int rect[4], double psi_rad, int n_max, dif_wave_data *out,
                              dif_error *err)
{
    const int ix0 = rect[0], ix1 = rect[1], iy0 = rect[2], iy1 = rect[3];
    const double n_all = (double)(ix1 - ix0) * (iy1 - iy0), c = cos(psi_rad), s = sin(psi_rad);
    /* rows are thinned first: neighbours along the fast axis carry the profile */
    const int step_y = (int)ceil(fmin(n_all / n_max, iy1 - iy0)), step_x = (int)ceil(n_all / step_y / n_max);
    const int nx = (ix1 - ix0 + step_x - 1) / step_x, ny = (iy1 - iy0 + step_y - 1) / step_y;
    *out = (dif_wave_data){.length_um = 0.5 * hypot(field->nx * field->pitch_x_um, field->ny * field->pitch_y_um)};
    out->along = dif_alloc((size_t)nx * (size_t)ny, sizeof *out->along);
    out->across = dif_alloc((size_t)nx * (size_t)ny, sizeof *out->across);
    out->z = dif_alloc((size_t)nx * (size_t)ny, sizeof *out->z);
    if (!out->along || !out->across || !out->z)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d x %d samples", nx, ny);
    for (int iy = iy0; iy < iy1; iy += step_y)
        for (int ix = ix0; ix < ix1; ix += step_x) {
            const double x = dif_field_x_um(field, ix), y = dif_field_y_um(field, iy);
            out->along[out->n] = (c * x + s * y) / out->length_um;
            out->across[out->n] = (c * y - s * x) / out->length_um;
            out->z[out->n] = field->z_um[(size_t)iy * (size_t)field->nx + (size_t)ix];
            out->n++;
        }
    out->height_um = level(nx, ny, out->z);
    if (!(out->height_um > HEIGHT_MIN_UM))
        return dif_fail(err, DIF_ERR_FIT, "the surface is flat: no period to fit");
    for (int i = 0; i < out->n; i++)
        out->z[i] /= out->height_um;
    return DIF_OK;
}

/* Model and Jacobian row of one sample; `shared` is f_along and, if free, f_across, in 1/length. */
static double wave_row(const dif_wave_data *data, int i, const double *par, double *jacobian)
{
    const int n_shared = data->across_free ? 2 : 1;
    const double *own = par + n_shared;
    const double x = data->along[i], y = data->across[i];
    const double phase = DIF_TWO_PI * (par[0] * x + (data->across_free ? par[1] * y : 0.0));
    const double c1 = cos(phase), s1 = sin(phase);
    double c = c1, s = s1, value = own[0] + own[1] * x + own[2] * y, slope = 0.0;
    for (int n = 1; n <= data->n_harmonic; n++) {
        const double a = own[DIF_WAVE_PLANE + 2 * (n - 1)], b = own[DIF_WAVE_PLANE + 2 * n - 1];
        value += a * c + b * s;
        slope += n * (b * c - a * s);
        if (jacobian) {
            jacobian[n_shared + DIF_WAVE_PLANE + 2 * (n - 1)] = c;
            jacobian[n_shared + DIF_WAVE_PLANE + 2 * n - 1] = s;
        }
        const double next = c * c1 - s * s1;
        s = s * c1 + c * s1;
        c = next;
    }
    if (jacobian) {
        jacobian[0] = DIF_TWO_PI * slope * x;
        if (data->across_free)
            jacobian[1] = DIF_TWO_PI * slope * y;
        jacobian[n_shared] = 1.0;
        jacobian[n_shared + 1] = x;
        jacobian[n_shared + 2] = y;
    }
    return value - data->z[i];
}

static dif_status wave_eval(void *self, const double *par, double *residual, double *jacobian)
{
    const dif_wave_data *data = self;
    const size_t stride = (size_t)((data->across_free ? 2 : 1) + DIF_WAVE_PLANE + 2 * data->n_harmonic);
    for (int i = 0; i < data->n; i++)
        residual[i] = wave_row(data, i, par, jacobian ? jacobian + stride * (size_t)i : NULL);
    return DIF_OK;
}

/* |sum z exp(-2 pi i f x')|^2 over the samples: what one harmonic at f explains. */
static double energy_at(const dif_wave_data *data, double f)
{
    double re = 0.0, im = 0.0;
    for (int i = 0; i < data->n; i++) {
        const double phase = DIF_TWO_PI * f * data->along[i];
        re += data->z[i] * cos(phase);
        im += data->z[i] * sin(phase);
    }
    return re * re + im * im;
}

/* A scan over one bin each way, then golden sections. */
double dif_wave_refine(const dif_wave_data *data, double f_per_um)
{
    const double f = f_per_um * data->length_um;
    const double bin = 0.5, golden = 0.5 * (sqrt(5.0) - 1.0); /* the patch is about two lengths long */
    double best = f, most = -1.0;
    for (int i = -8; i <= 8; i++) {
        const double here = energy_at(data, f + bin * i / 8.0);
        if (here > most) {
            most = here;
            best = f + bin * i / 8.0;
        }
    }
    double low = best - bin / 8.0, high = best + bin / 8.0;
    for (int i = 0; i < 20; i++) {
        const double a = high - golden * (high - low), b = low + golden * (high - low);
        if (energy_at(data, a) > energy_at(data, b))
            high = b;
        else
            low = a;
    }
    return 0.5 * (low + high) / data->length_um;
}

/* Fits the wave from f_along, f_across (1/um); linear parts start at zero and are found with the frequency held first. */
dif_status dif_wave_fit_solve(dif_wave_data *data, double f_along, double f_across, dif_wave_fit *out, dif_error *err)
{
    const int n_shared = data->across_free ? 2 : 1, n_own = DIF_WAVE_PLANE + 2 * data->n_harmonic;
    double par[2 + DIF_WAVE_OWN_MAX] = {f_along * data->length_um}, covariance[4] = {0.0};
    int *block = dif_alloc((size_t)data->n, sizeof *block);
    double *residual = dif_alloc((size_t)data->n, sizeof *residual);
    dif_ls_report report = {0};
    dif_status status = block && residual ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for %d rows", data->n);
    if (data->across_free)
        par[1] = f_across * data->length_um;
    dif_ls ls = {.n_row = data->n,
                 .n_shared = n_shared,
                 .n_block = 1,
                 .size = &n_own,
                 .row_block = block,
                 .par = par,
                 .stride = n_shared + n_own,
                 .n_iteration_max = 60,
                 .hold_shared = true,
                 .eval = wave_eval,
                 .self = data};
    if (status == DIF_OK)
        status = dif_ls_solve(&ls, NULL, &report, err);
    ls.hold_shared = false;
    ls.want_covariance = true;
    if (status == DIF_OK)
        status = dif_ls_solve(&ls, covariance, &report, err);
    if (status == DIF_OK && !report.converged)
        status = dif_fail(err, DIF_ERR_FIT, "the fit did not converge in %d iterations", report.n_iteration);
    if (status == DIF_OK && !report.has_covariance)
        status = dif_fail(err, DIF_ERR_FIT, "the heights do not determine the period");
    if (status == DIF_OK) {
        double sum = 0.0;
        status = wave_eval(data, par, residual, NULL);
        for (int i = 0; i < data->n; i++)
            sum += residual[i] * residual[i];
        const double variance = sum / fmax(data->n - n_shared - n_own, 1.0), per_um = 1.0 / data->length_um;
        *out = (dif_wave_fit){.f_along = par[0] * per_um,
                              .f_across = data->across_free ? par[1] * per_um : 0.0,
                              .rms_um = sqrt(sum / data->n) * data->height_um,
                              .n_iteration = report.n_iteration,
                              .variance = variance,
                              .unit_covariance = covariance[0]};
        for (int i = 0; i < n_shared; i++)
            for (int j = 0; j < n_shared; j++)
                out->covariance[i][j] = variance * covariance[i * n_shared + j] * per_um * per_um;
        for (int i = 0; i < n_own; i++)
            out->own[i] = par[n_shared + i] * data->height_um;
        /* the solver's own account against the recomputed one */
        if (fabs(0.5 * sum - report.cost) > 1e-6 * fmax(report.cost, 1e-12))
            status = dif_fail(err, DIF_ERR_FIT, "residuals recomputed outside the solver disagree with it");
    }
    dif_release(block);
    dif_release(residual);
    return status;
}

/* Sums of score (residual times the model's change with f) over all samples at one place along the wave. */
static void sum_scores(dif_wave_data *data, const dif_wave_fit *fit, double per_place, int n_place, double *score)
{
    double par[2 + DIF_WAVE_OWN_MAX] = {fit->f_along * data->length_um, fit->f_across * data->length_um};
    double jacobian[2 + DIF_WAVE_OWN_MAX];
    for (int i = 0; i < DIF_WAVE_PLANE + 2 * data->n_harmonic; i++)
        par[2 + i] = fit->own[i] / data->height_um;
    for (int i = 0; i < data->n; i++) {
        const double residual = wave_row(data, i, par, jacobian);
        /* places follow the fitted wave's own direction */
        const double at = data->along[i] + data->across[i] * fit->f_across / fit->f_along;
        const int place = (int)fmin(fmax(floor(at * per_place) + n_place / 2, 0.0), n_place - 1.0);
        score[place] += residual * jacobian[0];
    }
}

dif_status dif_wave_design_effect(dif_wave_data *data, const dif_wave_fit *fit, double pitch_um, double *effect,
                                  dif_error *err)
{
    const double per_place = data->length_um / pitch_um;
    const int n_place = 2 * (int)ceil(per_place) + 3;
    double *score = dif_alloc((size_t)n_place, sizeof *score), sum = 0.0;
    *effect = 1.0;
    if (!score)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d places", n_place);
    sum_scores(data, fit, per_place, n_place, score);
    for (int p = 0; p < n_place; p++)
        sum += score[p] * score[p];
    dif_release(score);
    if (fit->variance > 0.0)
        *effect = fmax(sum * fit->unit_covariance / fit->variance, 1.0);
    return DIF_OK;
}
