/* What the files of the renderer share. Not installed. */
#ifndef DIF_GPU_RENDER_IMPL_H
#define DIF_GPU_RENDER_IMPL_H

#include <stddef.h>

#include "core/shared.h"
#include "gpu/gl_program.h"
#include "gpu/gl_texture.h"
#include "gpu/gpu_render.h"

/* Parameters of mesh_block.glsl, std140. */
typedef struct dif_render_block {
    float row[3][4], shift[4], eye[4], light[DIF_RENDER_LIGHTS][4], shape[4], more[4], look[4], base[4], root[4];
    int job[4], size[4];
    float relief[4], blur[4], extra[4], spot[DIF_RENDER_MAPS][4];
} dif_render_block;

_Static_assert(DIF_RENDER_LIGHTS == DIF_LIGHT_MAX && DIF_RENDER_MAPS == DIF_LUT_MAP_MAX, "core/shared.h");
_Static_assert(DIF_RELIEF_PROBES == DIF_MESO_PROBES && DIF_BLUR_PROBES == DIF_LUT_FILTER_PROBES, "core/shared.h");
_Static_assert(DIF_FILTER_NONE == DIF_FILTER_IS_NONE && DIF_FILTER_MIP == DIF_FILTER_IS_MIP &&
                   DIF_FILTER_SLOPES == DIF_FILTER_IS_SLOPES,
               "core/shared.h");
_Static_assert(offsetof(dif_render_block, light) == 80 &&
                   offsetof(dif_render_block, job) == 80 + 16 * (DIF_LIGHT_MAX + 5),
               "std140");

/* The sources of its program: vertex and fragment shader. */
void dif_render_source_make(dif_gl_shader shader[2]);

/* The mesh on the GPU. */
typedef struct dif_gl_mesh {
    GLuint vertices, indices, array;
    int n_index;
} dif_gl_mesh;

/* Status DIF_ERR_NOMEM, DIF_ERR_FOREIGN. */
DIF_MUST_USE dif_status dif_gl_mesh_create(dif_gpu *gpu, const dif_mesh *mesh, dif_gl_mesh *out, dif_error *err);
void dif_gl_mesh_delete(dif_gpu *gpu, dif_gl_mesh *mesh);

/* Loads what the filter of opts needs, unless it is there. Status as dif_gl_texture_create. */
struct dif_gpu_renderer;
DIF_MUST_USE dif_status dif_gpu_render_load_filter(struct dif_gpu_renderer *renderer, const dif_shade_opts *opts,
                                                   dif_error *err);

struct dif_gpu_renderer {
    dif_gpu *gpu;
    char name[224];
    GLuint program, block, frame;
    dif_gl_mesh mesh;
    dif_gl_texture maps, masking, albedo, relief, product, pyramid;
    const dif_meso *meso;              /* that relief and product hold; NULL: none */
    const dif_lut_filter *blurred;     /* that pyramid holds                       */
    float *weight;                     /* weight[ny*nx] of the last frame's size   */
    dif_gl_texture light, base, depth; /* what is drawn into, of the last frame's size */
    dif_render_block params;
    float *texels; /* texels[ny*nx][4] of that size */
};

#endif
