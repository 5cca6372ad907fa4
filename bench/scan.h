/* Ranges and plans as a user writes them: MIN:MAX:STEP in degrees and nanometres.
 * Does not: measure. */
#ifndef DIF_SCAN_H
#define DIF_SCAN_H

#include "core/plan.h"

#ifdef __cplusplus
extern "C" {
#endif

/* MIN:MAX:STEP with both ends included, or one number. */
typedef struct dif_range {
    double min, max, step;
    int n; /* number of points, >= 1 */
} dif_range;

/* Parses a range; the text after the number must be empty. The last point is MAX if (MAX - MIN)/STEP is whole to
 * 1e-6, else the last one below it.
 * Status    DIF_ERR_ARG with a line that quotes the text: malformed, MIN > MAX, STEP <= 0, over 10^7 points */
DIF_MUST_USE dif_status dif_range_parse(const char *text, dif_range *out, dif_error *err);

/* Point i of a range. */
double dif_range_at(const dif_range *range, int i);

/* A plan from ranges in degrees and nanometres; checks as dif_plan_check. */
DIF_MUST_USE dif_status dif_scan_plan(bool fixed_is_wo, double fixed_deg, double azimuth_deg,
                                      const dif_range *angle_deg, const dif_range *lambda_nm, dif_plan *out,
                                      dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
