/* Unit conversions and mathematical constants, each spelled once.
 * Does not: parse or print. */
#ifndef DIF_UNITS_H
#define DIF_UNITS_H

#define DIF_PI     3.14159265358979323846
#define DIF_TWO_PI 6.28318530717958647693

static inline double dif_um_from_nm(double nm)
{
    return nm / 1e3;
}

static inline double dif_nm_from_um(double um)
{
    return um * 1e3;
}

static inline double dif_um_from_m(double m)
{
    return m * 1e6;
}

static inline double dif_rad_from_deg(double deg)
{
    return deg * (DIF_PI / 180.0);
}

static inline double dif_deg_from_rad(double rad)
{
    return rad * (180.0 / DIF_PI);
}

#endif
