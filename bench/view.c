#include "bench/view.h"

#include <math.h>
#include <stdlib.h>

#include "core/alloc.h"
#include "core/colour.h"
#include "core/io/image_cv.h"
#include "core/units.h"

enum { SIGMA_ROWS = 64 };

dif_view_plan dif_view_plan_default(void)
{
    return (dif_view_plan){.zoom = 1.0, .phi_rad = 1.5 * DIF_PI, .n_across = 8, .n_sample = 32, .seed = 1};
}

void dif_view_free(dif_view *view)
{
    dif_release(view->rgb);
    dif_release(view->inside);
    *view = (dif_view){0};
}

static dif_status check_plan(const dif_view_plan *plan, dif_error *err)
{
    if (!(plan->zoom > 0.0 && plan->zoom < 1e6))
        return dif_fail(err, DIF_ERR_ARG, "zoom %g, want > 0", plan->zoom);
    if (!(plan->theta_rad >= 0.0 && plan->theta_rad <= dif_rad_from_deg(89.0) && isfinite(plan->phi_rad)))
        return dif_fail(err, DIF_ERR_ARG, "view from theta %g, phi %g rad, want 0 ... 89 degrees and a number",
                        plan->theta_rad, plan->phi_rad);
    if (!(plan->n_across >= 2 && plan->n_across <= 16))
        return dif_fail(err, DIF_ERR_ARG, "%d places across a footprint, want 2 ... 16", plan->n_across);
    if (!(plan->n_sample >= 1 && plan->n_sample <= 256))
        return dif_fail(err, DIF_ERR_ARG, "%d samples on a side of a pixel, want 1 ... 256", plan->n_sample);
    return DIF_OK;
}

/* Everything that painting needs. A pixel's middle (a, b), counted from the picture's, lies at sample
 * (u0, v0) + a w1 + b w2. */
typedef struct job {
    const dif_pyramid *pyramid;
    const dif_transfer *transfer;
    const dif_view_plan *plan;
    dif_view_filter filter;
    dif_footprint footprint;
    double u0, v0;
    dif_view *view;
} job;

/* Jacobian of the picture, its inverse, and the picture's size. */
static dif_status place(job *j, double pitch_ratio, dif_error *err)
{
    const dif_view_plan *plan = j->plan;
    const int nx = j->pyramid->nx[0], ny = j->pyramid->ny[0];
    const double up_x = -cos(plan->phi_rad), up_y = -sin(plan->phi_rad), squeeze = cos(plan->theta_rad);
    const double da_du = plan->zoom * up_y,
                 da_dv = plan->zoom * up_x * pitch_ratio; /* right = (up_y, -up_x), v runs down */
    const double db_du = -plan->zoom * squeeze * up_x, db_dv = plan->zoom * squeeze * up_y * pitch_ratio;
    const double across = fabs(da_du) * nx + fabs(da_dv) * ny, down = fabs(db_du) * nx + fabs(db_dv) * ny;
    if (!(across <= DIF_VIEW_SIDE_MAX && down <= DIF_VIEW_SIDE_MAX))
        return dif_fail(err, DIF_ERR_SIZE, "picture of %.0f x %.0f pixels, want at most %d on a side (a smaller zoom)",
                        across, down, DIF_VIEW_SIDE_MAX);
    j->footprint = dif_footprint_from_screen(da_du, db_du, da_dv, db_dv, 4.0 * (nx + ny) / fmin(squeeze, 1.0));
    j->u0 = 0.5 * (nx - 1);
    j->v0 = 0.5 * (ny - 1);
    j->view->nx = (int)fmax(ceil(across - 1e-9), 1.0);
    j->view->ny = (int)fmax(ceil(down - 1e-9), 1.0);
    return DIF_OK;
}

static int inside_of(const job *j, double u, double v)
{
    const dif_footprint *f = &j->footprint;
    const double du = 0.5 * (fabs(f->w1[0]) + fabs(f->w2[0])), dv = 0.5 * (fabs(f->w1[1]) + fabs(f->w2[1]));
    const double right = j->pyramid->nx[0] - 0.5 + 1e-6, low = j->pyramid->ny[0] - 0.5 + 1e-6, edge = -0.5 - 1e-6;
    if (!(u > edge && u < right && v > edge && v < low))
        return 0;
    return u - du > edge && u + du < right && v - dv > edge && v + dv < low ? 2 : 1;
}

/* splitmix64, in [0, 1). */
static double random_next(unsigned long long *state)
{
    unsigned long long z = (*state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void supersample(const job *j, size_t pixel, double u, double v, double rgb[3])
{
    const int n = j->plan->n_sample;
    const double *w1 = j->footprint.w1, *w2 = j->footprint.w2;
    unsigned long long state = ((unsigned long long)j->plan->seed << 40) ^ (pixel * 0x9e3779b97f4a7c15ull);
    rgb[0] = rgb[1] = rgb[2] = 0.0;
    for (int k = 0; k < n * n; k++) {
        const double a = (k % n + random_next(&state)) / n - 0.5, b = (k / n + random_next(&state)) / n - 0.5;
        double colour[3];
        dif_transfer_colour(j->transfer,
                            dif_pyramid_height(j->pyramid, u + a * w1[0] + b * w2[0], v + a * w1[1] + b * w2[1]), 0.0,
                            colour);
        for (int c = 0; c < 3; c++)
            rgb[c] += colour[c] / (n * n);
    }
}

/* Colours one pixel; returns the places read. */
static int colour_pixel(const job *j, size_t pixel, double u, double v, double rgb[3])
{
    double mean, sigma;
    if (j->filter == DIF_VIEW_TRUTH) {
        supersample(j, pixel, u, v, rgb);
        return j->plan->n_sample * j->plan->n_sample;
    }
    if (j->filter == DIF_VIEW_POINT) {
        dif_transfer_colour(j->transfer, dif_pyramid_height(j->pyramid, u, v), 0.0, rgb);
        return 1;
    }
    const int n = dif_pyramid_footprint(j->pyramid, u, v, &j->footprint, j->plan->n_across, &mean, &sigma);
    dif_transfer_colour(j->transfer, mean, j->filter == DIF_VIEW_MEAN ? 0.0 : sigma, rgb);
    return n;
}

static void paint_row(const job *j, int iy, size_t *n_inside, size_t *n_read)
{
    const dif_view *view = j->view;
    for (int ix = 0; ix < view->nx; ix++) {
        const double a = ix - 0.5 * (view->nx - 1), b = iy - 0.5 * (view->ny - 1);
        const double u = j->u0 + a * j->footprint.w1[0] + b * j->footprint.w2[0];
        const double v = j->v0 + a * j->footprint.w1[1] + b * j->footprint.w2[1];
        const size_t at = (size_t)iy * (size_t)view->nx + (size_t)ix;
        double rgb[3] = {1.0, 1.0, 1.0};
        view->inside[at] = (uint8_t)inside_of(j, u, v);
        if (view->inside[at]) {
            *n_read += (size_t)colour_pixel(j, at, u, v, rgb);
            ++*n_inside;
        }
        for (size_t c = 0; c < 3; c++)
            view->rgb[3 * at + c] = (float)rgb[c];
    }
}

dif_status dif_view_make(const dif_pyramid *pyramid, double pitch_ratio, const dif_transfer *transfer,
                         const dif_view_plan *plan, dif_view_filter filter, dif_view *out, dif_error *err)
{
    job j = {.pyramid = pyramid, .transfer = transfer, .plan = plan, .filter = filter, .view = out};
    *out = (dif_view){0};
    dif_status status = check_plan(plan, err);
    if (!status)
        status = place(&j, pitch_ratio, err);
    if (status) {
        *out = (dif_view){0};
        return status;
    }
    const size_t n = (size_t)out->nx * (size_t)out->ny;
    out->rgb = dif_alloc(n, 3 * sizeof *out->rgb);
    out->inside = dif_alloc(n, sizeof *out->inside);
    if (!out->rgb || !out->inside) {
        dif_view_free(out);
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for a picture of %zu pixels", n);
    }
    size_t n_inside = 0, n_read = 0;
#pragma omp parallel for schedule(dynamic) reduction(+ : n_inside, n_read)
    for (int iy = 0; iy < out->ny; iy++)
        paint_row(&j, iy, &n_inside, &n_read);
    out->n_read = n_inside ? (double)n_read / (double)n_inside : 0.0;
    return DIF_OK;
}

static void lab_of(const float *linear, double lab[3])
{
    double rgb[3], xyz[3];
    for (int c = 0; c < 3; c++)
        rgb[c] = (double)linear[c];
    dif_colour_xyz_from_rgb(rgb, xyz);
    dif_colour_lab_from_xyz(xyz, lab);
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Differences of all pixels that count: de[out->n]; sums into *out. */
static void fill_differences(const dif_view *view, const dif_view *truth, double *de, dif_view_difference *out)
{
    double sum = 0.0, square = 0.0;
    const size_t n = (size_t)view->nx * (size_t)view->ny;
    for (size_t i = 0; i < n; i++) {
        double a[3], b[3];
        if (view->inside[i] != 2)
            continue;
        lab_of(view->rgb + 3 * i, a);
        lab_of(truth->rgb + 3 * i, b);
        const double here = dif_colour_difference_2000(a, b);
        if (here > out->de_worst) {
            out->de_worst = here;
            out->worst_x = (int)(i % (size_t)view->nx);
            out->worst_y = (int)(i / (size_t)view->nx);
        }
        for (size_t c = 0; c < 3; c++) {
            const double d = (double)view->rgb[3 * i + c] - (double)truth->rgb[3 * i + c];
            square += d * d;
        }
        sum += here;
        de[out->n++] = here;
    }
    if (out->n == 0)
        return;
    qsort(de, out->n, sizeof *de, by_size);
    out->de_mean = sum / (double)out->n;
    out->de_median = de[out->n / 2];
    out->de_p95 = de[(size_t)(0.95 * (double)(out->n - 1))];
    out->rms = sqrt(square / (3.0 * (double)out->n));
}

dif_status dif_view_compare(const dif_view *view, const dif_view *truth, dif_view_difference *out, dif_error *err)
{
    *out = (dif_view_difference){0};
    if (view->nx != truth->nx || view->ny != truth->ny)
        return dif_fail(err, DIF_ERR_ARG, "views of %d x %d and %d x %d pixels, want one size", view->nx, view->ny,
                        truth->nx, truth->ny);
    double *de = dif_alloc((size_t)view->nx * (size_t)view->ny, sizeof *de);
    if (!de)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory to compare %d x %d pixels", view->nx, view->ny);
    fill_differences(view, truth, de, out);
    dif_release(de);
    return DIF_OK;
}

dif_status dif_view_transfer(const char *colour_map, dif_transfer *out, dif_error *err)
{
    uint8_t bytes[256][3];
    double linear[256][3];
    *out = (dif_transfer){0};
    const dif_status status = dif_image_colormap(colour_map, bytes, err);
    if (status)
        return status;
    for (int i = 0; i < 256; i++)
        for (int c = 0; c < 3; c++)
            linear[i][c] = dif_colour_decode(bytes[i][c] / 255.0);
    return dif_transfer_create(256, (const double(*)[3])linear, SIGMA_ROWS, out, err);
}

void dif_view_encode(const dif_view *view, uint8_t *bytes)
{
    const size_t n = 3 * (size_t)view->nx * (size_t)view->ny;
    for (size_t i = 0; i < n; i++)
        bytes[i] = (uint8_t)(255.0 * dif_colour_encode(fmin(fmax((double)view->rgb[i], 0.0), 1.0)) + 0.5);
}
