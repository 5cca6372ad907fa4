#include "core/domain.h"

#include <math.h>
#include <stddef.h>

#include "core/units.h"

/* One row a rule: within all three limits the trust is given. The angles carry a hair for rounding. */
typedef struct rule {
    dif_trust trust;
    double d_min, h_max, theta_max_deg;
} rule;

static const rule SMOOTH[] = {
    {DIF_TRUST_SHARES, 5.0, 0.35, 30.0},
    {DIF_TRUST_SHARES, 5.0, 0.10, 75.0},
    {DIF_TRUST_DOMINANT, 2.5, 0.35, 75.0},
    {DIF_TRUST_DOMINANT, 5.0, 1.00, 30.0},
};

static const rule WALLS[] = {
    {DIF_TRUST_DOMINANT, 2.5, 0.50, 15.0},
    {DIF_TRUST_DOMINANT, 5.0, 1.00, 15.0},
};

static const char *const TRUST_NAMES[] = {
    [DIF_TRUST_NONE] = "none", [DIF_TRUST_DOMINANT] = "dominant", [DIF_TRUST_SHARES] = "shares"};

static const char *const LINES[] = {
    [DIF_TRUST_NONE] = "Scalar theory does not give trustworthy powers here; angles and periods from the grating "
                       "equation still hold.",
    [DIF_TRUST_DOMINANT] = "Scalar theory gives the share of each order to about 10 % of the whole power: believe the "
                           "dominant orders only; angles and periods hold.",
    [DIF_TRUST_SHARES] = "Scalar theory gives the shares of the orders within 5 % here; angles and periods hold.",
};

static dif_trust first_match(const rule *rules, size_t n, double d, double h, double theta_deg)
{
    for (size_t i = 0; i < n; i++) {
        const rule *r = &rules[i];
        if (d >= r->d_min && h <= r->h_max && theta_deg <= r->theta_max_deg + 1e-9)
            return r->trust;
    }
    return DIF_TRUST_NONE;
}

const char *dif_trust_name(dif_trust trust)
{
    return TRUST_NAMES[trust];
}

dif_trust dif_domain_verdict(dif_relief relief, double d_over_lambda, double h_over_lambda, double theta_rad,
                             const char **line)
{
    const double theta_deg = fabs(dif_deg_from_rad(theta_rad));
    dif_trust trust;
    if (relief == DIF_RELIEF_WALLS)
        trust = first_match(WALLS, sizeof WALLS / sizeof *WALLS, d_over_lambda, h_over_lambda, theta_deg);
    else
        trust = first_match(SMOOTH, sizeof SMOOTH / sizeof *SMOOTH, d_over_lambda, h_over_lambda, theta_deg);
    if (relief == DIF_RELIEF_MEASURED && trust == DIF_TRUST_SHARES)
        trust = DIF_TRUST_DOMINANT;
    if (line)
        *line = LINES[trust];
    return trust;
}
