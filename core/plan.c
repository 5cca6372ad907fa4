#include "core/plan.h"

#include <math.h>
#include <string.h>

#include "core/alloc.h"
#include "core/units.h"

/* 2 GiB of cells: above this a request is a mistake, and memory would be promised that is not there. */
static const size_t TABLE_CELLS_MAX = (size_t)1 << 28;

static const struct {
    const char *name, *unit;
} QUANTITIES[] = {
    [DIF_QUANTITY_POWER] = {"power", "1"},
    [DIF_QUANTITY_RHO] = {"rho", "1"},
    [DIF_QUANTITY_BRDF] = {"brdf", "sr^-1"},
};
enum { N_QUANTITY = sizeof QUANTITIES / sizeof *QUANTITIES };

const char *dif_quantity_name(dif_quantity quantity)
{
    return QUANTITIES[quantity].name;
}

const char *dif_quantity_unit(dif_quantity quantity)
{
    return QUANTITIES[quantity].unit;
}

bool dif_quantity_from_name(const char *name, dif_quantity *out)
{
    for (int i = 0; i < N_QUANTITY; i++) {
        if (strcmp(name, QUANTITIES[i].name) == 0) {
            *out = (dif_quantity)i;
            return true;
        }
    }
    return false;
}

dif_status dif_query_check(size_t i, const dif_query *query, dif_error *err)
{
    const double norm_i = dif_vec3_dot(query->wi, query->wi), norm_o = dif_vec3_dot(query->wo, query->wo);
    if (!(query->lambda_um > 0.0 && query->lambda_um < 1e6))
        return dif_fail(err, DIF_ERR_ARG, "query %zu: wavelength %g um, want > 0", i + 1, query->lambda_um);
    if (!(fabs(norm_i - 1.0) < 1e-9 && fabs(norm_o - 1.0) < 1e-9))
        return dif_fail(err, DIF_ERR_ARG, "query %zu: directions are not unit vectors", i + 1);
    if (!(query->wi.z > 0.0 && query->wo.z > 0.0))
        return dif_fail(err, DIF_ERR_ARG, "query %zu: a direction is not above the surface", i + 1);
    return DIF_OK;
}

dif_status dif_plan_create(int n_angle, int n_lambda, dif_plan *out, dif_error *err)
{
    *out = (dif_plan){0};
    if (!(n_angle >= 1 && n_lambda >= 1))
        return dif_fail(err, DIF_ERR_ARG, "plan of %d angles and %d wavelengths, want at least 1 of each", n_angle,
                        n_lambda);
    if ((size_t)n_angle > TABLE_CELLS_MAX / (size_t)n_lambda)
        return dif_fail(err, DIF_ERR_SIZE, "plan of %d angles and %d wavelengths, want at most %zu cells", n_angle,
                        n_lambda, TABLE_CELLS_MAX);
    dif_plan plan = {.n_angle = n_angle, .n_lambda = n_lambda};
    plan.angle_rad = dif_alloc((size_t)n_angle, sizeof *plan.angle_rad);
    plan.lambda_um = dif_alloc((size_t)n_lambda, sizeof *plan.lambda_um);
    if (!plan.angle_rad || !plan.lambda_um) {
        dif_plan_free(&plan);
        return dif_fail(err, DIF_ERR_NOMEM, "plan of %d angles and %d wavelengths", n_angle, n_lambda);
    }
    *out = plan;
    return DIF_OK;
}

dif_status dif_plan_copy(const dif_plan *plan, dif_plan *out, dif_error *err)
{
    dif_plan copy;
    const dif_status status = dif_plan_create(plan->n_angle, plan->n_lambda, &copy, err);
    if (status) {
        *out = (dif_plan){0};
        return status;
    }
    copy.fixed_is_wo = plan->fixed_is_wo;
    copy.fixed_rad = plan->fixed_rad;
    copy.azimuth_rad = plan->azimuth_rad;
    memcpy(copy.angle_rad, plan->angle_rad, (size_t)plan->n_angle * sizeof *plan->angle_rad);
    memcpy(copy.lambda_um, plan->lambda_um, (size_t)plan->n_lambda * sizeof *plan->lambda_um);
    *out = copy;
    return DIF_OK;
}

void dif_plan_free(dif_plan *plan)
{
    if (!plan)
        return;
    dif_release(plan->angle_rad);
    dif_release(plan->lambda_um);
    *plan = (dif_plan){0};
}

/* 90 degrees as a user types it must be refused, although pi/2 rounds to just below it. */
static bool is_polar(double angle_rad)
{
    return fabs(angle_rad) < 0.5 * DIF_PI * (1.0 - 1e-12);
}

dif_status dif_plan_check(const dif_plan *plan, dif_error *err)
{
    if (!(plan->n_angle >= 1 && plan->n_lambda >= 1 && plan->angle_rad && plan->lambda_um))
        return dif_fail(err, DIF_ERR_ARG, "plan of %d angles and %d wavelengths, want at least 1 of each",
                        plan->n_angle, plan->n_lambda);
    if (!is_polar(plan->fixed_rad))
        return dif_fail(err, DIF_ERR_ARG, "fixed angle %.9g deg, want -90 < angle < 90",
                        dif_deg_from_rad(plan->fixed_rad));
    if (!isfinite(plan->azimuth_rad))
        return dif_fail(err, DIF_ERR_ARG, "azimuth %.9g deg, want a finite number",
                        dif_deg_from_rad(plan->azimuth_rad));
    for (int i = 0; i < plan->n_angle; i++) {
        if (!is_polar(plan->angle_rad[i]))
            return dif_fail(err, DIF_ERR_ARG, "angle %d is %.9g deg, want -90 < angle < 90", i,
                            dif_deg_from_rad(plan->angle_rad[i]));
    }
    for (int i = 0; i < plan->n_lambda; i++) {
        if (!(plan->lambda_um[i] > 0.0 && isfinite(plan->lambda_um[i])))
            return dif_fail(err, DIF_ERR_ARG, "wavelength %d is %.9g nm, want a finite number > 0", i,
                            dif_nm_from_um(plan->lambda_um[i]));
    }
    return DIF_OK;
}

dif_status dif_table_create(const dif_plan *plan, dif_quantity quantity, dif_table *out, dif_error *err)
{
    *out = (dif_table){0};
    dif_table table = {.quantity = quantity};
    const dif_status status = dif_plan_copy(plan, &table.plan, err);
    if (status)
        return status;
    table.value = dif_alloc((size_t)plan->n_angle * (size_t)plan->n_lambda, sizeof *table.value);
    if (!table.value) {
        dif_table_free(&table);
        return dif_fail(err, DIF_ERR_NOMEM, "table of %d angles and %d wavelengths", plan->n_angle, plan->n_lambda);
    }
    *out = table;
    return DIF_OK;
}

void dif_table_free(dif_table *table)
{
    if (!table)
        return;
    dif_plan_free(&table->plan);
    dif_release(table->value);
    *table = (dif_table){0};
}

void dif_plan_directions(const dif_plan *plan, int i_angle, dif_vec3 *wi, dif_vec3 *wo)
{
    const dif_vec3 fixed = dif_vec3_from_angles_rad(plan->fixed_rad, plan->azimuth_rad);
    const dif_vec3 running = dif_vec3_from_angles_rad(plan->angle_rad[i_angle], plan->azimuth_rad);
    *wi = plan->fixed_is_wo ? running : fixed;
    *wo = plan->fixed_is_wo ? fixed : running;
}

void dif_plan_transfer(const dif_plan *plan, int i_angle, double *sin_sum, double *cos_sum)
{
    const double angle_rad = plan->angle_rad[i_angle];
    *sin_sum = sin(plan->fixed_rad) + sin(angle_rad);
    *cos_sum = cos(plan->fixed_rad) + cos(angle_rad);
}
