#include "core/colour.h"

#include <math.h>
#include <string.h>

#include "core/spectrum.h"
#include "core/units.h"

static const char *const GAMUT_NAMES[] = {"clip", "desaturate"};

bool dif_gamut_from_name(const char *name, dif_gamut *out)
{
    for (int i = 0; i < 2; i++)
        if (strcmp(name, GAMUT_NAMES[i]) == 0) {
            *out = (dif_gamut)i;
            return true;
        }
    return false;
}

const char *dif_gamut_name(dif_gamut gamut)
{
    return GAMUT_NAMES[gamut];
}

/* Primaries and white of sRGB: chromaticities (0.64, 0.33), (0.30, 0.60), (0.15, 0.06), white (0.3127, 0.3290). */
static const double RGB_FROM_XYZ[3][3] = {{3.2404541621, -1.5371385128, -0.4985314096},
                                          {-0.9692660305, 1.8760108454, 0.0415560175},
                                          {0.0556434310, -0.2040259135, 1.0572251882}};
static const double XYZ_FROM_RGB[3][3] = {{0.4124564391, 0.3575760776, 0.1804374833},
                                          {0.2126728514, 0.7151521553, 0.0721749934},
                                          {0.0193338956, 0.1191920259, 0.9503040785}};

static void multiply(const double m[3][3], const double in[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = m[i][0] * in[0] + m[i][1] * in[1] + m[i][2] * in[2];
}

void dif_colour_rgb_from_xyz(const double xyz[3], double rgb[3])
{
    multiply(RGB_FROM_XYZ, xyz, rgb);
}

void dif_colour_xyz_from_rgb(const double rgb[3], double xyz[3])
{
    multiply(XYZ_FROM_RGB, rgb, xyz);
}

void dif_colour_fit_gamut(dif_gamut gamut, double rgb[3])
{
    if (gamut == DIF_GAMUT_DESATURATE) {
        const double *y = XYZ_FROM_RGB[1];
        const double grey = fmax(y[0] * rgb[0] + y[1] * rgb[1] + y[2] * rgb[2], 0.0);
        const double least = fmin(rgb[0], fmin(rgb[1], rgb[2]));
        if (least < 0.0) {
            const double share = grey / (grey - least); /* of the colour that is kept */
            for (int c = 0; c < 3; c++)
                rgb[c] = grey + share * (rgb[c] - grey);
        }
    }
    for (int c = 0; c < 3; c++)
        rgb[c] = fmin(fmax(rgb[c], 0.0), 1.0);
}

double dif_colour_encode(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

double dif_colour_decode(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

void dif_colour_pixel(const double xyz[3], double exposure, dif_gamut gamut, uint8_t rgb[3])
{
    double linear[3];
    dif_colour_rgb_from_xyz(xyz, linear);
    for (int c = 0; c < 3; c++)
        linear[c] *= exposure;
    dif_colour_fit_gamut(gamut, linear);
    for (int c = 0; c < 3; c++)
        rgb[c] = (uint8_t)(255.0 * dif_colour_encode(linear[c]) + 0.5);
}

/* CIELAB's cube root with its straight start. */
static double lab_curve(double t)
{
    const double d = 6.0 / 29.0;
    return t > d * d * d ? cbrt(t) : t / (3.0 * d * d) + 4.0 / 29.0;
}

void dif_colour_lab_from_xyz(const double xyz[3], double lab[3])
{
    double white[3], f[3];
    dif_spectrum_white(white);
    for (int c = 0; c < 3; c++)
        f[c] = lab_curve(xyz[c] / white[c]);
    lab[0] = 116.0 * f[1] - 16.0;
    lab[1] = 500.0 * (f[0] - f[1]);
    lab[2] = 200.0 * (f[1] - f[2]);
}

/* Hue angle in degrees, [0, 360), 0 for a grey. */
static double hue_deg(double a, double b)
{
    if (a == 0.0 && b == 0.0)
        return 0.0;
    const double deg = dif_deg_from_rad(atan2(b, a));
    return deg < 0.0 ? deg + 360.0 : deg;
}

static double sin_deg(double deg)
{
    return sin(dif_rad_from_deg(deg));
}

static double cos_deg(double deg)
{
    return cos(dif_rad_from_deg(deg));
}

/* c^7 / (c^7 + 25^7), rooted: how chromatic a colour is. */
static double chroma_share(double chroma)
{
    const double c7 = pow(chroma, 7.0);
    return sqrt(c7 / (c7 + 6103515625.0));
}

/* Difference and mean of two hues the short way round; greys leave the other hue alone. */
static void hues(double c1, double c2, double h1, double h2, double *difference, double *mean)
{
    *difference = h2 - h1;
    *mean = h1 + h2;
    if (c1 * c2 == 0.0) {
        *difference = 0.0;
        return;
    }
    if (fabs(h2 - h1) > 180.0) {
        *difference += h2 > h1 ? -360.0 : 360.0;
        *mean += h1 + h2 < 360.0 ? 360.0 : -360.0;
    }
    *mean *= 0.5;
}

/* The rotation term that couples chroma and hue near blue. */
static double rotation(double mean_c, double mean_h)
{
    const double turn = 30.0 * exp(-pow((mean_h - 275.0) / 25.0, 2.0));
    return -sin_deg(2.0 * turn) * 2.0 * chroma_share(mean_c);
}

double dif_colour_difference_2000(const double lab1[3], const double lab2[3])
{
    const double c_ab = 0.5 * (hypot(lab1[1], lab1[2]) + hypot(lab2[1], lab2[2]));
    const double stretch = 1.0 + 0.5 * (1.0 - chroma_share(c_ab));
    const double a1 = stretch * lab1[1], a2 = stretch * lab2[1];
    const double c1 = hypot(a1, lab1[2]), c2 = hypot(a2, lab2[2]);
    double dh, mean_h;
    hues(c1, c2, hue_deg(a1, lab1[2]), hue_deg(a2, lab2[2]), &dh, &mean_h);
    const double mean_l = 0.5 * (lab1[0] + lab2[0]), mean_c = 0.5 * (c1 + c2);
    const double t = 1.0 - 0.17 * cos_deg(mean_h - 30.0) + 0.24 * cos_deg(2.0 * mean_h) +
                     0.32 * cos_deg(3.0 * mean_h + 6.0) - 0.20 * cos_deg(4.0 * mean_h - 63.0);
    const double l50 = (mean_l - 50.0) * (mean_l - 50.0);
    const double dl = (lab2[0] - lab1[0]) / (1.0 + 0.015 * l50 / sqrt(20.0 + l50));
    const double dc = (c2 - c1) / (1.0 + 0.045 * mean_c);
    const double dhue = 2.0 * sqrt(c1 * c2) * sin_deg(0.5 * dh) / (1.0 + 0.015 * mean_c * t);
    return sqrt(dl * dl + dc * dc + dhue * dhue + rotation(mean_c, mean_h) * dc * dhue);
}
