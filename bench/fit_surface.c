/* The harmonic model of a periodic surface: a plane and the harmonics of one wave, fitted to the heights.
 *
 *   h = p_0 + p_1 x + p_2 y + sum_n a_n cos(2 pi n g) + b_n sin(2 pi n g),  g = f_along x' + f_across y'
 *
 * with x' along the start wave's direction, y' across it. Bands of the scan are fitted again, each by itself, with the
 * direction held: their scatter is the uncertainty that the white-noise covariance cannot see. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "bench/fit.h"
#include "bench/fit_ceres.h"
#include "bench/fit_spectrum.h"
#include "core/alloc.h"
#include "core/units.h"

enum {
    ROWS_MAX = 120000,      /* samples of the whole fit                                     */
    ROWS_BAND = 40000,      /* samples of one band                                          */
    ROWS_CRITERION = 20000, /* samples when the number of harmonics is being found          */
    HARMONICS_FOUND = 8,    /* the criterion looks no further                               */
    PARTS = 8,
    N_PLANE = 3,
    OWN_MAX = N_PLANE + 2 * DIF_FIT_HARMONIC_MAX
};

/* A fit that explains less of the variance than this is no grating. */
#define SHARE_EXPLAINED_MIN 0.2
#define PERIODS_WANTED      2.0

dif_fit_surface_opts dif_fit_surface_opts_default(void)
{
    return (dif_fit_surface_opts){.n_harmonic = 0, .period_start_um = (double)NAN, .n_part = PARTS};
}

/* Samples of one fit, in the start wave's frame and in units of `length_um` and `height_um`. */
typedef struct wave_data {
    int n;
    double *along, *across, *z;
    double length_um, height_um;
    int n_harmonic;
    bool across_free;
} wave_data;

/* What one fit found: f in 1/um. */
typedef struct wave_fit {
    double f_along, f_across;
    double covariance[2][2]; /* of f_along, f_across, 1/um^2 */
    double own[OWN_MAX];
    double rms_um; /* of the residuals, recomputed */
    int n_iteration;
} wave_fit;

static void wave_data_free(wave_data *data)
{
    dif_release(data->along);
    dif_release(data->across);
    dif_release(data->z);
}

/* Takes rows iy0 ... iy1-1 and columns ix0 ... ix1-1, thinned evenly to at most n_max samples. */
static dif_status wave_data_make(const dif_field *field, const int rect[4], double psi_rad, int n_max, wave_data *out,
                                 dif_error *err)
{
    const int ix0 = rect[0], ix1 = rect[1], iy0 = rect[2], iy1 = rect[3];
    const double n_all = (double)(ix1 - ix0) * (iy1 - iy0), c = cos(psi_rad), s = sin(psi_rad);
    /* rows are thinned first: neighbours along the fast axis carry the profile */
    const int step_y = (int)ceil(fmin(n_all / n_max, iy1 - iy0)), step_x = (int)ceil(n_all / step_y / n_max);
    const int nx = (ix1 - ix0 + step_x - 1) / step_x, ny = (iy1 - iy0 + step_y - 1) / step_y;
    double sum = 0.0, sum2 = 0.0;
    *out = (wave_data){.length_um = 0.5 * hypot(field->nx * field->pitch_x_um, field->ny * field->pitch_y_um)};
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
            sum += out->z[out->n];
            sum2 += out->z[out->n] * out->z[out->n];
            out->n++;
        }
    out->height_um = sqrt(fmax(sum2 / out->n - (sum / out->n) * (sum / out->n), 0.0));
    if (!(out->height_um > 0.0))
        return dif_fail(err, DIF_ERR_FIT, "the surface is flat: no period to fit");
    for (int i = 0; i < out->n; i++)
        out->z[i] = (out->z[i] - sum / out->n) / out->height_um;
    return DIF_OK;
}

/* Model and Jacobian row of one sample; `shared` is f_along and, if free, f_across, in 1/length. */
static double wave_row(const wave_data *data, int i, const double *par, double *jacobian)
{
    const int n_shared = data->across_free ? 2 : 1;
    const double *own = par + n_shared;
    const double x = data->along[i], y = data->across[i];
    const double phase = DIF_TWO_PI * (par[0] * x + (data->across_free ? par[1] * y : 0.0));
    const double c1 = cos(phase), s1 = sin(phase);
    double c = c1, s = s1, value = own[0] + own[1] * x + own[2] * y, slope = 0.0;
    for (int n = 1; n <= data->n_harmonic; n++) {
        const double a = own[N_PLANE + 2 * (n - 1)], b = own[N_PLANE + 2 * n - 1];
        value += a * c + b * s;
        slope += n * (b * c - a * s);
        if (jacobian) {
            jacobian[n_shared + N_PLANE + 2 * (n - 1)] = c;
            jacobian[n_shared + N_PLANE + 2 * n - 1] = s;
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
    const wave_data *data = self;
    const size_t stride = (size_t)((data->across_free ? 2 : 1) + N_PLANE + 2 * data->n_harmonic);
    for (int i = 0; i < data->n; i++)
        residual[i] = wave_row(data, i, par, jacobian ? jacobian + stride * (size_t)i : NULL);
    return DIF_OK;
}

/* |sum z exp(-2 pi i f x')|^2 over the samples: what one harmonic at f explains. */
static double energy_at(const wave_data *data, double f)
{
    double re = 0.0, im = 0.0;
    for (int i = 0; i < data->n; i++) {
        const double phase = DIF_TWO_PI * f * data->along[i];
        re += data->z[i] * cos(phase);
        im += data->z[i] * sin(phase);
    }
    return re * re + im * im;
}

/* The frequency near `f` (in 1/length) of most energy: a scan over one bin each way, then golden sections. */
static double refine_start(const wave_data *data, double f)
{
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
    return 0.5 * (low + high);
}

/* Fits the wave from f_along, f_across (1/um); linear parts start at zero and are found with the frequency held first. */
static dif_status wave_fit_solve(wave_data *data, double f_along, double f_across, wave_fit *out, dif_error *err)
{
    const int n_shared = data->across_free ? 2 : 1, n_own = N_PLANE + 2 * data->n_harmonic;
    double par[2 + OWN_MAX] = {f_along * data->length_um}, covariance[4] = {0.0};
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
        *out = (wave_fit){.f_along = par[0] * per_um,
                          .f_across = data->across_free ? par[1] * per_um : 0.0,
                          .rms_um = sqrt(sum / data->n) * data->height_um,
                          .n_iteration = report.n_iteration};
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

static void whole_field(const dif_field *field, int rect[4])
{
    rect[0] = rect[2] = 0;
    rect[1] = field->nx;
    rect[3] = field->ny;
}

/* Harmonics that the pitch can carry along the wave. */
static int harmonics_resolved(const dif_field *field, double period_um)
{
    const double n = period_um / (2.0 * fmax(field->pitch_x_um, field->pitch_y_um));
    return n < 1.0 ? 1 : (n > DIF_FIT_HARMONIC_MAX ? DIF_FIT_HARMONIC_MAX : (int)n);
}

/* The number of harmonics: BIC, where residuals correlated from sample to sample count only as often as they are
 * independent, (1 - r)/(1 + r) of each. */
static dif_status find_harmonics(const dif_field *field, double psi_rad, double f, int n_max, int *found,
                                 dif_error *err)
{
    int rect[4];
    wave_data data = {0};
    wave_fit fit;
    double best = (double)INFINITY;
    whole_field(field, rect);
    dif_status status = wave_data_make(field, rect, psi_rad, ROWS_CRITERION, &data, err);
    data.across_free = true;
    *found = 1;
    for (int n = 1; n <= n_max && status == DIF_OK; n++) {
        data.n_harmonic = n;
        status = wave_fit_solve(&data, f, 0.0, &fit, err);
        if (status != DIF_OK)
            break;
        /* a residual as large as the last harmonic's own contribution is correlated over about a quarter of its period */
        const double independent = fmin((double)data.n, 16.0 * n * f * 2.0 * data.length_um * sqrt((double)data.n));
        const double bic = 2.0 * independent * log(fit.rms_um) + (2.0 * n + 5.0) * log(independent);
        if (bic < best) {
            best = bic;
            *found = n;
        }
    }
    wave_data_free(&data);
    return status;
}

/* Rectangle of band i: bands follow the slow axis (y) unless the wave runs along it. */
static void band_rect(const dif_field *field, double psi_rad, int n_part, int i, int rect[4])
{
    whole_field(field, rect);
    const bool by_rows = fabs(cos(psi_rad)) >= fabs(sin(psi_rad));
    const int n = by_rows ? field->ny : field->nx, at = by_rows ? 2 : 0;
    rect[at] = (int)((long long)n * i / n_part);
    rect[at + 1] = (int)((long long)n * (i + 1) / n_part);
}

/* Periods of the bands, the direction held; their standard deviation and the mean's standard error. */
static dif_status fit_bands(const dif_field *field, double psi_rad, double f, int n_harmonic, int n_part,
                            dif_fit_surface_result *out, dif_error *err)
{
    double sum = 0.0, sum2 = 0.0;
    int n = 0;
    for (int i = 0; i < n_part; i++) {
        int rect[4];
        wave_data data = {0};
        wave_fit fit;
        dif_error detail;
        band_rect(field, psi_rad, n_part, i, rect);
        if (rect[1] - rect[0] < 2 || rect[3] - rect[2] < 2)
            continue;
        dif_status status = wave_data_make(field, rect, psi_rad, ROWS_BAND, &data, &detail);
        data.n_harmonic = n_harmonic;
        if (status == DIF_OK)
            status = wave_fit_solve(&data, f, 0.0, &fit, &detail);
        wave_data_free(&data);
        if (status == DIF_ERR_FIT)
            continue;
        if (status != DIF_OK)
            return dif_fail(err, status, "%s", detail.text);
        const double period_um = 1.0 / fit.f_along, off = period_um - out->period_um;
        sum += off;
        sum2 += off * off;
        n++;
    }
    out->n_part = n;
    if (n < 2)
        return dif_fail(err, DIF_ERR_FIT, "fewer than two of %d bands determine a period: no scatter to state", n_part);
    out->band_sd_um = sqrt(fmax(sum2 - sum * sum / n, 0.0) / (n - 1));
    out->period_scatter_um = out->band_sd_um / sqrt((double)n);
    return DIF_OK;
}

/* Start wave: direction and frequency of the strongest peak, or of the strongest one near the wanted period. */
static dif_status find_start(const dif_field *field, double period_start_um, double *psi_rad, double *f, dif_error *err)
{
    dif_spectrum_wave wave[16];
    int n;
    const dif_status status = dif_fit_spectrum_waves(field, 16, wave, &n, err);
    if (status != DIF_OK)
        return status;
    int chosen = -1;
    for (int i = 0; i < n && chosen < 0; i++) {
        const double period_um = 1.0 / hypot(wave[i].fx_per_um, wave[i].fy_per_um);
        if (isnan(period_start_um) || fabs(log(period_um / period_start_um)) < 0.2)
            chosen = i;
    }
    if (chosen < 0)
        return n == 0 ? dif_fail(err, DIF_ERR_FIT, "the surface shows no wave: no period to fit")
                      : dif_fail(err, DIF_ERR_FIT, "no wave near %g um among the surface's strongest", period_start_um);
    *psi_rad = atan2(wave[chosen].fy_per_um, wave[chosen].fx_per_um);
    *f = hypot(wave[chosen].fx_per_um, wave[chosen].fy_per_um);
    return DIF_OK;
}

static dif_status check(const dif_field *field, const dif_fit_surface_opts *opts, dif_error *err)
{
    const dif_status status = dif_field_check(field, err);
    if (status != DIF_OK)
        return status;
    if (!(opts->n_harmonic >= 0 && opts->n_harmonic <= DIF_FIT_HARMONIC_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d harmonics, want 1 ... %d or 0 to let the data decide", opts->n_harmonic,
                        DIF_FIT_HARMONIC_MAX);
    if (!(opts->n_part >= 2 && opts->n_part <= 1000))
        return dif_fail(err, DIF_ERR_ARG, "%d parts, want 2 ... 1000", opts->n_part);
    if (!isnan(opts->period_start_um) && !(opts->period_start_um > 0.0 && opts->period_start_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "start period %g um, want > 0", opts->period_start_um);
    return DIF_OK;
}

/* From the whole fit's frequencies to period and direction with their standard errors. */
static void finish(const wave_fit *fit, double psi_rad, double height_um, dif_fit_surface_result *out)
{
    const double a = fit->f_along, b = fit->f_across, f2 = a * a + b * b, f = sqrt(f2);
    const double(*c)[2] = fit->covariance;
    out->period_um = 1.0 / f;
    out->period_sd_um = sqrt(a * a * c[0][0] + 2.0 * a * b * c[0][1] + b * b * c[1][1]) / (f2 * f);
    out->psi_rad = psi_rad + atan2(b, a);
    out->psi_rad -= DIF_PI * floor(out->psi_rad / DIF_PI);
    out->psi_sd_rad = sqrt(b * b * c[0][0] - 2.0 * a * b * c[0][1] + a * a * c[1][1]) / f2;
    for (int n = 0; n < out->n_harmonic; n++)
        out->amplitude_um[n] = hypot(fit->own[N_PLANE + 2 * n], fit->own[N_PLANE + 2 * n + 1]);
    out->residual_rms_um = fit->rms_um;
    out->residual_share = fit->rms_um / height_um;
    out->n_iteration = fit->n_iteration;
}

/* How much larger the variance of the period is than white residuals would make it. A misfit that repeats from line to
 * line (a wall between two samples, harmonics that were left out) is one observation per place along the wave, however
 * many lines there are. With share c of the residual power in the mean over lines, n samples and n_place places:
 * 1 + c (n/n_place - 1). */
static dif_status design_effect(wave_data *data, const wave_fit *fit, double pitch_um, double *effect, dif_error *err)
{
    const double per_place = data->length_um / pitch_um;
    const int n_place = 2 * (int)ceil(per_place) + 3;
    double par[2 + OWN_MAX] = {fit->f_along * data->length_um, fit->f_across * data->length_um};
    double *mean = dif_alloc((size_t)n_place, sizeof *mean), *count = dif_alloc((size_t)n_place, sizeof *count);
    double power = 0.0, common = 0.0, used = 0.0;
    *effect = 1.0;
    for (int i = 0; i < N_PLANE + 2 * data->n_harmonic; i++)
        par[2 + i] = fit->own[i] / data->height_um;
    for (int i = 0; i < data->n && mean && count; i++) {
        const double r = wave_row(data, i, par, NULL);
        /* places follow the fitted wave's own direction */
        const double at = data->along[i] + data->across[i] * fit->f_across / fit->f_along;
        const int place = (int)fmin(fmax(floor(at * per_place) + n_place / 2, 0.0), n_place - 1.0);
        mean[place] += r;
        count[place] += 1.0;
        power += r * r;
    }
    for (int p = 0; p < n_place && mean && count; p++)
        if (count[p] > 0.0) {
            common += mean[p] * mean[p] / count[p];
            used += 1.0;
        }
    const bool failed = !mean || !count;
    dif_release(mean);
    dif_release(count);
    if (failed)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d places", n_place);
    /* white residuals put used/n of their power into the means by chance */
    const double share = power > 0.0 ? fmax(common / power - used / data->n, 0.0) : 0.0;
    *effect = 1.0 + share * (data->n / used - 1.0);
    return DIF_OK;
}

/* The whole fit: thinned samples of the field, refined start, frequencies free. */
static dif_status fit_whole(const dif_field *field, double psi_rad, double *f, int n_harmonic,
                            dif_fit_surface_result *out, dif_error *err)
{
    int rect[4];
    wave_data data = {0};
    wave_fit fit;
    whole_field(field, rect);
    dif_status status = wave_data_make(field, rect, psi_rad, ROWS_MAX, &data, err);
    data.across_free = true;
    out->n_harmonic = data.n_harmonic = n_harmonic;
    if (status == DIF_OK)
        status = wave_fit_solve(&data, *f, 0.0, &fit, err);
    if (status == DIF_OK) {
        double effect;
        status = design_effect(&data, &fit, fmin(field->pitch_x_um, field->pitch_y_um), &effect, err);
        finish(&fit, psi_rad, data.height_um, out);
        out->period_profile_um = out->period_sd_um * sqrt(effect);
        *f = 1.0 / out->period_um;
    }
    if (status == DIF_OK) {
        if (1.0 - out->residual_share * out->residual_share < SHARE_EXPLAINED_MIN)
            status = dif_fail(err, DIF_ERR_FIT,
                              "one period (%.4g nm) explains only %.0f %% of the heights' variance: not a grating; "
                              "fit a table for its ridges",
                              1e3 * out->period_um, 100.0 * (1.0 - out->residual_share * out->residual_share));
    }
    wave_data_free(&data);
    return status;
}

/* The spectrum's peak, moved to where the thinned samples have most energy. */
static dif_status refine(const dif_field *field, double psi_rad, double *f, dif_error *err)
{
    int rect[4];
    wave_data data = {0};
    whole_field(field, rect);
    const dif_status status = wave_data_make(field, rect, psi_rad, ROWS_CRITERION, &data, err);
    if (status == DIF_OK)
        *f = refine_start(&data, *f * data.length_um) / data.length_um;
    wave_data_free(&data);
    return status;
}

dif_status dif_fit_surface(const dif_field *field, const dif_fit_surface_opts *opts, dif_fit_surface_result *out,
                           dif_error *err)
{
    const dif_fit_surface_opts defaults = dif_fit_surface_opts_default();
    const dif_fit_surface_opts *o = opts ? opts : &defaults;
    double psi_rad = 0.0, f = 0.0;
    *out = (dif_fit_surface_result){0};
    dif_status status = check(field, o, err);
    if (status == DIF_OK)
        status = find_start(field, o->period_start_um, &psi_rad, &f, err);
    if (status == DIF_OK)
        status = refine(field, psi_rad, &f, err);
    const double extent_um =
        fabs(cos(psi_rad)) * field->nx * field->pitch_x_um + fabs(sin(psi_rad)) * field->ny * field->pitch_y_um;
    if (status == DIF_OK && !(f * extent_um >= PERIODS_WANTED))
        status = dif_fail(err, DIF_ERR_FIT, "only %.1f periods of %g um in the patch, want %g", f * extent_um, 1.0 / f,
                          PERIODS_WANTED);
    int n_harmonic = o->n_harmonic;
    if (status == DIF_OK && n_harmonic == 0) {
        const int resolved = harmonics_resolved(field, 1.0 / f);
        status = find_harmonics(field, psi_rad, f, resolved < HARMONICS_FOUND ? resolved : HARMONICS_FOUND, &n_harmonic,
                                err);
    }
    if (status == DIF_OK)
        status = fit_whole(field, psi_rad, &f, n_harmonic, out, err);
    if (status == DIF_OK)
        status = fit_bands(field, out->psi_rad, f, n_harmonic, o->n_part, out, err);
    if (status != DIF_OK) {
        *out = (dif_fit_surface_result){0};
        return status;
    }
    out->period_uncertainty_um = fmax(out->period_profile_um, out->period_scatter_um);
    if (out->residual_share > 0.5)
        snprintf(out->note, sizeof out->note,
                 "one period explains %.0f %% of the heights' variance: not a pure grating",
                 100.0 * (1.0 - out->residual_share * out->residual_share));
    return DIF_OK;
}
