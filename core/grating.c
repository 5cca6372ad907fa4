/* jn() is POSIX, not C17. */
#define _XOPEN_SOURCE 700

#include "core/grating.h"

#include <math.h>
#include <string.h>

#include "core/brdf.h"
#include "core/units.h"

static const char *const PROFILE_NAMES[] = {
    [DIF_PROFILE_SINE] = "sine",
    [DIF_PROFILE_BLAZED] = "blazed",
    [DIF_PROFILE_TRIANGLE] = "triangle",
    [DIF_PROFILE_LAMELLAR] = "lamellar",
};
enum { N_PROFILE = sizeof PROFILE_NAMES / sizeof *PROFILE_NAMES };

bool dif_profile_from_name(const char *name, dif_profile *out)
{
    for (int i = 0; i < N_PROFILE; i++) {
        if (strcmp(name, PROFILE_NAMES[i]) == 0) {
            *out = (dif_profile)i;
            return true;
        }
    }
    return false;
}

const char *dif_profile_name(dif_profile profile)
{
    return PROFILE_NAMES[profile];
}

bool dif_grating_direction(dif_vec3 wi, double period_um, double psi_rad, double lambda_um, int m, dif_vec3 *wo)
{
    /* cos^2 below this is a grazing order that only rounding keeps above (or below) the surface */
    static const double GRAZING = 1e-14;
    const double step = m * lambda_um / period_um;
    const double x = step * cos(psi_rad) - wi.x;
    const double y = step * sin(psi_rad) - wi.y;
    const double z2 = 1.0 - x * x - y * y;
    const bool propagates = z2 > GRAZING;
    *wo = (dif_vec3){x, y, propagates ? sqrt(z2) : 0.0};
    return propagates;
}

bool dif_grating_order_range(dif_vec3 wi, double period_um, double psi_rad, double lambda_um, int *m_min, int *m_max)
{
    *m_min = *m_max = 0;
    if (!(wi.z > 0.0))
        return false;
    const double along = wi.x * cos(psi_rad) + wi.y * sin(psi_rad);
    const double across = wi.y * cos(psi_rad) - wi.x * sin(psi_rad);
    const double half = sqrt(fmax(1.0 - across * across, 0.0));
    const double per_order = period_um / lambda_um;
    /* one order too many on each side, then the same test as everywhere decides */
    int lo = (int)fmax(floor((along - half) * per_order), -1e9) - 1;
    int hi = (int)fmin(ceil((along + half) * per_order), 1e9) + 1;
    dif_vec3 wo;
    while (lo < 0 && !dif_grating_direction(wi, period_um, psi_rad, lambda_um, lo, &wo))
        lo++;
    while (hi > 0 && !dif_grating_direction(wi, period_um, psi_rad, lambda_um, hi, &wo))
        hi--;
    if (!dif_grating_direction(wi, period_um, psi_rad, lambda_um, 0, &wo))
        return false;
    *m_min = lo;
    *m_max = hi;
    return true;
}

/* sin(x)/x */
static double sinc(double x)
{
    return fabs(x) < 1e-8 ? 1.0 : sin(x) / x;
}

/* c_m = exp(i a/2) (..): the mean of exp(i (a - 2 pi m) t) over 0 <= t < 1, a = kw H, is a sinc around m = a/(2 pi);
 * a is negative in reflection, so a ramp that rises towards +s favours negative m. */
static double blazed_power(int m, double a)
{
    const double s = sinc(0.5 * a - DIF_PI * m);
    return s * s;
}

/* Both flanks are sincs, one around +a and one around -a (twice as steep, half as long), met at the apex:
 *   |c_m|^2 = (1/4) (sinc((a - pi m)/2) + (-1)^m sinc((a + pi m)/2))^2,   a = kw H */
static double triangle_power(int m, double a)
{
    const double up = sinc(0.5 * (a - DIF_PI * m));
    const double down = sinc(0.5 * (a + DIF_PI * m));
    const double s = 0.5 * (m % 2 == 0 ? up + down : up - down);
    return s * s;
}

static double lamellar_power(int m, double a, double duty)
{
    const double s = sin(0.5 * a);
    if (m == 0) /* |1 + D (e^{ia} - 1)|^2 = 1 - 4 D (1 - D) sin^2(a/2) */
        return 1.0 - 4.0 * duty * (1.0 - duty) * s * s;
    const double g = 2.0 * s * sin(DIF_PI * m * duty) / (DIF_PI * m);
    return g * g;
}

double dif_grating_power(const dif_grating *grating, int m, double kw_rad_per_um)
{
    const double a = kw_rad_per_um * grating->height_um;
    switch (grating->profile) {
    case DIF_PROFILE_SINE: {
        const double j = jn(m, 0.5 * a);
        return j * j;
    }
    case DIF_PROFILE_BLAZED:
        return blazed_power(m, a);
    case DIF_PROFILE_TRIANGLE:
        return triangle_power(m, a);
    case DIF_PROFILE_LAMELLAR:
        return lamellar_power(m, a, grating->duty);
    }
    return NAN;
}

double dif_grating_efficiency(const dif_grating *grating, dif_vec3 wi, double lambda_um, double reflectance, int m)
{
    dif_vec3 wm;
    if (!dif_grating_direction(wi, grating->period_um, grating->psi_rad, lambda_um, m, &wm))
        return 0.0;
    const double kw = -DIF_TWO_PI * (wi.z + wm.z) / lambda_um;
    return dif_brdf_gain_efficiency(reflectance, wi, wm) * dif_grating_power(grating, m, kw);
}
