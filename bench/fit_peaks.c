#include <math.h>

#include "bench/fit_cells.h"
#include "core/alloc.h"

enum { N_BIN_MAX = 2000000 };

dif_status dif_fit_spectrum_create(const dif_fit_view *view, double step_per_um, dif_fit_spectrum *out, dif_error *err)
{
    *out = (dif_fit_spectrum){0};
    const double bins = ceil((view->f_high - view->f_low) / step_per_um);
    if (!(bins < N_BIN_MAX))
        return dif_fail(err, DIF_ERR_SIZE, "%g bins of spatial frequency, the scan is too wide for its lines", bins);
    out->n = (int)bins + 1;
    out->f_low = view->f_low;
    out->step_per_um = step_per_um;
    out->mean = dif_alloc((size_t)out->n, sizeof *out->mean);
    out->count = dif_alloc((size_t)out->n, sizeof *out->count);
    if (!out->mean || !out->count) {
        dif_fit_spectrum_free(out);
        return dif_fail(err, DIF_ERR_NOMEM, "%g bins of spatial frequency", bins);
    }
    const dif_plan *plan = &view->table->plan;
    for (int il = 0; il < plan->n_lambda; il++)
        for (int ia = 0; ia < plan->n_angle; ia++) {
            const double y = dif_fit_view_power(view, il, ia);
            if (!isfinite(y))
                continue;
            const int bin = (int)((view->sin_sum[ia] / plan->lambda_um[il] - out->f_low) / step_per_um);
            out->mean[bin] += y;
            out->count[bin]++;
        }
    for (int i = 0; i < out->n; i++)
        out->mean[i] = out->count[i] > 0 ? out->mean[i] / out->count[i] : (double)NAN;
    return DIF_OK;
}

void dif_fit_spectrum_free(dif_fit_spectrum *spectrum)
{
    if (!spectrum)
        return;
    dif_release(spectrum->mean);
    dif_release(spectrum->count);
    *spectrum = (dif_fit_spectrum){0};
}

static int highest(const dif_fit_spectrum *s)
{
    int best = -1;
    for (int i = 0; i < s->n; i++)
        if (isfinite(s->mean[i]) && (best < 0 || s->mean[i] > s->mean[best]))
            best = i;
    return best;
}

static double lowest_mean(const dif_fit_spectrum *s)
{
    double low = INFINITY;
    for (int i = 0; i < s->n; i++)
        low = fmin(low, s->mean[i]); /* fmin passes NaN over */
    return low;
}

/* Distance from the peak to where it falls below half of its height over the floor; direction +1 or -1. */
static double half_width(const dif_fit_spectrum *s, int peak, double floor_value, int direction)
{
    const double half = floor_value + 0.5 * (s->mean[peak] - floor_value);
    double last = s->mean[peak];
    for (int i = peak + direction; i >= 0 && i < s->n; i += direction) {
        if (!isfinite(s->mean[i]))
            continue;
        if (s->mean[i] < half)
            return s->step_per_um * (fabs((double)(i - peak)) - (half - s->mean[i]) / (last - s->mean[i]));
        last = s->mean[i];
    }
    return NAN;
}

double dif_fit_spectrum_peak_sigma(const dif_fit_spectrum *s)
{
    const int peak = highest(s);
    if (peak < 0)
        return NAN;
    const double floor_value = lowest_mean(s);
    const double left = half_width(s, peak, floor_value, -1), right = half_width(s, peak, floor_value, 1);
    return 0.5 * (left + right) / sqrt(2.0 * log(2.0));
}

/* A bin is a peak if it is the highest within the line's width on both sides and the range goes on there. */
static bool is_peak(const dif_fit_spectrum *s, int i, int reach)
{
    if (i - reach < 0 || i + reach >= s->n)
        return false;
    int n_left = 0, n_right = 0;
    for (int j = 1; j <= reach; j++) {
        if (s->mean[i - j] > s->mean[i] || s->mean[i + j] > s->mean[i])
            return false;
        n_left += isfinite(s->mean[i - j]);
        n_right += isfinite(s->mean[i + j]);
    }
    return n_left > 0 && n_right > 0;
}

/* Centre of a peak to a part of a bin. */
static double peak_centre(const dif_fit_spectrum *s, int i)
{
    const double a = s->mean[i - 1], b = s->mean[i], c = s->mean[i + 1];
    const double curvature = a - 2.0 * b + c;
    double shift = isfinite(curvature) && curvature < 0.0 ? 0.5 * (a - c) / curvature : 0.0;
    shift = fmin(fmax(shift, -0.5), 0.5);
    return s->f_low + (i + 0.5 + shift) * s->step_per_um;
}

static bool far_from_others(double f, int n, const dif_fit_candidate *c, double distance)
{
    for (int i = 0; i < n; i++)
        if (fabs(c[i].f_per_um - f) < distance)
            return false;
    return true;
}

int dif_fit_spectrum_candidates(dif_fit_spectrum *s, const dif_fit_lineshape *line, int n_max, dif_fit_candidate *out)
{
    /* a peak weaker than this share of the strongest is not looked for */
    const double share_min = 1e-4, distance = 2.5 * line->sigma_per_um;
    const int reach = 1 + (int)(line->sigma_per_um / s->step_per_um);
    int n = 0;
    while (n < n_max) {
        int best = -1;
        for (int i = 0; i < s->n; i++)
            if (s->mean[i] > 0.0 && (best < 0 || s->mean[i] > s->mean[best]) && is_peak(s, i, reach) &&
                far_from_others(s->f_low + (i + 0.5) * s->step_per_um, n, out, distance))
                best = i;
        if (best < 0 || (n > 0 && s->mean[best] < share_min * out[0].height))
            break;
        out[n] = (dif_fit_candidate){.f_per_um = peak_centre(s, best), .height = s->mean[best]};
        for (int i = 0; i < s->n; i++)
            s->mean[i] -=
                out[n].height *
                dif_fit_line_at(line, s->f_low + (i + 0.5) * s->step_per_um - out[n].f_per_um, line->sigma_per_um).l;
        n++;
    }
    return n;
}
