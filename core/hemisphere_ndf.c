/* The distribution of normals, and the masking it gives. */
#include <math.h>

#include "core/alloc.h"
#include "core/hemisphere.h"
#include "core/slope.h"

static size_t texels_of(const dif_ndf *ndf)
{
    return (size_t)ndf->n * (size_t)ndf->n;
}

void dif_hemisphere_ndf_free(dif_ndf *ndf)
{
    dif_release(ndf->d);
    dif_release(ndf->vector[0]);
    *ndf = (dif_ndf){0};
}

static dif_status begin(int n, dif_ndf *out, dif_error *err)
{
    *out = (dif_ndf){.n = n};
    if (!(n >= 3 && n <= DIF_HEMISPHERE_MAX)) {
        out->n = 0;
        return dif_fail(err, DIF_ERR_ARG, "%d texels across, want 3 ... %d", n, DIF_HEMISPHERE_MAX);
    }
    out->d = dif_alloc(texels_of(out), sizeof *out->d);
    return out->d ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for %d x %d normals", n, n);
}

/* From projected areas in d, which add up to `total`, to D and the vectors. */
static dif_status finish(dif_ndf *ndf, double total, dif_error *err)
{
    const size_t n = texels_of(ndf);
    for (size_t i = 0; i < n; i++)
        ndf->n_used += ndf->d[i] > 0.0;
    ndf->vector[0] = dif_alloc(ndf->n_used, 3 * sizeof(double));
    if (!ndf->vector[0])
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu normals", ndf->n_used);
    ndf->vector[1] = ndf->vector[0] + ndf->n_used;
    ndf->vector[2] = ndf->vector[1] + ndf->n_used;
    size_t at = 0;
    for (size_t i = 0; i < n; i++) {
        if (!(ndf->d[i] > 0.0))
            continue;
        const dif_hemisphere_texel texel =
            dif_hemisphere_texel_at(ndf->n, (int)(i % (size_t)ndf->n), (int)(i / (size_t)ndf->n));
        ndf->d[i] /= total * texel.area;
        ndf->vector[0][at] = ndf->d[i] * texel.x;
        ndf->vector[1][at] = ndf->d[i] * texel.y;
        ndf->vector[2][at++] = ndf->d[i] * texel.area;
    }
    return DIF_OK;
}

/* Shares out one cell, whose projected area is 1, among the texels around its normal. */
static void splat(dif_ndf *ndf, const double s[2])
{
    const double scale = 1.0 / sqrt(1.0 + s[0] * s[0] + s[1] * s[1]);
    const int n = ndf->n;
    /* of the normal (-s, 1), in texels; row 0 on top */
    const double x = 0.5 * (1.0 - s[0] * scale) * n - 0.5, y = 0.5 * (1.0 + s[1] * scale) * n - 0.5;
    const int ix = (int)floor(x), iy = (int)floor(y);
    double share[4], sum = 0.0;
    for (int k = 0; k < 4; k++) {
        const int jx = ix + (k & 1), jy = iy + (k >> 1);
        const double dx = 2.0 * jx + 1.0 - n, dy = 2.0 * jy + 1.0 - n;
        const bool inside = jx >= 0 && jx < n && jy >= 0 && jy < n && dx * dx + dy * dy < (double)n * n;
        share[k] = inside ? (1.0 - fabs(x - jx)) * (1.0 - fabs(y - jy)) : 0.0;
        sum += share[k];
    }
    if (!(sum > 0.0)) { /* within half a texel of the rim: the texel that holds the normal, drawn inwards */
        const double inward = 1.0 - 1.5 / n;
        const double nx = -s[0] * scale * inward, ny = s[1] * scale * inward;
        ndf->d[(size_t)(0.5 * (ny + 1.0) * n) * (size_t)n + (size_t)(0.5 * (nx + 1.0) * n)] += 1.0;
        return;
    }
    for (int k = 0; k < 4; k++)
        if (share[k] > 0.0)
            ndf->d[(size_t)(iy + (k >> 1)) * (size_t)n + (size_t)(ix + (k & 1))] += share[k] / sum;
}

dif_status dif_hemisphere_ndf_create(const dif_field *field, int n, bool level, dif_ndf *out, dif_error *err)
{
    dif_slope_gauss gauss;
    *out = (dif_ndf){0};
    dif_status status = dif_slope_of_field(field, &gauss, err);
    if (status == DIF_OK)
        status = begin(n, out, err);
    if (status)
        return status;
    const double mean_x = level ? gauss.mean_x : 0.0, mean_y = level ? gauss.mean_y : 0.0;
    for (int iy = 0; iy < field->ny - 1; iy++)
        for (int ix = 0; ix < field->nx - 1; ix++) {
            double s[2];
            dif_slope_of_cell(field, ix, iy, s);
            s[0] -= mean_x;
            s[1] -= mean_y;
            splat(out, s);
        }
    out->slope_rms =
        sqrt(gauss.var_x + gauss.var_y + (level ? 0.0 : gauss.mean_x * gauss.mean_x + gauss.mean_y * gauss.mean_y));
    status = finish(out, (double)(field->nx - 1) * (double)(field->ny - 1), err);
    if (status)
        dif_hemisphere_ndf_free(out);
    return status;
}

/* Mean of x^2 + y^2 over z^2 at the texels' mean directions, by projected area. */
static double slope_rms_of(const dif_ndf *ndf)
{
    double sum = 0.0;
    for (size_t i = 0; i < ndf->n_used; i++) {
        const double x = ndf->vector[0][i], y = ndf->vector[1][i], z = ndf->vector[2][i];
        sum += (x * x + y * y) / z;
    }
    return sqrt(sum);
}

dif_status dif_hemisphere_ndf_from_image(const double *d, int n, dif_ndf *out, dif_error *err)
{
    dif_status status = begin(n, out, err);
    double total = 0.0;
    for (size_t i = 0; status == DIF_OK && i < texels_of(out); i++) {
        if (!(d[i] >= 0.0 && isfinite(d[i])))
            status = dif_fail(err, DIF_ERR_ARG, "normals: %g at texel %zu, want a number >= 0", d[i], i);
        else
            out->d[i] = d[i] * dif_hemisphere_texel_at(n, (int)(i % (size_t)n), (int)(i / (size_t)n)).area;
        total += out->d[i];
    }
    if (status == DIF_OK && !(total > 0.0 && isfinite(total)))
        status = dif_fail(err, DIF_ERR_ARG, "normals: nothing above the horizon");
    if (status == DIF_OK)
        status = finish(out, total, err);
    if (status == DIF_OK)
        out->slope_rms = slope_rms_of(out);
    else
        dif_hemisphere_ndf_free(out);
    return status;
}

double dif_hemisphere_ndf_projected(const dif_ndf *ndf)
{
    double sum = 0.0;
    for (size_t i = 0; i < ndf->n_used; i++)
        sum += ndf->vector[2][i];
    return sum;
}

double dif_hemisphere_masking(const dif_ndf *ndf, dif_vec3 k)
{
    const double *x = ndf->vector[0], *y = ndf->vector[1], *z = ndf->vector[2];
    double seen[4] = {0.0, 0.0, 0.0, 0.0}; /* four sums, so that the additions need not wait for each other */
    size_t i = 0;
    for (; i + 4 <= ndf->n_used; i += 4)
        for (size_t j = 0; j < 4; j++) {
            const double dot = k.x * x[i + j] + k.y * y[i + j] + k.z * z[i + j];
            seen[j] += dot > 0.0 ? dot : 0.0;
        }
    for (; i < ndf->n_used; i++)
        seen[0] += fmax(k.x * x[i] + k.y * y[i] + k.z * z[i], 0.0);
    const double all = (seen[0] + seen[1]) + (seen[2] + seen[3]);
    return all > k.z ? fmax(k.z, 0.0) / all : 1.0;
}

void dif_hemisphere_masking_image(const dif_ndf *ndf, int m, float *g)
{
#pragma omp parallel for schedule(dynamic)
    for (int iy = 0; iy < m; iy++)
        for (int ix = 0; ix < m; ix++) {
            const double x = (2.0 * ix + 1.0) / m - 1.0, y = 1.0 - (2.0 * iy + 1.0) / m, z2 = 1.0 - x * x - y * y;
            const dif_vec3 k = {x, y, z2 > 0.0 ? sqrt(z2) : 0.0};
            g[(size_t)iy * (size_t)m + (size_t)ix] = z2 > 0.0 ? (float)dif_hemisphere_masking(ndf, k) : 0.0f;
        }
}
