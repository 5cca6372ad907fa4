/* Preparation of a measured heightfield: level, correct lines, remove spikes and scars, fill, cut, resample, rotate.
 *
 * Every step works in place, in double; one that fails leaves the field as it was. A height that is not finite is a
 * missing point: the steps that look at heights one by one or by the row pass over it, those that need a neighbourhood
 * refuse (DIF_ERR_NONFINITE) until it is filled. Common status: DIF_ERR_ARG, DIF_ERR_NOMEM, and DIF_ERR_NONFINITE if
 * nothing is there at all.
 * Does not: choose steps or their order, print, or know a file. */
#ifndef DIF_PREP_H
#define DIF_PREP_H

#include <stdbool.h>
#include <stddef.h>

#include "core/field.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_LEVEL_DEGREE_MAX = 8, DIF_LEVEL_AUTO_MAX = 3 };

/* Heights that are there. */
typedef struct dif_prep_state {
    size_t n_missing;
    double mean_um, rms_um; /* of the others, rms about the mean; 0 if there are none */
} dif_prep_state;
dif_prep_state dif_prep_state_of(const dif_field *field);

/* The least-squares plane: how unlevelled a field is. */
typedef struct dif_prep_tilt {
    double slope_x, slope_y; /* ratios                                                   */
    double share;            /* of the variance that the plane explains, in [0, 1]       */
} dif_prep_tilt;
DIF_MUST_USE dif_status dif_prep_tilt_of(const dif_field *field, dif_prep_tilt *out, dif_error *err);

/* Subtracts the least-squares polynomial in x and y of a total degree in [0, DIF_LEVEL_DEGREE_MAX]: 0 is the mean, 1 a
 * plane. Terms that the points do not determine (a single row) are left out. */
DIF_MUST_USE dif_status dif_prep_level(dif_field *field, int degree, dif_error *err);

/* A plane; then a degree more, up to DIF_LEVEL_AUTO_MAX, as long as it takes more than 5 % of the variance that is
 * left. */
DIF_MUST_USE dif_status dif_prep_level_auto(dif_field *field, int *degree, dif_error *err);

typedef enum dif_prep_lines_method {
    DIF_LINES_MEDIAN, /* every row's median to one height: for surfaces whose rows all see the same                 */
    DIF_LINES_DIFF    /* the median of the steps from row to row to 0: keeps what a median of heights would flatten
                         within a row, but random errors of the steps add up over many rows                         */
} dif_prep_lines_method;

/* Shifts each row (a line of the fast axis, x); the shifts' mean is 0, so that the mean height stays. */
DIF_MUST_USE dif_status dif_prep_lines(dif_field *field, dif_prep_lines_method method, dif_error *err);

/* A limit in heights or in robust standard deviations (1.4826 times the median absolute value, or the rms where that is
 * 0) of the quantity that is compared. */
typedef struct dif_prep_limit {
    bool in_sigma;
    double value; /* > 0: um or sigma */
} dif_prep_limit;

/* Replaces points that differ by more than the limit from the median of the 5 x 5 around them (fewer near edges, always
 * symmetric, so that a slope is no spike) by what dif_prep_fill puts there. Other points keep their bits; *n_found
 * (may be NULL) counts the replaced ones. A spike is at most 12 points of its 25. */
DIF_MUST_USE dif_status dif_prep_despike(dif_field *field, dif_prep_limit limit, size_t *n_found, dif_error *err);

enum { DIF_SCAR_ROWS_MAX = 3, DIF_SCAR_SAMPLES_MIN = 8 };

/* The same for scars: stretches of at least DIF_SCAR_SAMPLES_MIN samples along x, up to DIF_SCAR_ROWS_MAX rows thick,
 * all above (or all below) both rows that enclose them by more than the limit; sigma is that of steps from row to
 * row. */
DIF_MUST_USE dif_status dif_prep_scars(dif_field *field, dif_prep_limit limit, size_t *n_found, dif_error *err);

typedef enum dif_prep_fill_method {
    DIF_FILL_PLATE,  /* least bending: goes on with the slopes around a hole, exact on planes                      */
    DIF_FILL_LAPLACE /* least slope: never above or below the hole's rim; for wide holes and noisy rims            */
} dif_prep_fill_method;

typedef struct dif_prep_filled {
    size_t n;        /* points filled                                                              */
    int reach;       /* steps along rows and columns from the farthest of them to a measured one    */
    double residual; /* of the equations, relative to a constant filling                           */
} dif_prep_filled;

/* Fills missing points from those around them. *out may be NULL.
 * Cost      O(missing points) a conjugate gradient step, few steps for small holes: the start comes from coarser grids */
DIF_MUST_USE dif_status dif_prep_fill(dif_field *field, dif_prep_fill_method method, dif_prep_filled *out,
                                      dif_error *err);

/* A part, in um from the LOWER LEFT corner of the field (y up): the samples whose centres lie in [x0, x1) x [y0, y1).
 * At least 2 x 2 of them. The new field has its own centre. */
typedef struct dif_prep_box {
    double x0_um, x1_um, y0_um, y1_um;
} dif_prep_box;
DIF_MUST_USE dif_status dif_prep_crop(dif_field *field, const dif_prep_box *box, dif_error *err);

/* Other pitches over the same patch about the same centre; a remainder of a sample is cut. Interpolation is by quintic
 * splines; towards a coarser pitch heights pass a low-pass first, so that nothing is aliased.
 * Accuracy  of a sine of period d, relative to its amplitude, 16 samples (8 new ones if coarser) from the edges:
 *           2.5 (pitch/(d - pitch))^6 towards a finer pitch, 2e-4 towards a coarser one for d >= 4 new pitches. At an
 *           edge the field goes on point-symmetrically. */
DIF_MUST_USE dif_status dif_prep_resample(dif_field *field, double pitch_x_um, double pitch_y_um, dif_error *err);

/* Turns the sample counter-clockwise seen from above: a groove normal at azimuth psi goes to psi + angle. Quarter turns
 * are exact; else the largest rectangle inside the turned patch is kept, at square pixels of the finer pitch. */
DIF_MUST_USE dif_status dif_prep_rotate(dif_field *field, double angle_rad, dif_error *err);

/* Subtracts the Gaussian mean line of ISO 16610 (half of a wave of the cut-off's length passes), fitted as a local
 * straight line along x and y, so that a plane is removed to its edges. For the bow of a scanner.
 * cutoff_um > 2 pitches. */
DIF_MUST_USE dif_status dif_prep_highpass(dif_field *field, double cutoff_um, dif_error *err);

typedef struct dif_prep_lattice {
    double period_um, psi_rad; /* of the wave: groove normal at psi                                  */
    double across_um;          /* period at right angles to it, or NaN for none                     */
} dif_prep_lattice;

/* Cuts a periodic surface to whole periods, so that it continues itself: turns the groove normal to the nearer axis and
 * resamples so that as many periods as fit inside are a whole number of samples (pitch at most the old one). *n_period
 * (may be NULL) is how many along and across, 0 for none across.
 * Status    DIF_ERR_SIZE if not one period is inside */
DIF_MUST_USE dif_status dif_prep_whole_periods(dif_field *field, const dif_prep_lattice *lattice, int n_period[2],
                                               dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
