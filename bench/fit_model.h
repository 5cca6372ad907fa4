/* The ridge model of a table and its least-squares fit; for bench/fit only.
 *
 *   y(f, kz) = sum_k [ C_k(kz) L(f - f_k) + side terms ] + b0_g(kz) + b1_g(kz) t
 *   cross terms of ridges closer than DIF_FIT_CROSS_SIGMA: X_kl S(f - f_k, f - f_l), they interfere
 *   side terms: A_k Re E + B_k Im E (leak through the edges),  G+_k S(+apart) + G-_k S(-apart) (ghosts),  fit_line.h
 *   apart = n/pitch - j g: the fold of the samples' pitch into the orders, a vernier of its own for g
 *
 * C, A, B, G, b0, b1 are uniform B-splines in kz; t = (f - middle of the group) / its half width. Cells come in groups: stretches
 * of f that hold one or several ridges and their surroundings. Ridges of other groups are too far away to matter.
 * Centres are free, f_k, or orders of one grating, f_k = m_k g.
 * Does not: choose cells, ridges or numbers of coefficients. */
#ifndef DIF_FIT_MODEL_H
#define DIF_FIT_MODEL_H

#include <stdbool.h>

#include "bench/fit.h"
#include "bench/fit_line.h"

enum {
    DIF_FIT_COEF_MAX = 18,
    DIF_FIT_EDGE_TERMS = 4,
    DIF_FIT_GHOST_MAX = 2,
    DIF_FIT_CROSS_MAX = 3, /* partners of one ridge */
    DIF_FIT_SIDE_MAX = DIF_FIT_EDGE_TERMS + 2 * DIF_FIT_GHOST_MAX + DIF_FIT_CROSS_MAX,
    DIF_FIT_SHARED_MAX = DIF_FIT_RIDGE_MAX + 2
};

/* Distances of ghosts that are modelled, in line widths. */
#define DIF_FIT_APART_MIN 2.0
#define DIF_FIT_APART_MAX 9.0
/* Ridges closer than this many line widths interfere. */
#define DIF_FIT_CROSS_SIGMA 6.0

/* A line is clean if the model leaves less than this share of the data's rms. */
#define DIF_FIT_CLEAN_SHARE 0.03

/* One cell of the table. */
typedef struct dif_fit_cell {
    double f_per_um, kz_rad_per_um;
    double y;              /* power in units of the table's largest                        */
    double turn_s, turn_c; /* sine and cosine of the running angle / lambda, for an offset */
    int group, i_angle, i_lambda;
} dif_fit_cell;

typedef struct dif_fit_component {
    int group, order;
    double f_per_um;                       /* start; used if the centre is free                        */
    double strength;                       /* mean of C as first found */
    double kz_low, kz_high;                /* where its amplitude splines live                         */
    int n_coef, n_side;                    /* coefficients of C; of each side term, 0: none                     */
    int n_cross, cross[DIF_FIT_CROSS_MAX]; /* later ridges of the group close enough to interfere with */
    int at;                                /* first coefficient in its group's block                   */
} dif_fit_component;

typedef struct dif_fit_group {
    double f_low, f_high, kz_low, kz_high;
    int n_level, n_slope; /* coefficients of b0 and b1 */
    int at;               /* first background coefficient in the block                */
    int size;             /* of the block              */
    int start;            /* of the block in the parameter vector                     */
} dif_fit_group;

typedef struct dif_fit_model {
    const dif_fit_lineshape *line;
    bool common, offset_free, width_free, edge;
    bool coherent; /* sum of amplitudes, squared: y = (c W^ + side amplitudes)^2 + background, one window only */
    int n_ghost;   /* pairs of ghosts at +-(ghost_f - ghost_order g) from each order */
    double ghost_f_per_um[DIF_FIT_GHOST_MAX]; /* multiples of 1/pitch                                          */
    int ghost_order[DIF_FIT_GHOST_MAX];
    double ghost_g_per_um; /* g, if it is no parameter (centres free)                                   */
    int n_ridge, n_group, n_shared, n_par, stride;
    dif_fit_component ridge[DIF_FIT_RIDGE_MAX];
    dif_fit_group group[DIF_FIT_RIDGE_MAX];
    int i_offset, i_width; /* places in the shared parameters; centres or g come first */
} dif_fit_model;

/* Numbers the parameters after ridges, groups and switches are set. */
void dif_fit_model_number(dif_fit_model *model);

/* Centre of ridge k, offset and line width for given parameters. */
double dif_fit_model_centre(const dif_fit_model *model, const double *par, int k);
double dif_fit_model_offset(const dif_fit_model *model, const double *par);
double dif_fit_model_width(const dif_fit_model *model, const double *par);

/* Frequency of a cell with the angular offset applied; *slope (may be NULL) its derivative by the offset. */
double dif_fit_model_frequency(const dif_fit_cell *cell, double offset_rad, double *slope);

/* Value of C_k at kz. */
double dif_fit_model_amplitude(const dif_fit_model *model, const double *par, int k, double kz);

/* Model value of one cell and its Jacobian row[stride]: shared columns, then those of the cell's block. */
double dif_fit_model_row(const dif_fit_model *model, const double *par, const dif_fit_cell *cell, double *row);

/* Model value of one cell, by a path of its own (no Jacobian): what residuals are recomputed with. */
double dif_fit_model_value(const dif_fit_model *model, const double *par, const dif_fit_cell *cell);

/* What a fit gave. */
typedef struct dif_fit_outcome {
    bool converged, has_covariance;
    int n_iteration;
    double cost;              /* the solver's                                             */
    double residual_rms;      /* recomputed                                               */
    double independent_share; /* of the cells, as the correlation of residuals counts them        */
    double n_independent;     /* cells / correlation of neighbouring residuals            */
    double criterion;         /* BIC with that number                                     */
    double covariance[DIF_FIT_SHARED_MAX * DIF_FIT_SHARED_MAX]; /* of the shared parameters, scaled by residuals */
    char text[160];
} dif_fit_outcome;

typedef enum dif_fit_mode { DIF_FIT_LINEAR /* shared parameters held */, DIF_FIT_PLAIN, DIF_FIT_ROBUST } dif_fit_mode;

/* Fits par[model->n_par] (start in, solution out) to cells[n], sorted by wavelength, then angle. Two rounds: plain
 * squares, then Huber's loss at 3 robust deviations of the residuals on the lines if the mode is robust.
 * Status    DIF_ERR_NOMEM, DIF_ERR_FOREIGN; DIF_ERR_FIT if the residuals computed here deny the solver's cost */
DIF_MUST_USE dif_status dif_fit_model_solve(const dif_fit_model *model, int n, const dif_fit_cell *cells,
                                            dif_fit_mode mode, double *par, dif_fit_outcome *out, dif_error *err);

#endif
