/* What the filters of a rendering read: moments of the mesostructure, and the pyramid of the table, as mip-mapped textures. */
#include "core/alloc.h"
#include "gpu/gpu_render_impl.h"

/* Numbers of a half-float pyramid are scaled up by this: a table without its spot is far below 1. */
static const float HALF_SCALE = 1024.0f;

/* One level of a texture from a list of n_number numbers a texel: 4 from `first` on, or 1. */
static dif_status store_level(const dif_gl_texture *to, int level, int nx, int ny, int layer, const float *from,
                              size_t n_number, size_t first, float scale, dif_error *err)
{
    const size_t n = (size_t)nx * (size_t)ny, n_channel = to->format == GL_R32F ? 1 : 4;
    float *texels = dif_alloc(n * n_channel, sizeof *texels);
    if (!texels)
        return dif_fail(err, DIF_ERR_NOMEM, "a level of %d x %d texels", nx, ny);
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < n_channel; c++)
            texels[n_channel * i + c] = first + c < n_number ? scale * from[n_number * i + first + c] : 0.0f;
    const GLenum channels = n_channel == 1 ? GL_RED : GL_RGBA;
    glBindTexture(to->target, to->id);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    if (to->target == GL_TEXTURE_2D_ARRAY)
        glTexSubImage3D(to->target, level, 0, 0, layer, nx, ny, 1, channels, GL_FLOAT, texels);
    else
        glTexSubImage2D(to->target, level, 0, 0, nx, ny, channels, GL_FLOAT, texels);
    dif_release(texels);
    return DIF_OK;
}

static int side(int n, int level)
{
    return n >> level > 0 ? n >> level : 1;
}

static dif_status load_relief(dif_gpu_renderer *r, const dif_meso *meso, dif_error *err)
{
    const bool single = r->gpu->info.float_linear;
    const dif_gl_texture wanted = {.target = GL_TEXTURE_2D,
                                   .format = single ? GL_RGBA32F : GL_RGBA16F,
                                   .nx = meso->nx,
                                   .ny = meso->ny,
                                   .n_layer = 1,
                                   .n_level = meso->n_level};
    dif_gl_texture *const textures[2] = {&r->relief, &r->product};
    for (int i = 0; i < 2; i++) {
        dif_gl_texture_delete(r->gpu, textures[i]);
        dif_status status = dif_gl_texture_create(r->gpu, "a mesostructure", &wanted, textures[i], err);
        for (int level = 0; level < meso->n_level && status == DIF_OK; level++)
            status = store_level(textures[i], level, side(meso->nx, level), side(meso->ny, level), 0,
                                 meso->moment[level], DIF_MESO_MOMENTS, i == 0 ? 0 : 4, 1.0f, err);
        if (status != DIF_OK)
            return status;
        dif_gl_texture_filter(textures[i], GL_REPEAT, GL_REPEAT);
    }
    r->meso = meso;
    return dif_gpu_check(r->gpu, "loading a mesostructure", err);
}

static dif_status load_pyramid(dif_gpu_renderer *r, const dif_lut_filter *f, dif_error *err)
{
    const bool single = r->gpu->info.float_linear;
    const size_t n_number = 3 * (size_t)f->lut->n_map;
    const float scale = single ? 1.0f : HALF_SCALE;
    const dif_gl_texture wanted = {.target = GL_TEXTURE_2D_ARRAY,
                                   .format = single ? GL_RGBA32F : GL_RGBA16F,
                                   .nx = f->n,
                                   .ny = f->n,
                                   .n_layer = (int)((n_number + 3) / 4),
                                   .n_level = f->n_level};
    dif_gl_texture_delete(r->gpu, &r->pyramid);
    dif_status status = dif_gl_texture_create(r->gpu, "a blurred table", &wanted, &r->pyramid, err);
    for (int level = 0; level < f->n_level && status == DIF_OK; level++)
        for (int layer = 0; layer < wanted.n_layer && status == DIF_OK; layer++)
            status = store_level(&r->pyramid, level, f->n >> level, f->n >> level, layer, f->coef[level], n_number,
                                 4 * (size_t)layer, scale, err);
    if (status != DIF_OK)
        return status;
    dif_gl_texture_filter(&r->pyramid, GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE);
    r->params.extra[0] = 1.0f / scale;
    r->params.blur[0] = (float)f->n;
    r->params.blur[1] = (float)f->n_level;
    r->params.blur[2] = (float)f->spot_radius;
    r->params.blur[3] = (float)f->spot_variance;
    for (int n = 0; n < f->lut->n_map; n++)
        for (int c = 0; c < 3; c++)
            r->params.spot[n][c] = (float)f->spot[n][c];
    r->blurred = f;
    return dif_gpu_check(r->gpu, "loading a blurred table", err);
}

dif_status dif_gpu_render_load_filter(dif_gpu_renderer *r, const dif_shade_opts *opts, dif_error *err)
{
    dif_status status = DIF_OK;
    if (opts->meso && opts->meso != r->meso)
        status = load_relief(r, opts->meso, err);
    if (status == DIF_OK && opts->filter == DIF_FILTER_SLOPES && opts->blurred != r->blurred)
        status = load_pyramid(r, opts->blurred, err);
    r->params.size[1] = opts->filter != DIF_FILTER_MIP || opts->meso ? (int)opts->filter : DIF_FILTER_NONE;
    r->params.size[2] = opts->meso != NULL;
    if (opts->meso) {
        r->params.relief[0] = (float)opts->meso->nx;
        r->params.relief[1] = (float)opts->meso->ny;
        r->params.relief[2] = (float)opts->meso->n_level;
        r->params.relief[3] = (float)opts->meso->tiles;
    }
    return status;
}
