/* The evaluator: a call is cut into passes that fit the lists, each pass run once a sheet. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/sheet_impl.h"
#include "core/units.h"
#include "gpu/gpu_eval_impl.h"

_Static_assert(sizeof(dif_eval_block) == 9 * 16, "std140: nine vectors");
_Static_assert(offsetof(dif_eval_block, job) == 48 && offsetof(dif_eval_block, gain) == 96, "std140");
_Static_assert(sizeof(dif_eval_lut_block) == 3 * 16 && offsetof(dif_eval_lut_block, job) == 32, "std140");

dif_gpu_eval_opts dif_gpu_eval_opts_default(void)
{
    return (dif_gpu_eval_opts){
        .path = DIF_GPU_COMPUTE, .fault = DIF_GPU_FAULT_NONE, .half = false, .budget_bytes = (size_t)1 << 30};
}

/* One pass: what the shader counts, and how big its result is. */
typedef struct pass {
    int job;
    int n;        /* items: queries, angles or directions                                  */
    int nx, ny;   /* texels                                                                */
    int n_lambda; /* table: wavelengths of this pass; colours by full sampling: all        */
    const double *lambda_um;
} pass;

/* Moves the waves to a sheet's axes, unless they are there already. */
static void set_waves(dif_gpu_eval *eval, const pass *ps, const dif_sheet *sheet, const dif_sheet *last)
{
    const bool same = last && sheet && !(fabs(last->s.step - sheet->s.step) > 0.0) &&
                      !(fabs(last->y.step - sheet->y.step) > 0.0) && !(fabs(last->z.step - sheet->z.step) > 0.0);
    if (same)
        return;
    if (ps->job == DIF_JOB_IS_VALUES)
        dif_eval_waves_of_values(eval, sheet);
    else if (eval->model->kind == DIF_MODEL_NMM)
        dif_eval_waves_of_few(eval, sheet);
    else
        dif_eval_waves_of(eval, sheet, ps->n_lambda, ps->lambda_um,
                          ps->job == DIF_JOB_IS_COLOURS ? eval->weight : NULL);
}

static void set_axis(const dif_axis *axis, int out[4])
{
    out[0] = axis->first;
    out[1] = axis->n;
    out[2] = axis->period;
    out[3] = 0;
}

static void set_params(dif_gpu_eval *eval, const pass *ps, const dif_sheet *sheet, double share, bool add)
{
    const dif_model *model = eval->model;
    dif_eval_block *p = &eval->params;
    *p = (dif_eval_block){
        .job = {ps->n, ps->n_lambda, add, 0},
        .gain = {(float)share, (float)model->index.n, (float)model->index.kappa, (float)model->area_um2}};
    if (sheet) {
        set_axis(&sheet->s, p->axis_s);
        set_axis(&sheet->y, p->axis_y);
        set_axis(&sheet->z, p->axis_z);
    }
    if (model->kind == DIF_MODEL_PQ) {
        p->copies[0] = model->replica.nx;
        p->copies[1] = model->replica.ny;
    }
    if (model->kind == DIF_MODEL_STAM) {
        const bool across = !isnan(model->stam.period_across_um);
        const double a = DIF_TWO_PI * model->stam.sigma_um / model->stam.period_um;
        const double b = DIF_TWO_PI * model->stam.sigma_um / (across ? model->stam.period_across_um : 1.0);
        p->copies[0] = across;
        p->more[0] = (float)(a * a);
        p->more[1] = (float)(b * b);
    }
    if (model->kind == DIF_MODEL_NMM) {
        const dif_nmm *nmm = &model->nmm;
        const double step = nmm->line_area_per_um > 0.0 ? nmm->line_area_per_um : 1.0 / nmm->extent_um;
        p->few[0] = nmm->n_fixed;
        p->few[1] = 1;
        p->few[2] = nmm->jacobian;
        p->more[0] = (float)(nmm->lambda_max_um - nmm->lambda_min_um);
        p->more[1] = (float)(step * nmm->extent_um);
        for (int c = 0; c < 3; c++)
            p->scale[c] = (float)eval->scale[c];
    }
}

/* Runs a pass over the sheets in the slots, first ... first + n_slot - 1 of the model; the sum comes back in `texels`. */
static dif_status run_pass(dif_gpu_eval *eval, const pass *ps, int first, dif_error *err)
{
    const dif_model *model = eval->model;
    const int left = eval->has_sheets ? model->n_sheet - first : 1;
    const int n = eval->has_sheets && eval->n_slot < left ? eval->n_slot : left;
    const dif_sheet *last = NULL;
    dif_status status = DIF_OK;
    for (int i = 0; i < n && status == DIF_OK; i++) {
        const dif_sheet *sheet = eval->has_sheets ? model->sheet[first + i] : NULL;
        if (model->kind == DIF_MODEL_LUT) {
            eval->lut_params.job[0] = ps->n;
        } else {
            set_waves(eval, ps, sheet, last);
            set_params(eval, ps, sheet, sheet ? model->share[first + i] : 1.0, i > 0);
        }
        if (sheet)
            dif_gl_texture_bind(eval->slot + i, 0);
        last = sheet;
        status = dif_eval_dispatch(eval, ps->job, ps->nx, ps->ny, i % 2, err);
    }
    return status == DIF_OK ? dif_eval_fetch(eval, ps->nx, ps->ny, (n - 1) % 2, err) : status;
}

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
    const pass ps = {
        .job = DIF_JOB_IS_VALUES, .n = (int)n, .nx = SIDE, .ny = ((int)n + 4 * SIDE - 1) / (4 * SIDE), .n_lambda = 1};
    for (size_t i = 0; i < n; i++)
        dif_eval_put_query(eval, i, query + i);
    dif_eval_list_upload(eval, &eval->directions, n * DIF_DIR_STRIDE, eval->pairs);
    const dif_status status = run_pass(eval, &ps, first, err);
    for (size_t i = 0; i < n && status == DIF_OK; i++)
        value[i] += (double)eval->texels[i];
    return status;
}

static dif_status gpu_values(void *self, size_t n, const dif_query *query, double *value, dif_eval_cost *cost,
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
    const pass ps = {.job = DIF_JOB_IS_TABLE,
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
    const dif_status status = run_pass(eval, &ps, first, err);
    for (int il = 0; il < n_lambda && status == DIF_OK; il++) {
        double *row = value + (size_t)(lambda + il) * (size_t)plan->n_angle + (size_t)angle;
        const float *from = eval->texels + (size_t)il * (size_t)ps.nx * 4;
        for (int i = 0; i < n_angle; i++)
            row[i] += (double)from[i];
    }
    return status;
}

static dif_status gpu_table(void *self, const dif_plan *plan, double *value, dif_eval_cost *cost, dif_error *err)
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
    const pass ps = {.job = DIF_JOB_IS_COLOURS,
                     .n = (int)n,
                     .nx = SIDE,
                     .ny = ((int)n + SIDE - 1) / SIDE,
                     .n_lambda = eval->model->n_lambda,
                     .lambda_um = eval->model->lambda_um};
    for (size_t i = 0; i < n; i++)
        dif_eval_put_direction(eval, i, wi[i], wo[i], 0.0);
    dif_eval_list_upload(eval, &eval->directions, n * DIF_DIR_STRIDE, eval->pairs);
    const dif_status status = run_pass(eval, &ps, first, err);
    for (size_t i = 0; i < n && status == DIF_OK; i++)
        for (size_t c = 0; c < 3; c++)
            xyz[i][c] += (double)eval->texels[4 * i + c];
    return status;
}

static dif_status gpu_colours(void *self, size_t n, const dif_vec3 *wi, const dif_vec3 *wo, double (*xyz)[3],
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

/* ---- life ---- */

static void gpu_close(void *self)
{
    dif_gpu_eval *eval = self;
    if (!eval)
        return;
    if (dif_gpu_begin(eval->gpu, NULL) == DIF_OK) {
        dif_gl_texture *const textures[] = {&eval->directions, &eval->waves, &eval->asked,    &eval->spectrum,
                                            &eval->maps,       eval->result, eval->result + 1};
        for (int i = 0; i < (int)(sizeof textures / sizeof *textures); i++)
            dif_gl_texture_delete(eval->gpu, textures[i]);
        for (int i = 0; i < eval->n_slot; i++)
            dif_gl_texture_delete(eval->gpu, eval->slot + i);
        for (int i = 0; i < DIF_EVAL_JOBS; i++)
            dif_gl_program_delete(eval->gpu, eval->program + i);
        dif_gl_block_delete(eval->gpu, &eval->block);
        if (eval->timer)
            glDeleteQueries(1, &eval->timer);
    }
    void *const blocks[] = {eval->source, eval->slot,    eval->pairs,  eval->wave_pairs, eval->ask_pairs,
                            eval->texels, eval->staging, eval->weight, eval->few_um,     eval->few_weight};
    for (int i = 0; i < (int)(sizeof blocks / sizeof *blocks); i++)
        dif_release(blocks[i]);
    dif_release(eval);
}

static dif_status create_results(dif_gpu_eval *eval, dif_error *err)
{
    const dif_gl_texture wanted = {.target = GL_TEXTURE_2D,
                                   .format = GL_RGBA32F,
                                   .nx = DIF_EVAL_SIDE,
                                   .ny = DIF_EVAL_SIDE,
                                   .n_layer = 1,
                                   .n_level = 1};
    dif_status status = DIF_OK;
    for (int i = 0; i < 2 && status == DIF_OK; i++)
        status = dif_gl_texture_create(eval->gpu, "results", &wanted, eval->result + i, err);
    eval->texels = dif_alloc((size_t)DIF_EVAL_SIDE * DIF_EVAL_SIDE * 4, sizeof *eval->texels);
    eval->source = dif_alloc(1, sizeof *eval->source);
    if (status == DIF_OK && (!eval->texels || !eval->source))
        status = dif_fail(err, DIF_ERR_NOMEM, "no memory for results");
    return status;
}

static dif_status create(dif_gpu_eval *eval, dif_error *err)
{
    const dif_model *model = eval->model;
    dif_status status = dif_gpu_begin(eval->gpu, err);
    if (status == DIF_OK)
        status = create_results(eval, err);
    if (status == DIF_OK)
        status = dif_eval_lists_create(eval, err);
    if (status == DIF_OK && eval->has_sheets)
        status = dif_eval_sheets_create(eval, err);
    if (status == DIF_OK && model->kind == DIF_MODEL_LUT) {
        status = dif_lut_texture_create(eval->gpu, model->lut, eval->opts.half, &eval->maps, eval->lut_params.shape,
                                        eval->lut_params.more, err);
        eval->lut_params.more[2] = (float)model->index.n;
        eval->lut_params.more[3] = (float)model->index.kappa;
    }
    if (status != DIF_OK)
        return status;
    eval->block = dif_gl_block_create(eval->gpu, sizeof eval->params);
    if (eval->gpu->info.timer && !eval->gpu->info.software) /* llvmpipe's leave compute shaders out */
        glGenQueries(1, &eval->timer);
    return dif_gpu_check(eval->gpu, "making an evaluator", err);
}

static dif_status check_opts(const dif_gpu_eval_opts *opts, dif_error *err)
{
    if (!(opts->path == DIF_GPU_COMPUTE || opts->path == DIF_GPU_FRAGMENT))
        return dif_fail(err, DIF_ERR_ARG, "path %d is none", (int)opts->path);
    if (!((int)opts->fault >= DIF_GPU_FAULT_NONE && opts->fault <= DIF_GPU_FAULT_TAP))
        return dif_fail(err, DIF_ERR_ARG, "fault %d is none", (int)opts->fault);
    return DIF_OK;
}

dif_status dif_gpu_evaluator_open(dif_gpu *gpu, const dif_model *model, const dif_gpu_eval_opts *opts,
                                  dif_evaluator *out, dif_error *err)
{
    const dif_gpu_eval_opts defaults = dif_gpu_eval_opts_default();
    *out = (dif_evaluator){0};
    dif_status status = dif_model_check(model, err);
    if (status == DIF_OK && opts)
        status = check_opts(opts, err);
    if (status != DIF_OK)
        return status;
    dif_gpu_eval *eval = dif_alloc(1, sizeof *eval);
    if (!eval)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for an evaluator");
    eval->gpu = gpu;
    eval->model = model;
    eval->opts = opts ? *opts : defaults;
    eval->has_sheets = model->kind != DIF_MODEL_STAM && model->kind != DIF_MODEL_LUT;
    eval->is_line = eval->has_sheets && model->sheet[0]->is_line;
    snprintf(eval->name, sizeof eval->name, "%s, %s", gpu->info.renderer,
             eval->opts.path == DIF_GPU_COMPUTE ? "compute" : "fragment");
    status = create(eval, err);
    if (status != DIF_OK) {
        gpu_close(eval);
        return status;
    }
    *out = (dif_evaluator){eval->name, eval, gpu_values, gpu_table, gpu_colours, gpu_close};
    return DIF_OK;
}
