/* The sheet transform of one windowed heightfield: its 3-D Fourier transform sampled so densely that any wanted
 * point of it is a short, accurate interpolation.
 *
 *   P(kappa) = sum_j W_j exp(i kappa . r_j),  r_j = (x, y, h)_j       core/conventions.h
 *
 * Two forms: `line` serves kappa in one vertical plane (in-plane tables at any azimuth), `volume` serves any direction.
 * Evaluation is core/response.h.
 * Does not: gains, averaging over windows, files. */
#ifndef DIF_SHEET_H
#define DIF_SHEET_H

#include <stdbool.h>
#include <stddef.h>

#include "core/field.h"
#include "core/vec.h"
#include "core/window.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dif_sheet dif_sheet;

/* The part of frequency space that will be asked for. */
typedef struct dif_band {
    double k_lateral_max_rad_per_um;             /* largest |(kappa_x, kappa_y)|, >= 0       */
    double kz_min_rad_per_um, kz_max_rad_per_um; /* range of -kappa_z, 0 <= min <= max       */
} dif_band;

typedef enum dif_basis {
    DIF_BASIS_WAVES, /* planes exp(i kappa_z h), interpolated in kappa_z: the sheet method       */
    DIF_BASIS_POWERS /* planes (h/a)^n / n!: the Taylor method of the source, for comparison     */
} dif_basis;

typedef struct dif_sheet_opts {
    dif_basis basis;
    int n_terms;       /* DIF_BASIS_POWERS: number of terms, or DIF_TERMS_FROM_TOL */
    bool single;       /* allow float storage where tol permits it               */
    bool force_single; /* float whatever tol says: to show where it breaks       */
} dif_sheet_opts;

#define DIF_TERMS_FROM_TOL (-1)

dif_sheet_opts dif_sheet_opts_default(void);

/* Builds the transform for directions in the vertical plane of the given azimuth.
 *
 * Given     tol  largest wanted |P error| / sum W, 1e-14 <= tol < 1
 *           opts NULL = defaults
 * Status    DIF_ERR_ARG, DIF_ERR_TOL, DIF_ERR_SIZE, DIF_ERR_NOMEM, DIF_ERR_FOREIGN; *out NULL on failure
 * Owns      the caller frees with dif_sheet_free
 * Cost      O(nx ny planes) */
DIF_MUST_USE dif_status dif_sheet_create_line(const dif_field *field, const dif_window *window, double azimuth_rad,
                                              const dif_band *band, double tol, const dif_sheet_opts *opts,
                                              dif_sheet **out, dif_error *err);

/* Builds the transform for any direction. Cost O(nx ny planes log(nx ny)). */
DIF_MUST_USE dif_status dif_sheet_create_volume(const dif_field *field, const dif_window *window, const dif_band *band,
                                                double tol, const dif_sheet_opts *opts, dif_sheet **out,
                                                dif_error *err);

void dif_sheet_free(dif_sheet *sheet);

/* What a sheet is like, for reports. */
typedef struct dif_sheet_info {
    double bound;         /* bound of |P error| / sum W: kernel aliasing (rigorous) + rounding (estimate)  */
    double sum_w;         /* sum of W                                                                      */
    double area_um2;      /* (T^2 sum W)^2 / (T^2 sum W^2)                                                 */
    int n_plane;          /* planes stored (or Taylor terms)                                               */
    int n_tap;            /* kernel width, samples per axis                                                */
    int n_bin_x, n_bin_y; /* frequency bins kept per plane (n_bin_y = 1 for a line)                     */
    size_t n_byte;        /* size of the stored planes                                                     */
    bool single;          /* stored in float                                                               */
    bool is_line;         /* made by dif_sheet_create_line                                                 */
    double azimuth_rad;   /* of a line's plane, as asked for; 0 for a volume                               */
} dif_sheet_info;

dif_sheet_info dif_sheet_info_of(const dif_sheet *sheet);

/* Whether a point lies in the band that the sheet was made for, so that core/response.h may read it there. Of a line's
 * point only the component along its azimuth counts. */
bool dif_sheet_covers(const dif_sheet *sheet, dif_vec3 kappa);

/* An order in which to read many points of a volume sheet so that neighbours share memory: order[n] is a permutation,
 * sorted by tiles of frequency bins.  Status DIF_ERR_NOMEM.  Cost O(n + tiles) */
DIF_MUST_USE dif_status dif_sheet_order(const dif_sheet *sheet, size_t n, const dif_vec3 *kappa, size_t *order,
                                        dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
