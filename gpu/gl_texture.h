/* Textures of floats: made within the driver's limits, filled, read back. Not installed. */
#ifndef DIF_GL_TEXTURE_H
#define DIF_GL_TEXTURE_H

#include <epoxy/gl.h>

#include "gpu/egl_ctx.h"

typedef struct dif_gl_texture {
    GLuint id;
    GLenum target;       /* GL_TEXTURE_2D or GL_TEXTURE_2D_ARRAY                                     */
    GLenum format;       /* GL_R32F, GL_RG32F, GL_RGBA32F, GL_RGBA16F; others can be made, not filled      */
    int nx, ny, n_layer; /* n_layer = 1 for GL_TEXTURE_2D                                            */
    int n_level;         /* of the mip pyramid                                                       */
} dif_gl_texture;

/* A box of texels. */
typedef struct dif_gl_box {
    int x, y, layer, nx, ny, n_layer;
} dif_gl_box;

/* Makes storage, filtered by nearest texel and clamped at the edges.
 * Status    DIF_ERR_SIZE: beyond the driver's limit, with both numbers; DIF_ERR_NOMEM, DIF_ERR_FOREIGN
 * Owns      the caller deletes with dif_gl_texture_delete; *out zeroed on failure */
DIF_MUST_USE dif_status dif_gl_texture_create(dif_gpu *gpu, const char *what, const dif_gl_texture *wanted,
                                              dif_gl_texture *out, dif_error *err);
void dif_gl_texture_delete(dif_gpu *gpu, dif_gl_texture *texture);

/* Linear filtering (between mip levels, too, if there are any); wrap_s, wrap_t: GL_REPEAT, GL_CLAMP_TO_EDGE. */
void dif_gl_texture_filter(const dif_gl_texture *texture, GLint wrap_s, GLint wrap_t);

/* Fills a box from floats, the format's channels side by side; rows of the source are row_texels apart (0: close). */
void dif_gl_texture_store(const dif_gl_texture *texture, const dif_gl_box *box, int row_texels, const float *data);

/* Makes it current on a unit. */
void dif_gl_texture_bind(const dif_gl_texture *texture, int unit);

/* Attaches layer 0 to the context's frame and makes the frame current. Status DIF_ERR_FOREIGN: it cannot be drawn into. */
DIF_MUST_USE dif_status dif_gl_texture_target(dif_gpu *gpu, const dif_gl_texture *texture, dif_error *err);

/* Reads nx x ny texels of a GL_RGBA32F texture from the lower left corner: rgba[ny][nx][4]. */
DIF_MUST_USE dif_status dif_gl_texture_read(dif_gpu *gpu, const dif_gl_texture *texture, int nx, int ny, float *rgba,
                                            dif_error *err);

#endif
