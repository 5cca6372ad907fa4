#include "core/shade.h"

#include <math.h>

#include "core/alloc.h"
#include "core/colour.h"

enum { PAIRS = 1 << 16 };

dif_shade_opts dif_shade_opts_default(void)
{
    return (dif_shade_opts){.n_sub = 1, .cos_min = 0.01};
}

dif_status dif_frame_create(int nx, int ny, dif_frame *out, dif_error *err)
{
    *out = (dif_frame){0};
    if (!(nx >= 1 && ny >= 1 && nx <= DIF_FRAME_SIDE_MAX && ny <= DIF_FRAME_SIDE_MAX))
        return dif_fail(err, DIF_ERR_SIZE, "a picture of %d x %d pixels, want 1 ... %d a side", nx, ny,
                        DIF_FRAME_SIDE_MAX);
    const size_t n = (size_t)nx * (size_t)ny;
    *out = (dif_frame){.nx = nx, .ny = ny};
    out->light = dif_alloc(3 * n, sizeof *out->light);
    out->base = dif_alloc(3 * n, sizeof *out->base);
    out->coverage = dif_alloc(n, sizeof *out->coverage);
    if (out->light && out->base && out->coverage)
        return DIF_OK;
    dif_frame_free(out);
    return dif_fail(err, DIF_ERR_NOMEM, "a picture of %d x %d pixels", nx, ny);
}

void dif_frame_free(dif_frame *frame)
{
    dif_release(frame->light);
    dif_release(frame->base);
    dif_release(frame->coverage);
    *frame = (dif_frame){0};
}

/* Direction pairs on their way through the evaluator. */
typedef struct batch {
    const dif_evaluator *evaluator;
    dif_frame *frame;
    dif_eval_cost *cost;
    int n;
    dif_vec3 *wi, *wo; /* [PAIRS], as all here */
    double *factor;    /* shadowing over samples of a pixel */
    size_t *pixel;
    double (*xyz)[3];
} batch;

static void batch_free(batch *b)
{
    dif_release(b->wi);
    dif_release(b->wo);
    dif_release(b->factor);
    dif_release(b->pixel);
    dif_release(b->xyz);
}

static dif_status batch_create(batch *b, dif_error *err)
{
    b->wi = dif_alloc(PAIRS, sizeof *b->wi);
    b->wo = dif_alloc(PAIRS, sizeof *b->wo);
    b->factor = dif_alloc(PAIRS, sizeof *b->factor);
    b->pixel = dif_alloc(PAIRS, sizeof *b->pixel);
    b->xyz = dif_alloc(PAIRS, sizeof *b->xyz);
    return b->wi && b->wo && b->factor && b->pixel && b->xyz
               ? DIF_OK
               : dif_fail(err, DIF_ERR_NOMEM, "%d direction pairs", (int)PAIRS);
}

static dif_status flush(batch *b, dif_error *err)
{
    dif_eval_cost cost = {0};
    if (b->n == 0)
        return DIF_OK;
    const dif_status status = b->evaluator->colours(b->evaluator->self, (size_t)b->n, b->wi, b->wo, b->xyz, &cost, err);
    if (status)
        return status;
    for (int i = 0; i < b->n; i++) {
        double rgb[3];
        dif_colour_rgb_from_xyz(b->xyz[i], rgb);
        for (int c = 0; c < 3; c++)
            b->frame->light[3 * b->pixel[i] + (size_t)c] += (float)(b->factor[i] * rgb[c]);
    }
    b->n = 0;
    b->cost->upload_s += cost.upload_s;
    b->cost->run_s += cost.run_s;
    b->cost->download_s += cost.download_s;
    return DIF_OK;
}

/* The diffuse colour at a hit, without the lights. */
static void base_of(const dif_scene *scene, const dif_hit *hit, double rgb[3])
{
    if (scene->base)
        dif_texture_read(scene->base, hit->uv, rgb);
    for (int c = 0; c < 3 && !scene->base; c++)
        rgb[c] = scene->base_rgb[c];
}

/* One sample of a pixel: its base, and its direction pairs. */
static dif_status add_sample(const dif_scene *scene, const dif_shade_opts *opts, const dif_hit *hit, size_t pixel,
                             batch *b, dif_error *err)
{
    const double share = 1.0 / (opts->n_sub * opts->n_sub);
    const dif_vec3 wo = dif_frame3_local(&hit->frame, hit->to_eye);
    double rgb[3];
    base_of(scene, hit, rgb);
    b->frame->coverage[pixel] += (float)share;
    for (int i = 0; i < scene->n_light; i++) {
        const dif_vec3 wi = dif_frame3_local(&hit->frame, scene->light[i]);
        for (int c = 0; c < 3; c++)
            b->frame->base[3 * pixel + (size_t)c] += (float)(share * fmax(wi.z, 0.0) * rgb[c]);
        if (!(wi.z > opts->cos_min && wo.z > opts->cos_min))
            continue;
        if (b->n == PAIRS) {
            const dif_status status = flush(b, err);
            if (status)
                return status;
        }
        b->wi[b->n] = wi;
        b->wo[b->n] = wo;
        b->factor[b->n] = share * dif_shadow_factor(opts->shadow, wi, wo);
        b->pixel[b->n++] = pixel;
    }
    return DIF_OK;
}

static dif_status add_samples(const dif_scene *scene, const dif_shade_opts *opts, const dif_gbuffer *gbuffer, batch *b,
                              dif_error *err)
{
    dif_status status = DIF_OK;
    for (int iy = 0; iy < gbuffer->ny && !status; iy++)
        for (int ix = 0; ix < gbuffer->nx && !status; ix++) {
            dif_hit hit;
            if (dif_raster_hit(scene, gbuffer, ix, iy, &hit))
                status = add_sample(scene, opts, &hit, (size_t)iy * (size_t)gbuffer->nx + (size_t)ix, b, err);
        }
    return status;
}

static dif_status draw(const dif_scene *scene, const dif_shade_opts *opts, dif_gbuffer *gbuffer, batch *b,
                       dif_error *err)
{
    const int n = opts->n_sub;
    dif_status status = DIF_OK;
    for (int k = 0; k < n * n && !status; k++) {
        const dif_subsample sample = {.n = n, .i = k % n, .j = k / n, .jitter = opts->jitter};
        status = dif_raster_draw(scene, &sample, gbuffer, err);
        if (!status)
            status = add_samples(scene, opts, gbuffer, b, err);
        if (!status)
            status = flush(b, err);
        if (opts->progress)
            opts->progress(opts->progress_self, (k + 1.0) / (n * n));
    }
    return status;
}

dif_status dif_shade_draw(const dif_scene *scene, const dif_evaluator *evaluator, const dif_shade_opts *opts,
                          dif_frame *frame, dif_eval_cost *cost, dif_error *err)
{
    const dif_shade_opts how = opts ? *opts : dif_shade_opts_default();
    const size_t n = (size_t)frame->nx * (size_t)frame->ny;
    dif_eval_cost sum = {0};
    dif_gbuffer gbuffer = {0};
    batch b = {.evaluator = evaluator, .frame = frame, .cost = &sum};
    if (!(how.n_sub >= 1 && how.n_sub <= DIF_SUBSAMPLE_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d x %d samples a pixel, want 1 ... %d a side", how.n_sub, how.n_sub,
                        DIF_SUBSAMPLE_MAX);
    if (!(how.cos_min > 0.0 && how.cos_min < 1.0))
        return dif_fail(err, DIF_ERR_ARG, "smallest cosine %g, want 0 < cosine < 1", how.cos_min);
    for (size_t i = 0; i < 3 * n; i++)
        frame->light[i] = frame->base[i] = 0.0F;
    for (size_t i = 0; i < n; i++)
        frame->coverage[i] = 0.0F;
    dif_status status = dif_gbuffer_create(frame->nx, frame->ny, &gbuffer, err);
    if (!status)
        status = batch_create(&b, err);
    if (!status)
        status = draw(scene, &how, &gbuffer, &b, err);
    if (cost)
        *cost = sum;
    batch_free(&b);
    dif_gbuffer_free(&gbuffer);
    return status;
}

double dif_frame_exposure(const dif_frame *frame, double share)
{
    enum { LEVELS = 8000, PER_E = 100 }; /* of 1 % */
    const size_t n = (size_t)frame->nx * (size_t)frame->ny;
    double n_covered = 0.0, n_lit = 0.0, n_above = 0.0, count[LEVELS] = {0.0};
    for (size_t i = 0; i < n; i++) {
        const float *rgb = frame->light + 3 * i;
        const double level = (double)fmaxf(rgb[0], fmaxf(rgb[1], rgb[2])), bin = PER_E * log(level) + 0.5 * LEVELS;
        n_covered += frame->coverage[i] > 0.0F;
        if (!(level > 0.0 && bin >= 0.0 && bin < LEVELS))
            continue;
        count[(int)bin] += 1.0;
        n_lit += 1.0;
    }
    const double n_white = share * (n_lit < 2.0 * share * n_covered ? n_lit : n_covered);
    int bin = LEVELS;
    while (bin > 0 && n_above <= n_white)
        n_above += count[--bin];
    return n_lit > 0.0 ? exp((0.5 * LEVELS - bin) / PER_E) : 1.0;
}
