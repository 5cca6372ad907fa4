/* What the files of shade share. Not installed. */
#ifndef DIF_SHADE_IMPL_H
#define DIF_SHADE_IMPL_H

#include "core/shade.h"

/* One sample of a pixel, ready to be lit. */
typedef struct dif_shade_sample {
    double weight; /* share of the pixel times how much of the facet is seen */
    dif_frame3 frame;
    dif_vec3 wo;    /* in the frame                                           */
    double blur[3]; /* slopes: variances and covariance along the frame       */
    double base[3]; /* albedo                                                 */
    int n_relief;   /* reads of the mesostructure                             */
} dif_shade_sample;

/* What is seen at a hit through a filter. */
void dif_shade_look(const dif_scene *scene, const dif_shade_opts *opts, const dif_hit *hit, dif_shade_sample *out);

/* Colour of one light on it by the filter `slopes`, shadowing included. Returns the number of places of the table. */
int dif_shade_blurred(const dif_shade_opts *opts, const dif_shade_sample *sample, dif_vec3 wi, double xyz[3]);

#endif
