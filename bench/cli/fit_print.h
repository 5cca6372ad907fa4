/* Fit results as text for people and as JSON for machines.
 * Does not: fit. */
#ifndef DIF_FIT_PRINT_H
#define DIF_FIT_PRINT_H

#include <jansson.h>
#include <stdbool.h>

#include "bench/fit.h"
#include "core/io/manifest.h"

/* is_common: all ridges are orders of one grating; otherwise the period is that of the strongest ridge only. */
void dif_fit_table_print(const dif_fit_result *result, bool is_common);
void dif_fit_surface_print(const dif_fit_surface_result *result);
json_t *dif_fit_table_json(const dif_fit_result *result, bool is_common, const dif_manifest *manifest);
json_t *dif_fit_surface_json(const dif_fit_surface_result *result, const dif_manifest *manifest);

#endif
