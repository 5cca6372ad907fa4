#include "bench/filter_study.h"

#include <math.h>
#include <stdlib.h>

#include "core/alloc.h"
#include "core/colour.h"

static bool is_whole(const dif_frame *a, const dif_frame *b, size_t i)
{
    return a->coverage[i] > 0.999F && b->coverage[i] > 0.999F;
}

/* What a pixel shows, linear. */
static void shown(const dif_frame *frame, size_t i, double exposure, double rgb[3])
{
    for (size_t c = 0; c < 3; c++)
        rgb[c] = exposure * (double)frame->light[3 * i + c] + (double)frame->base[3 * i + c];
    dif_colour_fit_gamut(DIF_GAMUT_DESATURATE, rgb);
}

/* The same, averaged with the neighbours that are compared: weights 4, 2, 1. */
static void blurred(const dif_frame *frame, const dif_frame *other, int x, int y, double exposure, double rgb[3])
{
    double sum = 0.0;
    rgb[0] = rgb[1] = rgb[2] = 0.0;
    for (int k = 0; k < 9; k++) {
        const int dx = k % 3 - 1, dy = k / 3 - 1, ix = x + dx, iy = y + dy;
        const size_t i = (size_t)iy * (size_t)frame->nx + (size_t)ix;
        if (ix < 0 || iy < 0 || ix >= frame->nx || iy >= frame->ny || !is_whole(frame, other, i))
            continue;
        const double weight = (dx == 0 ? 2.0 : 1.0) * (dy == 0 ? 2.0 : 1.0);
        double here[3];
        shown(frame, i, exposure, here);
        for (int c = 0; c < 3; c++)
            rgb[c] += weight * here[c];
        sum += weight;
    }
    for (int c = 0; c < 3; c++)
        rgb[c] /= sum;
}

static double luminance(const dif_frame *frame, size_t i)
{
    const double rgb[3] = {(double)frame->light[3 * i], (double)frame->light[3 * i + 1],
                           (double)frame->light[3 * i + 2]};
    double xyz[3];
    dif_colour_xyz_from_rgb(rgb, xyz);
    return xyz[1];
}

static double difference(const double a[3], const double b[3])
{
    double xyz[3], lab[2][3];
    dif_colour_xyz_from_rgb(a, xyz);
    dif_colour_lab_from_xyz(xyz, lab[0]);
    dif_colour_xyz_from_rgb(b, xyz);
    dif_colour_lab_from_xyz(xyz, lab[1]);
    return dif_colour_difference_2000(lab[0], lab[1]);
}

static int by_size(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

dif_status dif_frame_differ(const dif_frame *a, const dif_frame *b, double exposure, float *map,
                            dif_frame_difference *out, dif_error *err)
{
    const size_t n_pixel = (size_t)a->nx * (size_t)a->ny;
    *out = (dif_frame_difference){0};
    if (a->nx != b->nx || a->ny != b->ny)
        return dif_fail(err, DIF_ERR_ARG, "frames of %d x %d and %d x %d pixels", a->nx, a->ny, b->nx, b->ny);
    double light[2] = {0.0, 0.0};
    float *de = dif_alloc(n_pixel, sizeof *de);
    if (!de)
        return dif_fail(err, DIF_ERR_NOMEM, "differences of %zu pixels", n_pixel);
    for (size_t i = 0; i < n_pixel; i++) {
        double one[3], other[3];
        const bool whole = is_whole(a, b, i);
        if (map)
            map[i] = 0.0F;
        if (!whole)
            continue;
        light[0] += luminance(a, i);
        light[1] += luminance(b, i);
        shown(a, i, exposure, one);
        shown(b, i, exposure, other);
        de[out->n++] = (float)difference(one, other);
        out->mean += (double)de[out->n - 1];
        const int x = (int)(i % (size_t)a->nx), y = (int)(i / (size_t)a->nx);
        blurred(a, b, x, y, exposure, one);
        blurred(b, a, x, y, exposure, other);
        const double far = difference(one, other);
        out->blurred_mean += far;
        if (map)
            map[i] = (float)far;
    }
    out->light_ratio = light[1] > 0.0 ? light[0] / light[1] : (double)NAN;
    if (out->n > 0) {
        qsort(de, (size_t)out->n, sizeof *de, by_size);
        out->mean /= out->n;
        out->blurred_mean /= out->n;
        out->median = (double)de[out->n / 2];
        out->p95 = (double)de[(size_t)(0.95 * (out->n - 1))];
        out->worst = (double)de[out->n - 1];
    }
    dif_release(de);
    return DIF_OK;
}
