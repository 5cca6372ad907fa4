#include "bench/regress_limits.h"

#include <math.h>
#include <string.h>

#include "core/units.h"

static const struct {
    const char *name, *unit, *text;
} METRICS[DIF_REGRESS_METRICS] = {
#define DIF_REGRESS_METRIC_ROW(enumerator, name, unit, text) {name, unit, text},
    DIF_REGRESS_METRIC_LIST(DIF_REGRESS_METRIC_ROW)
#undef DIF_REGRESS_METRIC_ROW
};

/* Later rows take precedence. */
static const dif_regress_limit DEFAULTS[] = {
    {"*", "*", DIF_REGRESS_ONE_SIDED, 0.0,
     "a number that only one side has is a failure, however close the others are"},
    {"*", "table", DIF_REGRESS_ABS_WORST, 2e-6,
     "powers are at most 1, and an amplitude off by 1e-6 of the largest one is a power off by twice that: above it a "
     "plane, a tap or a sign is wrong, float32 is not"},
    {"*", "map", DIF_REGRESS_ABS_WORST, 2e-6, "as for tables"},
    {"*", "table", DIF_REGRESS_REL_P99, 1e-4,
     "float32 keeps seven digits of the largest amplitude; where the power is down to the floor of 1e-5 of the "
     "maximum, "
     "four are left"},
    {"*", "map", DIF_REGRESS_REL_P99, 1e-4, "as for tables"},
    {"*", "colour", DIF_REGRESS_MAX_WORST, 1e-5, "sums of powers with positive weights keep their relative error"},
    {"*", "colour", DIF_REGRESS_DE_P95, 0.02, "a hundredth of what an eye can tell, doubled for float32's rounding"},
    {"*", "colour", DIF_REGRESS_DE_WORST, 0.2, "a fifth of what an eye can tell"},
    {"lut", "full", DIF_REGRESS_DE_P95, 0.5,
     "half of what an eye can tell: what interpolating between texels may cost"},
    {"lut", "full", DIF_REGRESS_DE_WORST, 2.0, "seen by comparing side by side, not by looking"},
    {"*", "table", DIF_REGRESS_PEAK_LOST, 0.0, "a maximum of 1 % of the largest and more does not depend on rounding"},
    {"*", "table", DIF_REGRESS_PEAK_SHIFT, 1e-3,
     "a fiftieth of the default step of the detector; moves a period of 2500 nm by 0.02 nm"},
    {"*", "table", DIF_REGRESS_PERIOD_OFF, 0.01,
     "a fifth of the 0.05 nm to which the period of the blazed grating is known"},
};

const char *dif_regress_metric_name(dif_regress_metric metric)
{
    return METRICS[metric].name;
}

const char *dif_regress_metric_unit(dif_regress_metric metric)
{
    return METRICS[metric].unit;
}

const char *dif_regress_metric_text(dif_regress_metric metric)
{
    return METRICS[metric].text;
}

bool dif_regress_metric_from_name(const char *name, dif_regress_metric *out)
{
    for (int i = 0; i < DIF_REGRESS_METRICS; i++)
        if (strcmp(name, METRICS[i].name) == 0) {
            *out = (dif_regress_metric)i;
            return true;
        }
    return false;
}

static double period_off_nm(const dif_regress_fit *fit)
{
    if (!fit->tried || fit->reference != DIF_OK)
        return (double)NAN;
    return fit->device == DIF_OK ? dif_nm_from_um(fabs(fit->device_um - fit->reference_um)) : (double)INFINITY;
}

double dif_regress_metric_of(const dif_regress_case *result, dif_regress_metric metric)
{
    const dif_regress *v = &result->values;
    const double nan = (double)NAN;
    const bool colours = result->has_colours, peaks = result->has_peaks;
    if (result->status != DIF_OK)
        return nan;
    switch (metric) {
    case DIF_REGRESS_ONE_SIDED:
        return (double)v->n_one_sided;
    case DIF_REGRESS_ABS_P99:
        return v->absolute.p99;
    case DIF_REGRESS_ABS_WORST:
        return v->absolute.worst;
    case DIF_REGRESS_MAX_P99:
        return v->of_max.p99;
    case DIF_REGRESS_MAX_WORST:
        return v->of_max.worst;
    case DIF_REGRESS_REL_MEDIAN:
        return v->relative.median;
    case DIF_REGRESS_REL_P95:
        return v->relative.p95;
    case DIF_REGRESS_REL_P99:
        return v->relative.p99;
    case DIF_REGRESS_REL_WORST:
        return v->relative.worst;
    case DIF_REGRESS_DE_MEDIAN:
        return colours ? result->de.median : nan;
    case DIF_REGRESS_DE_P95:
        return colours ? result->de.p95 : nan;
    case DIF_REGRESS_DE_WORST:
        return colours ? result->de.worst : nan;
    case DIF_REGRESS_PEAK_LOST:
        return peaks ? result->peaks.n_lost : nan;
    case DIF_REGRESS_PEAK_SHIFT:
        return peaks && result->peaks.n > result->peaks.n_lost ? dif_deg_from_rad(result->peaks.worst_shift_rad) : nan;
    case DIF_REGRESS_PERIOD_OFF:
        return period_off_nm(&result->fit);
    case DIF_REGRESS_METRICS:
        break;
    }
    return nan;
}

const dif_regress_limit *dif_regress_limits_default(int *n)
{
    *n = sizeof DEFAULTS / sizeof *DEFAULTS;
    return DEFAULTS;
}

static bool fits(const char *pattern, const char *name)
{
    return strcmp(pattern, "*") == 0 || strcmp(pattern, name) == 0;
}

const dif_regress_limit *dif_regress_limit_find(int n, const dif_regress_limit *limit, const dif_regress_case *result,
                                                dif_regress_metric metric)
{
    const dif_regress_limit *found = NULL;
    for (int i = 0; i < n; i++)
        if (limit[i].metric == metric && fits(limit[i].method, dif_regress_method_name(result->method)) &&
            fits(limit[i].question, dif_regress_question_name(result->question)))
            found = limit + i;
    return found;
}

bool dif_regress_passes(int n, const dif_regress_limit *limit, const dif_regress_case *result, int *n_failed)
{
    *n_failed = 0;
    for (int m = 0; m < DIF_REGRESS_METRICS; m++) {
        const dif_regress_limit *found = dif_regress_limit_find(n, limit, result, (dif_regress_metric)m);
        *n_failed += found && dif_regress_metric_of(result, (dif_regress_metric)m) > found->limit;
    }
    return result->status == DIF_OK && result->values.n > 0 && *n_failed == 0;
}
