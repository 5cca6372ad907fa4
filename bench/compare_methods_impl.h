/* What the comparison of methods shares between its tables and its colours. Not installed. */
#ifndef DIF_COMPARE_METHODS_IMPL_H
#define DIF_COMPARE_METHODS_IMPL_H

#include "bench/compare_methods.h"

/* What all rows share. */
typedef struct dif_compare_job {
    const dif_field *field;
    const dif_plan *plan;
    double tol;
    const dif_measure_opts *opts;
    dif_compare_opts how;
    size_t *cell;         /* cell[n_check]                                    */
    dif_query *query;     /* and their directions                             */
    dif_sample *truth;    /* by the direct sum                                */
    dif_plan colour_plan; /* angles and wavelengths of the colours            */
    double (*full)[3];    /* full[n_angle]: colours by full sampling          */
    double (*xyz)[3];     /* the same of one method                           */
    double *de;           /* de[n_angle]                                      */
    double exposure;
} dif_compare_job;

/* Angles and wavelengths of the colours. Status DIF_ERR_NOMEM, ... */
DIF_MUST_USE dif_status dif_compare_colour_plan(dif_compare_job *job, dif_error *err);

/* The reference: colours by full sampling, and the exposure. */
DIF_MUST_USE dif_status dif_compare_full_colours(dif_compare_job *job, dif_error *err);

/* Colours of one method, held against them. */
DIF_MUST_USE dif_status dif_compare_colours(const dif_compare_job *job, const dif_measure_opts *opts,
                                            dif_compare_row *row, dif_error *err);

#endif
