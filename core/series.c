/* jn() is POSIX, not C17. */
#define _XOPEN_SOURCE 700

#include "core/series.h"

#include <math.h>

enum { ORDER_MAX = 4096 };

double dif_series_taylor_bound(double x_max, int n)
{
    const double x = fabs(x_max);
    if (x == 0.0)
        return 0.0;
    double log_bound = x;
    for (int k = 1; k <= n + 1; k++)
        log_bound += log(x / k);
    return exp(log_bound);
}

int dif_series_taylor_order(double x_max, double tol)
{
    const double x = fabs(x_max);
    const double log_tol = log(tol);
    double log_bound = x;
    for (int n = 0; n < ORDER_MAX; n++) {
        log_bound += log(x / (n + 1));
        if (log_bound <= log_tol)
            return n;
    }
    return ORDER_MAX;
}

double dif_series_taylor_peak(double x_max)
{
    const double x = fabs(x_max);
    double log_peak = 0.0;
    for (int k = 1; k <= x; k++)
        log_peak += log(x / k);
    return exp(log_peak);
}

/* Bound of sum_{n >= N} |J_n(z)| for N > |z|, by Kapteyn's inequality |J_n(n s)| <= q(s)^n with
 * q = s exp(r) / (1 + r), r = sqrt(1 - s^2); q falls with n at fixed z, so the tail is below a geometric one. */
static double kapteyn_tail(double z, int n)
{
    const double s = z / n;
    const double r = sqrt(1.0 - s * s);
    const double q = s * exp(r) / (1.0 + r);
    return pow(q, n) / (1.0 - q);
}

double dif_series_jacobi_bound(double z, int m)
{
    const double x = fabs(z);
    double sum = 0.0;
    int n = m > 1 ? m : 1;
    if (m < 1)
        sum += fabs(j0(x));
    while (n < x + 2.0 || kapteyn_tail(x, n) > 1e-3 * sum) {
        sum += fabs(jn(n, x));
        if (n >= x + 2.0 && sum == 0.0) /* everything left is below the smallest number */
            break;
        n++;
    }
    return 2.0 * (sum + (sum > 0.0 ? kapteyn_tail(x, n) : 0.0));
}

int dif_series_jacobi_order(double z, double tol)
{
    int above = 0;
    int below = 16;
    while (below < (1 << 20) && !(dif_series_jacobi_bound(z, below) <= tol)) {
        above = below;
        below *= 2;
    }
    while (below - above > 1) { /* the bound falls with m: smallest m by bisection */
        const int middle = above + (below - above) / 2;
        if (dif_series_jacobi_bound(z, middle) <= tol)
            below = middle;
        else
            above = middle;
    }
    return dif_series_jacobi_bound(z, above) <= tol ? above : below;
}
