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
#include "bench/fit_bands.h"
#include "bench/fit_spectrum.h"
#include "bench/fit_wave.h"
#include "core/units.h"

enum {
    ROWS_MAX = 120000,      /* samples of the whole fit                                     */
    ROWS_CRITERION = 20000, /* samples when the number of harmonics is being found          */
    PARTS = 8
};

/* A fit that explains less of the variance than this is no grating. */
#define SHARE_EXPLAINED_MIN 0.2
#define PERIODS_WANTED      2.0

dif_fit_surface_opts dif_fit_surface_opts_default(void)
{
    return (dif_fit_surface_opts){
        .n_harmonic = 0, .period_start_um = (double)NAN, .n_part = PARTS, .psi_start_rad = (double)NAN};
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

/* Numbers of harmonics that are tried: every one while they are few, then steps of about a third. */
static const int CANDIDATES[] = {1, 2, 3, 4, 6, 8, 11, 15, 20, 26, 32};
enum { N_CANDIDATE = sizeof CANDIDATES / sizeof *CANDIDATES };

/* The number of harmonics: BIC, where residuals correlated from sample to sample count only as often as they are
 * independent, (1 - r)/(1 + r) of each. */
static dif_status find_harmonics(const dif_field *field, double psi_rad, double f, int n_max, int *found,
                                 dif_error *err)
{
    int rect[4];
    dif_wave_data data = {0};
    dif_wave_fit fit;
    double best = (double)INFINITY;
    whole_field(field, rect);
    dif_status status = dif_wave_data_make(field, rect, psi_rad, ROWS_CRITERION, &data, err);
    data.across_free = true;
    *found = 1;
    for (int i = 0; i < N_CANDIDATE && CANDIDATES[i] <= n_max && status == DIF_OK; i++) {
        const int n = data.n_harmonic = CANDIDATES[i];
        status = dif_wave_fit_solve(&data, f, 0.0, &fit, err);
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
    dif_wave_data_free(&data);
    return status;
}

/* Start wave: direction and frequency of the strongest peak, or of the strongest one near the wanted period. */
static dif_status find_start(const dif_field *field, const dif_fit_surface_opts *opts, double *psi_rad, double *f,
                             dif_error *err)
{
    const double period_start_um = opts->period_start_um;
    dif_spectrum_wave wave[16];
    int n;
    const dif_status status = dif_fit_spectrum_waves(field, 16, wave, &n, err);
    if (status != DIF_OK)
        return status;
    int chosen = -1;
    for (int i = 0; i < n && chosen < 0; i++) {
        const double period_um = 1.0 / hypot(wave[i].fx_per_um, wave[i].fy_per_um);
        const double off_rad = atan2(wave[i].fy_per_um, wave[i].fx_per_um) - opts->psi_start_rad;
        if ((isnan(period_start_um) || fabs(log(period_um / period_start_um)) < 0.2) &&
            (isnan(off_rad) || fabs(sin(off_rad)) < 0.2))
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
    if (!(opts->n_part >= 2 && opts->n_part <= DIF_FIT_BAND_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d parts, want 2 ... %d", opts->n_part, DIF_FIT_BAND_MAX);
    if (!isnan(opts->period_start_um) && !(opts->period_start_um > 0.0 && opts->period_start_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "start period %g um, want > 0", opts->period_start_um);
    if (!isnan(opts->psi_start_rad) && !(fabs(opts->psi_start_rad) < 1e6))
        return dif_fail(err, DIF_ERR_ARG, "start direction %g rad, want a finite angle", opts->psi_start_rad);
    return DIF_OK;
}

/* From the whole fit's frequencies to period and direction with their standard errors. */
static void finish(const dif_wave_fit *fit, double psi_rad, double height_um, dif_fit_surface_result *out)
{
    const double a = fit->f_along, b = fit->f_across, f2 = a * a + b * b, f = sqrt(f2);
    const double(*c)[2] = fit->covariance;
    out->period_um = 1.0 / f;
    out->period_sd_um = sqrt(a * a * c[0][0] + 2.0 * a * b * c[0][1] + b * b * c[1][1]) / (f2 * f);
    out->psi_rad = psi_rad + atan2(b, a);
    out->psi_rad -= DIF_PI * floor(out->psi_rad / DIF_PI);
    out->psi_sd_rad = sqrt(b * b * c[0][0] - 2.0 * a * b * c[0][1] + a * a * c[1][1]) / f2;
    for (int n = 0; n < out->n_harmonic; n++)
        out->amplitude_um[n] = hypot(fit->own[DIF_WAVE_PLANE + 2 * n], fit->own[DIF_WAVE_PLANE + 2 * n + 1]);
    out->residual_rms_um = fit->rms_um;
    out->residual_share = fit->rms_um / height_um;
    out->n_iteration = fit->n_iteration;
}

/* The whole fit: thinned samples of the field, refined start, frequencies free. */
static dif_status fit_whole(const dif_field *field, double psi_rad, double *f, int n_harmonic,
                            dif_fit_surface_result *out, dif_error *err)
{
    int rect[4];
    dif_wave_data data = {0};
    dif_wave_fit fit;
    whole_field(field, rect);
    dif_status status = dif_wave_data_make(field, rect, psi_rad, ROWS_MAX, &data, err);
    data.across_free = true;
    out->n_harmonic = data.n_harmonic = n_harmonic;
    if (status == DIF_OK)
        status = dif_wave_fit_solve(&data, *f, 0.0, &fit, err);
    if (status == DIF_OK) {
        double effect;
        status = dif_wave_design_effect(&data, &fit, fmin(field->pitch_x_um, field->pitch_y_um), &effect, err);
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
    dif_wave_data_free(&data);
    return status;
}

/* The spectrum's peak, moved to where the thinned samples have most energy. */
static dif_status refine(const dif_field *field, double psi_rad, double *f, dif_error *err)
{
    int rect[4];
    dif_wave_data data = {0};
    whole_field(field, rect);
    const dif_status status = dif_wave_data_make(field, rect, psi_rad, ROWS_CRITERION, &data, err);
    if (status == DIF_OK)
        *f = dif_wave_refine(&data, *f);
    dif_wave_data_free(&data);
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
        status = find_start(field, o, &psi_rad, &f, err);
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
        status = find_harmonics(field, psi_rad, f, resolved, &n_harmonic, err);
    }
    if (status == DIF_OK)
        status = fit_whole(field, psi_rad, &f, n_harmonic, out, err);
    if (status == DIF_OK)
        status = dif_fit_bands(field, f, o->n_part, out, err);
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
