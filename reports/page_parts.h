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

#endif
