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

enum {
    DIF_RESPONSE_GRID = 64,   /* points a side of a rectangle, or of a column call       */
    DIF_RESPONSE_DEPTHS = 64, /* values of kappa_z of a column call                      */
    DIF_RESPONSE_PLANES = 512 /* planes a sheet may have to be read by columns           */
};

/* Powers |P / sum W|^2 of a volume sheet over a rectangle of lateral points; the taps of each row and column are made
 * once. Only for DIF_BASIS_WAVES.
 *
 * Given     kx[nx], ky[ny]  rad/um, nx, ny <= DIF_RESPONSE_GRID
 *           kz[ny][kz_stride]  -kappa_z >= 0; a negative one marks a point that is not wanted
 * Gives     power[ny][power_stride], 0 where not wanted */
void dif_response_volume_grid(const dif_sheet *sheet, int nx, const double *kx, int ny, const double *ky,
                              const double *kz, size_t kz_stride, float *power, size_t power_stride);

/* Powers of a volume sheet at n lateral points (n <= DIF_RESPONSE_GRID), each at the same n_z depths kz[n_z]
 * (n_z <= DIF_RESPONSE_DEPTHS): the lateral sum is done once for all depths. Only for DIF_BASIS_WAVES with at most
 * DIF_RESPONSE_PLANES planes.  Gives power[n][n_z]. */
void dif_response_volume_columns(const dif_sheet *sheet, int n, const double *kx, const double *ky, int n_z,
                                 const double *kz, float *power);

#ifdef __cplusplus
}
#endif
#endif
