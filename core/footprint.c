#include "core/footprint.h"

#include <math.h>

/* Singular values and vectors of a 2 x 2 matrix, M = U diag(s) V^T with columns cos, sin. */
typedef struct svd {
    double s[2];       /* s[0] >= s[1] >= 0                                               */
    double u[2], v[2]; /* first columns; the second ones are (-y, x), times `sign` for v  */
    double det, sign;  /* determinant, and its sign: 1 or -1                              */
} svd;

/* a b - c d to one rounding or two, however much of it cancels (Kahan). */
static double product_difference(double a, double b, double c, double d)
{
    const double cd = c * d, lost = fma(-c, d, cd);
    return fma(a, b, -cd) + lost;
}

/* In terms of the rotation and the reflection that M is the sum of; both angles at once. M finite, not zero. */
static svd svd_of(double m00, double m01, double m10, double m11)
{
    const double e = 0.5 * (m00 + m11), f = 0.5 * (m00 - m11), g = 0.5 * (m10 + m01), h = 0.5 * (m10 - m01);
    const double q = hypot(e, h), r = hypot(f, g);
    const double turn = atan2(h, e), fold = atan2(g, f);
    const double beta = 0.5 * (fold + turn), gamma = 0.5 * (fold - turn);
    const double det = product_difference(m00, m11, m01, m10);
    return (svd){.s = {q + r, fabs(det) / (q + r)}, /* not q - r, which cancels */
                 .u = {cos(beta), sin(beta)},
                 .v = {cos(gamma), sin(gamma)},
                 .det = det,
                 .sign = det < 0.0 ? -1.0 : 1.0};
}

static dif_footprint circle(double limit)
{
    return (dif_footprint){{limit, 0.0}, {0.0, limit}, true};
}

/* Column j of s0 u0 v0^T + s1 u1 v1^T. */
static void column(const svd *m, double s0, double s1, int j, double w[2])
{
    const double v0 = m->v[j], v1 = m->sign * (j == 0 ? -m->v[1] : m->v[0]);
    w[0] = s0 * m->u[0] * v0 - s1 * m->u[1] * v1;
    w[1] = s0 * m->u[1] * v0 + s1 * m->u[0] * v1;
}

/* Cuts the axes of a finite footprint to the limit. */
static dif_footprint clamp(const double w1[2], const double w2[2], double limit)
{
    dif_footprint out = {{w1[0], w1[1]}, {w2[0], w2[1]}, false};
    const double size = fmax(fmax(fabs(w1[0]), fabs(w1[1])), fmax(fabs(w2[0]), fabs(w2[1])));
    if (!(isfinite(w1[0]) && isfinite(w1[1]) && isfinite(w2[0]) && isfinite(w2[1])))
        return circle(limit);
    if (size == 0.0)
        return out;
    const svd m = svd_of(w1[0] / size, w2[0] / size, w1[1] / size, w2[1] / size);
    if (m.s[0] * size <= limit)
        return out;
    column(&m, limit, fmin(m.s[1] * size, limit), 0, out.w1);
    column(&m, limit, fmin(m.s[1] * size, limit), 1, out.w2);
    out.clamped = true;
    return out;
}

dif_footprint dif_footprint_from_screen(double da_du, double db_du, double da_dv, double db_dv, double limit)
{
    const double size = fmax(fmax(fabs(da_du), fabs(db_du)), fmax(fabs(da_dv), fabs(db_dv)));
    if (!(isfinite(da_du) && isfinite(db_du) && isfinite(da_dv) && isfinite(db_dv)) || !(size > 0.0))
        return circle(limit);
    const svd m = svd_of(da_du / size, da_dv / size, db_du / size, db_dv / size);
    const double longest = 1.0 / (m.s[1] * size), shortest = 1.0 / (m.s[0] * size); /* of the inverse; may be inf */
    if (longest <= limit) {
        const double scale = 1.0 / (m.det * size);
        return (dif_footprint){
            {db_dv / size * scale, -db_du / size * scale}, {-da_dv / size * scale, da_du / size * scale}, false};
    }
    /* M^-1 = V diag(1/s) U^T: the roles of u and v change */
    const double s0 = fmin(shortest, limit);
    const double v1[2] = {-m.sign * m.v[1], m.sign * m.v[0]}, u1[2] = {-m.u[1], m.u[0]};
    return (dif_footprint){{s0 * m.v[0] * m.u[0] + limit * v1[0] * u1[0], s0 * m.v[1] * m.u[0] + limit * v1[1] * u1[0]},
                           {s0 * m.v[0] * m.u[1] + limit * v1[0] * u1[1], s0 * m.v[1] * m.u[1] + limit * v1[1] * u1[1]},
                           true};
}

dif_footprint dif_footprint_rectangle(double du, double dv, double limit)
{
    const double w1[2] = {du, 0.0}, w2[2] = {0.0, dv};
    return clamp(w1, w2, limit);
}

dif_footprint dif_footprint_chain(const dif_footprint *uv, double ds_du, double dt_du, double ds_dv, double dt_dv,
                                  double limit)
{
    const double w1[2] = {ds_du * uv->w1[0] + ds_dv * uv->w1[1], dt_du * uv->w1[0] + dt_dv * uv->w1[1]};
    const double w2[2] = {ds_du * uv->w2[0] + ds_dv * uv->w2[1], dt_du * uv->w2[0] + dt_dv * uv->w2[1]};
    dif_footprint out = clamp(w1, w2, limit);
    out.clamped = out.clamped || uv->clamped;
    return out;
}

dif_footprint_ellipse dif_footprint_ellipse_of(const dif_footprint *footprint)
{
    const double *w1 = footprint->w1, *w2 = footprint->w2;
    const double size = fmax(fmax(fabs(w1[0]), fabs(w1[1])), fmax(fabs(w2[0]), fabs(w2[1])));
    if (!(size > 0.0))
        return (dif_footprint_ellipse){0.0, 0.0, {1.0, 0.0}, {0.0, 1.0}};
    const svd m = svd_of(w1[0] / size, w2[0] / size, w1[1] / size, w2[1] / size);
    return (dif_footprint_ellipse){m.s[0] * size, m.s[1] * size, {m.u[0], m.u[1]}, {-m.u[1], m.u[0]}};
}
