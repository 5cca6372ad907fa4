/* Which triangle a pixel sees: a rasteriser in homogeneous coordinates (no clipping needed), and what is there.
 * Does not: shade (core/shade.h). */
#ifndef DIF_RASTER_H
#define DIF_RASTER_H

#include <stdint.h>

#include "core/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where in a pixel the mesh is looked at: stratum (i, j) of n x n, at its centre or at a random place in it. */
typedef struct dif_subsample {
    int n, i, j;   /* n >= 1; 0 <= i, j < n */
    bool jitter;   /* random, but the same for the same pixel, stratum and seed */
    uint32_t seed; /* any                                                      */
} dif_subsample;

/* The pixel's centre. */
dif_subsample dif_subsample_centre(void);

/* What each pixel sees. */
typedef struct dif_gbuffer {
    int nx, ny;
    dif_subsample sample;
    dif_projection projection;
    int *triangle; /* triangle[ny*nx], -1 = none; owned   */
    float *depth;  /* depth[ny*nx] along the view axis; owned */
} dif_gbuffer;

/* Status DIF_ERR_SIZE, DIF_ERR_NOMEM. The caller frees with dif_gbuffer_free. */
DIF_MUST_USE dif_status dif_gbuffer_create(int nx, int ny, dif_gbuffer *out, dif_error *err);
void dif_gbuffer_free(dif_gbuffer *gbuffer);

/* Draws the scene's mesh. Status DIF_ERR_ARG (dif_scene_check), DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_raster_draw(const dif_scene *scene, const dif_subsample *sample, dif_gbuffer *gbuffer,
                                        dif_error *err);

/* The mesh at a pixel. */
typedef struct dif_hit {
    dif_vec3 position;
    dif_frame3 frame;              /* of the turned patch                                       */
    dif_vec3 to_eye;               /* unit                                                      */
    double uv[2];                  /* 0 without texture coordinates                             */
    double uv_dx[2], uv_dy[2];     /* change of uv per pixel to the right and per pixel DOWN    */
    dif_vec3 normal_dx, normal_dy; /* the same of the normal                                   */
    double depth;
} dif_hit;

/* False where the pixel sees nothing. */
bool dif_raster_hit(const dif_scene *scene, const dif_gbuffer *gbuffer, int ix, int iy, dif_hit *hit);

#ifdef __cplusplus
}
#endif
#endif
