#include "bench/regress_run.h"

#include <math.h>
#include <string.h>

#include "bench/map.h"
#include "bench/measure_impl.h"
#include "bench/model_build.h"
#include "bench/regress_impl.h"
#include "core/alloc.h"

static const dif_model_kind KINDS[DIF_REGRESS_METHODS] = {DIF_MODEL_SHEET, DIF_MODEL_NMM, DIF_MODEL_NMM,
                                                          DIF_MODEL_PQ,    DIF_MODEL_LUT, DIF_MODEL_STAM};
static const double REPEAT_MAX_S = 5.0; /* a first call that took longer is the timed one, too */

/* One run. */
typedef struct job {
    const dif_field *field;
    const dif_regress_plan *plan;
    dif_measure_opts opts;
    const dif_regress_device *device;
    const dif_regress_listener *listener;
    size_t n_direction;                            /* pixels inside the disc                      */
    dif_vec3 *wi, *wo;                             /* wi[n_direction], wo[n_direction]            */
    size_t *pixel;                                 /* pixel[n_direction]                          */
    dif_query *query;                              /* query[n_layer][n_direction]                 */
    double *compact;                               /* room for 3 or n_layer numbers a direction   */
    dif_model_built device_sheet, reference_sheet; /* volumes, shared by sheet, nmm and the full sampling */
    double build_device_s, build_reference_s;
} job;

/* What both sides read for one question. */
typedef struct pair {
    dif_model device, reference;
    double bound_device, bound_reference, build_device_s, build_reference_s;
} pair;

static size_t pixels(const job *j)
{
    return (size_t)j->plan->n_pixel * (size_t)j->plan->n_pixel;
}

static size_t numbers_of(const job *j, dif_regress_question question)
{
    if (question == DIF_REGRESS_TABLE)
        return (size_t)j->plan->table->n_angle * (size_t)j->plan->table->n_lambda;
    return pixels(j) * (question == DIF_REGRESS_MAP ? (size_t)j->plan->n_layer : 3);
}

static dif_status fill_directions(job *j, dif_error *err)
{
    const dif_regress_plan *plan = j->plan;
    const size_t n = pixels(j), n_layer = (size_t)plan->n_layer;
    j->wi = dif_alloc(n, sizeof *j->wi);
    j->wo = dif_alloc(n, sizeof *j->wo);
    j->pixel = dif_alloc(n, sizeof *j->pixel);
    j->query = dif_alloc(n * n_layer, sizeof *j->query);
    j->compact = dif_alloc(n * (n_layer > 3 ? n_layer : 3), sizeof *j->compact);
    if (!j->wi || !j->wo || !j->pixel || !j->query || !j->compact)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for maps of %d pixels across", plan->n_pixel);
    for (size_t i = 0; i < n; i++) {
        dif_vec3 wo;
        const int ix = (int)(i % (size_t)plan->n_pixel), iy = (int)(i / (size_t)plan->n_pixel);
        if (!dif_map_direction(plan->n_pixel, ix, iy, &wo))
            continue;
        j->wi[j->n_direction] = plan->wi;
        j->wo[j->n_direction] = wo;
        j->pixel[j->n_direction++] = i;
    }
    for (size_t il = 0; il < n_layer; il++)
        for (size_t i = 0; i < j->n_direction; i++)
            j->query[il * j->n_direction + i] = (dif_query){plan->wi, j->wo[i], plan->layer_um[il]};
    return DIF_OK;
}

/* Asks an evaluator; the answer as a listener gets it. */
static dif_status ask(const job *j, dif_regress_question question, const dif_evaluator *evaluator, double *out,
                      dif_eval_cost *cost, dif_error *err)
{
    const size_t n = j->n_direction, n_all = numbers_of(j, question), n_layer = (size_t)j->plan->n_layer;
    dif_status status;
    if (question == DIF_REGRESS_TABLE)
        return evaluator->table(evaluator->self, j->plan->table, out, cost, err);
    for (size_t i = 0; i < n_all; i++)
        out[i] = (double)NAN;
    if (question == DIF_REGRESS_MAP) {
        status = evaluator->values(evaluator->self, n * n_layer, j->query, j->compact, cost, err);
        for (size_t i = 0; i < n * n_layer && status == DIF_OK; i++)
            out[i / n * pixels(j) + j->pixel[i % n]] = j->compact[i];
        return status;
    }
    status = evaluator->colours(evaluator->self, n, j->wi, j->wo, (double(*)[3])j->compact, cost, err);
    for (size_t i = 0; i < 3 * n && status == DIF_OK; i++)
        out[3 * j->pixel[i / 3] + i % 3] = j->compact[i];
    return status;
}

static double since(dif_stopwatch *watch)
{
    double wall_s = 0.0, cpu_s = 0.0;
    dif_stopwatch_lap(watch, &wall_s, &cpu_s);
    return wall_s;
}

/* One path's answer, asked twice: the first call makes shaders and moves the model. */
static dif_status ask_device(const job *j, int path, const pair *models, double *out, dif_regress_case *result,
                             dif_error *err)
{
    dif_evaluator device;
    dif_stopwatch watch = dif_stopwatch_start();
    dif_status status = j->device->open(j->device->self, path, &models->device, &device, err);
    if (status != DIF_OK)
        return status;
    status = ask(j, result->question, &device, out, &result->device, err);
    result->first_device_s = result->wall_device_s = since(&watch);
    if (status == DIF_OK && result->first_device_s < REPEAT_MAX_S) {
        status = ask(j, result->question, &device, out, &result->device, err);
        result->wall_device_s = since(&watch);
    }
    dif_evaluator_close(&device);
    return status;
}

/* One path of the device against the reference's answer; what all paths share is in *shared, to which the reference's
 * fit is added. */
static dif_status run_path(const job *j, int path, const pair *models, double *device, double *reference,
                           dif_regress_case *shared, dif_error *err)
{
    dif_error why = {DIF_OK, ""};
    dif_regress_case result = *shared;
    result.path = j->device->path[path];
    result.status = ask_device(j, path, models, device, &result, &why);
    if (result.status == DIF_ERR_NOMEM)
        return dif_fail(err, DIF_ERR_NOMEM, "%s", why.text);
    const bool good = result.status == DIF_OK;
    dif_status status = DIF_OK;
    if (good)
        status = dif_regress_judge(j->field, j->plan, &j->opts, device, reference, &result, err);
    else
        memcpy(result.text, why.text, sizeof why.text);
    shared->fit = good ? result.fit : shared->fit;
    if (shared->fit.reference == DIF_OK)
        shared->fit.text[0] = '\0'; /* of the device alone */
    return status == DIF_OK ? j->listener->done(j->listener->self, j->plan, &result, good ? device : NULL,
                                                good ? reference : NULL, err)
                            : status;
}

static dif_status run_question(const job *j, dif_regress_question question, int method, const pair *models,
                               dif_error *err)
{
    const size_t n = numbers_of(j, question);
    dif_regress_case result = {.question = question,
                               .method = method,
                               .bound_device = models->bound_device,
                               .bound_reference = models->bound_reference,
                               .build_device_s = models->build_device_s,
                               .build_reference_s = models->build_reference_s,
                               .n_sample = question == DIF_REGRESS_TABLE ? n
                                           : question == DIF_REGRESS_MAP ? j->n_direction * (size_t)j->plan->n_layer
                                                                         : j->n_direction};
    dif_evaluator cpu = {0};
    double *device = dif_alloc(n, sizeof *device), *reference = dif_alloc(n, sizeof *reference);
    dif_status status = device && reference ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu numbers", n);
    if (j->listener->begins)
        j->listener->begins(j->listener->self, dif_regress_method_name(method), dif_regress_question_name(question));
    dif_stopwatch watch = dif_stopwatch_start();
    if (status == DIF_OK)
        status = dif_cpu_evaluator_open(&models->reference, &cpu, err);
    if (status == DIF_OK)
        status = ask(j, question, &cpu, reference, NULL, err);
    result.wall_reference_s = since(&watch);
    dif_evaluator_close(&cpu);
    for (int path = 0; path < j->device->n_path && status == DIF_OK; path++)
        status = run_path(j, path, models, device, reference, &result, err);
    dif_release(device);
    dif_release(reference);
    return status;
}

static bool wanted(const job *j, int method)
{
    const bool periodic = method == DIF_REGRESS_NMM_LINES || method == DIF_REGRESS_PQ;
    const bool needs = periodic || method == DIF_REGRESS_STAM;
    return j->plan->method[method] && (!periodic || j->plan->has_period) && (!needs || !isnan(j->opts.period_um));
}

static dif_status run_table(job *j, int method, dif_error *err)
{
    const dif_regress_plan *plan = j->plan;
    dif_model_built device = {0}, reference = {0};
    dif_measure_opts opts = j->opts;
    opts.quantity = DIF_QUANTITY_POWER;
    opts.nmm_lines = method == DIF_REGRESS_NMM_LINES;
    dif_stopwatch watch = dif_stopwatch_start();
    pair models = {0};
    dif_status status =
        dif_model_build_table(j->field, KINDS[method], plan->table, plan->tol_reference, &opts, &reference, err);
    models.build_reference_s = since(&watch);
    if (status == DIF_OK)
        status = dif_model_build_table(j->field, KINDS[method], plan->table, plan->tol_device, &opts, &device, err);
    models.build_device_s = since(&watch);
    if (status == DIF_OK) {
        models.device = device.model;
        models.reference = reference.model;
        models.bound_device = device.bound;
        models.bound_reference = reference.bound;
        status = run_question(j, DIF_REGRESS_TABLE, method, &models, err);
    }
    dif_model_built_free(&device);
    dif_model_built_free(&reference);
    return status;
}

/* A volume for all wavelengths that any question or method asks for. */
static dif_status build_volume(const job *j, dif_model_kind kind, double tol, dif_model_built *out, double *wall_s,
                               dif_error *err)
{
    const dif_regress_plan *plan = j->plan;
    const dif_model_reach reach = dif_model_reach_of_fixed(plan->wi);
    const dif_nmm nmm = dif_method_nmm(j->field, &j->opts, fmin(plan->layer_um[0], plan->full_um[0]),
                                       fmax(plan->layer_um[plan->n_layer - 1], plan->full_um[plan->n_full - 1]));
    const double ends_um[2] = {fmin(nmm.lambda_min_um, plan->lambda_um[0]),
                               fmax(nmm.lambda_max_um, plan->lambda_um[plan->n_lambda - 1])};
    dif_stopwatch watch = dif_stopwatch_start();
    const dif_status status = dif_model_build_volume(j->field, kind, 2, ends_um, &reach, tol, &j->opts, NULL, out, err);
    *wall_s = since(&watch);
    if (status == DIF_OK) {
        out->model.n_lambda = plan->n_lambda;
        out->model.lambda_um = plan->lambda_um;
    }
    return status;
}

/* The volumes that sheet, nmm and full sampling share. */
static dif_status build_sheets(job *j, dif_error *err)
{
    if (j->reference_sheet.own)
        return DIF_OK;
    const dif_status status =
        build_volume(j, DIF_MODEL_SHEET, j->plan->tol_reference, &j->reference_sheet, &j->build_reference_s, err);
    if (status != DIF_OK)
        return status;
    return build_volume(j, DIF_MODEL_SHEET, j->plan->tol_device, &j->device_sheet, &j->build_device_s, err);
}

/* Maps are asked for the power, colours for rho. */
static dif_status run_directions(job *j, int method, pair *models, dif_error *err)
{
    dif_status status = DIF_OK;
    models->device.quantity = models->reference.quantity = DIF_QUANTITY_POWER;
    if (method != DIF_REGRESS_LUT)
        status = run_question(j, DIF_REGRESS_MAP, method, models, err);
    models->device.quantity = models->reference.quantity = DIF_QUANTITY_RHO;
    return status == DIF_OK ? run_question(j, DIF_REGRESS_COLOUR, method, models, err) : status;
}

/* sheet, nmm and nmm-lines read the same volumes. */
static dif_status run_by_sheets(job *j, int method, dif_error *err)
{
    dif_measure_opts opts = j->opts;
    const dif_status status = build_sheets(j, err);
    if (status != DIF_OK)
        return status;
    opts.method = KINDS[method] == DIF_MODEL_NMM ? DIF_METHOD_NMM : DIF_METHOD_SHEET;
    opts.nmm_lines = method == DIF_REGRESS_NMM_LINES;
    pair models = {.device = j->device_sheet.model,
                   .reference = j->reference_sheet.model,
                   .bound_device = j->device_sheet.bound,
                   .bound_reference = j->reference_sheet.bound,
                   .build_device_s = j->build_device_s,
                   .build_reference_s = j->build_reference_s};
    models.device.kind = models.reference.kind = KINDS[method];
    models.device.nmm = models.reference.nmm =
        dif_method_nmm(j->field, &opts, j->plan->layer_um[0], j->plan->layer_um[j->plan->n_layer - 1]);
    return run_directions(j, method, &models, err);
}

static dif_status run_by_copies(job *j, int method, dif_error *err)
{
    dif_model_built device = {0}, reference = {0};
    pair models = {0};
    dif_status status =
        build_volume(j, KINDS[method], j->plan->tol_reference, &reference, &models.build_reference_s, err);
    if (status == DIF_OK)
        status = build_volume(j, KINDS[method], j->plan->tol_device, &device, &models.build_device_s, err);
    if (status == DIF_OK) {
        models.device = device.model;
        models.reference = reference.model;
        models.bound_device = device.bound;
        models.bound_reference = reference.bound;
        status = run_directions(j, method, &models, err);
    }
    dif_model_built_free(&device);
    dif_model_built_free(&reference);
    return status;
}

/* The table against itself on the reference, and against full sampling. */
static dif_status run_lut(job *j, dif_error *err)
{
    const dif_regress_plan *plan = j->plan;
    dif_model_built lut;
    dif_stopwatch watch = dif_stopwatch_start();
    dif_status status = dif_model_build_volume(j->field, DIF_MODEL_LUT, plan->n_full, plan->full_um, NULL,
                                               plan->tol_lut, &j->opts, &plan->lut, &lut, err);
    const double build_s = since(&watch), nan = (double)NAN;
    if (status != DIF_OK)
        return status;
    pair models = {lut.model, lut.model, nan, nan, build_s, 0.0};
    status = run_directions(j, DIF_REGRESS_LUT, &models, err);
    if (status == DIF_OK && plan->full)
        status = build_sheets(j, err);
    if (status == DIF_OK && plan->full) {
        models.reference = j->reference_sheet.model;
        models.reference.n_lambda = plan->n_full;
        models.reference.lambda_um = plan->full_um;
        models.reference.quantity = DIF_QUANTITY_RHO;
        models.bound_reference = j->reference_sheet.bound;
        models.build_reference_s = j->build_reference_s;
        status = run_question(j, DIF_REGRESS_FULL, DIF_REGRESS_LUT, &models, err);
    }
    dif_model_built_free(&lut);
    return status;
}

static dif_status run_method(job *j, int method, dif_error *err)
{
    if (method == DIF_REGRESS_LUT)
        return run_lut(j, err);
    const dif_status status = run_table(j, method, err);
    if (status != DIF_OK)
        return status;
    const bool copies = method == DIF_REGRESS_PQ || method == DIF_REGRESS_STAM;
    return copies ? run_by_copies(j, method, err) : run_by_sheets(j, method, err);
}

dif_status dif_regress_run(const dif_field *field, const dif_regress_plan *plan, const dif_measure_opts *opts,
                           const dif_regress_device *device, const dif_regress_listener *listener, dif_error *err)
{
    job j = {.field = field, .plan = plan, .opts = *opts, .device = device, .listener = listener};
    j.opts.quantity = DIF_QUANTITY_RHO;
    j.opts.progress = NULL;
    dif_status status = fill_directions(&j, err);
    for (int method = 0; method < DIF_REGRESS_METHODS && status == DIF_OK; method++)
        if (wanted(&j, method))
            status = run_method(&j, method, err);
    dif_model_built_free(&j.device_sheet);
    dif_model_built_free(&j.reference_sheet);
    dif_release(j.wi);
    dif_release(j.wo);
    dif_release(j.pixel);
    dif_release(j.query);
    dif_release(j.compact);
    return status;
}
