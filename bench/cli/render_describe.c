/* What a rendering says of itself. */
#include <stdio.h>

#include "bench/cli/render.h"
#include "core/units.h"

static dif_status describe_scene(const dif_render_args *args, const dif_render_scene *scene, dif_manifest *out,
                                 dif_error *err)
{
    char lights[DIF_LIGHT_MAX * 40] = "";
    size_t n = 0;
    for (int i = 0; i < scene->scene.n_light; i++)
        n += (size_t)snprintf(lights + n, sizeof lights - n, "%s%.9g,%.9g", i ? " " : "", scene->light_deg[i][0],
                              scene->light_deg[i][1]);
    dif_status status = dif_manifest_set(out, "mesh", args->mesh ? args->mesh : "snake", err);
    if (status ||
        (status = dif_manifest_setf(out, err, "camera",
                                    "theta %.9g deg, phi %.9g deg, distance %.9g radii, field of "
                                    "view %.9g deg",
                                    scene->camera_theta_deg, scene->camera_phi_deg, scene->camera_distance,
                                    args->fov_deg)) ||
        (status = dif_manifest_set(out, "lights_deg", lights, err)) ||
        (status = dif_manifest_setf(out, err, "groove_deg", "%.9g", dif_deg_from_rad(scene->scene.groove_rad))))
        return status;
    if (args->base_colour)
        status = dif_manifest_set(out, "base_colour", args->base_colour, err);
    return status;
}

/* A table's own provenance goes along under "table_KEY". */
static dif_status describe_table(const dif_manifest *table, dif_manifest *out, dif_error *err)
{
    for (int i = 0; i < table->n; i++) {
        char key[128];
        snprintf(key, sizeof key, "table_%.100s", table->item[i].key);
        const dif_status status = dif_manifest_set(out, key, table->item[i].value, err);
        if (status)
            return status;
    }
    return DIF_OK;
}

static dif_status describe_surface(const dif_render_args *args, const dif_render_source *source,
                                   const dif_render_engine *engine, dif_manifest *out, dif_error *err)
{
    const dif_measure_stats stats = {.bound = engine->bound, .n_window = engine->n_window};
    dif_status status = dif_cli_manifest_surface(out, &source->file, err);
    if (!status)
        status = dif_cli_manifest_measure(out, args->measure.tol, &engine->opts, &stats, err);
    if (!status)
        status = dif_manifest_setf(out, err, "wavelengths_nm", "%.12g:%.12g:%.12g", args->lambda_nm.min,
                                   args->lambda_nm.max, args->lambda_nm.step);
    return status ? status : dif_manifest_setf(out, err, "source_diameter_deg", "%.12g", args->source_deg);
}

static dif_status describe_meso(const dif_render_args *args, dif_manifest *out, dif_error *err)
{
    return args->meso ? dif_manifest_setf(out, err, "mesostructure", "%s, %.9g tiles, slopes times %.9g", args->meso,
                                          args->meso_tiles, args->meso_scale)
                      : DIF_OK;
}

dif_status dif_render_describe(const dif_cli *cli, const dif_render_args *args, const dif_render_source *source,
                               const dif_render_scene *scene, const dif_render_engine *engine, dif_manifest *out,
                               dif_error *err)
{
    static const char *const FILTERS[] = {"none", "mip", "slopes", "supersample"};
    const dif_shade_opts how = dif_render_shade_opts(args, source, engine, NULL);
    dif_status status = dif_cli_manifest(cli, cli->operand[0], out, err);
    if (!status)
        status = source->is_lut ? describe_table(&source->lut_manifest, out, err)
                                : describe_surface(args, source, engine, out, err);
    if (!status)
        status = describe_scene(args, scene, out, err);
    if (status || (status = dif_manifest_set(out, "method", dif_render_method_name(engine->method), err)) ||
        (status = dif_manifest_set(out, "renderer", dif_render_engine_name(engine), err)) ||
        (status = dif_manifest_set(out, "shadowing", dif_shadowing_name(source->shadow.kind), err)) ||
        (status = dif_manifest_setf(out, err, "samples_per_pixel", "%d x %d%s", how.n_sub, how.n_sub,
                                    how.jitter && !engine->renderer ? " random" : "")) ||
        (status = dif_manifest_set(out, "filter", FILTERS[args->filter], err)) ||
        (status = describe_meso(args, out, err)) ||
        (status = dif_manifest_set(out, "exposure_by", args->exposure_value > 0.0 ? "user" : "auto", err)) ||
        (status = dif_manifest_set(out, "colour", "linear sRGB, D65; a mirror under one light is 1 / exposure", err)))
        return status;
    return dif_manifest_set(out, "gamut", dif_gamut_name((dif_gamut)args->gamut), err);
}
