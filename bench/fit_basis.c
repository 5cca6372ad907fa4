#include "bench/fit_basis.h"

#include <math.h>

int dif_fit_basis_at(int n_coef, double low, double high, double x, double value[DIF_FIT_DEGREE_MAX + 1], int *degree)
{
    const int p = n_coef - 1 < DIF_FIT_DEGREE_MAX ? n_coef - 1 : DIF_FIT_DEGREE_MAX;
    const int n_interval = n_coef - p;
    double t = high > low ? (x - low) / (high - low) : 0.5;
    t = fmin(fmax(t, 0.0), 1.0) * n_interval;
    const int i = t >= n_interval ? n_interval - 1 : (int)t;
    t -= i;
    /* Cox - de Boor on integer knots: raise the degree one at a time */
    value[0] = 1.0;
    for (int d = 1; d <= p; d++) {
        double carried = 0.0;
        for (int j = 0; j < d; j++) {
            const double left = (t + d - 1 - j) / d; /* rising part of function j + 1 of the new degree */
            const double share = value[j] * left;
            value[j] = carried + (value[j] - share);
            carried = share;
        }
        value[d] = carried;
    }
    *degree = p;
    return i;
}
