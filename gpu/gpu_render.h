/* Pictures in real time: a mesh that wears a wavelength-integrated table, drawn by the GPU. The same pictures as
 * core/shade.h's with a lut evaluator, in float.
 * Does not: other methods (they go through core/shade.h with a GPU evaluator), casting shadows. */
#ifndef DIF_GPU_RENDER_H
#define DIF_GPU_RENDER_H

#include "core/shade.h"
#include "gpu/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dif_gpu_renderer dif_gpu_renderer;

typedef struct dif_gpu_render_opts {
    bool half; /* half-float texels, as a game would; else float where it can be filtered */
} dif_gpu_render_opts;

dif_gpu_render_opts dif_gpu_render_opts_default(void);

/* Loads a table and a mesh.
 *
 * Given     lut, mesh  copied to the GPU; base (may be NULL) likewise
 *           shadow     NULL: none; copied
 * Status    DIF_ERR_SIZE (a texture beyond the limit), DIF_ERR_NOMEM, DIF_ERR_FOREIGN; *out NULL on failure
 * Owns      the caller closes with dif_gpu_renderer_close, before the gpu */
DIF_MUST_USE dif_status dif_gpu_renderer_open(dif_gpu *gpu, const dif_lut *lut, dif_index index, const dif_mesh *mesh,
                                              const dif_texture *base, const dif_shadow *shadow,
                                              const dif_gpu_render_opts *opts, dif_gpu_renderer **out, dif_error *err);
void dif_gpu_renderer_close(dif_gpu_renderer *renderer);

/* "renderer, fragment"; lives as long as the renderer. */
const char *dif_gpu_renderer_name(const dif_gpu_renderer *renderer);

/* Draws a scene of the loaded mesh and base, n_sub x n_sub samples a pixel at the centres of their strata.
 *
 * Given     scene    as for dif_shade_draw; its mesh and base must be those that were loaded
 *           opts     n_sub, cos_min, filter, meso and blurred count; meso and blurred are loaded when they first come
 *                    (a `blurred` of the loaded table) and must not change while the renderer lives; no random samples
 * Gives     frame    of wanted size; cost (may be NULL)
 * Status    DIF_ERR_ARG, DIF_ERR_SIZE, DIF_ERR_NOMEM, DIF_ERR_FOREIGN */
DIF_MUST_USE dif_status dif_gpu_renderer_draw(dif_gpu_renderer *renderer, const dif_scene *scene,
                                              const dif_shade_opts *opts, dif_frame *frame, dif_eval_cost *cost,
                                              dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
