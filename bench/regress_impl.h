/* What the files of bench/regress_run share. Not installed. */
#ifndef DIF_REGRESS_IMPL_H
#define DIF_REGRESS_IMPL_H

#include "bench/regress_run.h"

enum { DIF_REGRESS_SHEET, DIF_REGRESS_NMM, DIF_REGRESS_NMM_LINES, DIF_REGRESS_PQ, DIF_REGRESS_LUT, DIF_REGRESS_STAM };

/* Fills what a case says of its two answers: errors, colours, maxima, periods. If out->fit is tried, the reference's
 * period stands in it already. */
DIF_MUST_USE dif_status dif_regress_judge(const dif_field *field, const dif_regress_plan *plan,
                                          const dif_measure_opts *opts, double *device, double *reference,
                                          dif_regress_case *out, dif_error *err);

#endif
