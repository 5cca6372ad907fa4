/* The steps of a table fit between the cells and the result; for bench/fit only.
 * Does not: check the caller's arguments. */
#ifndef DIF_FIT_RIDGES_H
#define DIF_FIT_RIDGES_H

#include "bench/fit.h"
#include "bench/fit_cells.h"
#include "bench/fit_model.h"

enum {
    DIF_FIT_LAMBDA_MIN = 8, /* wavelengths that a ridge must be seen at */
    DIF_FIT_LEVEL = 4,      /* coefficients of the background's level   */
    DIF_FIT_SLOPE = 2,      /* and of its slope                         */
    DIF_FIT_CELL_MAX = 9000,
    DIF_FIT_CHOOSE_COEF = 6,
    DIF_FIT_WALK_COEF = 6,
    DIF_FIT_GHOST_N_MAX = 6, /* highest multiple of 1/pitch whose fold is looked at */
    DIF_FIT_PAR_MAX = DIF_FIT_SHARED_MAX +
                      DIF_FIT_RIDGE_MAX * ((1 + DIF_FIT_SIDE_MAX) * DIF_FIT_COEF_MAX + DIF_FIT_LEVEL + DIF_FIT_SLOPE)
};

/* Half width of the stretch of f around a ridge, in line widths: where ridges are chosen, and where they are fitted. The
 * wings of a line are worth having: leak and ghosts stand out there, which in the core hide behind a shift. */
#define DIF_FIT_CHOOSE_SIGMA 5.0
#define DIF_FIT_WINDOW_SIGMA 6.0

/* A model with its cells, parameters and what the fit said. */
typedef struct dif_fit_state {
    dif_fit_model model;
    dif_fit_cell *cell; /* owned */
    int n_cell;
    double par[DIF_FIT_PAR_MAX];
    dif_fit_outcome outcome;
    bool has_before; /* the model was refined: centres without side terms, and before the last refinement */
    double plain[DIF_FIT_RIDGE_MAX], before[DIF_FIT_RIDGE_MAX];
} dif_fit_state;

/* Stretches of f of half width `reach` around the centres, merged where they meet; returns their number. */
int dif_fit_ridges_group(const dif_fit_view *view, double reach_per_um, int n, const double *centre,
                         dif_fit_group group[DIF_FIT_RIDGE_MAX]);

/* Sets the ranges of all splines to where cells are and caps the numbers of coefficients by the wavelengths that a
 * ridge is seen at. False if ridge k (of *lost) is not seen on both sides at DIF_FIT_LAMBDA_MIN wavelengths or more. */
bool dif_fit_ridges_range(dif_fit_model *model, int n, const dif_fit_cell *cells, const double *centre, int *lost);

/* Chooses each group's ridges among the candidates by the criterion; centres free. Fills the ridges of state->model
 * (line, groups and cells are set). */
DIF_MUST_USE dif_status dif_fit_ridges_choose(dif_fit_state *state, int n, const dif_fit_candidate *candidate,
                                              dif_error *err);

/* BIC of a fit with the independent cells of another, richer one, so that the two can be compared. */
double dif_fit_ridges_criterion(const dif_fit_state *state, double n_independent);

/* Fits all ridges together: number of coefficients by the criterion, side terms if they explain most of the rest. Shared
 * parameters start from state->par; pitch_um (or NaN) tells where ghosts of the samples lie. */
DIF_MUST_USE dif_status dif_fit_ridges_solve(dif_fit_state *state, double pitch_um, dif_error *err);

/* Takes ridge k out of a fitted state with free centres; the others start from where they are. */
void dif_fit_ridges_drop(dif_fit_state *state, int k);

/* Estimates of the parts: bands of wavelengths x ridges. */
typedef struct dif_fit_part {
    int ridge;
    double f_per_um, f_sd_per_um;
} dif_fit_part;

/* Fits each ridge's centre in n_band disjoint bands of wavelengths, offset and width held. Parts that do not see a ridge
 * give nothing. Returns through *n_part their number, at most n_band * n_ridge. */
DIF_MUST_USE dif_status dif_fit_ridges_parts(const dif_fit_state *state, int n_band, dif_fit_part *part, int *n_part,
                                             dif_error *err);

/* Mean of C_k over the cells within one width of its centre. */
double dif_fit_ridges_strength(const dif_fit_state *state, int k);

#endif
