/* The three calls of an evaluator, each cut into passes that fit the lists. */
#include <math.h>
#include <string.h>

#include "core/sheet_impl.h"
#include "core/units.h"
#include "gpu/gpu_eval_impl.h"

/* Groups of sheets: all at once, or as many as there are slots. */
static int group_step(const dif_gpu_eval *eval)
{
    return eval->has_sheets ? eval->n_slot : 1;
}

static int group_end(const dif_gpu_eval *eval)
{
    return eval->has_sheets ? eval->model->n_sheet : 1;
}

static dif_status load_group(dif_gpu_eval *eval, int first, dif_error *err)
{
    return eval->has_sheets ? dif_eval_sheets_load(eval, first, err) : DIF_OK;
}

static dif_status begin(dif_gpu_eval *eval, int job, dif_error *err)
{
    eval->cost = (dif_eval_cost){0};
    const dif_status status = dif_gpu_begin(eval->gpu, err);
    return status == DIF_OK ? dif_eval_program(eval, job, err) : status;
}

static dif_status end(const dif_gpu_eval *eval, dif_status status, dif_eval_cost *cost)
{
    if (cost)
        *cost = status == DIF_OK ? eval->cost : (dif_eval_cost){0};
    return status;
}

static dif_eval_reach reach_empty(void)
{
    const double inf = (double)INFINITY;
    return (dif_eval_reach){{inf, inf, inf}, {-inf, -inf, -inf}};
}

static void reach_add(dif_eval_reach *reach, double x, double y, double z, double k)
{
    const double at[3] = {k * x, k * y, k * z};
    for (int i = 0; i < 3; i++) {
        reach->min[i] = fmin(reach->min[i], at[i]);
        reach->max[i] = fmax(reach->max[i], at[i]);
    }
}

/* A direction at the shortest and the longest wavelength. */
static void reach_add_range(dif_eval_reach *reach, double x, double y, double z, double lambda_min_um,
                            double lambda_max_um)
{
    reach_add(reach, x, y, z, DIF_TWO_PI / lambda_min_um);
    reach_add(reach, x, y, z, DIF_TWO_PI / lambda_max_um);
}

/* ---- values ---- */

static dif_status check_values(const dif_gpu_eval *eval, size_t n, const dif_query *query, dif_error *err)
{
    const dif_model *model = eval->model;
    dif_eval_reach reach = reach_empty();
    if (model->kind == DIF_MODEL_LUT)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "a lut has colours, no values at a wavelength");
    if (eval->is_line)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "line sheets serve tables only");
    for (size_t i = 0; i < n; i++) {
        const dif_status status = dif_query_check(i, query + i, err);
        if (status != DIF_OK)
            return status;
        const dif_vec3 uvw = dif_vec3_transfer(query[i].wi, query[i].wo);
        double at_um = query[i].lambda_um;
        if (model->kind == DIF_MODEL_NMM)
            at_um = dif_nmm_nearest_um(&model->nmm, hypot(uvw.x, uvw.y), at_um);
        reach_add(&reach, uvw.x, uvw.y, -uvw.z, DIF_TWO_PI / at_um);
    }
    return n > 0 ? dif_eval_sheets_cover(eval, &reach, err) : DIF_OK;
}

static dif_status pass_values(dif_gpu_eval *eval, int first, size_t n, const dif_query *query, double *value,
                              dif_error *err)
{
    enum { SIDE = 128 }; /* SIDE * SIDE * 4 = DIF_EVAL_ITEMS */
    const dif_eval_pass ps = {
        .job = DIF_JOB_IS_VALUES, .n = (int)n, .nx = SIDE, .ny = ((int)n + 4 * SIDE - 1) / (4 * SIDE), .n_lambda = 1};
    for (size_t i = 0; i < n; i++)
        dif_eval_put_query(eval, i, query + i);
    dif_eval_list_upload(eval, &eval->directions, n * DIF_DIR_STRIDE, eval->pairs);
    const dif_status status = dif_eval_run_pass(eval, &ps, first, err);
    for (size_t i = 0; i < n && status == DIF_OK; i++)
        value[i] += (double)eval->texels[i];
    return status;
}

dif_status dif_eval_values(void *self, size_t n, const dif_query *query, double *value, dif_eval_cost *cost,
                           dif_error *err)
{
    dif_gpu_eval *eval = self;
    dif_status status = check_values(eval, n, query, err);
    if (status == DIF_OK)
        status = begin(eval, DIF_JOB_IS_VALUES, err);
    if (status == DIF_OK)
        memset(value, 0, n * sizeof *value);
    for (int first = 0; first < group_end(eval) && status == DIF_OK; first += group_step(eval)) {
        status = load_group(eval, first, err);
        for (size_t i = 0; i < n && status == DIF_OK; i += DIF_EVAL_ITEMS)
            status =
                pass_values(eval, first, n - i < DIF_EVAL_ITEMS ? n - i : DIF_EVAL_ITEMS, query + i, value + i, err);
    }
    return end(eval, status, cost);
}

/* ---- tables ---- */

static dif_status check_table(const dif_gpu_eval *eval, const dif_plan *plan, dif_error *err)
{
    const dif_model *model = eval->model;
    dif_eval_reach reach = reach_empty();
    const dif_status status = dif_plan_check(plan, err);
    if (status != DIF_OK)
        return status;
    if (model->kind == DIF_MODEL_LUT)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "a lut has colours, no table over wavelengths");
    if (eval->is_line) {
        const double azimuth_rad = model->sheet[0]->info.azimuth_rad;
        if (fabs(azimuth_rad - plan->azimuth_rad) > 1e-12)
            return dif_fail(err, DIF_ERR_UNSUPPORTED, "a table at azimuth %.9g deg, the model's sheets are at %.9g deg",
                            dif_deg_from_rad(plan->azimuth_rad), dif_deg_from_rad(azimuth_rad));
    }
    double least_um = (double)INFINITY, most_um = 0.0;
    for (int i = 0; i < plan->n_lambda; i++) {
        least_um = fmin(least_um, plan->lambda_um[i]);
        most_um = fmax(most_um, plan->lambda_um[i]);
    }
    if (model->kind == DIF_MODEL_NMM) {
        least_um = model->nmm.lambda_min_um;
        most_um = model->nmm.lambda_max_um;
    }
    for (int i = 0; i < plan->n_angle; i++) {
        double sin_sum, cos_sum;
        dif_plan_transfer(plan, i, &sin_sum, &cos_sum);
        const double c = eval->is_line ? 1.0 : cos(plan->azimuth_rad), s = eval->is_line ? 0.0 : sin(plan->azimuth_rad);
        reach_add_range(&reach, -sin_sum * c, -sin_sum * s, cos_sum, least_um, most_um);
    }
    return dif_eval_sheets_cover(eval, &reach, err);
}

/* Angles first_angle ... and wavelengths first_lambda ... of a plan. */
static dif_status pass_table(dif_gpu_eval *eval, int first, const dif_plan *plan, int angle, int lambda, double *value,
                             dif_error *err)
{
    const int n_angle = plan->n_angle - angle < DIF_EVAL_ANGLES ? plan->n_angle - angle : DIF_EVAL_ANGLES;
    const int n_lambda = plan->n_lambda - lambda < DIF_EVAL_WAVES ? plan->n_lambda - lambda : DIF_EVAL_WAVES;
    const dif_eval_pass ps = {.job = DIF_JOB_IS_TABLE,
                              .n = n_angle,
                              .nx = (n_angle + 3) / 4,
                              .ny = n_lambda,
                              .n_lambda = n_lambda,
                              .lambda_um = plan->lambda_um + lambda};
    for (int i = 0; i < n_angle; i++) {
        dif_vec3 wi, wo;
        dif_plan_directions(plan, angle + i, &wi, &wo);
        dif_eval_put_direction(eval, (size_t)i, wi, wo, plan->azimuth_rad);
    }
    dif_eval_list_upload(eval, &eval->directions, (size_t)n_angle * DIF_DIR_STRIDE, eval->pairs);
    if (eval->model->kind == DIF_MODEL_NMM)
        dif_eval_asks_of(eval, n_lambda, ps.lambda_um);
    const dif_status status = dif_eval_run_pass(eval, &ps, first, err);
    for (int il = 0; il < n_lambda && status == DIF_OK; il++) {
        double *row = value + (size_t)(lambda + il) * (size_t)plan->n_angle + (size_t)angle;
        const float *from = eval->texels + (size_t)il * (size_t)ps.nx * 4;
        for (int i = 0; i < n_angle; i++)
            row[i] += (double)from[i];
    }
    return status;
}

dif_status dif_eval_table(void *self, const dif_plan *plan, double *value, dif_eval_cost *cost, dif_error *err)
{
    dif_gpu_eval *eval = self;
    dif_status status = check_table(eval, plan, err);
    if (status == DIF_OK)
        status = begin(eval, DIF_JOB_IS_TABLE, err);
    if (status == DIF_OK)
        memset(value, 0, (size_t)plan->n_angle * (size_t)plan->n_lambda * sizeof *value);
    for (int first = 0; first < group_end(eval) && status == DIF_OK; first += group_step(eval)) {
        status = load_group(eval, first, err);
        for (int lambda = 0; lambda < plan->n_lambda; lambda += DIF_EVAL_WAVES)
            for (int angle = 0; angle < plan->n_angle && status == DIF_OK; angle += DIF_EVAL_ANGLES)
                status = pass_table(eval, first, plan, angle, lambda, value, err);
    }
    return end(eval, status, cost);
}

/* ---- colours ---- */

static dif_status check_colours(const dif_gpu_eval *eval, size_t n, const dif_vec3 *wi, const dif_vec3 *wo,
                                dif_error *err)
{
    const dif_model *model = eval->model;
    const bool few = model->kind == DIF_MODEL_NMM, lut = model->kind == DIF_MODEL_LUT;
    dif_eval_reach reach = reach_empty();
    if (model->quantity == DIF_QUANTITY_BRDF)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "colours of the BRDF, want those of power or rho");
    if (eval->is_line)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "line sheets serve tables only");
    if (!lut && !few && model->n_lambda < 1)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "colours of a model without wavelengths");
    for (size_t i = 0; i < n; i++) {
        const dif_query pair = {wi[i], wo[i], 1.0};
        const dif_status status = dif_query_check(i, &pair, err);
        if (status != DIF_OK)
            return status;
        const dif_vec3 uvw = dif_vec3_transfer(wi[i], wo[i]);
        if (eval->has_sheets)
            reach_add_range(&reach, uvw.x, uvw.y, -uvw.z, few ? model->nmm.lambda_min_um : model->lambda_um[0],
                            few ? model->nmm.lambda_max_um : model->lambda_um[model->n_lambda - 1]);
    }
    return n > 0 ? dif_eval_sheets_cover(eval, &reach, err) : DIF_OK;
}

static dif_status pass_colours(dif_gpu_eval *eval, int first, size_t n, const dif_vec3 *wi, const dif_vec3 *wo,
                               double (*xyz)[3], dif_error *err)
{
    enum { SIDE = 256 }; /* SIDE * SIDE = DIF_EVAL_ITEMS */
    const dif_eval_pass ps = {.job = DIF_JOB_IS_COLOURS,
                              .n = (int)n,
                              .nx = SIDE,
                              .ny = ((int)n + SIDE - 1) / SIDE,
                              .n_lambda = eval->model->n_lambda,
                              .lambda_um = eval->model->lambda_um};
    for (size_t i = 0; i < n; i++)
        dif_eval_put_direction(eval, i, wi[i], wo[i], 0.0);
    dif_eval_list_upload(eval, &eval->directions, n * DIF_DIR_STRIDE, eval->pairs);
    const dif_status status = dif_eval_run_pass(eval, &ps, first, err);
    for (size_t i = 0; i < n && status == DIF_OK; i++)
        for (size_t c = 0; c < 3; c++)
            xyz[i][c] += (double)eval->texels[4 * i + c];
    return status;
}

dif_status dif_eval_colours(void *self, size_t n, const dif_vec3 *wi, const dif_vec3 *wo, double (*xyz)[3],
                            dif_eval_cost *cost, dif_error *err)
{
    dif_gpu_eval *eval = self;
    dif_status status = check_colours(eval, n, wi, wo, err);
    if (status == DIF_OK)
        status = begin(eval, DIF_JOB_IS_COLOURS, err);
    if (status == DIF_OK)
        memset(xyz, 0, n * sizeof *xyz);
    for (int first = 0; first < group_end(eval) && status == DIF_OK; first += group_step(eval)) {
        status = load_group(eval, first, err);
        for (size_t i = 0; i < n && status == DIF_OK; i += DIF_EVAL_ITEMS)
            status = pass_colours(eval, first, n - i < DIF_EVAL_ITEMS ? n - i : DIF_EVAL_ITEMS, wi + i, wo + i, xyz + i,
                                  err);
    }
    return end(eval, status, cost);
}
