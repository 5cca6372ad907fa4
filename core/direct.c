#include "core/direct.h"

#include <math.h>

#include "core/alloc.h"
#include "core/simd.h"

enum { BLOCK = 256 };

/* Window weights and sample positions of one call. */
typedef struct grid {
    const dif_field *field;
    double *wx, *wy, *x_um;
} grid;

/* sum over one row of W exp(i phase); a block of phases at a time so that sine and cosine run as vectors. */
DIF_CLONES static void sum_row(const double *z_um, const double *weight, const double *x_um, int n, double kx,
                               double kz, double phase0, double *sum)
{
    double phase[BLOCK], c[BLOCK], s[BLOCK], re = 0.0, im = 0.0;
    for (int at = 0; at < n; at += BLOCK) {
        const int count = n - at < BLOCK ? n - at : BLOCK;
#pragma omp simd
        for (int j = 0; j < count; j++)
            phase[j] = phase0 + kx * x_um[at + j] + kz * z_um[at + j];
#pragma omp simd
        for (int j = 0; j < count; j++)
            c[j] = cos(phase[j]);
#pragma omp simd
        for (int j = 0; j < count; j++)
            s[j] = sin(phase[j]);
#pragma omp simd reduction(+ : re, im)
        for (int j = 0; j < count; j++) {
            re += weight[at + j] * c[j];
            im += weight[at + j] * s[j];
        }
    }
    sum[0] = re;
    sum[1] = im;
}

/* One point, over the whole field. */
static void sum_point(const grid *g, dif_vec3 kappa, double *amp)
{
    const dif_field *field = g->field;
    amp[0] = amp[1] = 0.0;
    for (int iy = 0; iy < field->ny; iy++) {
        double sum[2];
        sum_row(field->z_um + (size_t)iy * (size_t)field->nx, g->wx, g->x_um, field->nx, kappa.x, kappa.z,
                kappa.y * dif_field_y_um(field, iy), sum);
        amp[0] += g->wy[iy] * sum[0];
        amp[1] += g->wy[iy] * sum[1];
    }
}

dif_status dif_direct_amplitudes(const dif_field *field, const dif_window *window, size_t n, const dif_vec3 *kappa,
                                 double (*amp)[2], dif_error *err)
{
    dif_status status = DIF_OK;
    grid g = {.field = field};
    g.wx = dif_alloc((size_t)field->nx, sizeof *g.wx);
    g.wy = dif_alloc((size_t)field->ny, sizeof *g.wy);
    g.x_um = dif_alloc((size_t)field->nx, sizeof *g.x_um);
    if (!g.wx || !g.wy || !g.x_um) {
        status = dif_fail(err, DIF_ERR_NOMEM, "no memory for window weights");
        goto done;
    }
    const double sum_w = dif_window_fill(window, field, g.wx, g.wy).w;
    if (!(sum_w > 0.0)) {
        status = dif_fail(err, DIF_ERR_ARG, "the window misses every sample");
        goto done;
    }
    for (int ix = 0; ix < field->nx; ix++) {
        g.x_um[ix] = dif_field_x_um(field, ix);
        g.wx[ix] /= sum_w;
    }
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n; i++)
        sum_point(&g, kappa[i], amp[i]);
done:
    dif_release(g.wx);
    dif_release(g.wy);
    dif_release(g.x_um);
    return status;
}
