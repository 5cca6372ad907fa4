/* The figures of one surface, each written as an inline SVG element.
 * Does not: captions (page.c). */
#ifndef DIF_FIGURES_H
#define DIF_FIGURES_H

#include <stdio.h>

#include "reports/result.h"

/* What a caption must know of a figure. */
typedef struct dif_figure_notes {
    int n_cell_x, n_cell_y;               /* table cells that share one pixel of the heat map                  */
    double low, high;                     /* ends of the heat map's colour scale                               */
    int n_maximum, n_skipped;             /* maxima drawn, and those at an edge or too many to draw            */
    int n_curve;                          /* grating-equation curves drawn                                     */
    int n_residual, n_far;                /* residuals drawn, and those beyond the plot                        */
    double height_low_nm, height_high_nm; /* ends of the height picture's colour scale             */
    double height_outside;                /* share of its pixels beyond them                                  */
    double profile_um;                    /* length of the height profile                                      */
} dif_figure_notes;

/* Each draws to html with ids that begin with `prefix`. Status as dif_plot_close. */
DIF_MUST_USE dif_status dif_figure_height(const dif_result *result, const char *prefix, FILE *html,
                                          dif_figure_notes *notes, dif_error *err);
DIF_MUST_USE dif_status dif_figure_profile(const dif_result *result, const char *prefix, FILE *html,
                                           dif_figure_notes *notes, dif_error *err);
DIF_MUST_USE dif_status dif_figure_table(const dif_result *result, const char *prefix, FILE *html,
                                         dif_figure_notes *notes, dif_error *err);
DIF_MUST_USE dif_status dif_figure_residuals(const dif_result *result, const char *prefix, FILE *html,
                                             dif_figure_notes *notes, dif_error *err);
DIF_MUST_USE dif_status dif_figure_lines(const dif_result *result, const char *prefix, FILE *html, dif_error *err);

/* A BRDF map's picture on a disc with rings, azimuths and the light's direction; is_level: with the scale of the
 * luminance. `map` is the result's object of that name. */
void dif_figure_map(const dif_picture *picture, const json_t *map, bool is_level, const char *prefix, FILE *html);

/* Bytes as base64, for pictures inside a page. */
void dif_figure_base64(const unsigned char *data, size_t n, FILE *html);

/* One picture of a comparison with a ring around a place: `at` holds x and y as shares from the left and the top, NULL =
 * no ring. `axes`: [angle from, to, wavelength from, to] of a table, or NULL: a disc of directions. */
void dif_figure_compared(const dif_picture *picture, const json_t *axes, const json_t *at, const char *label,
                         const char *prefix, FILE *html);

/* The scale of a difference picture, from low to high. */
void dif_figure_difference_bar(double low, double high, const char *prefix, FILE *html);

/* The same small, without rings; `label` is for those who cannot see it. */
void dif_figure_small_map(const dif_picture *picture, const char *label, const char *prefix, FILE *html);

/* A picture as it is; `label` is for those who cannot see it. */
void dif_figure_picture(const dif_picture *picture, const char *label, FILE *html);

#endif
