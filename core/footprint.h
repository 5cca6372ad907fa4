/* The footprint of a pixel in texture space: two vectors that span it, and the ellipse inside.
 * Source: the filter footprints of Ptex.
 * Does not: read textures. */
#ifndef DIF_FOOTPRINT_H
#define DIF_FOOTPRINT_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The parallelogram spanned by w1 and w2 around a point (u, v): one step along each of two axes of the picture. */
typedef struct dif_footprint {
    double w1[2], w2[2]; /* (du, dv) of one step along the first and the second axis */
    bool clamped;        /* an axis of its ellipse was cut to the limit that was given */
} dif_footprint;

/* The ellipse that the two vectors map the unit circle to. */
typedef struct dif_footprint_ellipse {
    double major, minor;  /* half axes, major >= minor >= 0             */
    double major_axis[2]; /* unit vectors in (u, v), right-handed      */
    double minor_axis[2];
} dif_footprint_ellipse;

/* General case: picture coordinates (a, b) as functions of the texture's (u, v); the inverse of their Jacobian.
 *
 *   w1 = (du/da, dv/da) = (db/dv, -db/du) / det,   w2 = (du/db, dv/db) = (-da/dv, da/du) / det
 *
 * Given     limit  longest half axis, > 0 and finite
 * Returns   the footprint; an axis of its ellipse longer than limit becomes limit, so that a singular Jacobian gives
 *           limit along the direction that it does not see, and one that is zero a circle of limit. One that is not
 *           finite gives the circle, too. Never NaN.
 * Accuracy  1e-14 relative to the longer axis where nothing is clamped */
dif_footprint dif_footprint_from_screen(double da_du, double db_du, double da_dv, double db_dv, double limit);

/* The rectangle of a picture aligned with the texture: w1 = (du, 0), w2 = (0, dv). Each is clamped likewise. */
dif_footprint dif_footprint_rectangle(double du, double dv, double limit);

/* Another parametrisation (s, t) of the same surface, by the chain rule; clamped likewise. */
dif_footprint dif_footprint_chain(const dif_footprint *uv, double ds_du, double dt_du, double ds_dv, double dt_dv,
                                  double limit);

/* Half axes and their directions: the singular values of (w1 w2) in closed form. Accuracy 1e-15 of major. */
dif_footprint_ellipse dif_footprint_ellipse_of(const dif_footprint *footprint);

#ifdef __cplusplus
}
#endif
#endif
