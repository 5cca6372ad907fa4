#include "gpu/gl_texture.h"

static GLenum channels_of(GLenum format)
{
    switch (format) {
    case GL_R32F:
        return GL_RED;
    case GL_RG32F:
        return GL_RG;
    default:
        return GL_RGBA;
    }
}

static dif_status check_limits(const dif_gpu *gpu, const char *what, const dif_gl_texture *wanted, dif_error *err)
{
    if (!(wanted->nx >= 1 && wanted->ny >= 1 && wanted->n_layer >= 1))
        return dif_fail(err, DIF_ERR_ARG, "%s: a texture of %d x %d x %d", what, wanted->nx, wanted->ny,
                        wanted->n_layer);
    if (wanted->nx > gpu->info.texture_max || wanted->ny > gpu->info.texture_max)
        return dif_fail(err, DIF_ERR_SIZE, "%s needs a texture of %d x %d, and the GPU's largest side is %d", what,
                        wanted->nx, wanted->ny, gpu->info.texture_max);
    if (wanted->n_layer > gpu->info.layers_max)
        return dif_fail(err, DIF_ERR_SIZE, "%s needs a texture of %d layers, and the GPU has at most %d", what,
                        wanted->n_layer, gpu->info.layers_max);
    return DIF_OK;
}

dif_status dif_gl_texture_create(dif_gpu *gpu, const char *what, const dif_gl_texture *wanted, dif_gl_texture *out,
                                 dif_error *err)
{
    *out = (dif_gl_texture){0};
    dif_status status = check_limits(gpu, what, wanted, err);
    if (status != DIF_OK)
        return status;
    dif_gl_texture made = *wanted;
    glGenTextures(1, &made.id);
    gpu->n_live++;
    glBindTexture(made.target, made.id);
    if (made.target == GL_TEXTURE_2D_ARRAY)
        glTexStorage3D(made.target, made.n_level, made.format, made.nx, made.ny, made.n_layer);
    else
        glTexStorage2D(made.target, made.n_level, made.format, made.nx, made.ny);
    glTexParameteri(made.target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(made.target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(made.target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(made.target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    status = dif_gpu_check(gpu, what, err);
    if (status != DIF_OK) {
        dif_gl_texture_delete(gpu, &made);
        return status;
    }
    *out = made;
    return DIF_OK;
}

void dif_gl_texture_delete(dif_gpu *gpu, dif_gl_texture *texture)
{
    if (texture->id) {
        glDeleteTextures(1, &texture->id);
        gpu->n_live--;
    }
    *texture = (dif_gl_texture){0};
}

void dif_gl_texture_filter(const dif_gl_texture *texture, GLint wrap_s, GLint wrap_t)
{
    glBindTexture(texture->target, texture->id);
    glTexParameteri(texture->target, GL_TEXTURE_MIN_FILTER, texture->n_level > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
    glTexParameteri(texture->target, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(texture->target, GL_TEXTURE_WRAP_S, wrap_s);
    glTexParameteri(texture->target, GL_TEXTURE_WRAP_T, wrap_t);
}

void dif_gl_texture_store(const dif_gl_texture *texture, const dif_gl_box *box, int row_texels, const float *data)
{
    const GLenum channels = channels_of(texture->format);
    glBindTexture(texture->target, texture->id);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, row_texels);
    if (texture->target == GL_TEXTURE_2D_ARRAY)
        glTexSubImage3D(texture->target, 0, box->x, box->y, box->layer, box->nx, box->ny, box->n_layer, channels,
                        GL_FLOAT, data);
    else
        glTexSubImage2D(texture->target, 0, box->x, box->y, box->nx, box->ny, channels, GL_FLOAT, data);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

void dif_gl_texture_bind(const dif_gl_texture *texture, int unit)
{
    glActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    glBindTexture(texture->target, texture->id);
    glActiveTexture(GL_TEXTURE0);
}

dif_status dif_gl_texture_target(dif_gpu *gpu, const dif_gl_texture *texture, dif_error *err)
{
    glBindFramebuffer(GL_FRAMEBUFFER, gpu->frame);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture->id, 0);
    const GLenum state = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (state != GL_FRAMEBUFFER_COMPLETE)
        return dif_fail(err, DIF_ERR_FOREIGN, "the GPU cannot draw into floats: framebuffer status 0x%x",
                        (unsigned)state);
    return DIF_OK;
}

dif_status dif_gl_texture_read(dif_gpu *gpu, const dif_gl_texture *texture, int nx, int ny, float *rgba, dif_error *err)
{
    const dif_status status = dif_gl_texture_target(gpu, texture, err);
    if (status != DIF_OK)
        return status;
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, nx, ny, GL_RGBA, GL_FLOAT, rgba);
    return dif_gpu_check(gpu, "reading results", err);
}
