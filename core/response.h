/* Reading a sheet: the amplitude P / sum W at wanted points. Allocates nothing, threads are the caller's.
 * Does not: check that a point lies in the sheet's band (asserted). */
#ifndef DIF_RESPONSE_H
#define DIF_RESPONSE_H

#include <stddef.h>

#include "core/sheet.h"
#include "core/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Amplitudes of a line sheet at n points of its plane.
 *
 * Given     ks[n]  lateral kappa along the sheet's azimuth, rad/um, any sign
 *           kz[n]  -kappa_z >= 0, rad/um
 * Gives     amp[n] (re, im) = P / sum W, phases referred to the field's frame */
void dif_response_line(const dif_sheet *sheet, size_t n, const double *ks, const double *kz, double (*amp)[2]);

/* Powers |P / sum W|^2 along straight lines through the origin: at (k*s[i], k*c[i]) for one wavenumber k; this is one
 * wavelength of a table. Adds scale * power to power[n]. */
void dif_response_line_power(const dif_sheet *sheet, double k_rad_per_um, size_t n, const double *s, const double *c,
                             double scale, double *power);

/* Amplitudes of a volume sheet at kappa[n], rad/um, kappa.z <= 0. */
void dif_response_volume(const dif_sheet *sheet, size_t n, const dif_vec3 *kappa, double (*amp)[2]);

#ifdef __cplusplus
}
#endif
#endif
