#include "core/pyramid.h"

#include <math.h>

#include "core/alloc.h"

enum { TAPS_MAX = 64 }; /* along one side of a footprint */

void dif_pyramid_free(dif_pyramid *pyramid)
{
    dif_release(pyramid->moment[0]);
    *pyramid = (dif_pyramid){0};
}

static size_t blocks_of(const dif_pyramid *pyramid, int level)
{
    return (size_t)pyramid->nx[level] * (size_t)pyramid->ny[level];
}

/* Samples that block i of a level covers along an axis of n samples. */
static double cover(int i, int level, int n)
{
    const long first = (long)i << level, end = first + (1l << level);
    return (double)((end < n ? end : n) - first);
}

static void fill_level(dif_pyramid *p, int level)
{
    const float *below = p->moment[level - 1];
    const int mx = p->nx[level - 1], my = p->ny[level - 1];
    for (int iy = 0; iy < p->ny[level]; iy++)
        for (int ix = 0; ix < p->nx[level]; ix++) {
            double sum[2] = {0.0, 0.0}, weight = 0.0;
            for (int k = 0; k < 4; k++) {
                const int jx = 2 * ix + (k & 1), jy = 2 * iy + (k >> 1);
                if (jx >= mx || jy >= my)
                    continue;
                const double w = cover(jx, level - 1, p->nx[0]) * cover(jy, level - 1, p->ny[0]);
                const float *from = below + 2 * ((size_t)jy * (size_t)mx + (size_t)jx);
                sum[0] += w * (double)from[0];
                sum[1] += w * (double)from[1];
                weight += w;
            }
            float *to = p->moment[level] + 2 * ((size_t)iy * (size_t)p->nx[level] + (size_t)ix);
            to[0] = (float)(sum[0] / weight);
            to[1] = (float)(sum[1] / weight);
        }
}

dif_status dif_pyramid_create(const dif_field *field, double low_um, double high_um, dif_pyramid *out, dif_error *err)
{
    *out = (dif_pyramid){0};
    const dif_status status = dif_field_check(field, err);
    if (status)
        return status;
    if (!(low_um < high_um && isfinite(high_um - low_um)))
        return dif_fail(err, DIF_ERR_ARG, "heights %g ... %g um, want a range", low_um, high_um);
    size_t n = 0;
    int nx = field->nx, ny = field->ny;
    for (;; nx = (nx + 1) / 2, ny = (ny + 1) / 2) {
        out->nx[out->n_level] = nx;
        out->ny[out->n_level] = ny;
        n += blocks_of(out, out->n_level++);
        if ((nx == 1 && ny == 1) || out->n_level == DIF_PYRAMID_LEVELS)
            break;
    }
    out->moment[0] = dif_alloc(n, 2 * sizeof *out->moment[0]);
    if (!out->moment[0]) {
        dif_pyramid_free(out);
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu moments", n);
    }
    for (size_t i = 0; i < dif_field_n(field); i++) {
        const double z = (field->z_um[i] - low_um) / (high_um - low_um);
        out->moment[0][2 * i] = (float)z;
        out->moment[0][2 * i + 1] = (float)(z * z);
    }
    for (int level = 1; level < out->n_level; level++) {
        out->moment[level] = out->moment[level - 1] + 2 * blocks_of(out, level - 1);
        fill_level(out, level);
    }
    return DIF_OK;
}

/* Linear between the middles of blocks, cut at the edges. */
static void read_level(const dif_pyramid *p, int level, double u, double v, double moment[2])
{
    const double size = (double)(1l << level);
    const int nx = p->nx[level], ny = p->ny[level];
    const double x = fmin(fmax((u + 0.5) / size - 0.5, 0.0), nx - 1.0);
    const double y = fmin(fmax((v + 0.5) / size - 0.5, 0.0), ny - 1.0);
    const int ix = (int)x, iy = (int)y, jx = ix + 1 < nx ? ix + 1 : ix, jy = iy + 1 < ny ? iy + 1 : iy;
    const double fx = x - ix, fy = y - iy;
    const float *top = p->moment[level] + 2 * (size_t)iy * (size_t)nx;
    const float *bottom = p->moment[level] + 2 * (size_t)jy * (size_t)nx;
    for (int c = 0; c < 2; c++)
        moment[c] = (1.0 - fy) * ((1.0 - fx) * (double)top[2 * ix + c] + fx * (double)top[2 * jx + c]) +
                    fy * ((1.0 - fx) * (double)bottom[2 * ix + c] + fx * (double)bottom[2 * jx + c]);
}

double dif_pyramid_height(const dif_pyramid *pyramid, double u, double v)
{
    double moment[2];
    read_level(pyramid, 0, u, v, moment);
    return moment[0];
}

static int taps_of(double length, double size, int n_across)
{
    const double n = ceil(length / size);
    return n > TAPS_MAX ? TAPS_MAX : n > n_across ? (int)n : n_across;
}

int dif_pyramid_footprint(const dif_pyramid *pyramid, double u, double v, const dif_footprint *footprint, int n_across,
                          double *mean, double *sigma)
{
    const double *w1 = footprint->w1, *w2 = footprint->w2;
    const dif_footprint_ellipse ellipse = dif_footprint_ellipse_of(footprint);
    int level = 0;
    while (level + 1 < pyramid->n_level && (double)(2l << level) * n_across <= ellipse.minor)
        level++;
    const double size = (double)(1l << level);
    const int n1 = taps_of(hypot(w1[0], w1[1]), size, n_across), n2 = taps_of(hypot(w2[0], w2[1]), size, n_across);
    double sum[2] = {0.0, 0.0}, moment[2];
    for (int j = 0; j < n2; j++)
        for (int i = 0; i < n1; i++) {
            const double a = (i + 0.5) / n1 - 0.5, b = (j + 0.5) / n2 - 0.5;
            read_level(pyramid, level, u + a * w1[0] + b * w2[0], v + a * w1[1] + b * w2[1], moment);
            sum[0] += moment[0];
            sum[1] += level == 0 ? moment[0] * moment[0] : moment[1];
        }
    *mean = sum[0] / (n1 * n2);
    *sigma = sqrt(fmax(sum[1] / (n1 * n2) - *mean * *mean, 0.0));
    return n1 * n2;
}
