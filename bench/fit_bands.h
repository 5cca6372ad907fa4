/* Bands of a scan, each fitted by itself with the direction held: scatter and drift of the period. Not installed.
 * Does not: fit the whole scan. */
#ifndef DIF_FIT_BANDS_H
#define DIF_FIT_BANDS_H

#include "bench/fit.h"

/* Adds scatter and drift to a result whose period, direction and harmonics are known; f is 1/period.
 * Status    DIF_ERR_FIT if fewer than two bands determine a period; DIF_ERR_NOMEM, DIF_ERR_FOREIGN */
DIF_MUST_USE dif_status dif_fit_bands(const dif_field *field, double f_per_um, int n_part, dif_fit_surface_result *out,
                                      dif_error *err);

#endif
