/* The methods that draw a rendering: models of a surface or of a table, and who reads them. */
#include <math.h>
#include <string.h>

#include "bench/cli/render.h"
#include "bench/lut_check.h"
#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/lut_io.h"
#include "core/units.h"

static const size_t INPUT_BYTES_MAX = (size_t)1 << 33;
static const size_t SNIFF_BYTES = 1 << 16;
enum { BLURRED_SIDE = 512 };

static const dif_model_kind KINDS[] = {[DIF_RENDER_LUT] = DIF_MODEL_LUT,
                                       [DIF_RENDER_SHEET] = DIF_MODEL_SHEET,
                                       [DIF_RENDER_NMM] = DIF_MODEL_NMM,
                                       [DIF_RENDER_STAM] = DIF_MODEL_STAM};

const char *dif_render_method_name(dif_render_method method)
{
    return dif_model_kind_name(KINDS[method]);
}

/* A table's EXR says so in its header. */
static bool looks_like_lut(const unsigned char *data, size_t n)
{
    static const char MARK[] = "diffbench.lut_version";
    const size_t n_mark = sizeof MARK - 1, n_sniff = n < SNIFF_BYTES ? n : SNIFF_BYTES;
    for (size_t i = 0; i + n_mark <= n_sniff; i++)
        if (data[i] == 'd' && memcmp(data + i, MARK, n_mark) == 0)
            return true;
    return false;
}

static dif_status read_input(const dif_cli *cli, const dif_render_args *args, dif_render_source *out, dif_error *err)
{
    const char *path = cli->operand[0];
    unsigned char *data = NULL;
    size_t n = 0;
    dif_status status = dif_file_read(path, INPUT_BYTES_MAX, &data, &n, err);
    if (status)
        return status;
    out->is_lut = looks_like_lut(data, n);
    if (out->is_lut)
        status = dif_lut_parse(data, n, path, &out->lut, &out->lut_manifest, err);
    dif_release(data);
    return out->is_lut ? status : dif_cli_surface_read(cli, path, &args->surface, &out->file, err);
}

static dif_status read_meso(const dif_cli *cli, const dif_render_args *args, dif_render_source *out, dif_error *err)
{
    dif_cli_surface about = dif_cli_surface_default();
    if (!args->meso)
        return DIF_OK;
    about.pixel_nm = args->meso_pixel_um * 1e3;
    about.height_um = args->meso_height_um;
    dif_status status = dif_cli_surface_read(cli, args->meso, &about, &out->meso_file, err);
    if (status == DIF_ERR_SCALE)
        status = dif_fail(err, status, "%s: no scale, expected --meso-pixel-um and, for images, --meso-height-um",
                          args->meso);
    return status ? status
                  : dif_meso_create(&out->meso_file.field, args->meso_scale, args->meso_tiles, &out->meso, err);
}

dif_status dif_render_source_read(const dif_cli *cli, const dif_render_args *args, dif_render_source *out,
                                  dif_error *err)
{
    const dif_shadowing kind = (dif_shadowing)args->shadowing;
    const int n = args->lambda_nm.n;
    *out = (dif_render_source){0};
    dif_status status = read_input(cli, args, out, err);
    if (status)
        return status;
    if (out->is_lut && (args->contact_sheet || args->method != DIF_RENDER_LUT))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: a table, which only --method lut reads; expected a surface",
                        cli->operand[0]);
    if (out->is_lut && (kind == DIF_SHADOWING_SMITH || kind == DIF_SHADOWING_NDF))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: a table, and --shadowing %s needs the surface", cli->operand[0],
                        dif_shadowing_name(kind));
    status = dif_shadow_create(kind, out->is_lut ? NULL : &out->file.field, &out->shadow, err);
    if (status)
        return status;
    status = read_meso(cli, args, out, err);
    if (status)
        return status;
    out->lambda_um = dif_alloc((size_t)n, sizeof *out->lambda_um);
    if (!out->lambda_um)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d wavelengths", n);
    for (int i = 0; i < n; i++)
        out->lambda_um[i] = dif_um_from_nm(dif_range_at(&args->lambda_nm, i));
    return DIF_OK;
}

void dif_render_source_free(dif_render_source *source)
{
    dif_field_file_free(&source->file);
    dif_lut_free(&source->lut);
    dif_manifest_free(&source->lut_manifest);
    dif_shadow_free(&source->shadow);
    dif_field_file_free(&source->meso_file);
    dif_meso_free(&source->meso);
    dif_release(source->lambda_um);
}

static dif_status build(const dif_cli *cli, const dif_render_args *args, const dif_render_source *source,
                        dif_render_engine *out, dif_error *err)
{
    dif_progress progress = dif_progress_begin("table", cli->quiet);
    dif_lut_opts how = dif_lut_opts_default();
    how.n_azimuth = args->n_azimuth;
    how.n_radius = args->n_radius;
    how.source_diameter_rad = dif_rad_from_deg(args->source_deg);
    how.progress = dif_progress_draw;
    how.progress_self = &progress;
    out->opts = dif_cli_measure_opts(cli, &args->measure, &source->file, &progress);
    out->opts.average = args->measure.average == DIF_AVERAGE_BY_SURFACE ? DIF_AVERAGE_WELCH : out->opts.average;
    out->opts.method = out->method == DIF_RENDER_STAM  ? DIF_METHOD_STAM
                       : out->method == DIF_RENDER_NMM ? DIF_METHOD_NMM
                                                       : DIF_METHOD_SHEET;
    dif_status status = dif_cli_measure_period(cli, &source->file, &out->opts, err);
    if (!status)
        status = dif_model_build_volume(&source->file.field, KINDS[out->method], args->lambda_nm.n, source->lambda_um,
                                        NULL, args->measure.tol, &out->opts, &how, &out->built, err);
    dif_progress_end(&progress);
    out->bound = out->built.bound;
    out->n_window = out->built.n_window;
    return status;
}

static bool wants_blurred(const dif_render_args *args)
{
    return args->filter == DIF_FILTER_SLOPES || args->study;
}

/* The reader of a model that is there. */
static dif_status open_reader(const dif_model *model, const dif_render_source *source, const dif_render_scene *scene,
                              dif_gpu *gpu, dif_render_engine *out, dif_error *err)
{
    if (!gpu)
        return dif_cpu_evaluator_open(model, &out->evaluator, err);
    if (model->kind == DIF_MODEL_LUT)
        return dif_gpu_renderer_open(gpu, model->lut, model->index, &scene->mesh, scene->scene.base, &source->shadow,
                                     NULL, &out->renderer, err);
    return dif_gpu_evaluator_open(gpu, model, NULL, &out->evaluator, err);
}

static void say_reads(const dif_cli *cli, const dif_lut *lut)
{
    const dif_model model = {.kind = DIF_MODEL_LUT, .lut = lut, .quantity = DIF_QUANTITY_RHO};
    const double reads = dif_gpu_reads_of_colour(&model, 0.0);
    if (reads > DIF_GPU_READS_WANTED)
        dif_cli_say(cli, "%d maps cost a pixel %.0f texture reads, more than the %d that real time allows", lut->n_map,
                    reads, DIF_GPU_READS_WANTED);
}

dif_status dif_render_engine_open(const dif_cli *cli, const dif_render_args *args, const dif_render_source *source,
                                  const dif_render_scene *scene, dif_gpu *gpu, dif_render_method method,
                                  dif_render_engine *out, dif_error *err)
{
    *out = (dif_render_engine){.method = method, .bound = (double)NAN};
    dif_status status = DIF_OK;
    if (source->is_lut)
        out->model = (dif_model){.kind = DIF_MODEL_LUT,
                                 .lut = &source->lut,
                                 .quantity = DIF_QUANTITY_RHO,
                                 .index = {.n = args->measure.index_n, .kappa = args->measure.index_kappa}};
    else
        status = build(cli, args, source, out, err);
    if (!status)
        status = open_reader(source->is_lut ? &out->model : &out->built.model, source, scene, gpu, out, err);
    const dif_lut *lut = source->is_lut ? out->model.lut : out->built.model.lut;
    if (!status && method == DIF_RENDER_LUT && wants_blurred(args))
        status = dif_lut_filter_create(lut, BLURRED_SIDE, &out->blurred, err);
    if (!status && gpu && lut)
        say_reads(cli, lut);
    if (status)
        dif_render_engine_close(out);
    return status;
}

void dif_render_engine_close(dif_render_engine *engine)
{
    dif_gpu_renderer_close(engine->renderer);
    dif_evaluator_close(&engine->evaluator);
    dif_lut_filter_free(&engine->blurred);
    dif_model_built_free(&engine->built);
    engine->renderer = NULL;
}

const char *dif_render_engine_name(const dif_render_engine *engine)
{
    return engine->renderer ? dif_gpu_renderer_name(engine->renderer) : engine->evaluator.name;
}

dif_shade_opts dif_render_shade_opts(const dif_render_args *args, const dif_render_source *source,
                                     const dif_render_engine *engine, dif_progress *progress)
{
    const bool many = args->filter == DIF_RENDER_SUPERSAMPLE;
    dif_shade_opts how = dif_shade_opts_default();
    how.n_sub = args->n_sub != DIF_RENDER_SAMPLES_BY_FILTER ? args->n_sub : many ? DIF_RENDER_SUPERSAMPLES : 2;
    how.jitter = many;
    how.filter = many ? DIF_FILTER_NONE : (dif_filter)args->filter;
    how.meso = source->meso.moment[0] ? &source->meso : NULL;
    how.blurred = engine->blurred.coef[0] ? &engine->blurred : NULL;
    how.index = (dif_index){.n = args->measure.index_n, .kappa = args->measure.index_kappa};
    how.shadow = &source->shadow;
    how.progress = progress ? dif_progress_draw : NULL;
    how.progress_self = progress;
    return how;
}

dif_status dif_render_draw(const dif_render_args *args, const dif_render_source *source,
                           const dif_render_engine *engine, const dif_scene *scene, dif_progress *progress,
                           dif_frame *frame, dif_eval_cost *cost, dif_error *err)
{
    const dif_shade_opts how = dif_render_shade_opts(args, source, engine, progress);
    if (engine->renderer)
        return dif_gpu_renderer_draw(engine->renderer, scene, &how, frame, cost, err);
    return dif_shade_draw(scene, &engine->evaluator, &how, frame, cost, err);
}
