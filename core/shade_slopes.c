/* What a pixel sees: slopes within it, and the table averaged over them. */
#include <math.h>

#include "core/brdf.h"
#include "core/shade_impl.h"

dif_frame3 dif_shade_tilt(const dif_frame3 *frame, const double s[2])
{
    dif_vec3 up = dif_vec3_add(frame->normal, -s[0], frame->tangent);
    up = dif_vec3_unit(dif_vec3_add(up, -s[1], frame->bitangent));
    const dif_vec3 along = dif_vec3_unit(dif_vec3_add(frame->tangent, s[0], frame->normal));
    return (dif_frame3){up, along, dif_vec3_cross(up, along)};
}

/* Slopes along the mesh's tangent and bitangent become those along the turned ones. */
static void turn(double c, double s, const double from[2], double to[2])
{
    to[0] = c * from[0] + s * from[1];
    to[1] = -s * from[0] + c * from[1];
}

static void turn_gauss(double groove_rad, dif_slope_gauss *g)
{
    const double c = cos(groove_rad), s = sin(groove_rad), mean[2] = {g->mean_x, g->mean_y};
    const double xx = g->var_x, yy = g->var_y, xy = g->cov_xy;
    double turned[2];
    turn(c, s, mean, turned);
    *g = (dif_slope_gauss){.mean_x = turned[0],
                           .mean_y = turned[1],
                           .var_x = fmax(c * c * xx + 2.0 * c * s * xy + s * s * yy, 0.0),
                           .var_y = fmax(s * s * xx - 2.0 * c * s * xy + c * c * yy, 0.0),
                           .cov_xy = c * s * (yy - xx) + (c * c - s * s) * xy};
}

/* Slopes that the curvature of the mesh spreads over a pixel: those of a parallelogram, each side even. */
static void add_curvature(const dif_hit *hit, dif_slope_gauss *g)
{
    const dif_vec3 change[2] = {hit->normal_dx, hit->normal_dy};
    for (int i = 0; i < 2; i++) {
        const double x = dif_vec3_dot(change[i], hit->frame.tangent), y = dif_vec3_dot(change[i], hit->frame.bitangent);
        g->var_x += x * x / 12.0;
        g->var_y += y * y / 12.0;
        g->cov_xy += x * y / 12.0;
    }
}

int dif_shade_slopes(const dif_scene *scene, const dif_meso *meso, const dif_hit *hit, dif_slope_gauss *out)
{
    int n = 0;
    *out = (dif_slope_gauss){.mean_x = 0.0};
    if (meso) {
        const dif_footprint footprint = {.w1 = {hit->uv_dx[0], hit->uv_dx[1]}, .w2 = {hit->uv_dy[0], hit->uv_dy[1]}};
        n = dif_meso_moments(meso, hit->uv, &footprint, out);
        turn_gauss(scene->groove_rad, out);
    }
    add_curvature(hit, out);
    return n;
}

/* Tilts a sample by slopes and takes the direction to the eye along. */
static void tilt(const dif_hit *hit, const double s[2], dif_shade_sample *out)
{
    out->frame = dif_shade_tilt(&hit->frame, s);
    out->wo = dif_frame3_local(&out->frame, hit->to_eye);
}

/* The filter `slopes`: visible slopes, their mean as the frame, their covariance as the blur. */
static void look_at_slopes(const dif_scene *scene, const dif_shade_opts *opts, const dif_hit *hit,
                           dif_shade_sample *out)
{
    const dif_vec3 wo = dif_frame3_local(&hit->frame, hit->to_eye);
    dif_slope_gauss g;
    out->n_relief = dif_shade_slopes(scene, opts->meso, hit, &g);
    if (wo.z > 0.0)
        g = dif_slope_visible_of(&g, acos(fmin(wo.z, 1.0)), atan2(wo.y, wo.x)).gauss;
    const double mean[2] = {g.mean_x, g.mean_y};
    tilt(hit, mean, out);
    out->blur[0] = g.var_x;
    out->blur[1] = g.var_y;
    out->blur[2] = g.cov_xy;
}

void dif_shade_look(const dif_scene *scene, const dif_shade_opts *opts, const dif_hit *hit, dif_shade_sample *out)
{
    *out = (dif_shade_sample){.weight = 1.0, .frame = hit->frame};
    out->wo = dif_frame3_local(&hit->frame, hit->to_eye);
    if (opts->filter == DIF_FILTER_SLOPES) {
        look_at_slopes(scene, opts, hit, out);
    } else if (opts->meso && opts->filter == DIF_FILTER_MIP) {
        dif_slope_gauss g;
        out->n_relief = dif_shade_slopes(scene, opts->meso, hit, &g);
        const double mean[2] = {g.mean_x, g.mean_y};
        tilt(hit, mean, out);
    } else if (opts->meso) {
        double s[2], turned[2];
        dif_meso_slope(opts->meso, hit->uv, s);
        out->n_relief = 1;
        turn(cos(scene->groove_rad), sin(scene->groove_rad), s, turned);
        const dif_vec3 wo = out->wo;
        out->weight = wo.z > 0.0 ? fmax(1.0 - (turned[0] * wo.x + turned[1] * wo.y) / wo.z, 0.0) : 0.0;
        tilt(hit, turned, out);
    }
}

int dif_shade_blurred(const dif_shade_opts *opts, const dif_shade_sample *sample, dif_vec3 wi, double xyz[3])
{
    const dif_vec3 q = dif_vec3_transfer(wi, sample->wo);
    const double w2 = q.z * q.z;
    const double cov[3] = {w2 * sample->blur[0], w2 * sample->blur[1], w2 * sample->blur[2]};
    const double gain =
        dif_brdf_gain_rho(opts->index, wi, sample->wo) * dif_shadow_factor(opts->shadow, wi, sample->wo);
    const int n = dif_lut_filter_eval(opts->blurred, q.x, q.y, q.z, cov, xyz);
    for (int c = 0; c < 3; c++)
        xyz[c] *= gain;
    return n;
}
