/* A surface worn by the coiled snake, for the report. */
#include "bench/cli/report_render.h"

#include <stdio.h>

#include "bench/cli/cli.h"
#include "bench/cli/report_job.h"
#include "bench/lut_check.h"
#include "core/io/frame_io.h"
#include "core/units.h"
#include "fixtures/meshes.h"

enum { WIDTH = 640, HEIGHT = 300, AZIMUTHS = 1024, RADII = 192, WAVES = 41, SAMPLES = 2, PATH_SIZE = 4096 };
static const double tol = 1e-3, source_deg = 0.53, camera_deg[2] = {48.0, -90.0}, groove_deg = 90.0;
static const double lights_deg[2][2] = {{35.0, -60.0}, {40.0, 150.0}};

void dif_report_render_free(dif_report_render_data *render)
{
    dif_frame_free(&render->frame);
    *render = (dif_report_render_data){0};
}

/* Pictures see the expectation of a surface with speckle and the one window of an ideal one, as its table does. */
static dif_status make_table(const dif_report_job *job, dif_lut *lut, dif_report_render_data *out, dif_error *err)
{
    dif_measure_opts opts = job->opts;
    dif_lut_opts how = dif_lut_opts_default();
    double lambda_um[WAVES];
    opts.method = DIF_METHOD_SHEET;
    opts.progress = NULL;
    how.n_azimuth = AZIMUTHS;
    how.n_radius = RADII;
    how.source_diameter_rad = dif_rad_from_deg(source_deg);
    for (int i = 0; i < WAVES; i++)
        lambda_um[i] = 0.38 + 0.01 * i;
    const dif_status status =
        dif_lut_measure(&job->field, WAVES, lambda_um, tol, &opts, &how, lut, &out->n_window, err);
    out->n_map = lut->n_map;
    out->tail = lut->tail;
    return status;
}

static dif_status draw(const dif_report_job *job, const dif_lut *lut, const dif_mesh *mesh, dif_report_render_data *out,
                       dif_error *err)
{
    const dif_model model = {.kind = DIF_MODEL_LUT, .lut = lut, .quantity = DIF_QUANTITY_RHO, .index = job->opts.index};
    const dif_shadow vcavity = {.kind = DIF_SHADOWING_VCAVITY};
    const double fov_rad = dif_rad_from_deg(30.0);
    dif_shade_opts how = dif_shade_opts_default();
    dif_evaluator cpu = {0};
    dif_scene scene = {.mesh = mesh,
                       .camera = dif_camera_framing(mesh, dif_rad_from_deg(camera_deg[0]),
                                                    dif_rad_from_deg(camera_deg[1]), fov_rad, 2.0, 0.94),
                       .n_light = 2,
                       .groove_rad = dif_rad_from_deg(groove_deg)};
    for (int i = 0; i < 2; i++)
        scene.light[i] =
            dif_vec3_from_angles_rad(dif_rad_from_deg(lights_deg[i][0]), dif_rad_from_deg(lights_deg[i][1]));
    how.shadow = &vcavity;
    how.n_sub = SAMPLES;
    dif_status status = dif_frame_create(WIDTH, HEIGHT, &out->frame, err);
    if (!status)
        status = dif_cpu_evaluator_open(&model, &cpu, err);
    if (!status)
        status = dif_shade_draw(&scene, &cpu, &how, &out->frame, NULL, err);
    dif_evaluator_close(&cpu);
    out->exposure = status ? 0.0 : dif_frame_exposure(&out->frame, DIF_FRAME_EXPOSURE_SHARE);
    return status;
}

dif_status dif_report_render_make(const dif_report_job *job, dif_report_render_data *out, dif_error *err)
{
    dif_lut lut = {0};
    dif_mesh mesh = {0};
    *out = (dif_report_render_data){0};
    dif_status status = make_table(job, &lut, out, err);
    if (!status)
        status = dif_mesh_make(DIF_MESH_SNAKE, 2, &mesh, err);
    if (!status)
        status = draw(job, &lut, &mesh, out, err);
    dif_lut_free(&lut);
    dif_mesh_free(&mesh);
    if (status)
        dif_report_render_free(out);
    return status;
}

static dif_frame_look look_of(const dif_report_render_data *render)
{
    dif_frame_look look = dif_frame_look_default();
    look.exposure = render->exposure;
    return look;
}

dif_status dif_report_render_write(const char *folder, const dif_report_job *job, const dif_report_render_data *render,
                                   dif_error *err)
{
    char path[PATH_SIZE];
    const dif_frame_look look = look_of(render);
    const int n = snprintf(path, sizeof path, "%s/%s.render.png", folder, job->slug);
    if (n < 0 || n >= PATH_SIZE)
        return dif_fail(err, DIF_ERR_SIZE, "%.100s...: path too long", folder);
    return dif_frame_write_png(path, &render->frame, &look, &job->provenance, err);
}

json_t *dif_report_render_json(const dif_report_job *job, const dif_report_render_data *render)
{
    char name[128];
    snprintf(name, sizeof name, "%s.render.png", job->slug);
    return json_pack("{s:s, s:s, s:s, s:i, s:i, s:i, s:i, s:i, s:i, s:o, s:o, s:o, s:o, s:s}", "picture", name, "mesh",
                     "snake", "renderer", "cpu", "width", WIDTH, "height", HEIGHT, "azimuths", AZIMUTHS, "radii", RADII,
                     "maps", render->n_map, "windows", render->n_window, "source_deg", dif_json_number(source_deg),
                     "groove_deg", dif_json_number(groove_deg), "exposure", dif_json_number(render->exposure), "tail",
                     dif_json_number(render->tail), "shadowing", "vcavity");
}
