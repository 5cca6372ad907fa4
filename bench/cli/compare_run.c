#include "bench/cli/compare_run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/cli/compare_job.h"
#include "bench/cli/compare_surface.h"
#include "bench/cli/folder.h"
#include "bench/cli/report_job.h"
#include "core/alloc.h"
#include "core/io/table_io.h"
#include "core/units.h"
#include "reports/compare.h"

enum { PATH_SIZE = 4096 };

dif_compare_args dif_compare_args_default(void)
{
    const dif_regress_plan plan = dif_regress_plan_default();
    const dif_index index = dif_index_default();
    return (dif_compare_args){.surface = dif_cli_surface_default(),
                              .factor = 2.0,
                              .theta_i_deg = 75.0,
                              .azimuth_deg = NAN,
                              .map_theta_deg = 30.0,
                              .angle_deg = {-85.0, 85.0, 0.1, 1701},
                              .lambda_nm = {380.0, 780.0, 4.0, 101},
                              .layer_nm = {450.0, 650.0, 100.0, 3},
                              .colour_nm = {380.0, 780.0, 10.0, 41},
                              .full_nm = {380.0, 780.0, 2.0, 201},
                              .n_pixel = plan.n_pixel,
                              .n_azimuth = plan.lut.n_azimuth,
                              .n_radius = plan.lut.n_radius,
                              .tol_device = plan.tol_device,
                              .tol_reference = plan.tol_reference,
                              .sigma_um = DIF_SIGMA_DEFAULT_UM,
                              .period_nm = NAN,
                              .groove_deg = NAN,
                              .index_n = index.n,
                              .index_kappa = index.kappa,
                              .window = DIF_WINDOW_GAUSS,
                              .average = DIF_AVERAGE_NONE,
                              .shadowing = DIF_SHADOWING_NONE};
}

bool dif_compare_methods_parse(const char *list, bool *method, char unknown[32])
{
    for (int m = 0; m < DIF_REGRESS_METHODS && method; m++)
        method[m] = !list;
    while (list && *list) {
        const size_t n = strcspn(list, ",");
        int found = -1;
        for (int m = 0; m < DIF_REGRESS_METHODS; m++)
            if (strlen(dif_regress_method_name(m)) == n && strncmp(dif_regress_method_name(m), list, n) == 0)
                found = m;
        if (found < 0) {
            snprintf(unknown, 32, "%.*s", n < 31 ? (int)n : 31, list);
            return false;
        }
        if (method)
            method[found] = true;
        list += n + (list[n] == ',');
    }
    return true;
}

/* Everything of one run. */
typedef struct run {
    const dif_cli *cli;
    const dif_compare_args *args;
    dif_compare_device device;
    dif_compare_limits limits;
    dif_manifest manifest;
    double *layer_um, *lambda_um, *full_um;
    json_t *surfaces;              /* done ones                          */
    const dif_compare_surface *at; /* the one that is being compared    */
    json_t *cases;                 /* its cases                          */
    dif_compare_verdict *verdict;
} run;

static dif_status wavelengths(const dif_range *range, double **out, dif_error *err)
{
    *out = dif_alloc((size_t)range->n, sizeof **out);
    if (!*out)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d wavelengths", range->n);
    for (int i = 0; i < range->n; i++)
        (*out)[i] = dif_um_from_nm(dif_range_at(range, i));
    return DIF_OK;
}

/* A baseline that cannot be read is said before the work, not after it. */
static dif_status try_baseline(const char *path, dif_error *err)
{
    json_t *nothing = json_array(), *moved = NULL;
    int n_worse;
    const dif_status status = path ? dif_compare_baseline(path, nothing, 2.0, &moved, &n_worse, err) : DIF_OK;
    json_decref(moved);
    json_decref(nothing);
    return status;
}

static dif_status prepare(run *r, dif_error *err)
{
    const dif_compare_args *args = r->args;
    dif_status status = dif_compare_limits_load(args->thresholds, &r->limits, err);
    if (!status)
        status = try_baseline(args->baseline, err);
    if (!status)
        status = wavelengths(&args->layer_nm, &r->layer_um, err);
    if (!status)
        status = wavelengths(&args->colour_nm, &r->lambda_um, err);
    if (!status)
        status = wavelengths(&args->full_nm, &r->full_um, err);
    if (!status && args->device == DIF_COMPARE_ON_GPU)
        status = dif_compare_device_open(args->require_hardware, &r->device, err);
    if (!status)
        status = dif_folder_make(args->out, err);
    if (!status)
        status = dif_cli_manifest(r->cli, NULL, &r->manifest, err);
    if (!status)
        status = dif_compare_device_describe(&r->device, &r->manifest, err);
    r->device.fault = (dif_gpu_fault)args->fault;
    r->device.half = args->half;
    r->device.n_path = args->paths == DIF_COMPARE_PATHS_BOTH ? 2 : 1;
    r->device.path[0] = args->paths == DIF_COMPARE_PATHS_FRAGMENT ? DIF_GPU_FRAGMENT : DIF_GPU_COMPUTE;
    r->device.path[1] = DIF_GPU_FRAGMENT;
    r->surfaces = json_array();
    return !status && !r->surfaces ? dif_fail(err, DIF_ERR_NOMEM, "list of surfaces") : status;
}

static void begins(void *self, const char *method, const char *what)
{
    const run *r = self;
    dif_cli_say(r->cli, "%s: %s, %s", r->at->title, method, what);
}

/* The numbers of a sheet table, for others. */
static dif_status write_table(const run *r, const dif_regress_plan *plan, const char *side, const double *value,
                              dif_error *err)
{
    char path[PATH_SIZE];
    dif_table table;
    const int n = snprintf(path, sizeof path, "%s/%s.sheet.table.%s.exr", r->args->out, r->at->slug, side);
    if (n < 0 || n >= PATH_SIZE)
        return dif_fail(err, DIF_ERR_SIZE, "%.100s...: path too long", r->args->out);
    dif_status status = dif_table_create(plan->table, DIF_QUANTITY_POWER, &table, err);
    if (status)
        return status;
    memcpy(table.value, value, (size_t)table.plan.n_angle * (size_t)table.plan.n_lambda * sizeof *value);
    status = dif_table_write(path, &table, DIF_LAYOUT_TIDY, &r->at->manifest, err);
    dif_table_free(&table);
    return status;
}

static void count(const run *r, const dif_regress_case *result, bool pass)
{
    dif_compare_verdict *v = r->verdict;
    v->n++;
    if (!pass && v->n_failed++ == 0)
        snprintf(v->first_failed, sizeof v->first_failed, "%s: %s %s (%s)", r->at->slug,
                 dif_regress_method_name(result->method), dif_regress_question_name(result->question), result->path);
}

static dif_status done(void *self, const dif_regress_plan *plan, const dif_regress_case *result, const double *device,
                       const double *reference, dif_error *err)
{
    const run *r = self;
    const bool is_first = strcmp(result->path, r->device.name[0]) == 0;
    bool pass;
    json_t *json = dif_compare_case_json(plan, &r->limits, result, &pass);
    dif_status status = json ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "a case of the comparison");
    /* both paths look the same unless one of them is wrong */
    if (!status && device && !r->args->no_pictures && (is_first || !pass))
        status = dif_compare_pictures(r->args->out, r->at->slug, plan, result, device, reference, json, err);
    if (!status && device && is_first && result->method == 0 && result->question == DIF_REGRESS_TABLE) {
        status = write_table(r, plan, "device", device, err);
        if (!status)
            status = write_table(r, plan, "reference", reference, err);
    }
    count(r, result, pass);
    if (status)
        json_decref(json);
    else if (json_array_append_new(r->cases, json) != 0)
        status = dif_fail(err, DIF_ERR_NOMEM, "list of cases");
    return status;
}

static dif_regress_plan plan_of(const run *r, const dif_compare_surface *surface)
{
    const dif_compare_args *args = r->args;
    dif_regress_plan plan = dif_regress_plan_default();
    char unknown[32];
    plan.table = &surface->plan;
    plan.wi = dif_vec3_from_angles_rad(dif_rad_from_deg(args->map_theta_deg), surface->plan.azimuth_rad);
    plan.n_pixel = args->n_pixel;
    plan.n_layer = args->layer_nm.n;
    plan.layer_um = r->layer_um;
    plan.n_lambda = args->colour_nm.n;
    plan.lambda_um = r->lambda_um;
    plan.n_full = args->full_nm.n;
    plan.full_um = r->full_um;
    plan.lut.n_azimuth = args->n_azimuth;
    plan.lut.n_radius = args->n_radius;
    plan.tol_device = args->tol_device;
    plan.tol_reference = args->tol_reference;
    plan.fit = !args->no_fit;
    plan.has_period = surface->has_period;
    plan.is_grating = surface->is_grating;
    plan.f_min_per_um = surface->f_min_per_um;
    plan.f_max_per_um = surface->f_max_per_um;
    (void)dif_compare_methods_parse(args->methods, plan.method, unknown);
    return plan;
}

/* Methods that were asked for and make no sense here. */
static json_t *skipped_json(const dif_regress_plan *plan, const dif_compare_surface *surface)
{
    static const int periodic[] = {2, 3}; /* nmm-lines, pq */
    json_t *out = json_array();
    for (int i = 0; i < DIF_COUNT(periodic); i++)
        if (plan->method[periodic[i]] && !plan->has_period)
            json_array_append_new(out, json_pack("{s:s, s:s}", "method", dif_regress_method_name(periodic[i]), "text",
                                                 "no period is known (--grating-nm gives one)"));
    if (plan->method[5] && isnan(surface->opts.period_um))
        json_array_append_new(
            out, json_pack("{s:s, s:s}", "method", "stam", "text", "there is no structure to take a period from"));
    return out;
}

static dif_status compare_surface(run *r, const dif_compare_surface *surface, dif_error *err)
{
    const dif_regress_plan plan = plan_of(r, surface);
    const dif_regress_device device = dif_compare_device_of(&r->device);
    const dif_regress_listener listener = {r, begins, done};
    r->at = surface;
    r->cases = json_array();
    const dif_status status = dif_regress_run(&surface->field, &plan, &surface->opts, &device, &listener, err);
    if (status) {
        json_decref(r->cases);
        return status;
    }
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o}", "slug", surface->slug, "title", surface->title, "description",
        surface->description, "period_nm", dif_json_number(dif_nm_from_um(surface->opts.period_um)), "azimuth_deg",
        dif_json_number(dif_deg_from_rad(surface->plan.azimuth_rad)), "provenance",
        dif_json_manifest(&surface->manifest), "skipped", skipped_json(&plan, surface), "cases", r->cases);
    return json && json_array_append_new(r->surfaces, json) == 0 ? DIF_OK
                                                                 : dif_fail(err, DIF_ERR_NOMEM, "list of surfaces");
}

static json_t *range_json(const dif_range *range)
{
    char text[80];
    snprintf(text, sizeof text, "%.9g:%.9g:%.9g", range->min, range->max, range->step);
    return json_string(text);
}

static json_t *conditions_json(const dif_compare_args *args)
{
    const dif_regress_plan plan = dif_regress_plan_default();
    return json_pack("{s:f, s:o, s:o, s:f, s:i, s:o, s:o, s:o, s:i, s:i, s:f, s:f, s:f, s:f, s:f, s:s, s:f, s:s}",
                     "table_theta_i_deg", args->theta_i_deg, "table_angle_deg", range_json(&args->angle_deg),
                     "table_lambda_nm", range_json(&args->lambda_nm), "map_theta_i_deg", args->map_theta_deg,
                     "map_pixels", args->n_pixel, "map_lambda_nm", range_json(&args->layer_nm), "colour_lambda_nm",
                     range_json(&args->colour_nm), "lut_lambda_nm", range_json(&args->full_nm), "lut_azimuths",
                     args->n_azimuth, "lut_radii", args->n_radius, "lut_tol", plan.tol_lut, "tol_device",
                     args->tol_device, "tol_reference", args->tol_reference, "floor_of_maximum", plan.floor_share,
                     "maxima_from_share", plan.peak_floor_share, "window",
                     args->window == DIF_WINDOW_FLAT ? "flat" : "gauss", "sigma_um", args->sigma_um, "average",
                     args->average == DIF_AVERAGE_WELCH ? "welch" : "none");
}

static dif_status write_doc(run *r, dif_error *err)
{
    json_t *baseline = NULL;
    dif_compare_verdict *v = r->verdict;
    if (r->args->baseline) {
        const dif_status status =
            dif_compare_baseline(r->args->baseline, r->surfaces, r->args->factor, &baseline, &v->n_worse, err);
        if (status)
            return status;
    }
    json_t *doc =
        json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:{s:b, s:i, s:i, s:i}, s:O}", "schema", DIF_COMPARE_SCHEMA, "title",
                  "GPU against CPU", "provenance", dif_json_manifest(&r->manifest), "device",
                  dif_compare_device_json(&r->device), "conditions", conditions_json(r->args), "thresholds",
                  dif_compare_limits_json(&r->limits), "verdict", "pass", (int)(v->n_failed == 0 && v->n_worse == 0),
                  "n", v->n, "n_failed", v->n_failed, "n_worse", v->n_worse, "surfaces", r->surfaces);
    if (doc && baseline && json_object_set(doc, "baseline", baseline) != 0) {
        json_decref(doc);
        doc = NULL;
    }
    const dif_status status = doc ? dif_report_write_json(r->args->out, "compare.json", doc, err)
                                  : dif_fail(err, DIF_ERR_NOMEM, "document of the comparison");
    json_decref(baseline);
    json_decref(doc);
    return status;
}

dif_status dif_compare_measure(const dif_cli *cli, const dif_compare_args *args, dif_compare_verdict *verdict,
                               dif_error *err)
{
    const int n = cli->n_operand > 0 ? cli->n_operand : dif_compare_surface_built_in();
    run r = {.cli = cli, .args = args, .verdict = verdict};
    dif_status status = prepare(&r, err);
    for (int i = 0; i < n && !status; i++) {
        dif_compare_surface surface;
        status = dif_compare_surface_load(cli, args, i, &surface, err);
        if (!status)
            status = compare_surface(&r, &surface, err);
        dif_compare_surface_free(&surface);
    }
    if (!status)
        status = write_doc(&r, err);
    json_decref(r.surfaces);
    dif_compare_device_close(&r.device);
    dif_compare_limits_free(&r.limits);
    dif_manifest_free(&r.manifest);
    dif_release(r.layer_um);
    dif_release(r.lambda_um);
    dif_release(r.full_um);
    return status;
}
