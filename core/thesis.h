/* The program of the source (M. Single, Diffraction Shader, 2014), reproduced so that its published numbers can be.
 *
 *   P(kappa, k) = sum_b exp(-sigma^2 |kappa - kappa_b|^2 / 2) sum_{n<N} (i k)^n / n!  F_b{h^n} / (nx ny)
 *
 * F_b is the DFT of the heights' n-th power over the whole patch with its origin on the first sample, kappa_b the
 * frequency of bin b. Convolving the bins with a Gaussian of sigma_f = 1/(2 pi sigma) is the same as tiling the patch
 * endlessly and laying the coherence window on the CORNER of the patch.
 * Leaves out, as that program does: the factor w of the phase (k h in place of k w h, so the height's phase neither
 * depends on direction nor has the sign of a reflection: it is that of the other side of incidence at |w| = 1), and every
 * gain. Bins further than 4 sigma_f are not read.
 * Does not: bound its error; it is one of principle. */
#ifndef DIF_THESIS_H
#define DIF_THESIS_H

#include <stdbool.h>
#include <stddef.h>

#include "core/field.h"
#include "core/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_THESIS_TERMS = 40, DIF_THESIS_TERMS_MAX = 200 };

typedef struct dif_thesis dif_thesis;

/* The lateral frequencies that will be asked for, rad/um. */
typedef struct dif_thesis_box {
    double kx_min, kx_max, ky_min, ky_max;
} dif_thesis_box;

/* Transforms the powers of the heights.
 *
 * Given     sigma_um  of the window, > 0
 *           n_term    terms of the series, 1 ... DIF_THESIS_TERMS_MAX; the source's is DIF_THESIS_TERMS
 *           single    sum the series in float
 * Status    DIF_ERR_ARG, DIF_ERR_SIZE, DIF_ERR_NOMEM, DIF_ERR_FOREIGN; *out NULL on failure
 * Owns      the caller frees with dif_thesis_free
 * Cost      O(n_term nx ny log(nx ny)); memory O(n_term bins in the box) */
DIF_MUST_USE dif_status dif_thesis_create(const dif_field *field, double sigma_um, const dif_thesis_box *box,
                                          int n_term, bool single, dif_thesis **out, dif_error *err);
void dif_thesis_free(dif_thesis *thesis);

/* P at kappa[n] (rad/um, x and y only) and wavenumbers k[n]; phases are referred to the patch's first sample. */
void dif_thesis_amplitudes(const dif_thesis *thesis, size_t n, const dif_vec3 *kappa, const double *k_rad_per_um,
                           double (*amp)[2]);

#ifdef __cplusplus
}
#endif
#endif
