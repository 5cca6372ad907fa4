#include "core/slope.h"

#include <math.h>

#include "core/units.h"

#define SQRT_2 1.41421356237309504880
#define LN_2PI 1.83787706640934548356
#define Z_TAIL (-2.0)      /* below it the direct form loses digits: all of them by z = -8 */
#define Z_ALL  40.0        /* above it phi(z) is 0 in double and nothing is turned away */
enum { N_FRACTION = 120 }; /* terms of the continued fraction: 1e-17 at x = 2 needs 60, larger x fewer */

static double normal_density(double z)
{
    return exp(-0.5 * (z * z + LN_2PI));
}

static double normal_share(double z)
{
    return 0.5 * erfc(-z / SQRT_2);
}

static dif_slope_cut cut_tail(double z)
{
    const double x = -z;
    double r[4] = {0.0, 0.0, 0.0, 0.0}, next = 0.0;
    for (int n = N_FRACTION; n >= 0; n--) {
        next = 1.0 / (x + (n + 1) * next);
        if (n < 4)
            r[n] = next;
    }
    dif_slope_cut cut;
    cut.ln_psi = -0.5 * (z * z + LN_2PI) + log(r[0] * r[1]);
    cut.psi = exp(cut.ln_psi);
    cut.mean = z - 2.0 * r[2];
    cut.variance = 2.0 * r[2] * (3.0 * r[3] - 2.0 * r[2]);
    return cut;
}

dif_slope_cut dif_slope_cut_at(double z)
{
    if (z < Z_TAIL)
        return cut_tail(z);
    dif_slope_cut cut;
    if (z > Z_ALL) { /* also z = inf */
        const double per_z = 1.0 / z;
        return (dif_slope_cut){z, log(z), -per_z, 1.0 - per_z * per_z};
    }
    cut.psi = z * normal_share(z) + normal_density(z);
    const double ratio = normal_share(z) / cut.psi;
    cut.ln_psi = log(cut.psi);
    cut.mean = -ratio;
    cut.variance = 2.0 - z * ratio - ratio * ratio;
    return cut;
}

dif_status dif_slope_check(const dif_slope_gauss *g, dif_error *err)
{
    if (!(isfinite(g->mean_x) && isfinite(g->mean_y)))
        return dif_fail(err, DIF_ERR_ARG, "mean slope (%g, %g), want finite numbers", g->mean_x, g->mean_y);
    if (!(g->var_x >= 0.0 && g->var_y >= 0.0 && isfinite(g->var_x) && isfinite(g->var_y)))
        return dif_fail(err, DIF_ERR_ARG, "slope variances (%g, %g), want >= 0", g->var_x, g->var_y);
    const double limit = sqrt(g->var_x) * sqrt(g->var_y);
    if (!(fabs(g->cov_xy) <= limit * (1.0 + 1e-9)))
        return dif_fail(err, DIF_ERR_ARG, "slope covariance %g, want at most %g in size", g->cov_xy, limit);
    return DIF_OK;
}

/* From (x, y) to the frame of the view: x along its azimuth, y across; sin negated turns it back. */
static dif_slope_gauss turn(const dif_slope_gauss *g, double c, double s)
{
    return (dif_slope_gauss){.mean_x = g->mean_x * c + g->mean_y * s,
                             .mean_y = g->mean_y * c - g->mean_x * s,
                             .var_x = g->var_x * c * c + g->var_y * s * s + 2.0 * g->cov_xy * c * s,
                             .var_y = g->var_x * s * s + g->var_y * c * c - 2.0 * g->cov_xy * c * s,
                             .cov_xy = (g->var_y - g->var_x) * c * s + g->cov_xy * (c * c - s * s)};
}

dif_slope_visible dif_slope_visible_of(const dif_slope_gauss *gauss, double theta_rad, double phi_rad)
{
    const double c_phi = cos(phi_rad), s_phi = sin(phi_rad), sin_t = sin(theta_rad);
    dif_slope_gauss view = turn(gauss, c_phi, s_phi);
    const double var_o = fmax(view.var_x, 0.0), sd_o = sqrt(var_o), cov = view.cov_xy;
    const double a = cos(theta_rad) - view.mean_x * sin_t, b = sd_o * sin_t;
    if (!(b > 0.0) || a > Z_ALL * b) { /* the cut is out of reach: E = -b/a, and exactly 0 at b = 0 */
        const double share = a > 0.0 ? b / a : 0.0, norm = fmax(a, 0.0);
        const double along = b > 0.0 ? cov / sd_o : 0.0;
        view.mean_x -= sd_o * share;
        view.mean_y -= along * share;
        view.var_x -= var_o * share * share;
        view.var_y -= along * along * share * share;
        view.cov_xy -= cov * share * share;
        return (dif_slope_visible){turn(&view, c_phi, -s_phi), norm, log(norm)};
    }
    const double along = cov / sd_o; /* how much of a step of one sd_o the other axis shares */
    const dif_slope_cut cut = dif_slope_cut_at(a / b);
    view.mean_x += sd_o * cut.mean;
    view.mean_y += along * cut.mean;
    view.var_y -= along * along * (1.0 - cut.variance);
    view.var_x = var_o * cut.variance;
    view.cov_xy = cov * cut.variance;
    return (dif_slope_visible){turn(&view, c_phi, -s_phi), b * cut.psi, log(b) + cut.ln_psi};
}

double dif_slope_weight(double theta_rad, double phi_rad, const double s[2])
{
    return fmax(cos(theta_rad) - (s[0] * cos(phi_rad) + s[1] * sin(phi_rad)) * sin(theta_rad), 0.0);
}

double dif_slope_density(const dif_slope_gauss *gauss, const double s[2])
{
    const double det = gauss->var_x * gauss->var_y - gauss->cov_xy * gauss->cov_xy;
    const double x = s[0] - gauss->mean_x, y = s[1] - gauss->mean_y;
    if (!(det > 0.0))
        return 0.0;
    const double form = (gauss->var_y * x * x - 2.0 * gauss->cov_xy * x * y + gauss->var_x * y * y) / det;
    return exp(-0.5 * form) / (DIF_TWO_PI * sqrt(det));
}
