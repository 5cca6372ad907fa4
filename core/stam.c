#include "core/stam.h"

#include <math.h>

#include "core/units.h"

dif_status dif_stam_check(const dif_stam *stam, dif_error *err)
{
    if (!(stam->period_um > 0.0 && stam->period_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "a period of %g um, want > 0", stam->period_um);
    if (!isnan(stam->period_across_um) && !(stam->period_across_um > 0.0 && stam->period_across_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "a period of %g um across, want > 0", stam->period_across_um);
    if (!(stam->sigma_um > 0.0 && stam->sigma_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "sigma = %g um, want > 0", stam->sigma_um);
    return DIF_OK;
}

/* Distance of kappa from the nearest order of a period, rad/um; NaN = there is only order 0. */
static double distance(double kappa, double period_um)
{
    if (isnan(period_um))
        return kappa;
    const double step = DIF_TWO_PI / period_um;
    return kappa - step * rint(kappa / step);
}

double dif_stam_power(const dif_stam *stam, double kappa_x, double kappa_y)
{
    const double c = cos(stam->psi_rad), s = sin(stam->psi_rad);
    const double along = stam->sigma_um * distance(c * kappa_x + s * kappa_y, stam->period_um);
    const double across = stam->sigma_um * distance(c * kappa_y - s * kappa_x, stam->period_across_um);
    return exp(-along * along - across * across);
}
