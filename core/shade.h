/* Pictures of a scene whose mesh wears a surface: per pixel and light, the evaluator's colour in the mesh's tangent frame.
 *
 *   radiance = sum over lights of XYZ(rho),  rho = f cos_i up to a constant (core/brdf.h): no further cosine
 *
 * With mesostructure (core/meso.h) the frame is tilted by its slopes, and samples of one pixel weigh as much as their facet
 * is seen: max(0, cos - s.v sin) / cos. What then happens within a pixel is the filter's:
 *   none    the slope in the middle of each sample: aliases, and is the truth if samples are many
 *   mip     the mean slope of the footprint: plain mip-mapping of normals
 *   slopes  mean and covariance of the slopes that are seen, from the moments in the footprint and the curvature of the
 *           mesh; the table is averaged over them (core/lut_filter.h)
 *
 * A light below the horizon gives nothing, a place that faces away stays dark. A diffuse base lies under it, albedo times
 * the sum of cos_i. The lights' colour is D65.
 * Does not: cast shadows, open files (core/io/frame_io.h). */
#ifndef DIF_SHADE_H
#define DIF_SHADE_H

#include "core/evaluator.h"
#include "core/lut_filter.h"
#include "core/meso.h"
#include "core/raster.h"
#include "core/shadow.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_SUBSAMPLE_MAX = 64 };

typedef enum dif_filter { DIF_FILTER_NONE, DIF_FILTER_MIP, DIF_FILTER_SLOPES } dif_filter;

typedef struct dif_shade_opts {
    int n_sub;     /* n x n samples a pixel, 1 ... DIF_SUBSAMPLE_MAX                                           */
    bool jitter;   /* samples at random places of their strata, else at the centres                            */
    uint32_t seed; /* of the jitter: another one is another, independent picture                       */
    const dif_shadow *shadow; /* shadowing and masking, or NULL: none; not owned                                  */
    dif_filter filter;
    const dif_meso *meso;          /* NULL: none; not owned                                                    */
    const dif_lut_filter *blurred; /* slopes: the table of the evaluator's model; not owned                    */
    dif_index index;               /* slopes: of the material                                                  */
    double cos_min; /* directions nearer to the horizon give nothing, in (0, 1): rho grows like 1 / cos_o there */
    struct dif_shade_reads *reads;              /* may be NULL                                                 */
    void (*progress)(void *self, double share); /* may be NULL; called from the calling thread */
    void *progress_self;
} dif_shade_opts;

/* One sample in the middle, no shadowing, no filter, cos_min 0.01. */
dif_shade_opts dif_shade_opts_default(void);

/* Places that were read, for the cost of a filter. */
typedef struct dif_shade_reads {
    double pixels;        /* samples with light                                        */
    double table, relief; /* places of the table and of the mesostructure, all samples */
} dif_shade_reads;

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

/* The frame of a hit tilted by slopes along its tangent and bitangent. */
dif_frame3 dif_shade_tilt(const dif_frame3 *frame, const double s[2]);

/* What a filter knows of a hit: the slopes in its footprint along the turned tangent and bitangent, those of the mesh's own
 * curvature among them. Returns the number of reads of the mesostructure. */
int dif_shade_slopes(const dif_scene *scene, const dif_meso *meso, const dif_hit *hit, dif_slope_gauss *out);

/* Draws a scene into a frame of wanted size.
 *
 * Given     evaluator  of a model whose quantity is rho; not asked by the filter `slopes`
 * Gives     *cost (may be NULL) the evaluator's, summed
 *           opts->reads is filled if it is not NULL
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
