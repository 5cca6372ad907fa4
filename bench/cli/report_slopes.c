/* Slopes, normals and a distant view of a report's surface. */
#include "bench/cli/report_slopes.h"

#include <math.h>
#include <stdio.h>

#include "bench/cli/cli.h"
#include "bench/cli/report_job.h"
#include "core/alloc.h"
#include "core/units.h"

enum { TEXELS = 129, VIEW_PIXELS = 84, PATH_SIZE = 4096 };

static const double theta_max_rad = 1.5; /* 86 degrees: a view along the surface would see next to nothing */

void dif_report_slopes_free(dif_report_slopes_data *slopes)
{
    dif_slopes_free(&slopes->slopes);
    dif_hemisphere_ndf_free(&slopes->ndf);
    dif_release(slopes->masking);
    dif_view_set_free(&slopes->view);
    *slopes = (dif_report_slopes_data){0};
}

/* The plan's fixed direction, which a negative angle turns to the other side. */
static void view_of(const dif_plan *plan, double *theta_rad, double *phi_rad)
{
    *theta_rad = fmin(fabs(plan->fixed_rad), theta_max_rad);
    *phi_rad = plan->fixed_rad < 0.0 ? plan->azimuth_rad + DIF_PI : plan->azimuth_rad;
}

dif_status dif_report_slopes_make(const dif_report_job *job, dif_report_slopes_data *out, dif_error *err)
{
    double theta_rad, phi_rad;
    dif_view_plan plan = dif_view_plan_default();
    const int side = job->field.nx > job->field.ny ? job->field.nx : job->field.ny;
    *out = (dif_report_slopes_data){.zoom = exp2(-ceil(log2(fmax((double)side / VIEW_PIXELS, 1.0)) - 0.5))};
    plan.zoom = out->zoom;
    view_of(&job->plan, &theta_rad, &phi_rad);
    dif_status status = dif_slopes_of_field(&job->field, job->step_um, theta_rad, phi_rad, &out->slopes, err);
    if (!status)
        status = dif_hemisphere_ndf_create(&job->field, TEXELS, true, &out->ndf, err);
    if (!status) {
        out->masking = dif_alloc((size_t)TEXELS * TEXELS, sizeof *out->masking);
        status = out->masking ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for the masking");
    }
    if (!status) {
        dif_hemisphere_masking_image(&out->ndf, TEXELS, out->masking);
        status = dif_view_set_make(&job->field, "viridis", &plan, DIF_VIEW_ALL, &out->view, err);
    }
    if (status)
        dif_report_slopes_free(out);
    return status;
}

static dif_status join(const char *folder, const char *slug, const char *ending, char path[PATH_SIZE], dif_error *err)
{
    const int n = snprintf(path, PATH_SIZE, "%s/%s%s", folder, slug, ending);
    return n > 0 && n < PATH_SIZE ? DIF_OK : dif_fail(err, DIF_ERR_SIZE, "%.100s...: path too long", folder);
}

dif_status dif_report_slopes_write(const char *folder, const dif_report_job *job, dif_report_slopes_data *slopes,
                                   dif_error *err)
{
    char path[PATH_SIZE];
    dif_status status = join(folder, job->slug, ".slopes.png", path, err);
    if (!status)
        status = dif_slopes_write_png(path, NULL, &slopes->slopes, &job->provenance, err);
    if (!status)
        status = join(folder, job->slug, ".normals.png", path, err);
    if (!status)
        status = dif_ndf_write_png(path, NULL, &slopes->ndf, slopes->masking, &slopes->slopes.surface, &job->provenance,
                                   &slopes->smith_worst, err);
    if (!status)
        status = join(folder, job->slug, ".view.png", path, err);
    return status ? status : dif_view_set_write_png(path, &slopes->view, slopes->zoom, &job->provenance, err);
}

static json_t *gauss_json(const dif_slope_gauss *g)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:o}", "mean_x", dif_json_number(g->mean_x), "mean_y",
                     dif_json_number(g->mean_y), "sd_x", dif_json_number(sqrt(fmax(g->var_x, 0.0))), "sd_y",
                     dif_json_number(sqrt(fmax(g->var_y, 0.0))), "cov_xy", dif_json_number(g->cov_xy));
}

static json_t *file_json(const dif_report_job *job, const char *ending)
{
    char name[128];
    snprintf(name, sizeof name, "%s%s", job->slug, ending);
    return json_string(name);
}

json_t *dif_report_slopes_json(const dif_report_job *job, const dif_report_slopes_data *slopes)
{
    static const char *const filters[] = {"point", "mean", "filtered"};
    const dif_slopes *s = &slopes->slopes;
    const dif_vec3 view = dif_vec3_from_angles_rad(s->theta_rad, s->phi_rad);
    json_t *out = json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:i}", "theta_deg",
        dif_json_number(dif_deg_from_rad(s->theta_rad)), "azimuth_deg", dif_json_number(dif_deg_from_rad(s->phi_rad)),
        "surface", gauss_json(&s->surface), "seen", gauss_json(&s->seen.gauss), "gaussian", gauss_json(&s->model.gauss),
        "seen_area", dif_json_number(s->seen.norm), "gaussian_area", dif_json_number(s->model.norm), "overlap",
        dif_json_number(s->overlap), "masking_ndf", dif_json_number(dif_hemisphere_masking(&slopes->ndf, view)),
        "masking_smith", dif_json_number(dif_shadow_smith(&s->surface, view)), "masking_worst",
        dif_json_number(slopes->smith_worst), "picture", file_json(job, ".slopes.png"), "picture_normals",
        file_json(job, ".normals.png"), "picture_view", file_json(job, ".view.png"), "zoom",
        dif_json_number(slopes->zoom), "samples", slopes->view.n_sample);
    for (int i = 0; out && i < DIF_COUNT(filters); i++)
        if (json_object_set_new(out, filters[i], dif_view_difference_json(&slopes->view, i)) != 0) {
            json_decref(out);
            out = NULL;
        }
    return out;
}
