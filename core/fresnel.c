#include "core/fresnel.h"

#include <math.h>

dif_index dif_index_default(void)
{
    return (dif_index){.n = 1.5, .kappa = 0.0};
}

double dif_fresnel_schlick(dif_index index, double cos_h)
{
    const double q = 1.0 - fmin(fmax(cos_h, 0.0), 1.0);
    const double q5 = q * q * q * q * q;
    const double below = index.n - 1.0, above = index.n + 1.0;
    const double kappa2 = index.kappa * index.kappa;
    return (below * below + 4.0 * index.n * q5 + kappa2) / (above * above + kappa2);
}
