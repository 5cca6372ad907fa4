/* Three-vectors for directions.  Does not: allocate. */
#ifndef DIF_VEC_H
#define DIF_VEC_H

#include <math.h>

typedef struct dif_vec3 {
    double x, y, z;
} dif_vec3;

static inline double dif_vec3_dot(dif_vec3 a, dif_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Unit direction of polar angle theta (may be signed) and azimuth phi, see core/conventions.h. */
static inline dif_vec3 dif_vec3_from_angles_rad(double theta_rad, double phi_rad)
{
    const double s = sin(theta_rad);
    const dif_vec3 direction = {s * cos(phi_rad), s * sin(phi_rad), cos(theta_rad)};
    return direction;
}

/* (u, v, w) = -(wi + wo). */
static inline dif_vec3 dif_vec3_transfer(dif_vec3 wi, dif_vec3 wo)
{
    const dif_vec3 transfer = {-(wi.x + wo.x), -(wi.y + wo.y), -(wi.z + wo.z)};
    return transfer;
}

static inline dif_vec3 dif_vec3_cross(dif_vec3 a, dif_vec3 b)
{
    const dif_vec3 c = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return c;
}

/* a + scale b. */
static inline dif_vec3 dif_vec3_add(dif_vec3 a, double scale, dif_vec3 b)
{
    const dif_vec3 c = {a.x + scale * b.x, a.y + scale * b.y, a.z + scale * b.z};
    return c;
}

/* Length 1; the zero vector stays. */
static inline dif_vec3 dif_vec3_unit(dif_vec3 a)
{
    const double n = sqrt(dif_vec3_dot(a, a)), scale = n > 0.0 ? 1.0 / n : 0.0;
    const dif_vec3 unit = {a.x * scale, a.y * scale, a.z * scale};
    return unit;
}

/* v turned by an angle about a unit axis, right-handed.          Rodrigues */
static inline dif_vec3 dif_vec3_turn(dif_vec3 v, dif_vec3 axis, double angle_rad)
{
    const double c = cos(angle_rad), s = sin(angle_rad);
    const dif_vec3 still = {(1.0 - c) * dif_vec3_dot(axis, v) * axis.x, (1.0 - c) * dif_vec3_dot(axis, v) * axis.y,
                            (1.0 - c) * dif_vec3_dot(axis, v) * axis.z};
    return dif_vec3_add(dif_vec3_add(still, c, v), s, dif_vec3_cross(axis, v));
}

#endif
