#include "core/meso.h"

#include <math.h>

#include "core/alloc.h"

enum { SIDE_MAX = 1 << (DIF_MESO_LEVELS - 1) };

static int power_above(int n)
{
    int p = 1;
    while (p < n && p < SIDE_MAX)
        p *= 2;
    return p;
}

/* Samples of a cell of field at (x, y) in cells, cut at the edges, linear between cells. */
static void cell_slope(const dif_field *field, double x, double y, double s[2])
{
    const int nx = field->nx - 1, ny = field->ny - 1;
    const double cx = fmin(fmax(x, 0.0), nx - 1.0), cy = fmin(fmax(y, 0.0), ny - 1.0);
    const int ix = (int)fmin(floor(cx), fmax(nx - 2.0, 0.0)), iy = (int)fmin(floor(cy), fmax(ny - 2.0, 0.0));
    const double right = cx - ix, down = cy - iy;
    s[0] = s[1] = 0.0;
    for (int i = 0; i < 4; i++) {
        const int jx = ix + i % 2 < nx ? ix + i % 2 : ix, jy = iy + i / 2 < ny ? iy + i / 2 : iy;
        const double weight = (i % 2 ? right : 1.0 - right) * (i / 2 ? down : 1.0 - down);
        double here[2];
        dif_slope_of_cell(field, jx, jy, here);
        for (int c = 0; c < 2; c++)
            s[c] += weight * here[c];
    }
}

static void fill_slopes(const dif_field *field, double scale, dif_meso *meso)
{
    for (int iy = 0; iy < meso->ny; iy++)
        for (int ix = 0; ix < meso->nx; ix++) {
            float *to = meso->moment[0] + DIF_MESO_MOMENTS * ((size_t)iy * (size_t)meso->nx + (size_t)ix);
            double s[2];
            cell_slope(field, (ix + 0.5) * field->nx / meso->nx - 1.0, (iy + 0.5) * field->ny / meso->ny - 1.0, s);
            to[0] = (float)(scale * s[0]);
            to[1] = (float)(scale * s[1]);
        }
}

/* Moments within a texel of slopes that are linear between it and its neighbours: integrals over the texel of the hat
 * functions of the three along an axis, and of their products. */
static void texel_moments(const dif_meso *meso, int ix, int iy, double out[DIF_MESO_MOMENTS])
{
    static const double HAT[3] = {1.0 / 8.0, 3.0 / 4.0, 1.0 / 8.0};
    static const double PRODUCT[3][3] = {
        {1.0 / 24.0, 1.0 / 12.0, 0.0}, {1.0 / 12.0, 7.0 / 12.0, 1.0 / 12.0}, {0.0, 1.0 / 12.0, 1.0 / 24.0}};
    double s[9][2];
    for (int c = 0; c < DIF_MESO_MOMENTS; c++)
        out[c] = 0.0;
    for (int i = 0; i < 9; i++) {
        const size_t jx = (size_t)((ix + i % 3 - 1 + meso->nx) % meso->nx);
        const size_t jy = (size_t)((iy + i / 3 - 1 + meso->ny) % meso->ny);
        for (size_t c = 0; c < 2; c++) {
            s[i][c] = (double)meso->moment[0][DIF_MESO_MOMENTS * (jy * (size_t)meso->nx + jx) + c];
            out[c] += HAT[i % 3] * HAT[i / 3] * s[i][c];
        }
    }
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 9; k++) {
            const double weight = PRODUCT[i % 3][k % 3] * PRODUCT[i / 3][k / 3];
            out[2] += weight * (s[i][0] - out[0]) * (s[k][0] - out[0]);
            out[3] += weight * (s[i][1] - out[1]) * (s[k][1] - out[1]);
            out[4] += weight * (s[i][0] - out[0]) * (s[k][1] - out[1]);
        }
}

static int side(int n, int level)
{
    return n >> level > 0 ? n >> level : 1;
}

/* The moments of a block from those of its four parts. */
static void join(double part[4][DIF_MESO_MOMENTS], float *to)
{
    double sum[DIF_MESO_MOMENTS] = {0.0};
    for (int c = 0; c < DIF_MESO_MOMENTS; c++)
        for (int i = 0; i < 4; i++)
            sum[c] += 0.25 * part[i][c];
    for (int i = 0; i < 4; i++) {
        const double x = part[i][0] - sum[0], y = part[i][1] - sum[1];
        sum[2] += 0.25 * x * x;
        sum[3] += 0.25 * y * y;
        sum[4] += 0.25 * x * y;
    }
    for (int c = 0; c < DIF_MESO_MOMENTS; c++)
        to[c] = (float)sum[c];
}

/* A level from the one below it; the lowest, whose slopes are not means, gives its covariances on the way. */
static void reduce(const dif_meso *meso, int level)
{
    const int nx = side(meso->nx, level), ny = side(meso->ny, level);
    const int mx = side(meso->nx, level - 1), my = side(meso->ny, level - 1);
#pragma omp parallel for
    for (int iy = 0; iy < ny; iy++)
        for (int ix = 0; ix < nx; ix++) {
            double part[4][DIF_MESO_MOMENTS];
            for (int i = 0; i < 4; i++) {
                const int jx = mx > 1 ? 2 * ix + i % 2 : 0, jy = my > 1 ? 2 * iy + i / 2 : 0;
                float *from = meso->moment[level - 1] + DIF_MESO_MOMENTS * ((size_t)jy * (size_t)mx + (size_t)jx);
                if (level == 1)
                    texel_moments(meso, jx, jy, part[i]);
                for (int c = level == 1 ? 2 : 0; c < DIF_MESO_MOMENTS; c++) {
                    if (level == 1)
                        from[c] = (float)part[i][c];
                    part[i][c] = (double)from[c];
                }
            }
            join(part, meso->moment[level] + DIF_MESO_MOMENTS * ((size_t)iy * (size_t)nx + (size_t)ix));
        }
}

dif_status dif_meso_create(const dif_field *field, double scale, double tiles, dif_meso *out, dif_error *err)
{
    *out = (dif_meso){0};
    if (!isfinite(scale))
        return dif_fail(err, DIF_ERR_ARG, "mesostructure: slopes scaled by %g, want a finite number", scale);
    if (!(tiles > 0.0 && isfinite(tiles)))
        return dif_fail(err, DIF_ERR_ARG, "mesostructure: %g tiles, want more than 0", tiles);
    if (field->nx < 2 || field->ny < 2)
        return dif_fail(err, DIF_ERR_SIZE, "mesostructure of %d x %d samples, want at least 2 x 2", field->nx,
                        field->ny);
    dif_meso meso = {.nx = power_above(field->nx), .ny = power_above(field->ny), .tiles = tiles};
    size_t n = 0, first[DIF_MESO_LEVELS];
    do {
        first[meso.n_level] = n;
        n += (size_t)DIF_MESO_MOMENTS * (size_t)side(meso.nx, meso.n_level) * (size_t)side(meso.ny, meso.n_level);
        meso.n_level++;
    } while (side(meso.nx, meso.n_level - 1) > 1 || side(meso.ny, meso.n_level - 1) > 1);
    meso.moment[0] = dif_alloc(n, sizeof *meso.moment[0]);
    if (!meso.moment[0])
        return dif_fail(err, DIF_ERR_NOMEM, "mesostructure of %d x %d slopes", meso.nx, meso.ny);
    fill_slopes(field, scale, &meso);
    for (int level = 1; level < meso.n_level; level++) {
        meso.moment[level] = meso.moment[0] + first[level];
        reduce(&meso, level);
    }
    *out = meso;
    return DIF_OK;
}

void dif_meso_free(dif_meso *meso)
{
    dif_release(meso->moment[0]);
    *meso = (dif_meso){0};
}

/* Linear read of a level at tile coordinates, which repeat; adds weight times the moments first ... end - 1. */
static void add_level(const dif_meso *meso, int level, const double at[2], double weight, int first, int end,
                      double *sum)
{
    const int nx = side(meso->nx, level), ny = side(meso->ny, level);
    const double x = (at[0] - floor(at[0])) * nx - 0.5, y = (1.0 - (at[1] - floor(at[1]))) * ny - 0.5;
    const double right = x - floor(x), down = y - floor(y);
    const int ix = (int)floor(x) + nx, iy = (int)floor(y) + ny;
    for (int i = 0; i < 4; i++) {
        const size_t jx = (size_t)((ix + i % 2) % nx), jy = (size_t)((iy + i / 2) % ny);
        const float *from = meso->moment[level] + DIF_MESO_MOMENTS * (jy * (size_t)nx + jx);
        const double part = weight * (i % 2 ? right : 1.0 - right) * (i / 2 ? down : 1.0 - down);
        for (int c = first; c < end; c++)
            sum[c] += part * (double)from[c];
    }
}

void dif_meso_slope(const dif_meso *meso, const double uv[2], double s[2])
{
    const double at[2] = {meso->tiles * uv[0], meso->tiles * uv[1]};
    s[0] = s[1] = 0.0;
    add_level(meso, 0, at, 1.0, 0, 2, s);
}

/* Two levels and the share of the upper one. */
typedef struct blend {
    int low;
    double share;
} blend;

static blend blend_of(const dif_meso *meso, double width)
{
    const double level = fmin(fmax(log2(width), 0.0), meso->n_level - 1.0);
    const int low = (int)fmin(floor(level), meso->n_level - 2.0);
    return (blend){low, level - low};
}

static void add_blend(const dif_meso *meso, blend at_level, const double at[2], int first, int end, double *sum)
{
    add_level(meso, at_level.low, at, 1.0 - at_level.share, first, end, sum);
    if (at_level.share > 0.0)
        add_level(meso, at_level.low + 1, at, at_level.share, first, end, sum);
}

int dif_meso_moments(const dif_meso *meso, const double uv[2], const dif_footprint *footprint, dif_slope_gauss *out)
{
    const double scale[2] = {meso->tiles * meso->nx, meso->tiles * meso->ny};
    dif_footprint texels = *footprint;
    for (int c = 0; c < 2; c++) {
        texels.w1[c] *= scale[c];
        texels.w2[c] *= scale[c];
    }
    const dif_footprint_ellipse e = dif_footprint_ellipse_of(&texels);
    const double minor = fmax(fmax(e.minor, e.major / DIF_MESO_PROBES), 1e-12);
    const int n = (int)fmin(fmax(ceil(e.major / minor - 1e-9), 1.0), DIF_MESO_PROBES);
    /* the reads' own spread and that within a block make up the longer axis */
    const double reach = n > 1 ? sqrt(fmax(e.major * e.major - minor * minor, 0.0) / (1.0 - 1.0 / (n * n))) : 0.0;
    const blend means = blend_of(meso, minor / sqrt(3.0)); /* a linear read of blocks is sqrt(3) times as wide */
    blend spreads = blend_of(meso, minor);
    const bool same = means.low == spreads.low && means.share == spreads.share;
    spreads.share = (exp2(2.0 * spreads.share) - 1.0) / 3.0; /* covariances grow like the square of the width */
    double mean[DIF_MESO_MOMENTS] = {0.0}, square[3] = {0.0}, origin[2] = {0.0};
    for (int k = 0; k < n; k++) {
        const double along = reach * ((k + 0.5) / n - 0.5);
        const double at[2] = {meso->tiles * uv[0] + along * e.major_axis[0] / meso->nx,
                              meso->tiles * uv[1] + along * e.major_axis[1] / meso->ny};
        double here[2] = {0.0};
        add_blend(meso, means, at, 0, 2, here);
        add_blend(meso, spreads, at, 2, DIF_MESO_MOMENTS, mean);
        for (int c = 0; c < 2; c++) { /* from the first, lest squares of large means cancel */
            origin[c] = k == 0 ? here[c] : origin[c];
            here[c] -= origin[c];
            mean[c] += here[c];
            square[c] += here[c] * here[c] / n;
        }
        square[2] += here[0] * here[1] / n;
    }
    for (int c = 0; c < DIF_MESO_MOMENTS; c++)
        mean[c] /= n;
    const double within = fmin(minor * minor, 1.0); /* below a texel */
    out->mean_x = origin[0] + mean[0];
    out->mean_y = origin[1] + mean[1];
    out->var_x = within * mean[2] + fmax(square[0] - mean[0] * mean[0], 0.0);
    out->var_y = within * mean[3] + fmax(square[1] - mean[1] * mean[1], 0.0);
    const double most = sqrt(out->var_x * out->var_y);
    out->cov_xy = fmin(fmax(within * mean[4] + square[2] - mean[0] * mean[1], -most), most);
    return same ? n : 2 * n;
}
