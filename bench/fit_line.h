/* The shape that one order has along f in a table, and the cross term that the patch's edges add; for bench/fit only.
 *
 *   L(delta) = sum_s |W^_s(delta)|^2 / sum_s W^_s(0)^2                  over the windows s of the average
 *   E(delta) = sum_s conj(W^_s(delta)) W_s(edge) exp(2 pi i delta x_edge) / norm
 *
 * A window that the patch cuts leaks: every order reaches every other one through the two edges, with an amplitude that
 * goes as W(edge) and a phase exp(+-i pi f D). To first order the leak adds alpha Re E + beta Im E to |c_m|^2 L with
 * alpha and beta smooth. For a Gaussian of a quarter of the patch the leak is only 3e-3 of a neighbour's amplitude, but
 * it moves a line's centre by 1e-4 of the frequency, so precise fits need it.
 *
 * Ghosts: a ruling whose pitch does not fit the samples repeats its errors every few grooves, which puts weak lines close
 * to each order. Alone they are invisible, but their cross term with the strong line reshapes its flanks.
 * Does not: know orders or amplitudes. */
#ifndef DIF_FIT_LINE_H
#define DIF_FIT_LINE_H

#include <stdbool.h>

#include "bench/fit.h"

/* Values and derivatives at one delta. */
typedef struct dif_fit_shape {
    double l, dl;         /* L, dL/d delta                                             */
    double re, dre;       /* Re E                                                      */
    double im, dim;       /* Im E                                                      */
    double dl_dlog_width; /* dL/d ln(width), Gaussian of free width only               */
} dif_fit_shape;

typedef struct dif_fit_lineshape {
    bool known;          /* false: L = exp(-delta^2 / (2 width^2))                    */
    bool has_edge;       /* E is of use: the plane runs along an axis of the patch    */
    double sigma_per_um; /* half width at half maximum of L / sqrt(2 ln 2)            */
    double rms_per_um;   /* rms width of L within 5 sigma                              */
    double extent_um;    /* of the patch along the plane                               */
    int n_node;
    double step_per_um;
    double (*node)[6]; /* L, L', Re E, Re E', Im E, Im E' at delta = i step, owned  */
    int n_wave;        /* windows along the plane's axis, 0: no pair terms          */
    double (*wave)[4]; /* wave[n_wave * n_node]: Re W^, Re W^', Im W^, Im W^', owned */
} dif_fit_lineshape;

/* Cross term of two lines: S = sum_s Re(conj(W^_s(a)) W^_s(b)) / norm at distances a and b from them. */
typedef struct dif_fit_pair_shape {
    double s, ds_da, ds_db;
} dif_fit_pair_shape;

enum { DIF_FIT_LINE_REACH = 25 }; /* the table ends at this many sigma; L and E are 0 beyond */

/* Tabulates a known line in a plane of the given azimuth. Status DIF_ERR_ARG, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_fit_line_create(const dif_fit_line *line, double azimuth_rad, dif_fit_lineshape *out,
                                            dif_error *err);
void dif_fit_line_free(dif_fit_lineshape *line);

/* A Gaussian of the given width. */
dif_fit_lineshape dif_fit_line_gauss(double sigma_per_um);

/* Shape at delta; width_per_um is read only if the line is not known. */
dif_fit_shape dif_fit_line_at(const dif_fit_lineshape *line, double delta_per_um, double width_per_um);

/* W^ itself and its slope, for a line of one window at the patch's centre (n_wave = 1): real, 1 at 0. */
double dif_fit_line_amplitude(const dif_fit_lineshape *line, double delta_per_um, double *slope);

/* Cross term; exact where n_wave is not 0, else the geometric mean of the two shapes. */
dif_fit_pair_shape dif_fit_line_pair(const dif_fit_lineshape *line, double a_per_um, double b_per_um,
                                     double width_per_um);

#endif
