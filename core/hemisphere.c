#include "core/hemisphere.h"

#include <math.h>

#include "core/units.h"

double dif_hemisphere_solid_angle_sr(double x, double y)
{
    const double s2 = (1.0 - x) * (1.0 + x) - y * y;
    if (s2 <= 0.0) {
        const double size = 0.5 * DIF_PI * (fabs(x) + fabs(y) - 1.0);
        return x * y < 0.0 ? -size : x * y > 0.0 ? size : 0.0;
    }
    const double s = sqrt(s2);
    return x * atan2(y, s) + y * atan2(x, s) - atan2(x * y, s);
}

/* Signed area of the unit disc inside [0, x] x [0, y], odd in both. */
static double disc_area(double x, double y)
{
    const double ax = fabs(x), ay = fabs(y), sign = (x < 0.0) != (y < 0.0) ? -1.0 : 1.0;
    if ((1.0 - ax) * (1.0 + ax) - ay * ay >= 0.0)
        return x * y;
    /* up to x0 the rectangle's upper side lies inside, then the circle bounds it */
    const double x0 = sqrt((1.0 - ay) * (1.0 + ay)), yx = sqrt(fmax((1.0 - ax) * (1.0 + ax), 0.0));
    return sign * 0.5 * (x0 * ay + ax * yx + atan2(ax, yx) - atan2(x0, ay));
}

/* int_0^y sqrt(max(0, 1 - x^2 - b^2)) db, odd in y, even in x: minus the primitive of x over solid angle. */
static double rim_integral(double x, double y)
{
    const double c2 = (1.0 - x) * (1.0 + x), s2 = c2 - y * y;
    if (s2 <= 0.0)
        return copysign(0.25 * DIF_PI * fmax(c2, 0.0), y);
    const double s = sqrt(s2);
    return 0.5 * (y * s + c2 * atan2(y, s));
}

static double edge(int n, int i)
{
    return (2.0 * i - n) / n;
}

/* Distance squared of the nearest point of a texel to the origin, in units of (1 / n)^2. Whole numbers: exact. */
static double nearest2(int n, int ix, int iy)
{
    const int x0 = 2 * ix - n, y0 = 2 * iy - n, x1 = x0 + 2, y1 = y0 + 2;
    const double x = x0 > 0 ? x0 : x1 < 0 ? x1 : 0, y = y0 > 0 ? y0 : y1 < 0 ? y1 : 0;
    return x * x + y * y;
}

/* Value of a function's mixed difference over a texel. */
static double texel_difference(double (*primitive)(double, double), double x0, double x1, double y0, double y1)
{
    return (primitive(x1, y1) - primitive(x0, y1)) - (primitive(x1, y0) - primitive(x0, y0));
}

dif_hemisphere_texel dif_hemisphere_texel_at(int n, int ix, int iy)
{
    const int from_below = n - 1 - iy;
    const double x0 = edge(n, ix), x1 = edge(n, ix + 1), y0 = edge(n, from_below), y1 = edge(n, from_below + 1);
    if (nearest2(n, ix, from_below) >= (double)n * n)
        return (dif_hemisphere_texel){0};
    return (dif_hemisphere_texel){
        .sr = fmax(texel_difference(dif_hemisphere_solid_angle_sr, x0, x1, y0, y1), 0.0),
        .x = -texel_difference(rim_integral, x0, x1, y0, y1),
        .y = -texel_difference(rim_integral, y0, y1, x0, x1),
        .area = fmax(texel_difference(disc_area, x0, x1, y0, y1), 0.0),
    };
}

void dif_hemisphere_row_sr(int n, int iy, double *sr)
{
    const int from_below = n - 1 - iy;
    const double y0 = edge(n, from_below), y1 = edge(n, from_below + 1);
    double before = dif_hemisphere_solid_angle_sr(-1.0, y1) - dif_hemisphere_solid_angle_sr(-1.0, y0);
    for (int ix = 0; ix < n; ix++) {
        const double x1 = edge(n, ix + 1);
        const double here = dif_hemisphere_solid_angle_sr(x1, y1) - dif_hemisphere_solid_angle_sr(x1, y0);
        sr[ix] = nearest2(n, ix, from_below) >= (double)n * n ? 0.0 : fmax(here - before, 0.0);
        before = here;
    }
}
