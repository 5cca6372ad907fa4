/* Colours: linear and encoded sRGB, what to do outside its gamut, CIELAB and the CIEDE2000 difference.
 * Does not: spectra (core/spectrum.h). */
#ifndef DIF_COLOUR_H
#define DIF_COLOUR_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What happens to a colour that sRGB cannot show. */
typedef enum dif_gamut {
    DIF_GAMUT_CLIP,      /* each channel to [0, 1]                                                        */
    DIF_GAMUT_DESATURATE /* towards the grey of equal luminance Y until every channel is >= 0, then clip  */
} dif_gamut;

bool dif_gamut_from_name(const char *name, dif_gamut *out); /* "clip", "desaturate" */
const char *dif_gamut_name(dif_gamut gamut);

/* Linear sRGB from XYZ and back, D65, Y = 1 for white.          IEC 61966-2-1 */
void dif_colour_rgb_from_xyz(const double xyz[3], double rgb[3]);
void dif_colour_xyz_from_rgb(const double rgb[3], double xyz[3]);

/* Brings linear rgb into the gamut: afterwards every channel is in [0, 1]. */
void dif_colour_fit_gamut(dif_gamut gamut, double rgb[3]);

/* The sRGB transfer curve, [0, 1] to [0, 1], and its inverse. */
double dif_colour_encode(double linear);
double dif_colour_decode(double encoded);

/* A pixel: XYZ times exposure, gamut, curve, 8 bits. */
void dif_colour_pixel(const double xyz[3], double exposure, dif_gamut gamut, uint8_t rgb[3]);

/* CIELAB of XYZ relative to the D65 white of core/spectrum.h. */
void dif_colour_lab_from_xyz(const double xyz[3], double lab[3]);

/* Colour difference CIEDE2000, kL = kC = kH = 1.          Sharma, Wu, Dalal 2005 */
double dif_colour_difference_2000(const double lab1[3], const double lab2[3]);

#ifdef __cplusplus
}
#endif
#endif
