/* The evaluator's life; its calls are in gpu_eval_calls.c. */
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/sheet_impl.h"
#include "gpu/gpu_eval_impl.h"

dif_gpu_eval_opts dif_gpu_eval_opts_default(void)
{
    return (dif_gpu_eval_opts){
        .path = DIF_GPU_COMPUTE, .fault = DIF_GPU_FAULT_NONE, .half = false, .budget_bytes = (size_t)1 << 30};
}

static void gpu_close(void *self)
{
    enum { N_TEXTURE = 8 };
    dif_gpu_eval *eval = self;
    if (!eval)
        return;
    if (dif_gpu_begin(eval->gpu, NULL) == DIF_OK) {
        dif_gl_texture *const textures[N_TEXTURE] = {&eval->directions, &eval->waves,   &eval->asked, &eval->spectrum,
                                                     &eval->maps,       &eval->masking, eval->result, eval->result + 1};
        for (int i = 0; i < N_TEXTURE; i++)
            dif_gl_texture_delete(eval->gpu, textures[i]);
        for (int i = 0; i < eval->n_slot; i++)
            dif_gl_texture_delete(eval->gpu, eval->slot + i);
        for (int i = 0; i < DIF_EVAL_JOBS; i++)
            dif_gl_program_delete(eval->gpu, eval->program + i);
        dif_gl_block_delete(eval->gpu, &eval->block);
        if (eval->timer)
            glDeleteQueries(1, &eval->timer);
    }
    void *const blocks[] = {eval->source, eval->slot,    eval->pairs,  eval->wave_pairs, eval->ask_pairs,
                            eval->texels, eval->staging, eval->weight, eval->few_um,     eval->few_weight};
    for (int i = 0; i < (int)(sizeof blocks / sizeof *blocks); i++)
        dif_release(blocks[i]);
    dif_release(eval);
}

static dif_status create_results(dif_gpu_eval *eval, dif_error *err)
{
    const dif_gl_texture wanted = {.target = GL_TEXTURE_2D,
                                   .format = GL_RGBA32F,
                                   .nx = DIF_EVAL_SIDE,
                                   .ny = DIF_EVAL_SIDE,
                                   .n_layer = 1,
                                   .n_level = 1};
    dif_status status = DIF_OK;
    for (int i = 0; i < 2 && status == DIF_OK; i++)
        status = dif_gl_texture_create(eval->gpu, "results", &wanted, eval->result + i, err);
    eval->texels = dif_alloc((size_t)DIF_EVAL_SIDE * DIF_EVAL_SIDE * 4, sizeof *eval->texels);
    eval->source = dif_alloc(1, sizeof *eval->source);
    if (status == DIF_OK && (!eval->texels || !eval->source))
        status = dif_fail(err, DIF_ERR_NOMEM, "no memory for results");
    return status;
}

static dif_status create(dif_gpu_eval *eval, dif_error *err)
{
    const dif_model *model = eval->model;
    dif_status status = dif_gpu_begin(eval->gpu, err);
    if (status == DIF_OK)
        status = create_results(eval, err);
    if (status == DIF_OK)
        status = dif_eval_lists_create(eval, err);
    if (status == DIF_OK && eval->has_sheets)
        status = dif_eval_sheets_create(eval, err);
    if (status == DIF_OK && dif_eval_shadowing(model) != DIF_SHADOWING_NONE)
        status = dif_shadow_texture_create(eval->gpu, model->shadow, &eval->masking, eval->root, err);
    if (status == DIF_OK && model->kind == DIF_MODEL_LUT) {
        status = dif_lut_texture_create(eval->gpu, model->lut, eval->opts.half, &eval->maps, eval->lut_params.shape,
                                        eval->lut_params.more, err);
        eval->lut_params.more[2] = (float)model->index.n;
        eval->lut_params.more[3] = (float)model->index.kappa;
        memcpy(eval->lut_params.root, eval->root, sizeof eval->root);
    }
    if (status != DIF_OK)
        return status;
    eval->block = dif_gl_block_create(eval->gpu, sizeof eval->params);
    if (eval->gpu->info.timer && !eval->gpu->info.software) /* llvmpipe's leave compute shaders out */
        glGenQueries(1, &eval->timer);
    return dif_gpu_check(eval->gpu, "making an evaluator", err);
}

static dif_status check_opts(const dif_gpu_eval_opts *opts, dif_error *err)
{
    if (!(opts->path == DIF_GPU_COMPUTE || opts->path == DIF_GPU_FRAGMENT))
        return dif_fail(err, DIF_ERR_ARG, "path %d is none", (int)opts->path);
    if (!((int)opts->fault >= DIF_GPU_FAULT_NONE && opts->fault <= DIF_GPU_FAULT_TAP))
        return dif_fail(err, DIF_ERR_ARG, "fault %d is none", (int)opts->fault);
    return DIF_OK;
}

dif_status dif_gpu_evaluator_open(dif_gpu *gpu, const dif_model *model, const dif_gpu_eval_opts *opts,
                                  dif_evaluator *out, dif_error *err)
{
    const dif_gpu_eval_opts defaults = dif_gpu_eval_opts_default();
    *out = (dif_evaluator){0};
    dif_status status = dif_model_check(model, err);
    if (status == DIF_OK && opts)
        status = check_opts(opts, err);
    if (status != DIF_OK)
        return status;
    dif_gpu_eval *eval = dif_alloc(1, sizeof *eval);
    if (!eval)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for an evaluator");
    eval->gpu = gpu;
    eval->model = model;
    eval->opts = opts ? *opts : defaults;
    eval->has_sheets = model->kind != DIF_MODEL_STAM && model->kind != DIF_MODEL_LUT;
    eval->is_line = eval->has_sheets && model->sheet[0]->is_line;
    snprintf(eval->name, sizeof eval->name, "%s, %s", gpu->info.renderer,
             eval->opts.path == DIF_GPU_COMPUTE ? "compute" : "fragment");
    status = create(eval, err);
    if (status != DIF_OK) {
        gpu_close(eval);
        return status;
    }
    *out = (dif_evaluator){eval->name, eval, dif_eval_values, dif_eval_table, dif_eval_colours, gpu_close};
    return DIF_OK;
}
