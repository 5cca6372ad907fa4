#include "core/transfer.h"

#include <math.h>

#include "core/alloc.h"
#include "core/slope.h"

enum { SIDE_MAX = 4096 };

static double sigma_of_row(int row, int n_row)
{
    const double part = (double)row / (n_row - 1);
    return DIF_TRANSFER_SIGMA_MAX * part * part;
}

/* reach[i + n] = R(t) for mean - t = i / (n - 1), i = -n ... n - 1. */
static void fill_reach(int n, double sigma, double *reach)
{
    for (int i = -n; i < n; i++) {
        const double away = (double)i / (n - 1);
        reach[i + n] = sigma > 0.0 ? sigma * dif_slope_cut_at(away / sigma).psi : fmax(away, 0.0);
    }
}

static void fill_row(int n, const double (*colour)[3], const double *reach, float *rgb)
{
    for (int at = 0; at < n; at++)
        for (int c = 0; c < 3; c++) {
            double sum = colour[0][c];
            for (int i = 0; i + 1 < n; i++)
                sum += (colour[i + 1][c] - colour[i][c]) * (n - 1) * (reach[at - i + n] - reach[at - i - 1 + n]);
            rgb[3 * at + c] = (float)sum;
        }
}

dif_status dif_transfer_create(int n, const double (*colour)[3], int n_sigma, dif_transfer *out, dif_error *err)
{
    *out = (dif_transfer){0};
    if (!(n >= 2 && n <= SIDE_MAX && n_sigma >= 2 && n_sigma <= SIDE_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d colours and %d widths, want 2 ... %d", n, n_sigma, SIDE_MAX);
    for (int i = 0; i < n; i++)
        if (!(isfinite(colour[i][0]) && isfinite(colour[i][1]) && isfinite(colour[i][2])))
            return dif_fail(err, DIF_ERR_ARG, "colour %d is not finite", i);
    double *reach = dif_alloc(2 * (size_t)n, sizeof *reach);
    out->rgb = dif_alloc((size_t)n * (size_t)n_sigma, 3 * sizeof *out->rgb);
    if (!reach || !out->rgb) {
        dif_release(reach);
        dif_transfer_free(out);
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d x %d colours", n, n_sigma);
    }
    out->n_mean = n;
    out->n_sigma = n_sigma;
    for (int row = 0; row < n_sigma; row++) {
        fill_reach(n, sigma_of_row(row, n_sigma), reach);
        fill_row(n, colour, reach, out->rgb + 3 * (size_t)row * (size_t)n);
    }
    dif_release(reach);
    return DIF_OK;
}

void dif_transfer_free(dif_transfer *transfer)
{
    dif_release(transfer->rgb);
    *transfer = (dif_transfer){0};
}

/* Place in a table of n entries: index of the first of two, and the part of the second. */
static int place(double at, int n, double *part)
{
    const double cut = fmin(fmax(at, 0.0), n - 1.0); /* NaN becomes 0 */
    const int first = cut < n - 2 ? (int)cut : n - 2;
    *part = cut - first;
    return first;
}

void dif_transfer_colour(const dif_transfer *transfer, double mean, double sigma, double rgb[3])
{
    double x, y;
    const int n = transfer->n_mean, i = place(mean * (n - 1), n, &x);
    const int j =
        place(sqrt(fmax(sigma, 0.0) / DIF_TRANSFER_SIGMA_MAX) * (transfer->n_sigma - 1), transfer->n_sigma, &y);
    const float *upper = transfer->rgb + 3 * ((size_t)j * (size_t)n + (size_t)i), *lower = upper + 3 * (size_t)n;
    for (int c = 0; c < 3; c++)
        rgb[c] = (1.0 - y) * ((1.0 - x) * (double)upper[c] + x * (double)upper[c + 3]) +
                 y * ((1.0 - x) * (double)lower[c] + x * (double)lower[c + 3]);
}
