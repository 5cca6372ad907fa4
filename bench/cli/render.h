/* Renderings: what `render` was asked for, the scene that becomes of it, and the methods that draw it.
 * Does not: parse the command line. */
#ifndef DIF_RENDER_CLI_H
#define DIF_RENDER_CLI_H

#include "bench/cli/cli.h"
#include "bench/model_build.h"
#include "bench/scan.h"
#include "core/io/frame_io.h"
#include "core/lut.h"
#include "core/shade.h"
#include "gpu/gpu_render.h"

/* In the order of --method; the model kinds of the same names. */
typedef enum dif_render_method {
    DIF_RENDER_LUT,
    DIF_RENDER_SHEET,
    DIF_RENDER_NMM,
    DIF_RENDER_STAM,
    DIF_RENDER_METHODS
} dif_render_method;

const char *dif_render_method_name(dif_render_method method);

/* The command line. Texts are NULL and angles NaN where not given. */
typedef struct dif_render_args {
    dif_cli_surface surface;
    dif_cli_measure measure;
    int method, shadowing, gamut;
    const char *mesh, *camera, *size, *base_colour, *exposure, *out, *meso, *study;
    dif_opt_list light_deg;
    int filter; /* dif_filter, or DIF_RENDER_SUPERSAMPLE */
    double meso_tiles, meso_scale, meso_pixel_um, meso_height_um;
    int detail, n_sub, n_azimuth, n_radius, n_turn;
    double groove_deg, fov_deg, source_deg, ground;
    dif_range lambda_nm, sweep_deg;
    bool has_sweep, contact_sheet, cpu, require_hardware;
    double exposure_value; /* of `exposure`, or DIF_RENDER_EXPOSURE_AUTO */
} dif_render_args;

#define DIF_RENDER_EXPOSURE_AUTO (-1.0)
enum { DIF_RENDER_SUPERSAMPLE = 3, DIF_RENDER_SUPERSAMPLES = 32, DIF_RENDER_SAMPLES_BY_FILTER = 0 };

/* Adds all options. */
void dif_render_add_options(dif_cli *cli, dif_render_args *args);

/* A scene and what it points to. */
typedef struct dif_render_scene {
    dif_scene scene;
    dif_mesh mesh;                                            /* owned */
    dif_texture base;                                         /* owned */
    dif_vec3 centre;                                          /* that the camera looks at and turntables turn about */
    double camera_theta_deg, camera_phi_deg, camera_distance; /* distance in radii of the mesh */
    double light_deg[DIF_LIGHT_MAX][2];
    int nx, ny;
} dif_render_scene;

/* Makes the scene. Status DIF_ERR_ARG (texts of flags), those of reading meshes and pictures. Frees nothing on failure:
 * dif_render_scene_free does. */
DIF_MUST_USE dif_status dif_render_scene_make(const dif_render_args *args, dif_render_scene *out, dif_error *err);
void dif_render_scene_free(dif_render_scene *scene);

/* Two to four numbers with commas between them. False if text is not that. */
bool dif_render_numbers(const char *text, int n_min, int n_max, double *out, int *n);

/* A surface, or a table of `diffbench lut`, and the models made of it so far. */
typedef struct dif_render_source {
    bool is_lut;
    dif_field_file file;
    dif_lut lut;
    dif_manifest lut_manifest; /* of the table's file */
    dif_shadow shadow;
    dif_field_file meso_file;
    dif_meso meso;     /* moment[0] NULL: none */
    double *lambda_um; /* of args->lambda_nm */
} dif_render_source;

DIF_MUST_USE dif_status dif_render_source_read(const dif_cli *cli, const dif_render_args *args, dif_render_source *out,
                                               dif_error *err);
void dif_render_source_free(dif_render_source *source);

/* A method made ready: its model and who reads it: the CPU's evaluator, the GPU's renderer (lut), or the GPU's evaluator
 * on what the CPU's rasteriser sees (the other methods). */
typedef struct dif_render_engine {
    dif_render_method method;
    dif_model model;       /* of a table that was read */
    dif_model_built built; /* of a surface             */
    dif_evaluator evaluator;
    dif_gpu_renderer *renderer;
    dif_lut_filter blurred; /* lut with the filter slopes */
    dif_measure_opts opts;
    double bound;
    int n_window;
} dif_render_engine;

/* Given gpu, or NULL for the CPU. Status as dif_model_build_volume, dif_gpu_renderer_open, dif_gpu_evaluator_open. */
DIF_MUST_USE dif_status dif_render_engine_open(const dif_cli *cli, const dif_render_args *args,
                                               const dif_render_source *source, const dif_render_scene *scene,
                                               dif_gpu *gpu, dif_render_method method, dif_render_engine *out,
                                               dif_error *err);
void dif_render_engine_close(dif_render_engine *engine);

/* "cpu", or the GPU's renderer string and path. */
const char *dif_render_engine_name(const dif_render_engine *engine);

/* The options of core/shade.h for what was asked. */
dif_shade_opts dif_render_shade_opts(const dif_render_args *args, const dif_render_source *source,
                                     const dif_render_engine *engine, dif_progress *progress);

/* Draws a frame. */
DIF_MUST_USE dif_status dif_render_draw(const dif_render_args *args, const dif_render_source *source,
                                        const dif_render_engine *engine, const dif_scene *scene, dif_progress *progress,
                                        dif_frame *frame, dif_eval_cost *cost, dif_error *err);

/* All filters at zooms 1, 4, 16 and 64 (tiles of the mesostructure that much smaller) against many samples a pixel:
 * FOLDER/filters.png and FOLDER/filters.csv, whose lines are also said. Status as dif_shade_draw, DIF_ERR_IO. */
DIF_MUST_USE dif_status dif_render_study(const dif_cli *cli, const dif_render_args *args,
                                         const dif_render_source *source, const dif_render_scene *scene,
                                         const dif_render_engine *engine, const dif_manifest *manifest, dif_error *err);

/* What a picture says of itself. */
DIF_MUST_USE dif_status dif_render_describe(const dif_cli *cli, const dif_render_args *args,
                                            const dif_render_source *source, const dif_render_scene *scene,
                                            const dif_render_engine *engine, dif_manifest *out, dif_error *err);

#endif
