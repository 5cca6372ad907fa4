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

static void fill(const dif_field *field, double scale, dif_meso *meso)
{
    for (int iy = 0; iy < meso->ny; iy++)
        for (int ix = 0; ix < meso->nx; ix++) {
            float *to = meso->moment[0] + (size_t)DIF_MESO_MOMENTS * ((size_t)iy * (size_t)meso->nx + (size_t)ix);
            double s[2];
            cell_slope(field, (ix + 0.5) * field->nx / meso->nx - 1.0, (iy + 0.5) * field->ny / meso->ny - 1.0, s);
            to[0] = (float)(scale * s[0]);
            to[1] = (float)(scale * s[1]);
            to[2] = to[0] * to[0];
            to[3] = to[1] * to[1];
            to[4] = to[0] * to[1];
        }
}

static int side(int n, int level)
{
    return n >> level > 0 ? n >> level : 1;
}

/* A level from the one below it. */
static void reduce(const dif_meso *meso, int level)
{
    const int nx = side(meso->nx, level), ny = side(meso->ny, level);
    const int mx = side(meso->nx, level - 1), my = side(meso->ny, level - 1);
    for (int iy = 0; iy < ny; iy++)
        for (int ix = 0; ix < nx; ix++)
            for (size_t c = 0; c < DIF_MESO_MOMENTS; c++) {
                float sum = 0.0F;
                for (int i = 0; i < 4; i++) {
                    const int jx = mx > 1 ? 2 * ix + i % 2 : 0, jy = my > 1 ? 2 * iy + i / 2 : 0;
                    sum += meso->moment[level - 1][DIF_MESO_MOMENTS * ((size_t)jy * (size_t)mx + (size_t)jx) + c];
                }
                meso->moment[level][DIF_MESO_MOMENTS * ((size_t)iy * (size_t)nx + (size_t)ix) + c] = 0.25F * sum;
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
    fill(field, scale, &meso);
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

/* Linear read of a level at tile coordinates, which repeat; adds weight times the first n_moment moments. */
static void add_level(const dif_meso *meso, int level, const double at[2], double weight, int n_moment, double *sum)
{
    const int nx = side(meso->nx, level), ny = side(meso->ny, level);
    const double x = (at[0] - floor(at[0])) * nx - 0.5, y = (1.0 - (at[1] - floor(at[1]))) * ny - 0.5;
    const double right = x - floor(x), down = y - floor(y);
    const int ix = (int)floor(x) + nx, iy = (int)floor(y) + ny;
    for (int i = 0; i < 4; i++) {
        const size_t jx = (size_t)((ix + i % 2) % nx), jy = (size_t)((iy + i / 2) % ny);
        const float *from = meso->moment[level] + DIF_MESO_MOMENTS * (jy * (size_t)nx + jx);
        const double part = weight * (i % 2 ? right : 1.0 - right) * (i / 2 ? down : 1.0 - down);
        for (int c = 0; c < n_moment; c++)
            sum[c] += part * (double)from[c];
    }
}

void dif_meso_slope(const dif_meso *meso, const double uv[2], double s[2])
{
    const double at[2] = {meso->tiles * uv[0], meso->tiles * uv[1]};
    s[0] = s[1] = 0.0;
    add_level(meso, 0, at, 1.0, 2, s);
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
    const double lod = log2(minor), level = fmin(fmax(lod, 0.0), meso->n_level - 1.0);
    const int low = (int)fmin(floor(level), fmax(meso->n_level - 2.0, 0.0));
    double sum[DIF_MESO_MOMENTS] = {0.0};
    for (int k = 0; k < n; k++) {
        const double along = e.major * ((k + 0.5) / n - 0.5);
        const double at[2] = {meso->tiles * uv[0] + along * e.major_axis[0] / meso->nx,
                              meso->tiles * uv[1] + along * e.major_axis[1] / meso->ny};
        add_level(meso, low, at, (1.0 - (level - low)) / n, DIF_MESO_MOMENTS, sum);
        if (level > low)
            add_level(meso, low + 1, at, (level - low) / n, DIF_MESO_MOMENTS, sum);
    }
    const double fade = fmin(fmax(log2(fmax(e.major, 1e-12)) + 1.0, 0.0), 1.0);
    out->mean_x = sum[0];
    out->mean_y = sum[1];
    out->var_x = fade * fmax(sum[2] - sum[0] * sum[0], 0.0);
    out->var_y = fade * fmax(sum[3] - sum[1] * sum[1], 0.0);
    const double most = sqrt(out->var_x * out->var_y);
    out->cov_xy = fmin(fmax(fade * (sum[4] - sum[0] * sum[1]), -most), most);
    return n;
}
