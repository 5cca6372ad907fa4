/* newlocale, uselocale: numbers must not depend on the locale of the calling program. */
#define _POSIX_C_SOURCE 200809L

#include "bench/scan.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/units.h"

static const double POINTS_MAX = 1e7;
static const double WHOLE_TOL = 1e-6; /* of one step: what counts as a whole number of steps */

/* Reads one plain decimal number at *at and moves past it; no blanks, hex, inf or nan. */
static bool read_number(const char **at, double *value)
{
    const size_t n = strspn(*at, "+-.0123456789eE");
    if (n == 0)
        return false;
    char *end = NULL;
    *value = strtod(*at, &end);
    if (end != *at + n || !isfinite(*value))
        return false;
    *at = end;
    return true;
}

/* Splits "A" or "A:B:C" into 1 or 3 numbers; 0 if malformed. */
static int read_numbers(const char *text, double number[3])
{
    for (int n = 0; n < 3; n++) {
        if (!read_number(&text, &number[n]))
            return 0;
        if (*text == '\0')
            return n == 1 ? 0 : n + 1;
        if (*text != ':')
            return 0;
        text++;
    }
    return 0;
}

static int read_numbers_c_locale(const char *text, double number[3])
{
    const locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    const locale_t before = plain ? uselocale(plain) : (locale_t)0;
    const int n = read_numbers(text, number);
    if (plain) {
        uselocale(before);
        freelocale(plain);
    }
    return n;
}

dif_status dif_range_parse(const char *text, dif_range *out, dif_error *err)
{
    *out = (dif_range){0};
    double number[3] = {0.0, 0.0, 0.0};
    const int n_number = read_numbers_c_locale(text, number);
    if (n_number == 0)
        return dif_fail(err, DIF_ERR_ARG, "range '%.80s', want a number or MIN:MAX:STEP", text);
    if (n_number == 1) {
        *out = (dif_range){.min = number[0], .max = number[0], .step = 0.0, .n = 1};
        return DIF_OK;
    }
    const double min = number[0], max = number[1], step = number[2];
    if (!(min <= max))
        return dif_fail(err, DIF_ERR_ARG, "range '%.80s': MIN %g is above MAX %g, want MIN <= MAX", text, min, max);
    if (!(step > 0.0))
        return dif_fail(err, DIF_ERR_ARG, "range '%.80s': STEP is %g, want STEP > 0", text, step);
    const double n_step = floor((max - min) / step + WHOLE_TOL);
    if (!(n_step < POINTS_MAX))
        return dif_fail(err, DIF_ERR_ARG, "range '%.80s' has %.3g points, want at most 1e7", text, n_step + 1.0);
    *out = (dif_range){.min = min, .max = max, .step = step, .n = (int)n_step + 1};
    return DIF_OK;
}

double dif_range_at(const dif_range *range, int i)
{
    const double value = range->min + i * range->step;
    const bool is_end = i == range->n - 1 && fabs(value - range->max) <= WHOLE_TOL * range->step;
    return is_end ? range->max : value;
}

dif_status dif_scan_plan(bool fixed_is_wo, double fixed_deg, double azimuth_deg, const dif_range *angle_deg,
                         const dif_range *lambda_nm, dif_plan *out, dif_error *err)
{
    dif_status status = dif_plan_create(angle_deg->n, lambda_nm->n, out, err);
    if (status)
        return status;
    out->fixed_is_wo = fixed_is_wo;
    out->fixed_rad = dif_rad_from_deg(fixed_deg);
    out->azimuth_rad = dif_rad_from_deg(azimuth_deg);
    for (int i = 0; i < angle_deg->n; i++)
        out->angle_rad[i] = dif_rad_from_deg(dif_range_at(angle_deg, i));
    for (int i = 0; i < lambda_nm->n; i++)
        out->lambda_um[i] = dif_um_from_nm(dif_range_at(lambda_nm, i));
    status = dif_plan_check(out, err);
    if (status)
        dif_plan_free(out);
    return status;
}
