/* Shadowing and masking S(wi, wo) of a direction pair, the factor in rho and in the BRDF: V-cavities, Smith for Gaussian
 * slopes, or the distribution of normals that the surface has.
 * Does not: cast rays; diffraction knows no shadow edges, S scales it.
 *
 * For a shader: V-cavity is dif_shadow_vcavity, plain arithmetic. Smith and NDF are G(wi) G(wo) with one read of a table
 * each: g[n_row][n_column], floats, linear in both directions, columns periodic:
 *
 *   t = k.z / (k.z + sqrt(var_x k.x^2 + 2 cov_xy k.x k.y + var_y k.y^2))   row t (n_row - 1)
 *   azimuth of (k.x, k.y) in turns, [0, 1)                                   column azimuth n_column
 *
 * with var_x, var_y and cov_xy of `slopes`. Smith has one column, because t says it all. */
#ifndef DIF_SHADOW_H
#define DIF_SHADOW_H

#include <stdbool.h>

#include "core/hemisphere.h"
#include "core/slope.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_shadowing {
    DIF_SHADOWING_NONE,    /* S = 1                                                                  */
    DIF_SHADOWING_VCAVITY, /* min(1, 2 h_n e_n / (e.h), 2 h_n l_n / (e.h)): needs no surface        */
    DIF_SHADOWING_SMITH,   /* G(wi) G(wo) of Gaussian slopes with the surface's covariance           */
    DIF_SHADOWING_NDF      /* G(wi) G(wo) of the surface's normals, core/hemisphere.h              */
} dif_shadowing;

const char *dif_shadowing_name(dif_shadowing kind); /* "none", "vcavity", "smith", "ndf" */
bool dif_shadowing_from_name(const char *name, dif_shadowing *out);

/* Shadowing, ready to be evaluated. */
typedef struct dif_shadow {
    dif_shadowing kind;
    dif_slope_gauss slopes; /* of the surface, mean subtracted: 0, for none and vcavity all 0  */
    int n_row, n_column;    /* of the table; 0 for none and vcavity                            */
    float *g;               /* g[n_row][n_column], in [0, 1]; owned                            */
} dif_shadow;

/* Prepares a kind for a surface; slopes are taken relative to its mean plane.
 *
 * Given     field  may be NULL for none and vcavity
 * Status    DIF_ERR_ARG (kind, no field), as dif_slope_of_field, DIF_ERR_NOMEM; *out zeroed on failure
 * Owns      the caller frees with dif_shadow_free
 * Cost      ndf: one pass over the surface and 33,000 directions over the texels in use: about half a CPU second */
DIF_MUST_USE dif_status dif_shadow_create(dif_shadowing kind, const dif_field *field, dif_shadow *out, dif_error *err);
void dif_shadow_free(dif_shadow *shadow); /* accepts a zeroed struct */

/* S(wi, wo).
 *
 * Given     shadow  NULL: 1
 *           wi, wo  unit, z >= 0
 * Returns   S in [0, 1], the same for (wo, wi).  No allocation */
double dif_shadow_factor(const dif_shadow *shadow, dif_vec3 wi, dif_vec3 wo);

/* The masking G(k) of one direction, read from the table; 1 for none and vcavity.
 * Accuracy  2e-5 for Smith; NDF: 1e-3 for rough surfaces, 1e-2 at the kinks of a few flat facets */
double dif_shadow_masking(const dif_shadow *shadow, dif_vec3 k);

/* min(1, 2 h_n e_n / (e.h), 2 h_n l_n / (e.h)) with h the half vector.            Torrance, Sparrow 1967 */
double dif_shadow_vcavity(dif_vec3 wi, dif_vec3 wo);

/* Smith's masking for Gaussian slopes, exact: G = z / Psi(z), z = cot t / sqrt(v_o).          Smith 1967
 *
 * Given     slopes  covariance; the mean is not used
 *           k       unit, k.z >= 0
 * Returns   G in [0, 1]; 1 where the slopes have no variance along k */
double dif_shadow_smith(const dif_slope_gauss *slopes, dif_vec3 k);

#ifdef __cplusplus
}
#endif
#endif
