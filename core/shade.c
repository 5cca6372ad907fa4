#include "core/shade.h"

#include <math.h>

#include "core/alloc.h"
#include "core/colour.h"
#include "core/shade_impl.h"

enum { PAIRS = 1 << 16 };

dif_shade_opts dif_shade_opts_default(void)
{
    return (dif_shade_opts){.n_sub = 1, .cos_min = 0.01, .index = dif_index_default()};
}

/* What one sample of one pixel comes to, before the evaluator has answered. */
typedef struct slot {
    size_t pixel;
    bool seen;
    double weight, base[3], rgb[3];
    double n_table, n_relief;
    int n_pair; /* that want to be evaluated */
    double factor[DIF_LIGHT_MAX];
    dif_vec3 wi[DIF_LIGHT_MAX], wo;
} slot;

/* A drawing in progress. */
typedef struct job {
    const dif_scene *scene;
    const dif_evaluator *evaluator;
    const dif_shade_opts *opts;
    dif_frame *frame;
    dif_gbuffer gbuffer;
    dif_eval_cost cost;
    dif_shade_reads reads;
    float *weight; /* weight[ny*nx]: of the samples so far, by how much of their facets is seen */
    int n_slot;    /* samples a batch */
    slot *slots;
    dif_vec3 *wi, *wo; /* [PAIRS], as below */
    double (*xyz)[3];
} job;

static void job_free(job *j)
{
    dif_gbuffer_free(&j->gbuffer);
    dif_release(j->weight);
    dif_release(j->slots);
    dif_release(j->wi);
    dif_release(j->wo);
    dif_release(j->xyz);
}

static dif_status job_create(job *j, dif_error *err)
{
    const size_t n = (size_t)j->frame->nx * (size_t)j->frame->ny;
    j->n_slot = PAIRS / j->scene->n_light;
    const dif_status status = dif_gbuffer_create(j->frame->nx, j->frame->ny, &j->gbuffer, err);
    if (status)
        return status;
    j->weight = dif_alloc(n, sizeof *j->weight);
    j->slots = dif_alloc((size_t)j->n_slot, sizeof *j->slots);
    j->wi = dif_alloc(PAIRS, sizeof *j->wi);
    j->wo = dif_alloc(PAIRS, sizeof *j->wo);
    j->xyz = dif_alloc(PAIRS, sizeof *j->xyz);
    return j->weight && j->slots && j->wi && j->wo && j->xyz
               ? DIF_OK
               : dif_fail(err, DIF_ERR_NOMEM, "%d direction pairs", (int)PAIRS);
}

/* The diffuse colour at a hit, without the lights. */
static void base_of(const dif_scene *scene, const dif_hit *hit, double rgb[3])
{
    if (scene->base)
        dif_texture_read(scene->base, hit->uv, rgb);
    for (int c = 0; c < 3 && !scene->base; c++)
        rgb[c] = scene->base_rgb[c];
}

/* The hit's footprint is that of a sample, not of the pixel. */
static void narrow(dif_hit *hit, int n_sub)
{
    const double scale = 1.0 / n_sub;
    for (int c = 0; c < 2; c++) {
        hit->uv_dx[c] *= scale;
        hit->uv_dy[c] *= scale;
    }
    hit->normal_dx = dif_vec3_add((dif_vec3){0.0, 0.0, 0.0}, scale, hit->normal_dx);
    hit->normal_dy = dif_vec3_add((dif_vec3){0.0, 0.0, 0.0}, scale, hit->normal_dy);
}

/* One light on a sample: a pair for the evaluator, or the blurred table's colour at once. */
static void light_sample(const job *j, const dif_shade_sample *sample, dif_vec3 light, slot *to)
{
    const dif_shade_opts *opts = j->opts;
    const dif_vec3 wi = dif_frame3_local(&sample->frame, light);
    for (int c = 0; c < 3; c++)
        to->base[c] += fmax(wi.z, 0.0) * sample->base[c];
    if (!(wi.z > opts->cos_min && sample->wo.z > opts->cos_min))
        return;
    if (opts->filter == DIF_FILTER_SLOPES) {
        double xyz[3], rgb[3];
        to->n_table += dif_shade_blurred(opts, sample, wi, xyz);
        dif_colour_rgb_from_xyz(xyz, rgb);
        for (int c = 0; c < 3; c++)
            to->rgb[c] += rgb[c];
        return;
    }
    to->n_table += 1.0;
    to->factor[to->n_pair] = dif_shadow_factor(opts->shadow, wi, sample->wo);
    to->wi[to->n_pair++] = wi;
}

static void fill_slot(const job *j, size_t pixel, slot *to)
{
    dif_hit hit;
    dif_shade_sample sample;
    *to = (slot){.pixel = pixel};
    const int nx = j->frame->nx;
    to->seen = dif_raster_hit(j->scene, &j->gbuffer, (int)(pixel % (size_t)nx), (int)(pixel / (size_t)nx), &hit);
    if (!to->seen)
        return;
    narrow(&hit, j->opts->n_sub);
    dif_shade_look(j->scene, j->opts, &hit, &sample);
    base_of(j->scene, &hit, sample.base);
    to->weight = sample.weight;
    to->wo = sample.wo;
    to->n_relief = sample.n_relief;
    for (int i = 0; i < j->scene->n_light && sample.weight > 0.0; i++)
        light_sample(j, &sample, j->scene->light[i], to);
}

/* All pairs of the slots through the evaluator. */
static dif_status evaluate(job *j, int n_slot, dif_error *err)
{
    size_t n = 0, at = 0;
    dif_eval_cost cost = {0};
    for (int i = 0; i < n_slot; i++)
        for (int k = 0; k < j->slots[i].n_pair; k++) {
            j->wi[n] = j->slots[i].wi[k];
            j->wo[n++] = j->slots[i].wo;
        }
    if (n == 0)
        return DIF_OK;
    const dif_status status = j->evaluator->colours(j->evaluator->self, n, j->wi, j->wo, j->xyz, &cost, err);
    if (status)
        return status;
    for (int i = 0; i < n_slot; i++)
        for (int k = 0; k < j->slots[i].n_pair; k++) {
            double rgb[3];
            dif_colour_rgb_from_xyz(j->xyz[at++], rgb);
            for (int c = 0; c < 3; c++)
                j->slots[i].rgb[c] += j->slots[i].factor[k] * rgb[c];
        }
    j->cost.upload_s += cost.upload_s;
    j->cost.run_s += cost.run_s;
    j->cost.download_s += cost.download_s;
    return DIF_OK;
}

static void take_slots(job *j, int n_slot)
{
    const double share = 1.0 / (j->opts->n_sub * j->opts->n_sub);
    for (int i = 0; i < n_slot; i++) {
        const slot *from = &j->slots[i];
        if (!from->seen)
            continue;
        j->frame->coverage[from->pixel] += (float)share;
        j->weight[from->pixel] += (float)(share * from->weight);
        for (size_t c = 0; c < 3; c++) {
            j->frame->light[3 * from->pixel + c] += (float)(share * from->weight * from->rgb[c]);
            j->frame->base[3 * from->pixel + c] += (float)(share * from->weight * from->base[c]);
        }
        j->reads.pixels += from->n_table > 0.0;
        j->reads.table += from->n_table;
        j->reads.relief += from->n_relief;
    }
}

/* One sample of every pixel. */
static dif_status draw_sample(job *j, const dif_subsample *sample, dif_error *err)
{
    const size_t n = (size_t)j->frame->nx * (size_t)j->frame->ny;
    dif_status status = dif_raster_draw(j->scene, sample, &j->gbuffer, err);
    for (size_t first = 0; first < n && !status; first += (size_t)j->n_slot) {
        const int count = n - first < (size_t)j->n_slot ? (int)(n - first) : j->n_slot;
#pragma omp parallel for schedule(dynamic, 256)
        for (int i = 0; i < count; i++)
            fill_slot(j, first + (size_t)i, &j->slots[i]);
        status = evaluate(j, count, err);
        if (!status)
            take_slots(j, count);
    }
    return status;
}

/* Samples weigh as much as they are seen: their mean, times the share of the pixel that sees the mesh. */
static void normalise(job *j)
{
    const size_t n = (size_t)j->frame->nx * (size_t)j->frame->ny;
    for (size_t i = 0; i < n; i++) {
        const float scale = j->weight[i] > 0.0F ? j->frame->coverage[i] / j->weight[i] : 0.0F;
        for (size_t c = 0; c < 3; c++) {
            j->frame->light[3 * i + c] *= scale;
            j->frame->base[3 * i + c] *= scale;
        }
    }
}

static dif_status draw(job *j, dif_error *err)
{
    const int n = j->opts->n_sub;
    dif_status status = DIF_OK;
    for (int k = 0; k < n * n && !status; k++) {
        const dif_subsample sample = {.n = n, .i = k % n, .j = k / n, .jitter = j->opts->jitter, .seed = j->opts->seed};
        status = draw_sample(j, &sample, err);
        if (j->opts->progress)
            j->opts->progress(j->opts->progress_self, (k + 1.0) / (n * n));
    }
    normalise(j);
    return status;
}

static dif_status check(const dif_scene *scene, const dif_shade_opts *how, dif_error *err)
{
    if (!(how->n_sub >= 1 && how->n_sub <= DIF_SUBSAMPLE_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d x %d samples a pixel, want 1 ... %d a side", how->n_sub, how->n_sub,
                        DIF_SUBSAMPLE_MAX);
    if (!(how->cos_min > 0.0 && how->cos_min < 1.0))
        return dif_fail(err, DIF_ERR_ARG, "smallest cosine %g, want 0 < cosine < 1", how->cos_min);
    if (how->filter == DIF_FILTER_SLOPES && !how->blurred)
        return dif_fail(err, DIF_ERR_ARG, "slopes are filtered in an integrated table, and there is none");
    if (how->meso && !scene->mesh->uv)
        return dif_fail(err, DIF_ERR_ARG, "mesostructure needs texture coordinates, and the mesh has none");
    return dif_scene_check(scene, err);
}

static void clear(dif_frame *frame)
{
    const size_t n = (size_t)frame->nx * (size_t)frame->ny;
    for (size_t i = 0; i < 3 * n; i++)
        frame->light[i] = frame->base[i] = 0.0F;
    for (size_t i = 0; i < n; i++)
        frame->coverage[i] = 0.0F;
}

dif_status dif_shade_draw(const dif_scene *scene, const dif_evaluator *evaluator, const dif_shade_opts *opts,
                          dif_frame *frame, dif_eval_cost *cost, dif_error *err)
{
    const dif_shade_opts how = opts ? *opts : dif_shade_opts_default();
    job j = {.scene = scene, .evaluator = evaluator, .opts = &how, .frame = frame};
    dif_status status = check(scene, &how, err);
    if (status)
        return status;
    clear(frame);
    status = job_create(&j, err);
    if (!status)
        status = draw(&j, err);
    if (cost)
        *cost = j.cost;
    if (how.reads)
        *how.reads = j.reads;
    job_free(&j);
    return status;
}
