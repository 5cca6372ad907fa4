/* The surfaces of a comparison: built-in ones or files, with what is known of them.
 * Does not: compare. */
#ifndef DIF_COMPARE_SURFACE_H
#define DIF_COMPARE_SURFACE_H

#include "bench/cli/compare_run.h"

typedef struct dif_compare_surface {
    char title[160], slug[64], description[400];
    dif_field field;       /* owned                                                       */
    dif_plan plan;         /* owned: of the table                                         */
    dif_manifest manifest; /* owned                                                       */
    dif_measure_opts opts; /* with the period, NaN = none; its shadowing is the next      */
    dif_shadow shadow;     /* owned                                                       */
    bool has_period;       /* exactly periodic: nmm-lines and pq make sense               */
    bool is_grating;
    double f_min_per_um, f_max_per_um;
} dif_compare_surface;

/* Number of built-in surfaces. */
int dif_compare_surface_built_in(void);

/* Loads operand i, or built-in surface i if there are no operands; *out must be freed in any case. */
DIF_MUST_USE dif_status dif_compare_surface_load(const dif_cli *cli, const dif_compare_args *args, int i,
                                                 dif_compare_surface *out, dif_error *err);
void dif_compare_surface_free(dif_compare_surface *surface);

#endif
