/* Pictures of a scene whose mesh wears a surface: per pixel and light, the evaluator's colour in the mesh's tangent frame.
 *
 *   radiance = sum over lights of XYZ(rho),  rho = f cos_i up to a constant (core/brdf.h): no further cosine
 *
 * A light below the horizon gives nothing, a place that faces away stays dark. A diffuse base lies under it, albedo times
 * the sum of cos_i. The lights' colour is D65.
 * Does not: cast shadows, open files (core/io/frame_io.h). */
#ifndef DIF_SHADE_H
#define DIF_SHADE_H

#include "core/evaluator.h"
#include "core/raster.h"
#include "core/shadow.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_SUBSAMPLE_MAX = 64 };

typedef struct dif_shade_opts {
    int n_sub;   /* n x n samples a pixel, 1 ... DIF_SUBSAMPLE_MAX                                           */
    bool jitter; /* samples at random places of their strata, else at the centres                            */
    const dif_shadow *shadow; /* shadowing and masking, or NULL: none; not owned                                  */
    double cos_min; /* directions nearer to the horizon give nothing, in (0, 1): rho grows like 1 / cos_o there */
    void (*progress)(void *self, double share); /* may be NULL; called from the calling thread */
    void *progress_self;
} dif_shade_opts;

/* One sample in the middle, no shadowing, cos_min 0.01. */
dif_shade_opts dif_shade_opts_default(void);

/* A picture, row 0 at the top, linear sRGB, not clipped. What is shown is exposure * light + base. */
typedef struct dif_frame {
    int nx, ny;
    float *light;    /* light[ny*nx][3] diffracted, a mirror under one light being 1; owned  */
    float *base;     /* base[ny*nx][3] diffuse; owned                                        */
    float *coverage; /* coverage[ny*nx]: share of a pixel's samples that see the mesh; owned */
} dif_frame;

/* Status DIF_ERR_SIZE, DIF_ERR_NOMEM. The caller frees with dif_frame_free. */
DIF_MUST_USE dif_status dif_frame_create(int nx, int ny, dif_frame *out, dif_error *err);
void dif_frame_free(dif_frame *frame);

/* Draws a scene into a frame of wanted size.
 *
 * Given     evaluator  of a model whose quantity is rho
 * Gives     *cost (may be NULL) the evaluator's, summed
 * Status    DIF_ERR_ARG, those of the evaluator, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_shade_draw(const dif_scene *scene, const dif_evaluator *evaluator,
                                       const dif_shade_opts *opts, dif_frame *frame, dif_eval_cost *cost,
                                       dif_error *err);

#define DIF_FRAME_EXPOSURE_SHARE 0.02

/* The exposure at which a share of the pixels that see the mesh are brighter than white (largest of R, G, B above 1), to
 * 1 %: the mirror's spot, small and many times brighter than the colours, does not count for more than its pixels. Of the
 * pixels that hold light at all if these are fewer than twice that; 1 for a dark frame. */
double dif_frame_exposure(const dif_frame *frame, double share);

#ifdef __cplusplus
}
#endif
#endif
