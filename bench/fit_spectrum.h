/* The strongest waves of a surface, as start values of fits. Not installed.  Does not: fit. */
#ifndef DIF_FIT_SPECTRUM_H
#define DIF_FIT_SPECTRUM_H

#include "core/field.h"

typedef struct dif_spectrum_wave {
    double fx_per_um, fy_per_um; /* upper half plane                           */
    double share;                /* of the texture's variance around the peak  */
} dif_spectrum_wave;

/* wave[n_max], strongest first; *n_out found. */
DIF_MUST_USE dif_status dif_fit_spectrum_waves(const dif_field *field, int n_max, dif_spectrum_wave *wave, int *n_out,
                                               dif_error *err);

#endif
