#include "bench/fit_bands.h"

#include <math.h>

#include "bench/fit_wave.h"
#include "core/units.h"

enum { ROWS_BAND = 40000 /* samples of one band */ };

/* Periods that a band must hold if it cuts the wave itself. */
static const double PERIODS_BAND = 3.0;

/* Band i of n: rows of the slow axis (y), or columns. */
static void band_rect(const dif_field *field, bool by_rows, int n_part, int i, int rect[4])
{
    const int n = by_rows ? field->ny : field->nx, at = by_rows ? 2 : 0;
    rect[0] = rect[2] = 0;
    rect[1] = field->nx;
    rect[3] = field->ny;
    rect[at] = (int)((long long)n * i / n_part);
    rect[at + 1] = (int)((long long)n * (i + 1) / n_part);
}

/* The period of one rectangle, the direction held; DIF_ERR_FIT if it has none of its own. */
static dif_status fit_band(const dif_field *field, const int rect[4], double f_per_um,
                           const dif_fit_surface_result *whole, dif_fit_band *out, dif_error *err)
{
    dif_wave_data data = {0};
    dif_wave_fit fit;
    if (rect[1] - rect[0] < 2 || rect[3] - rect[2] < 2)
        return DIF_ERR_FIT;
    dif_status status = dif_wave_data_make(field, rect, whole->psi_rad, ROWS_BAND, &data, err);
    data.n_harmonic = whole->n_harmonic;
    if (status == DIF_OK)
        status = dif_wave_fit_solve(&data, f_per_um, 0.0, &fit, err);
    dif_wave_data_free(&data);
    if (status == DIF_OK)
        *out = (dif_fit_band){.y_um = 0.5 * (dif_field_y_um(field, rect[2]) + dif_field_y_um(field, rect[3] - 1)),
                              .period_um = 1.0 / fit.f_along,
                              .period_sd_um = sqrt(fit.covariance[0][0]) / (fit.f_along * fit.f_along)};
    return status;
}

/* All bands that determine a period, band[n_part]; *n of them. */
static dif_status fit_bands(const dif_field *field, bool by_rows, double f_per_um, int n_part,
                            const dif_fit_surface_result *whole, dif_fit_band *band, int *n, dif_error *err)
{
    *n = 0;
    for (int i = 0; i < n_part; i++) {
        int rect[4];
        dif_error detail = {0};
        band_rect(field, by_rows, n_part, i, rect);
        const dif_status status = fit_band(field, rect, f_per_um, whole, &band[*n], &detail);
        if (status == DIF_OK)
            ++*n;
        else if (status != DIF_ERR_FIT)
            return dif_fail(err, status, "%s", detail.text);
    }
    return DIF_OK;
}

/* Student's t beyond which 1 % lies, both sides together. */
static double student_1_percent(int freedom)
{
    static const double few[] = {63.66, 9.925, 5.841, 4.604, 4.032, 3.707, 3.499, 3.355, 3.250, 3.169};
    const double z = 2.5758;
    return freedom <= 10 ? few[freedom - 1] : z + (z * z * z + z) / (4.0 * freedom);
}

/* A straight line through the bands; its error from how they scatter about it. */
static void find_drift(const dif_field *field, double period_um, dif_fit_drift *drift)
{
    const int n = drift->n_band;
    double y = 0.0, p = 0.0, yy = 0.0, yp = 0.0, left = 0.0;
    drift->slope = drift->slope_sd = drift->share = (double)NAN;
    if (n < 3)
        return;
    for (int i = 0; i < n; i++) {
        y += drift->band[i].y_um / n;
        p += (drift->band[i].period_um - period_um) / n;
    }
    for (int i = 0; i < n; i++) {
        const double dy = drift->band[i].y_um - y, dp = drift->band[i].period_um - period_um - p;
        yy += dy * dy;
        yp += dy * dp;
    }
    drift->slope = yp / yy;
    for (int i = 0; i < n; i++) {
        const double off = drift->band[i].period_um - period_um - p - drift->slope * (drift->band[i].y_um - y);
        left += off * off;
    }
    drift->slope_sd = sqrt(left / (n - 2) / yy);
    drift->share = drift->slope * field->ny * field->pitch_y_um / period_um;
    drift->is_significant = fabs(drift->slope) > student_1_percent(n - 2) * drift->slope_sd;
}

/* Bands of rows: those of the scatter if the wave runs along the lines, else as many as hold enough of it. */
static dif_status follow_slow_axis(const dif_field *field, bool by_rows, double f_per_um, int n_part,
                                   const dif_fit_band *band, int n_band, dif_fit_surface_result *out, dif_error *err)
{
    dif_status status = DIF_OK;
    if (by_rows) {
        for (int i = 0; i < n_band; i++)
            out->drift.band[i] = band[i];
        out->drift.n_band = n_band;
    } else {
        const double n_room = field->ny * field->pitch_y_um * fabs(sin(out->psi_rad)) * f_per_um / PERIODS_BAND;
        status =
            fit_bands(field, true, f_per_um, (int)fmin(n_room, n_part), out, out->drift.band, &out->drift.n_band, err);
    }
    find_drift(field, out->period_um, &out->drift);
    return status;
}

dif_status dif_fit_bands(const dif_field *field, double f_per_um, int n_part, dif_fit_surface_result *out,
                         dif_error *err)
{
    dif_fit_band band[DIF_FIT_BAND_MAX];
    double sum = 0.0, sum2 = 0.0;
    int n = 0;
    const bool by_rows = fabs(cos(out->psi_rad)) >= fabs(sin(out->psi_rad)); /* else the wave runs along y */
    const dif_status status = fit_bands(field, by_rows, f_per_um, n_part, out, band, &n, err);
    if (status)
        return status;
    out->n_part = n;
    if (n < 2)
        return dif_fail(err, DIF_ERR_FIT, "fewer than two of %d bands determine a period: no scatter to state", n_part);
    for (int i = 0; i < n; i++) {
        const double off = band[i].period_um - out->period_um;
        sum += off;
        sum2 += off * off;
    }
    out->band_sd_um = sqrt(fmax(sum2 - sum * sum / n, 0.0) / (n - 1));
    out->period_scatter_um = out->band_sd_um / sqrt((double)n);
    return follow_slow_axis(field, by_rows, f_per_um, n_part, band, n, out, err);
}
