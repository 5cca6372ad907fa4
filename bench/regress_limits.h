/* What a comparison is judged by: named metrics of a case, and the limits that they are held to, each with its reason.
 * Does not: compare (bench/regress_run.h), read files. */
#ifndef DIF_REGRESS_LIMITS_H
#define DIF_REGRESS_LIMITS_H

#include "bench/regress_run.h"

#ifdef __cplusplus
extern "C" {
#endif

/* X(enumerator, name, unit, what it is) */
#define DIF_REGRESS_METRIC_LIST(X)                                                                                     \
    X(ONE_SIDED, "one_sided", "", "places where only one side has a number")                                           \
    X(ABS_P99, "abs.p99", "", "|a - b|, 99th percentile")                                                              \
    X(ABS_WORST, "abs.worst", "", "|a - b|, largest")                                                                  \
    X(MAX_P99, "max.p99", "", "|a - b| / maximum, 99th percentile")                                                    \
    X(MAX_WORST, "max.worst", "", "|a - b| / maximum, largest")                                                        \
    X(REL_MEDIAN, "rel.median", "", "|a - b| / max(|a|, |b|, floor), median")                                          \
    X(REL_P95, "rel.p95", "", "the same, 95th percentile")                                                             \
    X(REL_P99, "rel.p99", "", "the same, 99th percentile")                                                             \
    X(REL_WORST, "rel.worst", "", "the same, largest")                                                                 \
    X(DE_MEDIAN, "de.median", "", "CIEDE2000, median")                                                                 \
    X(DE_P95, "de.p95", "", "CIEDE2000, 95th percentile")                                                              \
    X(DE_WORST, "de.worst", "", "CIEDE2000, largest")                                                                  \
    X(PEAK_LOST, "peak.lost", "", "maxima without a counterpart")                                                      \
    X(PEAK_SHIFT, "peak.shift_deg", "deg", "largest shift of a maximum")                                               \
    X(PERIOD_OFF, "period.off_nm", "nm", "difference of the fitted periods")

typedef enum dif_regress_metric {
#define DIF_REGRESS_METRIC_ENUM(enumerator, name, unit, text) DIF_REGRESS_##enumerator,
    DIF_REGRESS_METRIC_LIST(DIF_REGRESS_METRIC_ENUM)
#undef DIF_REGRESS_METRIC_ENUM
        DIF_REGRESS_METRICS
} dif_regress_metric;

const char *dif_regress_metric_name(dif_regress_metric metric);
const char *dif_regress_metric_unit(dif_regress_metric metric);
const char *dif_regress_metric_text(dif_regress_metric metric);
bool dif_regress_metric_from_name(const char *name, dif_regress_metric *out);

/* The metric of a case; NaN if it has none (colours have no maxima, a period was not determined by the reference). A
 * period that the reference alone has is infinitely off. */
double dif_regress_metric_of(const dif_regress_case *result, dif_regress_metric metric);

/* One limit, for one method or question or, "*", for all. */
typedef struct dif_regress_limit {
    char method[12], question[12];
    dif_regress_metric metric;
    double limit; /* largest value that passes; infinity: not judged */
    char reason[240];
} dif_regress_limit;

/* The built-in limits, static. */
const dif_regress_limit *dif_regress_limits_default(int *n);

/* The limit that counts for a case and metric: the last of the list that fits, NULL if none does. */
const dif_regress_limit *dif_regress_limit_find(int n, const dif_regress_limit *limit, const dif_regress_case *result,
                                                dif_regress_metric metric);

/* Whether a case passes: it was answered with numbers, and every metric that has a limit keeps it. *n_failed counts the others. */
bool dif_regress_passes(int n, const dif_regress_limit *limit, const dif_regress_case *result, int *n_failed);

#ifdef __cplusplus
}
#endif
#endif
