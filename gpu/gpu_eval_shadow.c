/* Shadowing as the shaders read it (gpu/shaders/shadow.glsl). */
#include <math.h>

#include "gpu/gpu_eval_impl.h"

_Static_assert(DIF_SHADOWING_NONE == DIF_SHADOWING_IS_NONE && DIF_SHADOWING_VCAVITY == DIF_SHADOWING_IS_VCAVITY,
               "core/shared.h");

dif_shadowing dif_eval_shadowing(const dif_model *model)
{
    return model->shadow && model->quantity != DIF_QUANTITY_POWER ? model->shadow->kind : DIF_SHADOWING_NONE;
}

void dif_shadow_root(const dif_slope_gauss *slopes, float root[4])
{
    const double along = sqrt(slopes->var_x), across = along > 0.0 ? slopes->cov_xy / along : 0.0;
    root[0] = (float)along;
    root[1] = (float)across;
    root[2] = (float)sqrt(fmax(slopes->var_y - across * across, 0.0));
    root[3] = 0.0f;
}

dif_status dif_shadow_texture_create(dif_gpu *gpu, const dif_shadow *shadow, dif_gl_texture *out, float root[4],
                                     dif_error *err)
{
    *out = (dif_gl_texture){0};
    if (shadow->n_row == 0)
        return DIF_OK;
    const dif_gl_texture wanted = {.target = GL_TEXTURE_2D,
                                   .format = GL_R32F,
                                   .nx = shadow->n_column,
                                   .ny = shadow->n_row,
                                   .n_layer = 1,
                                   .n_level = 1};
    const dif_gl_box whole = {0, 0, 0, wanted.nx, wanted.ny, 1};
    dif_status status = dif_gl_texture_create(gpu, "a table of masking", &wanted, out, err);
    if (status != DIF_OK)
        return status;
    dif_gl_texture_store(out, &whole, 0, shadow->g);
    dif_shadow_root(&shadow->slopes, root);
    status = dif_gpu_check(gpu, "loading a table of masking", err);
    if (status != DIF_OK)
        dif_gl_texture_delete(gpu, out);
    return status;
}
