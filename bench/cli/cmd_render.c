/* diffbench render SURFACE: pictures of meshes that wear a measured surface. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/folder.h"
#include "bench/cli/render.h"
#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/number.h"
#include "core/units.h"

static const dif_cli_help HELP = {
    "SURFACE|TABLE",
    "Renders a mesh that wears a surface, or a table that `diffbench lut` made of it. Angles are those of the bench: "
    "theta\n"
    "from the mesh's z, phi from x towards y. The patch's x axis lies along the mesh's tangent (texture u; the body of "
    "the\n"
    "snake, the radius of the disc), turned by --groove-deg. EXR holds linear R, G, B, exposed, and the coverage A; "
    "PNG is\n"
    "encoded sRGB. The GPU draws (lut in its fragment shader, the other methods in compute shaders on what the CPU's\n"
    "rasteriser sees), or with --cpu the CPU in double precision. With --turntable or --light-sweep, F.png becomes "
    "F.0000.png, F.0001.png ...\n",
    "  diffbench fixture xenopeltis --size-um 32 --pixels 256 --out shed.gsf\n"
    "  diffbench lut shed.gsf --azimuths 512 --radii 96 --sigma-um 8 --average welch --out shed.lut.exr\n"
    "  diffbench render shed.lut.exr --cpu --mesh snake --size 320x180 --out snake.png\n"
    "  diffbench render shed.lut.exr --cpu --mesh sphere --size 160x160 --light-deg 40,-50 --turntable 3 --out "
    "ball.png\n",
};

/* Everything that one run makes. */
typedef struct render_run {
    dif_render_source source;
    dif_render_scene scene;
    dif_gpu *gpu; /* NULL: the CPU draws */
    char renderer[224];
    dif_render_engine engine[DIF_RENDER_METHODS];
    dif_frame frame[DIF_RENDER_METHODS];
    dif_manifest manifest;
    dif_eval_cost cost;
    double exposure; /* of all frames, once known */
    int n_frame;
} render_run;

static void run_free(render_run *run)
{
    for (int i = 0; i < DIF_RENDER_METHODS; i++) {
        dif_render_engine_close(&run->engine[i]);
        dif_frame_free(&run->frame[i]);
    }
    dif_gpu_close(run->gpu);
    dif_render_source_free(&run->source);
    dif_render_scene_free(&run->scene);
    dif_manifest_free(&run->manifest);
}

static dif_frame_look look_of(const dif_render_args *args, const render_run *run)
{
    return (dif_frame_look){.exposure = run->exposure, .gamut = (dif_gamut)args->gamut, .ground = args->ground};
}

/* F.png of frame i of a sequence is F.0007.png. */
static dif_status name_frame(const dif_render_args *args, const render_run *run, int i, char path[4096], dif_error *err)
{
    const size_t n_stem = strlen(args->out) - 4;
    const int n = run->n_frame == 1
                      ? snprintf(path, 4096, "%s", args->out)
                      : snprintf(path, 4096, "%.*s.%04d%s", (int)n_stem, args->out, i, args->out + n_stem);
    return n > 0 && n < 4096 ? DIF_OK : dif_fail(err, DIF_ERR_ARG, "%.100s...: path too long", args->out);
}

/* The scene of frame i: turned, or lit from elsewhere. */
static dif_scene scene_of(const dif_render_args *args, const render_run *run, int i)
{
    dif_scene scene = run->scene.scene;
    if (args->n_turn > 0)
        dif_scene_turn(&scene, run->scene.centre, DIF_TWO_PI * i / args->n_turn);
    if (args->has_sweep)
        scene.light[0] = dif_vec3_from_angles_rad(dif_rad_from_deg(dif_range_at(&args->sweep_deg, i)),
                                                  dif_rad_from_deg(run->scene.light_deg[0][1]));
    return scene;
}

static void note_renderer(render_run *run)
{
    const char *name = dif_render_engine_name(&run->engine[0]);
    snprintf(run->renderer, sizeof run->renderer, "%s", name ? name : "");
}

static dif_status note_frame(const dif_render_args *args, render_run *run, int i, dif_error *err)
{
    dif_status status = dif_manifest_setf(&run->manifest, err, "exposure", "%.9g", run->exposure);
    if (!status && run->n_frame > 1)
        status = dif_manifest_setf(&run->manifest, err, "frame", "%d of %d", i, run->n_frame);
    if (!status && args->n_turn > 0)
        status = dif_manifest_setf(&run->manifest, err, "turned_deg", "%.9g", 360.0 * i / args->n_turn);
    if (!status && args->has_sweep)
        status = dif_manifest_setf(&run->manifest, err, "swept_theta_deg", "%.9g", dif_range_at(&args->sweep_deg, i));
    return status;
}

static dif_status draw_frame(const dif_render_args *args, render_run *run, int i, dif_progress *progress,
                             dif_error *err)
{
    dif_eval_cost cost = {0};
    char path[4096];
    const dif_scene scene = scene_of(args, run, i);
    dif_status status = dif_render_draw(args, &run->source, &run->engine[0], &scene,
                                        run->n_frame == 1 ? progress : NULL, &run->frame[0], &cost, err);
    if (status)
        return status;
    if (!(run->exposure > 0.0))
        run->exposure = args->exposure_value > 0.0 ? args->exposure_value
                                                   : dif_frame_exposure(&run->frame[0], DIF_FRAME_EXPOSURE_SHARE);
    run->cost.upload_s += cost.upload_s;
    run->cost.run_s += cost.run_s;
    run->cost.download_s += cost.download_s;
    const dif_frame_look look = look_of(args, run);
    status = note_frame(args, run, i, err);
    if (!status)
        status = name_frame(args, run, i, path, err);
    if (status)
        return status;
    return dif_file_ends_in(path, ".exr") ? dif_frame_write(path, &run->frame[0], &look, &run->manifest, err)
                                          : dif_frame_write_png(path, &run->frame[0], &look, &run->manifest, err);
}

static dif_status draw_frames(const dif_cli *cli, const dif_render_args *args, render_run *run, dif_error *err)
{
    dif_progress progress = dif_progress_begin(run->n_frame > 1 ? "frames" : cli->verb, cli->quiet);
    dif_status status = dif_render_engine_open(cli, args, &run->source, &run->scene, run->gpu,
                                               (dif_render_method)args->method, &run->engine[0], err);
    if (!status)
        status = dif_frame_create(run->scene.nx, run->scene.ny, &run->frame[0], err);
    if (!status)
        status = dif_render_describe(cli, args, &run->source, &run->scene, &run->engine[0], &run->manifest, err);
    note_renderer(run);
    for (int i = 0; i < run->n_frame && !status; i++) {
        status = draw_frame(args, run, i, &progress, err);
        dif_progress_draw(&progress, (i + 1.0) / run->n_frame);
    }
    dif_progress_end(&progress);
    return status;
}

/* All methods; lut, sheet and nmm at the exposure of the table, stam, whose brightness means nothing, at its own. */
static dif_status draw_sheet(const dif_cli *cli, const dif_render_args *args, render_run *run, dif_error *err)
{
    static const char *const NOTES[] = {"integrated table", "every wavelength", "few wavelengths", "bumps, no profile"};
    dif_sheet_cell cell[DIF_RENDER_METHODS];
    dif_status status = DIF_OK;
    for (int i = 0; i < DIF_RENDER_METHODS && !status; i++) {
        dif_progress progress = dif_progress_begin(dif_render_method_name((dif_render_method)i), cli->quiet);
        status = dif_render_engine_open(cli, args, &run->source, &run->scene, run->gpu, (dif_render_method)i,
                                        &run->engine[i], err);
        if (!status)
            status = dif_frame_create(run->scene.nx, run->scene.ny, &run->frame[i], err);
        if (!status)
            status = dif_render_draw(args, &run->source, &run->engine[i], &run->scene.scene, &progress, &run->frame[i],
                                     NULL, err);
        if (!status && i == 0)
            status = dif_render_describe(cli, args, &run->source, &run->scene, &run->engine[0], &run->manifest, err);
        if (i == 0)
            note_renderer(run);
        dif_render_engine_close(&run->engine[i]);
        dif_progress_end(&progress);
    }
    if (status)
        return status;
    run->exposure = args->exposure_value > 0.0 ? args->exposure_value
                                               : dif_frame_exposure(&run->frame[0], DIF_FRAME_EXPOSURE_SHARE);
    for (int i = 0; i < DIF_RENDER_METHODS; i++)
        cell[i] =
            (dif_sheet_cell){&run->frame[i], run->exposure, dif_render_method_name((dif_render_method)i), NOTES[i]};
    cell[DIF_RENDER_STAM].exposure = dif_frame_exposure(&run->frame[DIF_RENDER_STAM], DIF_FRAME_EXPOSURE_SHARE);
    const dif_frame_look look = look_of(args, run);
    status = note_frame(args, run, 0, err);
    return status ? status : dif_frame_write_sheet(args->out, DIF_RENDER_METHODS, cell, 2, &look, &run->manifest, err);
}

static dif_status draw_study(const dif_cli *cli, const dif_render_args *args, render_run *run, dif_error *err)
{
    dif_status status =
        dif_render_engine_open(cli, args, &run->source, &run->scene, NULL, DIF_RENDER_LUT, &run->engine[0], err);
    if (!status)
        status = dif_render_describe(cli, args, &run->source, &run->scene, &run->engine[0], &run->manifest, err);
    note_renderer(run);
    return status ? status
                  : dif_render_study(cli, args, &run->source, &run->scene, &run->engine[0], &run->manifest, err);
}

static dif_status open_gpu(const dif_render_args *args, render_run *run, dif_error *err)
{
    const dif_gpu_opts opts = {.require_hardware = args->require_hardware};
    dif_error why = {0};
    if (args->cpu)
        return DIF_OK;
    const dif_status status = dif_gpu_open(&opts, &run->gpu, &why);
    return status ? dif_fail(err, status, "%.180s; --cpu renders without a GPU", why.text) : DIF_OK;
}

/* A study has an exposure for each zoom, beside the numbers in its table. */
static void say_done(const dif_cli *cli, const dif_render_args *args, const render_run *run)
{
    const dif_render_scene *scene = &run->scene;
    const char *plural = scene->mesh.n_triangle == 1 ? "" : "s";
    if (args->study)
        dif_cli_say(cli, "%d x %d pixels, %d triangle%s, drawn on %s: %s/filters.png and .csv", scene->nx, scene->ny,
                    scene->mesh.n_triangle, plural, run->renderer, args->study);
    else
        dif_cli_say(cli, "%d x %d pixels, %d triangle%s, exposure %.4g%s, drawn on %s", scene->nx, scene->ny,
                    scene->mesh.n_triangle, plural, run->exposure, args->exposure_value > 0.0 ? "" : " (auto)",
                    run->renderer);
}

static int execute(const dif_cli *cli, const dif_render_args *args)
{
    dif_error err = {0};
    render_run run = {.n_frame = args->n_turn > 0 ? args->n_turn : args->has_sweep ? args->sweep_deg.n : 1};
    dif_status status = args->study ? dif_folder_make(args->study, &err) : dif_cli_check_out(args->out, &err);
    if (!status)
        status = dif_render_scene_make(args, &run.scene, &err);
    if (!status)
        status = open_gpu(args, &run, &err);
    if (!status)
        status = dif_render_source_read(cli, args, &run.source, &err);
    if (!status)
        status = args->study           ? draw_study(cli, args, &run, &err)
                 : args->contact_sheet ? draw_sheet(cli, args, &run, &err)
                                       : draw_frames(cli, args, &run, &err);
    int code = DIF_EXIT_DONE;
    if (status) {
        code = dif_cmd_fail(cli->verb, &err);
    } else {
        say_done(cli, args, &run);
        if (cli->json)
            code = dif_json_print(cli, json_pack("{s:i, s:i, s:i, s:o, s:o}", "width", run.scene.nx, "height",
                                                 run.scene.ny, "frames", run.n_frame, "exposure",
                                                 dif_json_number(args->study ? (double)NAN : run.exposure),
                                                 "provenance", dif_json_manifest(&run.manifest)));
    }
    run_free(&run);
    return code;
}

static int check_filter(const dif_cli *cli, dif_render_args *args)
{
    if (args->filter == DIF_FILTER_SLOPES && (args->method != DIF_RENDER_LUT || args->contact_sheet))
        return dif_cmd_usage(cli->verb, "--filter slopes averages the table, expected --method lut");
    if (isnan(args->source_deg))
        args->source_deg = args->contact_sheet ? 0.0 : 0.53;
    return DIF_CLI_GO;
}

static int check_args(const dif_cli *cli, dif_render_args *args)
{
    if (args->study && (args->out || args->method != DIF_RENDER_LUT || !args->meso || !args->cpu))
        return dif_cmd_usage(cli->verb, "--filter-study needs --mesostructure, --cpu and --method lut, and no --out");
    if (args->study)
        return check_filter(cli, args);
    if (!args->out)
        return dif_cmd_usage(cli->verb, "nowhere to put the picture, expected --out F.png or F.exr");
    if (!dif_file_ends_in(args->out, ".exr") && !dif_file_ends_in(args->out, ".png"))
        return dif_cmd_usage(cli->verb, "--out '%s': unknown kind of file, expected F.png or F.exr", args->out);
    if (args->contact_sheet && !dif_file_ends_in(args->out, ".png"))
        return dif_cmd_usage(cli->verb, "--contact-sheet with --out '%s': expected F.png", args->out);
    if ((args->n_turn > 0) + args->has_sweep + args->contact_sheet > 1)
        return dif_cmd_usage(cli->verb, "expected at most one of --turntable, --light-sweep and --contact-sheet");
    if (args->has_sweep && args->sweep_deg.n > 10000)
        return dif_cmd_usage(cli->verb, "--light-sweep: %d frames, expected at most 10000", args->sweep_deg.n);
    if (args->exposure && strcmp(args->exposure, "auto") != 0 &&
        (!dif_number_all(args->exposure, strlen(args->exposure), '.', &args->exposure_value) ||
         !(args->exposure_value > 0.0 && isfinite(args->exposure_value))))
        return dif_cmd_usage(cli->verb, "--exposure '%s': expected a number > 0 or auto", args->exposure);
    return check_filter(cli, args);
}

int dif_cmd_render(int argc, char **argv)
{
    dif_render_args args = {.surface = dif_cli_surface_default(),
                            .measure = dif_cli_measure_default(),
                            .shadowing = DIF_SHADOWING_VCAVITY,
                            .gamut = DIF_GAMUT_DESATURATE,
                            .detail = 2,
                            .n_sub = DIF_RENDER_SAMPLES_BY_FILTER,
                            .meso_tiles = 4.0,
                            .meso_scale = 1.0,
                            .meso_pixel_um = NAN,
                            .meso_height_um = NAN,
                            .n_azimuth = 4096,
                            .n_radius = 320,
                            .groove_deg = NAN,
                            .fov_deg = 30.0,
                            .source_deg = NAN,
                            .ground = 0.01,
                            .lambda_nm = {380.0, 780.0, 5.0, 81},
                            .exposure_value = DIF_RENDER_EXPOSURE_AUTO};
    dif_cli cli;
    args.measure.tol = 1e-4;
    dif_cli_begin(&cli, argc, argv, &HELP);
    dif_render_add_options(&cli, &args);
    int code = dif_cli_parse(&cli, 1, 1);
    if (code == DIF_CLI_GO)
        code = check_args(&cli, &args);
    if (code != DIF_CLI_GO)
        return code;
    dif_cli_use_threads(&cli);
    return execute(&cli, &args);
}
