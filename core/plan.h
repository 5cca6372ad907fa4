/* What is measured: the angle-wavelength plan of an in-plane table and single queries.
 * Frame and signs: core/conventions.h.
 * Does not: measure anything. */
#ifndef DIF_PLAN_H
#define DIF_PLAN_H

#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"
#include "core/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_quantity { DIF_QUANTITY_POWER, DIF_QUANTITY_RHO, DIF_QUANTITY_BRDF } dif_quantity;

/* "power", "rho", "brdf"; the unit is "1", "1", "sr^-1". */
const char *dif_quantity_name(dif_quantity quantity);
const char *dif_quantity_unit(dif_quantity quantity);

/* Finds a quantity by name; false if there is none. */
bool dif_quantity_from_name(const char *name, dif_quantity *out);

/* One direction pair and wavelength. */
typedef struct dif_query {
    dif_vec3 wi, wo; /* unit, both away from the surface, z > 0 */
    double lambda_um;
} dif_query;

/* DIF_OK, or DIF_ERR_ARG if query i (counted from 0) has a bad wavelength, a direction that is not a unit vector or one
 * that is not above the surface. */
DIF_MUST_USE dif_status dif_query_check(size_t i, const dif_query *query, dif_error *err);

/* An in-plane scan: one angle fixed, the other (signed, in the same plane) runs, for each wavelength. */
typedef struct dif_plan {
    bool fixed_is_wo;   /* false: wi is fixed and wo runs; true: the reverse      */
    double fixed_rad;   /* signed, |.| < pi/2                                      */
    double azimuth_rad; /* of the plane; positive angles lean towards it           */
    int n_angle;        /* >= 1 */
    int n_lambda;       /* >= 1 */
    double *angle_rad;  /* angle_rad[n_angle], |.| < pi/2, owned                   */
    double *lambda_um;  /* lambda_um[n_lambda], > 0, owned                         */
} dif_plan;

/* A table of values over a plan: value[i_lambda * n_angle + i_angle], NaN = not measured. */
typedef struct dif_table {
    dif_plan plan; /* owned */
    dif_quantity quantity;
    double *value; /* owned */
} dif_table;

/* Allocates the axes (zeroed). Status DIF_ERR_ARG, DIF_ERR_SIZE, DIF_ERR_NOMEM; *out zeroed on failure. */
DIF_MUST_USE dif_status dif_plan_create(int n_angle, int n_lambda, dif_plan *out, dif_error *err);
DIF_MUST_USE dif_status dif_plan_copy(const dif_plan *plan, dif_plan *out, dif_error *err);
void dif_plan_free(dif_plan *plan);

/* DIF_OK if every angle is inside (-90, 90) degrees and every wavelength positive and finite. */
DIF_MUST_USE dif_status dif_plan_check(const dif_plan *plan, dif_error *err);

/* A table of zeros over a copy of the plan. */
DIF_MUST_USE dif_status dif_table_create(const dif_plan *plan, dif_quantity quantity, dif_table *out, dif_error *err);
void dif_table_free(dif_table *table);

/* The directions of cell i_angle. */
void dif_plan_directions(const dif_plan *plan, int i_angle, dif_vec3 *wi, dif_vec3 *wo);

/* sin theta_i + sin theta_o (= -u along the azimuth) and -w = cos theta_i + cos theta_o of cell i_angle. */
void dif_plan_transfer(const dif_plan *plan, int i_angle, double *sin_sum, double *cos_sum);

#ifdef __cplusplus
}
#endif
#endif
