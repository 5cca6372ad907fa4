/* Inside the table: shared by lut.c and lut_build.c. Not installed. */
#ifndef DIF_LUT_IMPL_H
#define DIF_LUT_IMPL_H

#include "core/lut.h"

/* Coefficients averaged over a disc of the given radius around (s, azimuth): out[n_map][3]. */
void dif_lut_disc_average(const dif_lut *lut, double s, double azimuth_rad, double radius, float *out);

#endif
