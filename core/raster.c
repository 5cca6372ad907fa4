#include "core/raster.h"

#include <math.h>
#include <stdint.h>

#include "core/alloc.h"

/* A triangle in the picture: at pixel place (x, y), weight[i] = a x + b y + c is the share of vertex i over depth. A place
 * lies inside where no weight is negative; 1 / sum is its depth. */
typedef struct flat {
    double weight[3][3];
    int x0, x1, y0, y1; /* pixels it may touch, ends excluded; x1 <= x0: none */
} flat;

dif_subsample dif_subsample_centre(void)
{
    return (dif_subsample){.n = 1};
}

dif_status dif_gbuffer_create(int nx, int ny, dif_gbuffer *out, dif_error *err)
{
    *out = (dif_gbuffer){0};
    if (!(nx >= 1 && ny >= 1 && nx <= DIF_FRAME_SIDE_MAX && ny <= DIF_FRAME_SIDE_MAX))
        return dif_fail(err, DIF_ERR_SIZE, "a picture of %d x %d pixels, want 1 ... %d a side", nx, ny,
                        DIF_FRAME_SIDE_MAX);
    const size_t n = (size_t)nx * (size_t)ny;
    *out = (dif_gbuffer){.nx = nx, .ny = ny, .sample = dif_subsample_centre()};
    out->triangle = dif_alloc(n, sizeof *out->triangle);
    out->depth = dif_alloc(n, sizeof *out->depth);
    if (out->triangle && out->depth)
        return DIF_OK;
    dif_gbuffer_free(out);
    return dif_fail(err, DIF_ERR_NOMEM, "a picture of %d x %d pixels", nx, ny);
}

void dif_gbuffer_free(dif_gbuffer *gbuffer)
{
    dif_release(gbuffer->triangle);
    dif_release(gbuffer->depth);
    *gbuffer = (dif_gbuffer){0};
}

/* Two numbers in [0, 1) that a pixel, a stratum and a seed always give. */
static void scatter(int ix, int iy, const dif_subsample *sample, double out[2])
{
    uint64_t z = ((uint64_t)(uint32_t)ix << 32 | (uint32_t)iy) * 0x9e3779b97f4a7c15u;
    z ^= (uint64_t)(uint32_t)(sample->j * sample->n + sample->i + 1) * 0xd1b54a32d192ed03u;
    z ^= (uint64_t)sample->seed * 0xa0761d6478bd642fu;
    for (int c = 0; c < 2; c++) {
        z += 0x9e3779b97f4a7c15u;
        uint64_t mixed = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
        out[c] = (double)((mixed ^ (mixed >> 31)) >> 11) * 0x1p-53;
    }
}

static void place_of(const dif_subsample *sample, int ix, int iy, double place[2])
{
    double at[2] = {0.5, 0.5};
    if (sample->jitter)
        scatter(ix, iy, sample, at);
    place[0] = ix + (sample->i + at[0]) / sample->n;
    place[1] = iy + (sample->j + at[1]) / sample->n;
}

/* Pixel coordinates times depth, and depth, of a vertex. */
static void project(const dif_gbuffer *to, dif_vec3 p, double out[3])
{
    double clip[3];
    for (int i = 0; i < 3; i++) {
        const double *row = to->projection.row[i];
        clip[i] = row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3];
    }
    out[0] = 0.5 * to->nx * (clip[2] + clip[0]);
    out[1] = 0.5 * to->ny * (clip[2] - clip[1]);
    out[2] = clip[2];
}

static int clamp_pixel(double at, int n)
{
    return at > 0.0 ? (at < n ? (int)at : n) : 0;
}

/* The pixels a triangle may touch: its bounding box, or everything if a vertex lies behind the eye. */
static void bound(const dif_gbuffer *to, double v[3][3], flat *out)
{
    double low[2] = {(double)INFINITY, (double)INFINITY}, high[2] = {-(double)INFINITY, -(double)INFINITY};
    int n_front = 0;
    for (int i = 0; i < 3; i++) {
        n_front += v[i][2] > to->projection.near_depth;
        for (int c = 0; c < 2; c++) {
            low[c] = fmin(low[c], v[i][c] / v[i][2]);
            high[c] = fmax(high[c], v[i][c] / v[i][2]);
        }
    }
    *out = (flat){.x1 = n_front ? to->nx : 0, .y1 = to->ny};
    if (n_front == 3) {
        out->x0 = clamp_pixel(floor(low[0]) - 1.0, to->nx);
        out->x1 = clamp_pixel(ceil(high[0]) + 1.0, to->nx);
        out->y0 = clamp_pixel(floor(low[1]) - 1.0, to->ny);
        out->y1 = clamp_pixel(ceil(high[1]) + 1.0, to->ny);
    }
}

/* The weights: rows of the inverse of the matrix of vertices.          after Olano and Greer 1997 */
static flat flatten(const dif_scene *scene, const dif_gbuffer *to, int triangle)
{
    double v[3][3];
    flat out;
    for (int i = 0; i < 3; i++)
        project(to, scene->mesh->position[scene->mesh->triangle[triangle][i]], v[i]);
    bound(to, v, &out);
    double across[3][3];
    for (int i = 0; i < 3; i++) {
        const double *a = v[(i + 1) % 3], *b = v[(i + 2) % 3];
        for (int c = 0; c < 3; c++)
            across[i][c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
    }
    const double volume = v[0][0] * across[0][0] + v[0][1] * across[0][1] + v[0][2] * across[0][2];
    if (!(fabs(volume) > 0.0) || !isfinite(volume)) {
        out.x1 = 0;
        return out;
    }
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            out.weight[i][c] = across[i][c] / volume;
    return out;
}

static double weight_at(const double weight[3], const double place[2])
{
    return weight[0] * place[0] + weight[1] * place[1] + weight[2];
}

/* Depth of a triangle at a place, or 0 outside. Places on an edge count for both sides: nothing shows through. */
static double depth_at(const flat *triangle, const double place[2], double near_depth)
{
    const double slack = -1e-12;
    double w[3], sum = 0.0;
    for (int i = 0; i < 3; i++) {
        w[i] = weight_at(triangle->weight[i], place);
        sum += w[i];
    }
    const double depth = 1.0 / sum;
    if (!(depth > near_depth) || w[0] * depth < slack || w[1] * depth < slack || w[2] * depth < slack)
        return 0.0;
    return depth;
}

/* All triangles on the rows y0 ... y1 - 1. */
static void draw_rows(const flat *triangles, int n_triangle, int y0, int y1, dif_gbuffer *to)
{
    for (int t = 0; t < n_triangle; t++) {
        const flat *triangle = &triangles[t];
        const int from = triangle->y0 > y0 ? triangle->y0 : y0, end = triangle->y1 < y1 ? triangle->y1 : y1;
        for (int iy = from; iy < end; iy++)
            for (int ix = triangle->x0; ix < triangle->x1; ix++) {
                const size_t at = (size_t)iy * (size_t)to->nx + (size_t)ix;
                double place[2];
                place_of(&to->sample, ix, iy, place);
                const double depth = depth_at(triangle, place, to->projection.near_depth);
                if (depth > 0.0 && (to->triangle[at] < 0 || depth < (double)to->depth[at])) {
                    to->triangle[at] = t;
                    to->depth[at] = (float)depth;
                }
            }
    }
}

dif_status dif_raster_draw(const dif_scene *scene, const dif_subsample *sample, dif_gbuffer *gbuffer, dif_error *err)
{
    enum { BAND = 16 };
    const int n = scene->mesh->n_triangle, n_band = (gbuffer->ny + BAND - 1) / BAND;
    const size_t n_pixel = (size_t)gbuffer->nx * (size_t)gbuffer->ny;
    const dif_status status = dif_scene_check(scene, err);
    if (status)
        return status;
    flat *triangles = dif_alloc((size_t)n, sizeof *triangles);
    if (!triangles)
        return dif_fail(err, DIF_ERR_NOMEM, "%d triangles", n);
    gbuffer->sample = *sample;
    gbuffer->projection = dif_scene_projection(&scene->camera, (double)gbuffer->nx / gbuffer->ny);
    for (size_t i = 0; i < n_pixel; i++)
        gbuffer->triangle[i] = -1;
#pragma omp parallel for schedule(static)
    for (int t = 0; t < n; t++)
        triangles[t] = flatten(scene, gbuffer, t);
#pragma omp parallel for schedule(dynamic)
    for (int band = 0; band < n_band; band++)
        draw_rows(triangles, n, band * BAND, band + 1 < n_band ? (band + 1) * BAND : gbuffer->ny, gbuffer);
    dif_release(triangles);
    return DIF_OK;
}

/* Sum of vertex values with the given shares. */
static dif_vec3 mix(const dif_vec3 *value, const int triangle[3], const double share[3])
{
    dif_vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i < 3; i++)
        sum = dif_vec3_add(sum, share[i], value[triangle[i]]);
    return sum;
}

/* uv and its derivatives: uv = sum(uv_i w_i) / sum(w_i) with w linear in the picture. */
static void mix_uv(const dif_mesh *mesh, const int triangle[3], const flat *f, const double share[3], double depth,
                   dif_hit *hit)
{
    for (int c = 0; c < 2; c++) {
        double value = 0.0, dx = 0.0, dy = 0.0;
        for (int i = 0; i < 3; i++)
            value += share[i] * mesh->uv[triangle[i]][c];
        for (int i = 0; i < 3; i++) {
            const double off = mesh->uv[triangle[i]][c] - value;
            dx += off * f->weight[i][0];
            dy += off * f->weight[i][1];
        }
        hit->uv[c] = value;
        hit->uv_dx[c] = depth * dx;
        hit->uv_dy[c] = depth * dy;
    }
}

/* How the unit normal changes over a pixel. */
static void mix_normal(const dif_mesh *mesh, const int triangle[3], const flat *f, dif_vec3 mean, dif_hit *hit)
{
    const double length = sqrt(dif_vec3_dot(mean, mean)), scale = length > 0.0 ? hit->depth / length : 0.0;
    const dif_vec3 n = dif_vec3_unit(mean);
    for (int axis = 0; axis < 2; axis++) {
        dif_vec3 change = {0.0, 0.0, 0.0};
        for (int i = 0; i < 3; i++)
            change =
                dif_vec3_add(change, scale * f->weight[i][axis], dif_vec3_add(mesh->normal[triangle[i]], -1.0, mean));
        change = dif_vec3_add(change, -dif_vec3_dot(change, n), n);
        *(axis == 0 ? &hit->normal_dx : &hit->normal_dy) = change;
    }
}

bool dif_raster_hit(const dif_scene *scene, const dif_gbuffer *gbuffer, int ix, int iy, dif_hit *hit)
{
    const int t = gbuffer->triangle[(size_t)iy * (size_t)gbuffer->nx + (size_t)ix];
    const dif_mesh *mesh = scene->mesh;
    *hit = (dif_hit){.depth = 0.0};
    if (t < 0)
        return false;
    const flat f = flatten(scene, gbuffer, t);
    double place[2], share[3], sum = 0.0;
    place_of(&gbuffer->sample, ix, iy, place);
    for (int i = 0; i < 3; i++) {
        share[i] = weight_at(f.weight[i], place);
        sum += share[i];
    }
    for (int i = 0; i < 3; i++)
        share[i] /= sum;
    hit->depth = 1.0 / sum;
    hit->position = mix(mesh->position, mesh->triangle[t], share);
    hit->to_eye = dif_vec3_unit(dif_vec3_add(scene->camera.eye, -1.0, hit->position));
    const dif_vec3 normal = mix(mesh->normal, mesh->triangle[t], share);
    hit->frame = dif_scene_frame(normal, mix(mesh->tangent, mesh->triangle[t], share), scene->groove_rad);
    mix_normal(mesh, mesh->triangle[t], &f, normal, hit);
    if (mesh->uv)
        mix_uv(mesh, mesh->triangle[t], &f, share, hit->depth, hit);
    return true;
}
