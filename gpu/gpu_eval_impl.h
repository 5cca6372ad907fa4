/* What the files of the GPU evaluator share. Not installed. */
#ifndef DIF_GPU_EVAL_IMPL_H
#define DIF_GPU_EVAL_IMPL_H

#include "core/shared.h"
#include "gpu/gl_program.h"
#include "gpu/gl_texture.h"

enum {
    DIF_EVAL_ITEMS = 1 << 16, /* queries or directions that one pass takes                                */
    DIF_EVAL_SIDE = 512,      /* texels of a side of the result                                           */
    DIF_EVAL_WAVES = 512,     /* wavelengths of a table that one pass takes, <= DIF_EVAL_SIDE             */
    DIF_EVAL_ANGLES = 2048,   /* angles that one pass takes, 4 a texel                                    */
    DIF_EVAL_JOBS = 3,
    DIF_EVAL_KERNEL_CHARS = 24576
};

/* Parameters of evaluate.glsl. */
typedef struct dif_eval_block {
    int axis_s[4], axis_y[4], axis_z[4], job[4], few[4], copies[4];
    float gain[4], more[4], scale[4], root[4];
} dif_eval_block;

/* Parameters of evaluate_lut.glsl. */
typedef struct dif_eval_lut_block {
    float shape[4], more[4];
    int job[4];
    float root[4];
} dif_eval_lut_block;

/* What a shader is made for. */
typedef struct dif_eval_variant {
    dif_model_kind kind;
    int job; /* DIF_JOB_IS_... */
    dif_quantity quantity;
    dif_shadowing shadowing; /* of rho and brdf */
    dif_gpu_path path;
    dif_gpu_fault fault;
    const dif_sheet *sheet; /* whose kernels it holds; NULL: none */
} dif_eval_variant;

/* Its source. The shader points into the struct, which must stay where it is. */
typedef struct dif_eval_source {
    char defines[512], kernels[DIF_EVAL_KERNEL_CHARS];
    int n_shader;
    dif_gl_shader shader[2];
} dif_eval_source;

/* Source of a variant, from the files of gpu/shaders and the sheet's kernels. */
void dif_eval_source_make(const dif_eval_variant *variant, dif_eval_source *out);

/* Extremes of lateral and vertical wave numbers, rad/um, that a call will read: along the sheet's axes. */
typedef struct dif_eval_reach {
    double min[3], max[3];
} dif_eval_reach;

typedef struct dif_gpu_eval {
    dif_gpu *gpu;
    const dif_model *model;
    dif_gpu_eval_opts opts;
    char name[224];
    bool has_sheets, is_line;
    GLuint program[DIF_EVAL_JOBS]; /* made when first asked for */
    GLuint block;
    dif_eval_source *source;
    dif_gl_texture directions, waves, asked, spectrum, maps, masking, result[2];
    float root[4];         /* of the slopes' covariance: dif_shadow_place       */
    int n_slot;            /* sheets that the device holds at a time            */
    dif_gl_texture *slot;  /* slot[n_slot]                                      */
    int slot_first;        /* the sheet that slot 0 holds; -1: none yet         */
    dif_eval_block params; /* of the next dispatch                              */
    dif_eval_lut_block lut_params;
    size_t n_wave_max;       /* entries that `waves` has room for                 */
    float *pairs;            /* pairs[DIF_EVAL_ITEMS][DIF_DIR_STRIDE][2]          */
    float *wave_pairs;       /* wave_pairs[n_wave_max][DIF_WAVE_STRIDE][2]        */
    float *ask_pairs;        /* nmm: ask_pairs[DIF_EVAL_WAVES][DIF_ASK_STRIDE][2] */
    float *texels;           /* texels[DIF_EVAL_SIDE * DIF_EVAL_SIDE][4]          */
    float *staging;          /* planes on their way into a texture                */
    size_t n_staging;        /* floats there                                      */
    double (*weight)[3];     /* weight[n_lambda]: colours of sheet, pq and stam   */
    double scale[3];         /* nmm                                               */
    double *few_um;          /* nmm: few_um[n_fixed]                              */
    double (*few_weight)[3]; /* nmm: few_weight[n_fixed]                          */
    GLuint timer;            /* query object, 0 if there are no timers            */
    dif_eval_cost cost;      /* of the call that is going on                      */
} dif_gpu_eval;

/* ---- gpu_eval_lists.c: numbers for the lists ---- */

/* Splits a number so that hi has 12 significant bits and lo is the rest. */
void dif_eval_pair(double x, float pair[2]);

/* Makes and fills the list textures of an evaluator; uploads one. */
DIF_MUST_USE dif_status dif_eval_lists_create(dif_gpu_eval *eval, dif_error *err);
void dif_eval_list_upload(dif_gpu_eval *eval, const dif_gl_texture *list, size_t n_pair, const float *pairs);

/* Entry i of `pairs`: a direction pair; a query, whose coordinates are kappa. */
void dif_eval_put_direction(dif_gpu_eval *eval, size_t i, dif_vec3 wi, dif_vec3 wo, double azimuth_rad);
void dif_eval_put_query(dif_gpu_eval *eval, size_t i, const dif_query *query);

/* Fills `waves` for a sheet (NULL: none): n wavelengths, with the weights of colours if there are any; nmm's own if n is 0;
 * or the one entry that values need. */
void dif_eval_waves_of(dif_gpu_eval *eval, const dif_sheet *sheet, int n, const double *lambda_um, double (*weight)[3]);
void dif_eval_waves_of_few(dif_gpu_eval *eval, const dif_sheet *sheet);
void dif_eval_waves_of_values(dif_gpu_eval *eval, const dif_sheet *sheet);

/* Fills `asked` with the wavelengths of a table. */
void dif_eval_asks_of(dif_gpu_eval *eval, int n, const double *lambda_um);

/* ---- gpu_eval_sheets.c: planes ---- */

/* Slots for the sheets. Status as dif_gl_texture_create; DIF_ERR_UNSUPPORTED. */
DIF_MUST_USE dif_status dif_eval_sheets_create(dif_gpu_eval *eval, dif_error *err);

/* Sees to it that the slots hold sheets first ... first + n_slot - 1. */
DIF_MUST_USE dif_status dif_eval_sheets_load(dif_gpu_eval *eval, int first, dif_error *err);

/* DIF_OK if every sheet holds what will be read, else DIF_ERR_ARG. */
DIF_MUST_USE dif_status dif_eval_sheets_cover(const dif_gpu_eval *eval, const dif_eval_reach *reach, dif_error *err);

/* ---- gpu_eval_shadow.c ---- */

/* The shadowing that a model's shader computes: none for powers. */
dif_shadowing dif_eval_shadowing(const dif_model *model);

/* The Cholesky factor of a covariance: root[0 ... 2], as dif_shadow_place wants it. */
void dif_shadow_root(const dif_slope_gauss *slopes, float root[4]);

/* A shadowing's table as a texture, and dif_shadow_root of its slopes.
 * Status    as dif_gl_texture_create;  *out stays zeroed for kinds without a table */
DIF_MUST_USE dif_status dif_shadow_texture_create(dif_gpu *gpu, const dif_shadow *shadow, dif_gl_texture *out,
                                                  float root[4], dif_error *err);

/* ---- gpu_eval_run.c ---- */

double dif_eval_now_s(void);

/* The program of a job, made if it is not there yet. */
DIF_MUST_USE dif_status dif_eval_program(dif_gpu_eval *eval, int job, dif_error *err);

/* Runs a job over nx x ny texels into result[to]; `before` reads the other one. */
DIF_MUST_USE dif_status dif_eval_dispatch(dif_gpu_eval *eval, int job, int nx, int ny, int to, dif_error *err);

/* result[from] into `texels`. */
DIF_MUST_USE dif_status dif_eval_fetch(dif_gpu_eval *eval, int nx, int ny, int from, dif_error *err);

/* ---- gpu_eval_pass.c ---- */

/* One pass: what the shader counts, and how big its result is. */
typedef struct dif_eval_pass {
    int job;
    int n;        /* items: queries, angles or directions                                  */
    int nx, ny;   /* texels                                                                */
    int n_lambda; /* table: wavelengths of this pass; colours by full sampling: all        */
    const double *lambda_um;
} dif_eval_pass;

/* Runs a pass over the sheets in the slots, first ... first + n_slot - 1 of the model; the sum comes back in `texels`. */
DIF_MUST_USE dif_status dif_eval_run_pass(dif_gpu_eval *eval, const dif_eval_pass *ps, int first, dif_error *err);

/* ---- gpu_eval_calls.c: of dif_evaluator ---- */

dif_status dif_eval_values(void *self, size_t n, const dif_query *query, double *value, dif_eval_cost *cost,
                           dif_error *err);
dif_status dif_eval_table(void *self, const dif_plan *plan, double *value, dif_eval_cost *cost, dif_error *err);
dif_status dif_eval_colours(void *self, size_t n, const dif_vec3 *wi, const dif_vec3 *wo, double (*xyz)[3],
                            dif_eval_cost *cost, dif_error *err);

/* ---- gpu_eval_lut.c ---- */

/* The table as a texture: 3 K numbers a place, four to a texel; shape[4] and more[2] are what dif_lut_colour wants.
 * half: half floats, scaled by a power of two so that small numbers keep their digits; else floats where they can be
 * filtered.
 * Status    DIF_ERR_SIZE: more columns or rows than a texture may have, with both numbers; DIF_ERR_NOMEM, DIF_ERR_FOREIGN
 * Owns      the caller deletes the texture */
DIF_MUST_USE dif_status dif_lut_texture_create(dif_gpu *gpu, const dif_lut *lut, bool half, dif_gl_texture *out,
                                               float shape[4], float more[2], dif_error *err);

#endif
