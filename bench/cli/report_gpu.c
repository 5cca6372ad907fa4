/* GPU against CPU on a report's surface. The verb compare does the same with more directions and pictures. */
#include "bench/cli/report_gpu.h"

#include <math.h>

#include "bench/cli/cli.h"
#include "bench/cli/compare_job.h"
#include "bench/cli/report_job.h"
#include "bench/scan.h"
#include "core/units.h"

enum { PIXELS = 33, WAVES = 21, AZIMUTHS = 512, RADII = 96 };

void dif_report_gpu_free(dif_report_gpu_data *gpu)
{
    json_decref(gpu->json);
    *gpu = (dif_report_gpu_data){0};
}

/* What the listener fills. */
typedef struct hearing {
    dif_compare_limits limits;
    json_t *cases;
    int n, n_failed;
} hearing;

static dif_status hear(void *self, const dif_regress_plan *plan, const dif_regress_case *result, const double *device,
                       const double *reference, dif_error *err)
{
    hearing *h = self;
    bool pass;
    (void)device;
    (void)reference;
    json_t *json = dif_compare_case_json(plan, &h->limits, result, &pass);
    h->n++;
    h->n_failed += !pass;
    return json_array_append_new(h->cases, json) == 0 ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "a case of GPU and CPU");
}

/* Every half degree and 20 nm of the job's own plane. */
static dif_status make_plan(const dif_report_job *job, dif_plan *out, dif_error *err)
{
    const dif_range angle = {-85.0, 85.0, 0.5, 341}, lambda = {380.0, 780.0, 20.0, WAVES};
    return dif_scan_plan(job->plan.fixed_is_wo, dif_deg_from_rad(job->plan.fixed_rad),
                         dif_deg_from_rad(job->plan.azimuth_rad), &angle, &lambda, out, err);
}

/* One window at the centre: its powers hold everything that the shaders do, and memory for many is not needed. */
static dif_measure_opts make_opts(const dif_report_job *job)
{
    dif_measure_opts opts = job->opts;
    opts.average = DIF_AVERAGE_NONE;
    opts.shadow = NULL;
    opts.progress = NULL;
    opts.period_um = job->known_period_um; /* NaN where none is known: stam and what replicates is left out */
    opts.psi_rad = job->has_grating ? job->grating.psi_rad : job->plan.azimuth_rad;
    return opts;
}

static dif_status compare(const dif_report_job *job, dif_compare_device *device, hearing *h, dif_error *err)
{
    const double layer_um[] = {0.55};
    double lambda_um[WAVES];
    const dif_measure_opts opts = make_opts(job);
    dif_regress_plan plan = dif_regress_plan_default();
    dif_plan table;
    dif_status status = make_plan(job, &table, err);
    if (status != DIF_OK)
        return status;
    for (int i = 0; i < WAVES; i++)
        lambda_um[i] = dif_um_from_nm(380.0 + 20.0 * i);
    plan.table = &table;
    plan.wi = dif_vec3_from_angles_rad(dif_rad_from_deg(30.0), job->plan.azimuth_rad);
    plan.n_pixel = PIXELS;
    plan.n_layer = 1;
    plan.layer_um = layer_um;
    plan.n_lambda = plan.n_full = WAVES;
    plan.lambda_um = plan.full_um = lambda_um;
    plan.lut.n_azimuth = AZIMUTHS;
    plan.lut.n_radius = RADII;
    plan.has_period = plan.is_grating = job->has_grating;
    plan.full = false; /* the table is coarse here: the shaders are judged, not its interpolation */
    plan.fit = false;
    plan.f_min_per_um = job->f_min_per_um;
    plan.f_max_per_um = job->f_max_per_um;
    const dif_regress_device under_test = dif_compare_device_of(device);
    const dif_regress_listener listener = {h, NULL, hear};
    status = dif_regress_run(&job->field, &plan, &opts, &under_test, &listener, err);
    dif_plan_free(&table);
    return status;
}

dif_status dif_report_gpu_make(const dif_report_job *job, dif_report_gpu_data *out, dif_error *err)
{
    dif_compare_device device = {.n_path = 2, .path = {DIF_GPU_COMPUTE, DIF_GPU_FRAGMENT}};
    hearing h = {.cases = json_array()};
    dif_error why = {DIF_OK, ""};
    *out = (dif_report_gpu_data){0};
    dif_status status = dif_compare_device_open(false, &device, &why);
    if (status == DIF_ERR_RESOURCE) {
        json_decref(h.cases);
        out->json = json_pack("{s:s}", "text", why.text);
        return out->json ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "a line on the GPU");
    }
    if (status != DIF_OK)
        status = dif_fail(err, status, "%s", why.text);
    if (status == DIF_OK)
        status = dif_compare_limits_load(NULL, &h.limits, err);
    if (status == DIF_OK)
        status = compare(job, &device, &h, err);
    if (status == DIF_OK) {
        out->n = h.n;
        out->n_failed = h.n_failed;
        out->json = json_pack("{s:o, s:{s:b, s:i, s:i}, s:O}", "device", dif_compare_device_json(&device), "verdict",
                              "pass", (int)(h.n_failed == 0), "n", h.n, "n_failed", h.n_failed, "cases", h.cases);
        if (!out->json)
            status = dif_fail(err, DIF_ERR_NOMEM, "a comparison of GPU and CPU");
    }
    json_decref(h.cases);
    dif_compare_limits_free(&h.limits);
    dif_compare_device_close(&device);
    return status;
}
