#include "core/lut_impl.h"

#include <math.h>

#include "core/alloc.h"
#include "core/units.h"

dif_lut_opts dif_lut_opts_default(void)
{
    return (dif_lut_opts){.n_azimuth = 4096, .n_radius = 320, .n_map = DIF_LUT_MAPS_FROM_TOL};
}

double dif_lut_row_step(const dif_lut *lut)
{
    return asinh(2.0 / lut->s0) / (lut->n_radius - 1);
}

double dif_lut_radius(const dif_lut *lut, int row)
{
    return row == lut->n_radius - 1 ? 2.0 : lut->s0 * sinh(row * dif_lut_row_step(lut));
}

void dif_lut_free(dif_lut *lut)
{
    dif_release(lut->coef);
    *lut = (dif_lut){0};
}

/* The four texels around a place, and their weights. */
typedef struct corners {
    const float *texel[4];
    double weight[4];
} corners;

static corners corners_of(const dif_lut *lut, double u, double v)
{
    const double row_at = fmin(asinh(hypot(u, v) / lut->s0) / dif_lut_row_step(lut), lut->n_radius - 1.0);
    double column_at = atan2(v, u) / DIF_TWO_PI * lut->n_azimuth;
    column_at = column_at < 0.0 ? column_at + lut->n_azimuth : column_at;
    const int row = (int)fmin(floor(row_at), lut->n_radius - 2.0), column = (int)column_at % lut->n_azimuth;
    const double down = row_at - row, along = column_at - floor(column_at);
    const size_t texel = 3 * (size_t)lut->n_map, line = texel * (size_t)lut->n_azimuth;
    corners c;
    for (int i = 0; i < 4; i++) {
        const size_t at = (size_t)(row + i / 2) * line + (size_t)((column + i % 2) % lut->n_azimuth) * texel;
        c.texel[i] = lut->coef + at;
        c.weight[i] = (i / 2 ? down : 1.0 - down) * (i % 2 ? along : 1.0 - along);
    }
    return c;
}

void dif_lut_eval(const dif_lut *lut, double u, double v, double w, double xyz[3])
{
    const corners at = corners_of(lut, u, v);
    const double range = sqrt(fmax(4.0 - u * u - v * v, 1e-12));
    const double t = fmin(fmax(2.0 * fabs(w) / range - 1.0, -1.0), 1.0);
    double next[3] = {0.0}, after[3] = {0.0};
    /* Clenshaw: b_n = q_n + 2 t b_{n+1} - b_{n+2};  value = q_0 + t b_1 - b_2 */
    for (int n = lut->n_map - 1; n >= 0; n--)
        for (int c = 0; c < 3; c++) {
            double q = 0.0;
            for (int i = 0; i < 4; i++)
                q += at.weight[i] * (double)at.texel[i][3 * n + c];
            const double here = q + (n == 0 ? t : 2.0 * t) * next[c] - after[c];
            after[c] = next[c];
            next[c] = here;
        }
    for (int c = 0; c < 3; c++)
        xyz[c] = next[c];
}

void dif_lut_disc_average(const dif_lut *lut, double s, double azimuth_rad, double radius, float *out)
{
    enum { RINGS = 3 };
    const double u = s * cos(azimuth_rad), v = s * sin(azimuth_rad);
    const int n_value = 3 * lut->n_map;
    double sum[3 * DIF_LUT_MAP_MAX] = {0.0};
    /* ring i of equal area carries 6 (i + 1) points; each ring counts alike */
    for (int ring = 0; ring < RINGS; ring++) {
        const int n = 6 * (ring + 1);
        const double r = radius * sqrt((ring + 0.5) / RINGS);
        for (int i = 0; i < n; i++) {
            const double turn = DIF_TWO_PI * (i + 0.5 * ring) / n;
            const corners at = corners_of(lut, u + r * cos(turn), v + r * sin(turn));
            for (int corner = 0; corner < 4; corner++)
                for (int k = 0; k < n_value; k++)
                    sum[k] += at.weight[corner] / (n * RINGS) * (double)at.texel[corner][k];
        }
    }
    for (int k = 0; k < n_value; k++)
        out[k] = (float)sum[k];
}
