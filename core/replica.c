#include "core/replica.h"

#include <math.h>
#include <stdbool.h>

#include "core/units.h"

static dif_status check_axis(char axis, int n, double period_um, dif_error *err)
{
    if (!(n >= 1 && n <= DIF_REPLICA_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d replicas along %c, want 1 ... %d", n, axis, DIF_REPLICA_MAX);
    if (!(period_um > 0.0 && period_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "a period of %g um along %c, want > 0", period_um, axis);
    return DIF_OK;
}

dif_status dif_replica_check(const dif_replica *replica, dif_error *err)
{
    const dif_status status = check_axis('x', replica->nx, replica->period_x_um, err);
    return status != DIF_OK ? status : check_axis('y', replica->ny, replica->period_y_um, err);
}

double dif_replica_ratio(int n, double x)
{
    const double turns = rint(x / DIF_PI), rest = fma(-turns, DIF_PI, x);
    /* x = pi j + rest: sin(n x)/sin x = (-1)^{j (n-1)} sin(n rest)/sin(rest), free of the poles' cancellation */
    const double s = sin(rest);
    const double ratio = s == 0.0 ? 1.0 : sin(n * rest) / (n * s);
    const bool odd = fmod(turns, 2.0) != 0.0 && n % 2 == 0;
    return odd ? -ratio : ratio;
}

double dif_replica_factor(const dif_replica *replica, double kappa_x, double kappa_y)
{
    return dif_replica_ratio(replica->nx, 0.5 * kappa_x * replica->period_x_um) *
           dif_replica_ratio(replica->ny, 0.5 * kappa_y * replica->period_y_um);
}
