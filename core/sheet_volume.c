/* The volume form: every plane is transformed along x, then along y, and only the wanted bins are kept.
 *
 * Between the two passes the kept columns wait in `mid`, float or double as the planes; when they would take more than
 * MID_BYTES_MAX the x bins are done in several runs, each of which makes the plane factors again. */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "core/alloc.h"
#include "core/fft.h"
#include "core/sheet_impl.h"

/* Less oversampling and more taps than a line: here the DFT is what costs. */
#define SIGMA_VOLUME  1.5
#define MID_BYTES_MAX ((size_t)640 << 20)

enum { ROWS = 8, PLANES = 4 }; /* rows and planes that one pass over x takes together */

typedef struct volume_build {
    dif_sheet *sheet;
    const dif_field *field;
    dif_plane_factors factors;
    int n_plane; /* computed planes                                                          */
    int n_dft_x, n_dft_y;
    double *wx, *wy;
    int bin0, n_bin; /* x bins of this run                                                       */
    int n_row;       /* ny rounded up to whole groups of ROWS                                    */
    void *mid;       /* mid[n_plane][n_bin][n_row] complex                                       */
} volume_build;

static size_t mid_index(const volume_build *b, int plane, int bin, int row)
{
    return ((size_t)plane * (size_t)b->n_bin + (size_t)bin) * (size_t)b->n_row + (size_t)row;
}

/* Plane factors of rows iy0 ... iy0+ROWS-1 for a few planes, in DFT order: buffer[n_plane][ROWS][n_dft_x] complex. */
static void fill_rows(const volume_build *b, int iy0, int plane0, int n_plane, double *buffer)
{
    const dif_field *field = b->field;
    memset(buffer, 0, 2 * sizeof *buffer * (size_t)n_plane * ROWS * (size_t)b->n_dft_x);
    for (int iy = iy0; iy < iy0 + ROWS && iy < field->ny; iy++)
        for (int ix0 = 0; ix0 < field->nx; ix0 += DIF_SHEET_BLOCK) {
            const int left = field->nx - ix0, n = left < DIF_SHEET_BLOCK ? left : DIF_SHEET_BLOCK;
            double acc[2 * PLANES * DIF_SHEET_BLOCK] = {0};
            dif_plane_factors_add(&b->factors, n, field->z_um + (size_t)iy * (size_t)field->nx + ix0, b->wx + ix0,
                                  b->wy[iy], plane0, n_plane, acc);
            for (int l = 0; l < n_plane; l++) {
                double *row = buffer + 2 * (size_t)(l * ROWS + iy - iy0) * (size_t)b->n_dft_x;
                for (int j = 0; j < n; j++) {
                    double *at = row + 2 * (size_t)dif_bin_wrap(ix0 + j - field->nx / 2, b->n_dft_x);
                    at[0] = acc[(2 * l) * DIF_SHEET_BLOCK + j];
                    at[1] = acc[(2 * l + 1) * DIF_SHEET_BLOCK + j];
                }
            }
        }
}

/* Moves the kept bins of a few planes and ROWS rows into mid, a cache line of rows at a time. */
static void keep_rows(const volume_build *b, int iy0, int plane0, int n_plane, const double *buffer)
{
    for (int l = 0; l < n_plane; l++)
        for (int i = 0; i < b->n_bin; i++) {
            const int column = dif_bin_wrap(b->sheet->s.first + b->bin0 + i, b->n_dft_x);
            const size_t at = 2 * mid_index(b, plane0 + l, i, iy0);
            for (int r = 0; r < ROWS; r++) {
                const double *from = buffer + 2 * ((size_t)(l * ROWS + r) * (size_t)b->n_dft_x + (size_t)column);
                for (size_t part = 0; part < 2; part++) {
                    if (b->sheet->info.single)
                        ((float *)b->mid)[at + 2 * (size_t)r + part] = (float)from[part];
                    else
                        ((double *)b->mid)[at + 2 * (size_t)r + part] = from[part];
                }
            }
        }
}

static dif_status transform_x(const volume_build *b, dif_error *err)
{
    const size_t n_buffer = (size_t)2 * PLANES * ROWS * (size_t)b->n_dft_x;
    const int n_thread = omp_get_max_threads();
    double *buffers = dif_alloc(n_buffer * (size_t)n_thread, sizeof *buffers);
    if (!buffers)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for rows of the volume");
    dif_status bad = DIF_OK;
#pragma omp parallel for schedule(dynamic) num_threads(n_thread)
    for (int iy0 = 0; iy0 < b->field->ny; iy0 += ROWS) {
        double *buffer = buffers + n_buffer * (size_t)omp_get_thread_num();
        for (int plane0 = 0; plane0 < b->n_plane; plane0 += PLANES) {
            const int more = b->n_plane - plane0, n_plane = more < PLANES ? more : PLANES;
            dif_error detail;
            fill_rows(b, iy0, plane0, n_plane, buffer);
            const dif_status status = dif_fft_rows(buffer, n_plane * ROWS, b->n_dft_x, false, &detail);
            if (status != DIF_OK)
#pragma omp critical
                bad = dif_fail(err, status, "%s", detail.text);
            keep_rows(b, iy0, plane0, n_plane, buffer);
        }
    }
    dif_release(buffers);
    return bad;
}

/* One x bin: rows of all planes in DFT order (y runs against iy), buffer[n_plane][n_dft_y] complex. */
static void fill_column(const volume_build *b, int bin, double *buffer)
{
    const int ny = b->field->ny;
    memset(buffer, 0, 2 * sizeof *buffer * (size_t)b->n_plane * (size_t)b->n_dft_y);
    for (int l = 0; l < b->n_plane; l++) {
        const size_t from = 2 * mid_index(b, l, bin, 0);
        for (int iy = 0; iy < ny; iy++) {
            double *at =
                buffer + 2 * ((size_t)l * (size_t)b->n_dft_y + (size_t)dif_bin_wrap(ny - 1 - iy - ny / 2, b->n_dft_y));
            for (size_t part = 0; part < 2; part++)
                at[part] = b->sheet->info.single ? (double)((const float *)b->mid)[from + 2 * (size_t)iy + part]
                                                 : ((const double *)b->mid)[from + 2 * (size_t)iy + part];
        }
    }
}

/* Stores a transformed x bin: planes from zero up in place, negative ones as complex conjugates at the opposite bin. */
static void store_column(const volume_build *b, int bin, const double *buffer)
{
    dif_sheet *sheet = b->sheet;
    const size_t stride = (size_t)sheet->stride, n_y = (size_t)sheet->y.n;
    const size_t here = (size_t)bin * n_y, opposite = (size_t)(sheet->s.n - 1 - bin) * n_y;
    for (int j = 0; j < sheet->y.n; j++) {
        const double *from = buffer + 2 * (size_t)dif_bin_wrap(sheet->y.first + j, b->n_dft_y);
        for (int l = 0; l < sheet->z.n; l++) {
            const int plane = sheet->z.first + l;
            const int row = (plane < 0 ? -plane : plane) - b->factors.first;
            const double *value = from + 2 * (size_t)row * (size_t)b->n_dft_y;
            if (plane < 0)
                dif_sheet_store(sheet, (opposite + n_y - 1 - (size_t)j) * stride + (size_t)l, value[0], -value[1]);
            else
                dif_sheet_store(sheet, (here + (size_t)j) * stride + (size_t)l, value[0], value[1]);
        }
    }
}

static dif_status transform_y(const volume_build *b, dif_error *err)
{
    const size_t n_buffer = 2 * (size_t)b->n_plane * (size_t)b->n_dft_y;
    const int n_thread = omp_get_max_threads();
    double *buffers = dif_alloc(n_buffer * (size_t)n_thread, sizeof *buffers);
    if (!buffers)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for columns of the volume");
    dif_status bad = DIF_OK;
#pragma omp parallel for schedule(dynamic, 8) num_threads(n_thread)
    for (int i = 0; i < b->n_bin; i++) {
        double *buffer = buffers + n_buffer * (size_t)omp_get_thread_num();
        dif_error detail;
        fill_column(b, i, buffer);
        const dif_status status = dif_fft_rows(buffer, b->n_plane, b->n_dft_y, false, &detail);
        if (status != DIF_OK)
#pragma omp critical
            bad = dif_fail(err, status, "%s", detail.text);
        store_column(b, b->bin0 + i, buffer);
    }
    dif_release(buffers);
    return bad;
}

/* Both passes, in as many runs over the x bins as the memory for `mid` asks for. */
static dif_status transform(volume_build *b, dif_error *err)
{
    const size_t size = 2 * (b->sheet->info.single ? sizeof(float) : sizeof(double));
    const size_t n_byte_bin = size * (size_t)b->n_plane * (size_t)b->n_row;
    const size_t fit = MID_BYTES_MAX / n_byte_bin;
    const int n_all = b->sheet->s.n, n_run = fit < 1 ? 1 : (fit > (size_t)n_all ? n_all : (int)fit);
    dif_status status = DIF_OK;
    b->mid = dif_alloc((size_t)n_run * n_byte_bin, 1);
    if (!b->mid)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d columns of the volume", n_run);
    for (b->bin0 = 0; b->bin0 < n_all && status == DIF_OK; b->bin0 += n_run) {
        b->n_bin = n_all - b->bin0 < n_run ? n_all - b->bin0 : n_run;
        status = transform_x(b, err);
        if (status == DIF_OK)
            status = transform_y(b, err);
    }
    return status;
}

static dif_status lay_out(volume_build *b, const dif_window *window, double k_max, dif_error *err)
{
    const dif_field *field = b->field;
    dif_sheet *sheet = b->sheet;
    sheet->y.kernel = sheet->s.kernel;
    b->n_dft_x = dif_axis_layout(&sheet->s, field->nx, field->pitch_x_um, k_max);
    b->n_dft_y = dif_axis_layout(&sheet->y, field->ny, field->pitch_y_um, k_max);
    b->n_row = (field->ny + ROWS - 1) / ROWS * ROWS;
    if (b->n_dft_x == 0 || b->n_dft_y == 0)
        return dif_fail(err, DIF_ERR_SIZE, "a volume of %d x %d samples", field->nx, field->ny);
    dif_status status = dif_sheet_window(sheet, field, window, &b->wx, &b->wy, err);
    if (status == DIF_OK)
        status = dif_sheet_allocate(sheet, err);
    if (status != DIF_OK)
        return status;
    dif_axis_correct(&sheet->s, field->nx, field->pitch_x_um, false, b->wx);
    dif_axis_correct(&sheet->y, field->ny, field->pitch_y_um, true, b->wy);
    return DIF_OK;
}

dif_status dif_sheet_create_volume(const dif_field *field, const dif_window *window, const dif_band *band, double tol,
                                   const dif_sheet_opts *opts, dif_sheet **out, dif_error *err)
{
    volume_build b = {.field = field};
    *out = NULL;
    dif_status status = dif_sheet_begin(field, window, band, tol, opts, 2, SIGMA_VOLUME, &b.sheet, err);
    if (status != DIF_OK)
        return status;
    b.factors = dif_sheet_factors(b.sheet, &b.n_plane);
    status = lay_out(&b, window, band->k_lateral_max_rad_per_um, err);
    if (status == DIF_OK)
        status = transform(&b, err);
    dif_release(b.wx);
    dif_release(b.wy);
    dif_release(b.mid);
    if (status == DIF_OK)
        *out = b.sheet;
    else
        dif_sheet_free(b.sheet);
    return status;
}
