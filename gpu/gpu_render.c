/* The real-time renderer: what is loaded once. Drawing is gpu_render_draw.c. */
#include <stdio.h>

#include "core/alloc.h"
#include "gpu/gpu_eval_impl.h"
#include "gpu/gpu_render_impl.h"

dif_gpu_render_opts dif_gpu_render_opts_default(void)
{
    return (dif_gpu_render_opts){.half = false};
}

void dif_render_source_make(dif_gl_shader shader[2])
{
    static const char *const VERTEX[] = {"prelude.glsl", "shared.h", "mesh_block.glsl", "mesh.vert"};
    static const char *const FRAGMENT[] = {"prelude.glsl", "shared.h",        "eval.glsl",
                                           "shadow.glsl",  "colour.glsl",     "slope.glsl",
                                           "filter.glsl",  "mesh_block.glsl", "mesh.frag"};
    shader[0] = (dif_gl_shader){.stage = GL_VERTEX_SHADER};
    shader[1] = (dif_gl_shader){.stage = GL_FRAGMENT_SHADER};
    for (size_t i = 0; i < sizeof VERTEX / sizeof *VERTEX; i++)
        dif_gl_shader_add(&shader[0], dif_shader_part(VERTEX[i]));
    for (size_t i = 0; i < sizeof FRAGMENT / sizeof *FRAGMENT; i++)
        dif_gl_shader_add(&shader[1], dif_shader_part(FRAGMENT[i]));
}

static dif_status make_program(dif_gpu_renderer *out, dif_error *err)
{
    static const char *const SAMPLERS[] = {"maps", "masking", "albedo", "relief", "product", "pyramid"};
    dif_gl_shader shader[2];
    dif_render_source_make(shader);
    const dif_status status = dif_gl_program_create(out->gpu, 2, shader, &out->program, err);
    if (status != DIF_OK)
        return status;
    for (int i = 0; i < (int)(sizeof SAMPLERS / sizeof *SAMPLERS); i++)
        dif_gl_program_sampler(out->program, SAMPLERS[i], i);
    dif_gl_program_block(out->program, "dif_render", 0);
    out->block = dif_gl_block_create(out->gpu, sizeof out->params);
    glGenFramebuffers(1, &out->frame);
    out->gpu->n_live++;
    return dif_gpu_check(out->gpu, "setting up a renderer", err);
}

/* n places of `n_channel` floats as half-float RGBA, which every driver filters. */
static dif_status load_picture(dif_gpu *gpu, const char *what, int nx, int ny, int n_channel, const float *from,
                               GLint wrap_t, dif_gl_texture *out, dif_error *err)
{
    const size_t n = (size_t)nx * (size_t)ny;
    const dif_gl_texture wanted = {
        .target = GL_TEXTURE_2D, .format = GL_RGBA16F, .nx = nx, .ny = ny, .n_layer = 1, .n_level = 1};
    dif_status status = dif_gl_texture_create(gpu, what, &wanted, out, err);
    if (status != DIF_OK)
        return status;
    float *texels = dif_alloc(4 * n, sizeof *texels);
    if (!texels)
        return dif_fail(err, DIF_ERR_NOMEM, "%s of %d x %d texels", what, nx, ny);
    for (size_t i = 0; i < n; i++)
        for (int c = 0; c < 4; c++)
            texels[4 * i + (size_t)c] = c < n_channel ? from[(size_t)n_channel * i + (size_t)c] : 1.0f;
    const dif_gl_box box = {0, 0, 0, nx, ny, 1};
    dif_gl_texture_store(out, &box, 0, texels);
    dif_gl_texture_filter(out, GL_REPEAT, wrap_t);
    dif_release(texels);
    return dif_gpu_check(gpu, what, err);
}

static dif_status load_shadow(dif_gpu_renderer *out, const dif_shadow *shadow, dif_error *err)
{
    dif_render_block *p = &out->params;
    p->job[1] = shadow ? (int)shadow->kind : DIF_SHADOWING_IS_NONE;
    if (!shadow || shadow->n_row == 0)
        return DIF_OK;
    dif_shadow_root(&shadow->slopes, p->root);
    p->job[3] = shadow->n_column;
    p->size[0] = shadow->n_row;
    return load_picture(out->gpu, "a table of masking", shadow->n_column, shadow->n_row, 1, shadow->g, GL_CLAMP_TO_EDGE,
                        &out->masking, err);
}

static dif_status load(dif_gpu_renderer *out, const dif_lut *lut, dif_index index, const dif_mesh *mesh,
                       const dif_texture *base, const dif_shadow *shadow, bool half, dif_error *err)
{
    dif_render_block *p = &out->params;
    dif_status status = dif_lut_texture_create(out->gpu, lut, half, &out->maps, p->shape, p->more, err);
    p->more[2] = (float)index.n;
    p->more[3] = (float)index.kappa;
    p->job[2] = base != NULL;
    if (status == DIF_OK)
        status = dif_gl_mesh_create(out->gpu, mesh, &out->mesh, err);
    if (status == DIF_OK)
        status = load_shadow(out, shadow, err);
    if (status == DIF_OK && base)
        status =
            load_picture(out->gpu, "a base colour", base->nx, base->ny, 3, base->rgb, GL_REPEAT, &out->albedo, err);
    return status == DIF_OK ? make_program(out, err) : status;
}

dif_status dif_gpu_renderer_open(dif_gpu *gpu, const dif_lut *lut, dif_index index, const dif_mesh *mesh,
                                 const dif_texture *base, const dif_shadow *shadow, const dif_gpu_render_opts *opts,
                                 dif_gpu_renderer **out, dif_error *err)
{
    const dif_gpu_render_opts how = opts ? *opts : dif_gpu_render_opts_default();
    *out = NULL;
    dif_status status = dif_gpu_begin(gpu, err);
    if (status != DIF_OK)
        return status;
    dif_gpu_renderer *made = dif_alloc(1, sizeof *made);
    if (!made)
        return dif_fail(err, DIF_ERR_NOMEM, "a renderer");
    made->gpu = gpu;
    snprintf(made->name, sizeof made->name, "%s, fragment%s", gpu->info.renderer, how.half ? ", half" : "");
    status = load(made, lut, index, mesh, base, shadow, how.half, err);
    if (status != DIF_OK)
        dif_gpu_renderer_close(made);
    else
        *out = made;
    return status;
}

void dif_gpu_renderer_close(dif_gpu_renderer *renderer)
{
    if (!renderer)
        return;
    dif_gpu *gpu = renderer->gpu;
    if (dif_gpu_begin(gpu, NULL) == DIF_OK) {
        enum { N_TEXTURE = 9 };
        dif_gl_texture *const textures[N_TEXTURE] = {&renderer->maps,   &renderer->masking, &renderer->albedo,
                                                     &renderer->light,  &renderer->base,    &renderer->depth,
                                                     &renderer->relief, &renderer->product, &renderer->pyramid};
        for (int i = 0; i < N_TEXTURE; i++)
            dif_gl_texture_delete(gpu, textures[i]);
        dif_gl_mesh_delete(gpu, &renderer->mesh);
        dif_gl_program_delete(gpu, &renderer->program);
        dif_gl_block_delete(gpu, &renderer->block);
        if (renderer->frame) {
            glDeleteFramebuffers(1, &renderer->frame);
            gpu->n_live--;
        }
    }
    dif_release(renderer->texels);
    dif_release(renderer->weight);
    dif_release(renderer);
}

const char *dif_gpu_renderer_name(const dif_gpu_renderer *renderer)
{
    return renderer->name;
}
