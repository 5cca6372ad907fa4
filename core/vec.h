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

#endif
