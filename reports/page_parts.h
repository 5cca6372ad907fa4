/* The tables and statements of one surface's section.
 * Does not: draw figures. */
#ifndef DIF_PAGE_PARTS_H
#define DIF_PAGE_PARTS_H

#include <stdio.h>

#include "reports/result.h"

void dif_part_conditions(FILE *html, const json_t *doc);   /* size, heights, plan, window, quantity       */
void dif_part_periods(FILE *html, const json_t *doc);      /* fits beside the expected period             */
void dif_part_orders(FILE *html, const json_t *doc);       /* residual statistics by order                */
void dif_part_ridges(FILE *html, const json_t *doc);       /* the fitted ridges with weights              */
void dif_part_accuracy(FILE *html, const json_t *doc);     /* error against the direct sum, tol, bound    */
void dif_part_energy(FILE *html, const json_t *doc);       /* integral of the BRDF                        */
void dif_part_order_powers(FILE *html, const json_t *doc); /* sampled against closed form, where there is */
void dif_part_trust(FILE *html, const json_t *doc);        /* where scalar theory stops                   */
void dif_part_timings(FILE *html, const json_t *doc);      /* nothing if the file has no timings          */
void dif_part_methods(FILE *html, const json_t *doc);      /* all methods side by side, and which to trust */

/* The BRDF map's section; nothing if there is no map. Status as dif_picture_load. */
DIF_MUST_USE dif_status dif_part_map(FILE *html, int number, const dif_result *result, dif_error *err);

/* The rendering's section; nothing if there is none. Status as dif_picture_load. */
DIF_MUST_USE dif_status dif_part_render(FILE *html, int number, const dif_result *result, dif_error *err);

/* The section of slopes, normals and views; nothing if there is none. Status as dif_picture_load. */
DIF_MUST_USE dif_status dif_part_slopes(FILE *html, int number, const dif_result *result, dif_error *err);

/* GPU against CPU: its section, or why it is missing; nothing if it was not asked for. */
void dif_part_gpu(FILE *html, int number, const json_t *doc);

/* The studies' section; nothing if there are none. Status as dif_picture_load. */
DIF_MUST_USE dif_status dif_part_study(FILE *html, int number, const dif_result *result, dif_error *err);

#endif
