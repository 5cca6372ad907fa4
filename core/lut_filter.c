#include "core/lut_filter.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "core/alloc.h"
#include "core/lut_impl.h"
#include "core/units.h"

static size_t numbers_of(const dif_lut_filter *filter)
{
    return 3 * (size_t)filter->lut->n_map;
}

/* Mean over the azimuths of one number of a row. */
static double ring_mean(const dif_lut *lut, int row, size_t number)
{
    const size_t n_number = 3 * (size_t)lut->n_map, n = (size_t)lut->n_azimuth;
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += (double)lut->coef[((size_t)row * n + i) * n_number + number];
    return sum / (double)n;
}

/* The first row where the mirror's spot is over: where Y at the middle depth (t = 0: even maps, signs alternating) has
 * fallen to SPOT_END of its peak; 0 if it does not fall within SPOT_MAX, so that there is none. */
static int spot_row(const dif_lut *lut)
{
    static const double SPOT_END = 1e-3, SPOT_MAX = 0.3;
    double peak = 0.0;
    for (int row = 0; row < lut->n_radius && dif_lut_radius(lut, row) < SPOT_MAX; row++) {
        double level = 0.0;
        for (int n = 0; n < lut->n_map; n += 2)
            level += (n % 4 ? -1.0 : 1.0) * ring_mean(lut, row, 3 * (size_t)n + 1);
        peak = row == 0 ? level : peak;
        if (row > 0 && level < SPOT_END * peak)
            return row;
    }
    return 0;
}

/* Integrals of the spot above what lies at its end, ring by ring. */
static void measure_spot(dif_lut_filter *filter, int end)
{
    const dif_lut *lut = filter->lut;
    double light = 0.0, spread = 0.0;
    filter->spot_radius = end > 0 ? dif_lut_radius(lut, end) : 0.0;
    for (int row = 0; row < end; row++) {
        const double inner = row > 0 ? 0.5 * (dif_lut_radius(lut, row - 1) + dif_lut_radius(lut, row)) : 0.0;
        const double outer = 0.5 * (dif_lut_radius(lut, row) + dif_lut_radius(lut, row + 1));
        const double area = DIF_PI * (outer * outer - inner * inner);
        for (size_t n = 0; n < numbers_of(filter); n++) {
            const double part = area * (ring_mean(lut, row, n) - ring_mean(lut, end, n));
            filter->spot[n / 3][n % 3] += part;
            if (n == 1) {
                light += part;
                spread += part * 0.25 * (outer * outer + inner * inner); /* along one axis */
            }
        }
    }
    filter->spot_variance = light > 0.0 ? fmax(spread / light, 0.0) : 0.0;
}

/* A copy of the table in which the rows of the spot are those at its end. */
static dif_status copy_without_spot(const dif_lut *lut, int end, dif_lut *out, dif_error *err)
{
    const size_t line = 3 * (size_t)lut->n_map * (size_t)lut->n_azimuth, n = line * (size_t)lut->n_radius;
    *out = *lut;
    out->coef = dif_alloc(n, sizeof *out->coef);
    if (!out->coef)
        return dif_fail(err, DIF_ERR_NOMEM, "a table of %zu numbers", n);
    memcpy(out->coef, lut->coef, n * sizeof *out->coef);
    for (int row = 0; row < end; row++)
        memcpy(out->coef + (size_t)row * line, lut->coef + (size_t)end * line, line * sizeof *out->coef);
    return DIF_OK;
}

/* Level 0: means over discs of a texel's area. */
static void fill(dif_lut_filter *filter, const dif_lut *plain)
{
    const int n = filter->n;
    const double step = 4.0 / n, radius = step / sqrt(DIF_PI);
#pragma omp parallel for schedule(dynamic)
    for (int iy = 0; iy < n; iy++)
        for (int ix = 0; ix < n; ix++) {
            const double u = (ix + 0.5) * step - 2.0, v = (iy + 0.5) * step - 2.0;
            dif_lut_disc_average(plain, hypot(u, v), atan2(v, u), radius,
                                 filter->coef[0] + ((size_t)iy * (size_t)n + (size_t)ix) * numbers_of(filter));
        }
}

static void reduce(dif_lut_filter *filter, int level)
{
    const size_t n = (size_t)(filter->n >> level), m = 2 * n, n_number = numbers_of(filter);
    for (size_t iy = 0; iy < n; iy++)
        for (size_t ix = 0; ix < n; ix++)
            for (size_t k = 0; k < n_number; k++) {
                float sum = 0.0F;
                for (size_t i = 0; i < 4; i++)
                    sum += filter->coef[level - 1][((2 * iy + i / 2) * m + 2 * ix + i % 2) * n_number + k];
                filter->coef[level][(iy * n + ix) * n_number + k] = 0.25F * sum;
            }
}

dif_status dif_lut_filter_create(const dif_lut *lut, int n, dif_lut_filter *out, dif_error *err)
{
    dif_lut_filter filter = {.lut = lut, .n = n};
    size_t n_texel = 0, first[DIF_LUT_FILTER_LEVELS];
    *out = (dif_lut_filter){0};
    if (!(n >= 16 && n <= 2048 && (n & (n - 1)) == 0))
        return dif_fail(err, DIF_ERR_ARG, "a pyramid of side %d, want a power of two of 16 ... 2048", n);
    for (; n >> filter.n_level > 0; filter.n_level++) {
        first[filter.n_level] = n_texel;
        n_texel += (size_t)(n >> filter.n_level) * (size_t)(n >> filter.n_level);
    }
    filter.coef[0] = dif_alloc(n_texel, numbers_of(&filter) * sizeof *filter.coef[0]);
    if (!filter.coef[0])
        return dif_fail(err, DIF_ERR_NOMEM, "a pyramid of %zu texels of %d maps", n_texel, lut->n_map);
    dif_lut plain;
    const int end = spot_row(lut);
    const dif_status status = copy_without_spot(lut, end, &plain, err);
    if (status) {
        dif_lut_filter_free(&filter);
        return status;
    }
    measure_spot(&filter, end);
    fill(&filter, &plain);
    dif_lut_free(&plain);
    for (int level = 1; level < filter.n_level; level++) {
        filter.coef[level] = filter.coef[0] + first[level] * numbers_of(&filter);
        reduce(&filter, level);
    }
    *out = filter;
    return DIF_OK;
}

void dif_lut_filter_free(dif_lut_filter *filter)
{
    dif_release(filter->coef[0]);
    *filter = (dif_lut_filter){0};
}

void dif_lut_filter_probes(int n_side, const double cov[3], dif_lut_probes *out)
{
    const double mean = 0.5 * (cov[0] + cov[1]), half = 0.5 * (cov[0] - cov[1]), spread = hypot(half, cov[2]);
    const double major = sqrt(fmax(mean + spread, 0.0)), thin = sqrt(fmax(mean - spread, 0.0));
    const double angle = 0.5 * atan2(cov[2], half);
    /* probes two widths apart over five standard deviations, so that the shorter axis may have to be widened */
    const double minor = fmax(fmax(thin, 2.5 * major / DIF_LUT_FILTER_PROBES), 1e-12);
    const double along = sqrt(fmax(major * major - minor * minor, 0.0));
    const int n = (int)fmin(fmax(ceil(2.5 * along / minor - 1e-6), 1.0), DIF_LUT_FILTER_PROBES);
    double sum = 0.0, variance = 0.0;
    out->n = n;
    out->level = log2(2.0 * minor * n_side / 4.0); /* a texel read linearly has half its width as standard deviation */
    for (int i = 0; i < n; i++) {
        const double at = 5.0 * ((i + 0.5) / n - 0.5); /* standard deviations */
        out->weight[i] = exp(-0.5 * at * at);
        sum += out->weight[i];
        variance += out->weight[i] * at * at;
    }
    const double spread_out = n > 1 ? along / sqrt(variance / sum) : 0.0; /* few probes have the variance, too */
    for (int i = 0; i < n; i++) {
        const double at = 5.0 * ((i + 0.5) / n - 0.5) * spread_out;
        out->offset[i][0] = at * cos(angle);
        out->offset[i][1] = at * sin(angle);
        out->weight[i] /= sum;
    }
}

/* The four texels around a place in a level, cut at the edges, with weights times `scale`. */
static void corners(const dif_lut_filter *filter, int level, double u, double v, double scale, const float *texel[4],
                    double weight[4])
{
    const int n = filter->n >> level;
    const double x = fmin(fmax((u + 2.0) / 4.0 * n - 0.5, 0.0), n - 1.0);
    const double y = fmin(fmax((v + 2.0) / 4.0 * n - 0.5, 0.0), n - 1.0);
    const int ix = (int)fmin(floor(x), fmax(n - 2.0, 0.0)), iy = (int)fmin(floor(y), fmax(n - 2.0, 0.0));
    for (int i = 0; i < 4; i++) {
        const int jx = n > 1 ? ix + i % 2 : 0, jy = n > 1 ? iy + i / 2 : 0;
        texel[i] = filter->coef[level] + ((size_t)jy * (size_t)n + (size_t)jx) * numbers_of(filter);
        weight[i] = scale * (i % 2 ? x - ix : 1.0 - (x - ix)) * (i / 2 ? y - iy : 1.0 - (y - iy));
    }
}

/* Clenshaw's sum over weighted texels. */
static void add_sum(const dif_lut *lut, int n_texel, const float *const *texel, const double *weight, double t,
                    double xyz[3])
{
    double next[3] = {0.0}, after[3] = {0.0};
    for (int n = lut->n_map - 1; n >= 0; n--)
        for (int c = 0; c < 3; c++) {
            double q = 0.0;
            for (int i = 0; i < n_texel; i++)
                q += weight[i] * (double)texel[i][3 * n + c];
            const double here = q + (n == 0 ? t : 2.0 * t) * next[c] - after[c];
            after[c] = next[c];
            next[c] = here;
        }
    for (int c = 0; c < 3; c++)
        xyz[c] += next[c];
}

static void add_probe(const dif_lut_filter *filter, double u, double v, double w, double level, double weight,
                      double xyz[3])
{
    const double share = fmin(fmax(level + 1.0, 0.0), 1.0); /* of the pyramid */
    if (share < 1.0) {
        double fine[3];
        dif_lut_eval(filter->lut, u, v, w, fine);
        for (int c = 0; c < 3; c++)
            xyz[c] += weight * (1.0 - share) * fine[c];
    }
    if (share == 0.0)
        return;
    const float *texel[8];
    double part[8];
    const double at = fmin(fmax(level, 0.0), filter->n_level - 1.0);
    const int low = (int)fmin(floor(at), filter->n_level - 2.0);
    corners(filter, low, u, v, weight * share * (1.0 - (at - low)), texel, part);
    corners(filter, low + 1, u, v, weight * share * (at - low), texel + 4, part + 4);
    const double range = sqrt(fmax(4.0 - u * u - v * v, 1e-12));
    add_sum(filter->lut, 8, texel, part, fmin(fmax(2.0 * fabs(w) / range - 1.0, -1.0), 1.0), xyz);
}

/* The spot's light times the density of the Gaussian, widened by the spot's own width, at (u, v). */
static void add_spot(const dif_lut_filter *filter, double u, double v, double w, const double cov[3], double share,
                     double xyz[3])
{
    const double uu = cov[0] + filter->spot_variance, vv = cov[1] + filter->spot_variance, uv = cov[2];
    const double det = uu * vv - uv * uv, t = fmin(fmax(fabs(w) - 1.0, -1.0), 1.0);
    if (!(filter->spot_radius > 0.0 && det > 0.0 && share > 0.0))
        return;
    const double density = exp(-0.5 * (vv * u * u - 2.0 * uv * u * v + uu * v * v) / det) / (DIF_TWO_PI * sqrt(det));
    double next[3] = {0.0}, after[3] = {0.0};
    for (int n = filter->lut->n_map - 1; n >= 0; n--)
        for (int c = 0; c < 3; c++) {
            const double here = filter->spot[n][c] + (n == 0 ? t : 2.0 * t) * next[c] - after[c];
            after[c] = next[c];
            next[c] = here;
        }
    for (int c = 0; c < 3; c++)
        xyz[c] += share * density * next[c];
}

int dif_lut_filter_eval(const dif_lut_filter *filter, double u, double v, double w, const double cov[3], double xyz[3])
{
    dif_lut_probes probes;
    dif_lut_filter_probes(filter->n, cov, &probes);
    xyz[0] = xyz[1] = xyz[2] = 0.0;
    for (int i = 0; i < probes.n; i++)
        add_probe(filter, u + probes.offset[i][0], v + probes.offset[i][1], w, probes.level, probes.weight[i], xyz);
    add_spot(filter, u, v, w, cov, fmin(fmax(probes.level + 1.0, 0.0), 1.0), xyz);
    return probes.level > -1.0 && probes.level < 0.0 ? 2 * probes.n : probes.n;
}
