/* The conventions of the whole project, stated once and cited from here. Documentation only.
 *
 * Frame       right-handed, seen from above: x to the right, y up, z towards the viewer; mean plane z = 0.
 * Layout      row-major [iy * nx + ix], row 0 at the TOP of the picture, so that sample (ix, iy) lies at
 *               x = (ix - (nx - 1) / 2) * pitch_x,   y = ((ny - 1) / 2 - iy) * pitch_y.
 * Directions  wi (to the light) and wo (to the detector) are unit vectors, BOTH pointing away from the surface:
 *               w = (sin theta cos phi, sin theta sin phi, cos theta).
 *             A signed in-plane angle -theta means azimuth phi + 180 degrees.
 * Transfer    (u, v, w) = -(wi + wo);  kappa = k (u, v, w),  k = 2 pi / lambda;  kappa_z <= 0 in reflection.
 * Amplitude   P = sum_j W_j exp(+i kappa . r_j),  r_j = (x, y, h)_j;  p = |P / sum W|^2 in [0, 1].
 * Orders      sin theta_i + sin theta_m = m lambda / d along the groove normal s = (cos psi, sin psi):
 *               -(u, v) = (m lambda / d) s.  m = 0 is the mirror direction; m > 0 lies towards the light from it.
 * Spatial     f = -(u, v) . s / lambda, so that order m of period d sits at f = m / d for every wavelength.
 * frequency
 * DFT         forward kernel exp(+i 2 pi q n / N), unscaled (the sign of the amplitude above).
 * Units       every length in core and gpu is in micrometres (_um), angles in radians (_rad); nanometres and
 *             degrees exist only in files, on the command line and in reports. */
#ifndef DIF_CONVENTIONS_H
#define DIF_CONVENTIONS_H
#endif
