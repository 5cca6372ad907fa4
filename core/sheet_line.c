/* The line form: every plane is summed across the plane of incidence, then transformed along it.
 *
 * Azimuths along an axis sum whole columns or rows, exactly. Any other azimuth rotates the sampling, not the image:
 * pixels are spread with the kernel onto a grid along s = x cos(phi) + y sin(phi). */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "core/alloc.h"
#include "core/fft.h"
#include "core/sheet_impl.h"
#include "core/units.h"

/* Lateral oversampling: the DFT of a line is cheap, so fewer taps are worth more bins. */
#define SIGMA_LINE   2.5
#define SIGMA_SPREAD 2.0

typedef struct line_build {
    dif_sheet *sheet;
    const dif_field *field;
    dif_plane_factors factors;
    int n_plane;  /* computed planes                                    */
    int n_sample; /* samples along s                                    */
    int n_dft;
    double *wx, *wy; /* window with corrections                            */
    double *line;    /* line[n_plane][n_dft] complex, DFT order            */
} line_build;

static double *line_at(const line_build *b, int plane, int sample)
{
    return b->line + 2 * ((size_t)plane * (size_t)b->n_dft + (size_t)dif_bin_wrap(sample - b->n_sample / 2, b->n_dft));
}

/* Sums columns ix0 ... over all rows, for all planes. */
static void collapse_columns(const line_build *b, int ix0, bool flip)
{
    const dif_field *field = b->field;
    const int left = field->nx - ix0, n = left < DIF_SHEET_BLOCK ? left : DIF_SHEET_BLOCK;
    for (int plane0 = 0; plane0 < b->n_plane; plane0 += DIF_SHEET_PLANE_BLOCK) {
        double acc[2 * DIF_SHEET_PLANE_BLOCK * DIF_SHEET_BLOCK] = {0};
        const int more = b->n_plane - plane0, n_plane = more < DIF_SHEET_PLANE_BLOCK ? more : DIF_SHEET_PLANE_BLOCK;
        for (int iy = 0; iy < field->ny; iy++)
            dif_plane_factors_add(&b->factors, n, field->z_um + (size_t)iy * (size_t)field->nx + ix0, b->wx + ix0,
                                  b->wy[iy], plane0, n_plane, acc);
        for (int l = 0; l < n_plane; l++)
            for (int j = 0; j < n; j++) {
                double *at = line_at(b, plane0 + l, flip ? field->nx - 1 - (ix0 + j) : ix0 + j);
                at[0] = acc[(size_t)(2 * l) * DIF_SHEET_BLOCK + (size_t)j];
                at[1] = acc[(size_t)(2 * l + 1) * DIF_SHEET_BLOCK + (size_t)j];
            }
    }
}

static double sum_block(const double *lane)
{
    double sum = 0.0;
    for (int j = 0; j < DIF_SHEET_BLOCK; j++)
        sum += lane[j];
    return sum;
}

/* Sums row iy over all columns, for all planes. Row 0 is the top, so y runs against iy. */
static void collapse_row(const line_build *b, int iy, bool flip)
{
    const dif_field *field = b->field;
    for (int plane0 = 0; plane0 < b->n_plane; plane0 += DIF_SHEET_PLANE_BLOCK) {
        double acc[2 * DIF_SHEET_PLANE_BLOCK * DIF_SHEET_BLOCK] = {0};
        const int more = b->n_plane - plane0, n_plane = more < DIF_SHEET_PLANE_BLOCK ? more : DIF_SHEET_PLANE_BLOCK;
        for (int ix0 = 0; ix0 < field->nx; ix0 += DIF_SHEET_BLOCK) {
            const int left = field->nx - ix0, n = left < DIF_SHEET_BLOCK ? left : DIF_SHEET_BLOCK;
            dif_plane_factors_add(&b->factors, n, field->z_um + (size_t)iy * (size_t)field->nx + ix0, b->wx + ix0,
                                  b->wy[iy], plane0, n_plane, acc);
        }
        for (int l = 0; l < n_plane; l++) {
            double *at = line_at(b, plane0 + l, flip ? iy : field->ny - 1 - iy);
            at[0] = sum_block(acc + (size_t)(2 * l) * DIF_SHEET_BLOCK);
            at[1] = sum_block(acc + (size_t)(2 * l + 1) * DIF_SHEET_BLOCK);
        }
    }
}

/* Spreading onto the rotated grid. */
typedef struct spread {
    dif_kernel kernel;
    dif_reciprocal lateral_gain; /* interpolation's correction at a position s        */
    double cos_az, sin_az, pitch_um;
    double span_um; /* where lateral_gain reaches: s_max of its argument */
} spread;

/* Spreads the block's planes (acc[l][2][BLOCK]) of one pixel j into grid[n_sample][2 n_plane]. */
static void spread_pixel(const spread *sp, const double *acc, int j, int n_plane, int n_plane_all, double position,
                         double *grid)
{
    const int w = sp->kernel.width;
    const int first = (int)ceil(position - 0.5 * w);
    double tap[DIF_KERNEL_WIDTH_MAX], value[2 * DIF_SHEET_PLANE_BLOCK];
    dif_kernel_taps(&sp->kernel, position - first - 0.5 * (w - 1), tap);
    for (int l = 0; l < 2 * n_plane; l++)
        value[l] = acc[(size_t)l * DIF_SHEET_BLOCK + (size_t)j];
    for (int i = 0; i < w; i++) {
        double *at = grid + (size_t)(first + i) * 2 * (size_t)n_plane_all;
        for (int l = 0; l < 2 * n_plane; l++)
            at[l] += tap[i] * value[l];
    }
}

static void spread_row(const line_build *b, const spread *sp, int iy, double *grid)
{
    const dif_field *field = b->field;
    for (int ix0 = 0; ix0 < field->nx; ix0 += DIF_SHEET_BLOCK) {
        const int left = field->nx - ix0, n = left < DIF_SHEET_BLOCK ? left : DIF_SHEET_BLOCK;
        double weight[DIF_SHEET_BLOCK], position[DIF_SHEET_BLOCK];
        for (int j = 0; j < n; j++) {
            const double s = dif_field_x_um(field, ix0 + j) * sp->cos_az + dif_field_y_um(field, iy) * sp->sin_az;
            position[j] = s / sp->pitch_um + b->n_sample / 2;
            weight[j] = b->wx[ix0 + j] * dif_reciprocal_at(&sp->lateral_gain, s / sp->span_um);
        }
        for (int plane0 = 0; plane0 < b->n_plane; plane0 += DIF_SHEET_PLANE_BLOCK) {
            double acc[2 * DIF_SHEET_PLANE_BLOCK * DIF_SHEET_BLOCK] = {0};
            const int more = b->n_plane - plane0;
            const int n_plane = more < DIF_SHEET_PLANE_BLOCK ? more : DIF_SHEET_PLANE_BLOCK;
            dif_plane_factors_add(&b->factors, n, field->z_um + (size_t)iy * (size_t)field->nx + ix0, weight, b->wy[iy],
                                  plane0, n_plane, acc);
            for (int j = 0; j < n; j++)
                spread_pixel(sp, acc, j, n_plane, b->n_plane, position[j], grid + (size_t)2 * (size_t)plane0);
        }
    }
}

/* Every thread spreads its rows into a grid of its own; the grids are added up in thread order. */
static dif_status spread_field(const line_build *b, const spread *sp, dif_error *err)
{
    const int n_thread = omp_get_max_threads();
    const size_t n_grid = 2 * (size_t)b->n_plane * (size_t)b->n_sample;
    double *grids = dif_alloc(n_grid * (size_t)n_thread, sizeof *grids);
    if (!grids)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for the rotated grid");
#pragma omp parallel for schedule(static) num_threads(n_thread)
    for (int iy = 0; iy < b->field->ny; iy++)
        spread_row(b, sp, iy, grids + n_grid * (size_t)omp_get_thread_num());
    for (int thread = 0; thread < n_thread; thread++)
        for (int m = 0; m < b->n_sample; m++)
            for (int l = 0; l < b->n_plane; l++) {
                const double *from = grids + n_grid * (size_t)thread + 2 * ((size_t)m * (size_t)b->n_plane + (size_t)l);
                double *at = line_at(b, l, m);
                at[0] += from[0];
                at[1] += from[1];
            }
    dif_release(grids);
    return DIF_OK;
}

/* Moves the wanted bins of the transformed lines into the sheet; gain[bin] (NULL = 1) undoes the spreading. */
static void store_bins(const line_build *b, const double *gain)
{
    dif_sheet *sheet = b->sheet;
    for (int i = 0; i < sheet->s.n; i++)
        for (int l = 0; l < sheet->z.n; l++) {
            /* A negative plane is the complex conjugate of the positive one at the opposite frequency. */
            const int plane = sheet->z.first + l, bin = sheet->s.first + i, sign = plane < 0 ? -1 : 1;
            const size_t row = (size_t)(sign * plane - b->factors.first) * (size_t)b->n_dft;
            const double *from = b->line + 2 * (row + (size_t)dif_bin_wrap(sign * bin, b->n_dft));
            const double g = gain ? gain[i] : 1.0;
            dif_sheet_store(sheet, (size_t)i * (size_t)sheet->stride + (size_t)l, g * from[0], g * sign * from[1]);
        }
}

static dif_status allocate_line(line_build *b, dif_error *err)
{
    if (b->n_dft == 0)
        return dif_fail(err, DIF_ERR_SIZE, "%d samples along the azimuth", b->n_sample);
    const dif_status status = dif_sheet_allocate(b->sheet, err);
    if (status != DIF_OK)
        return status;
    b->line = dif_alloc(2 * (size_t)b->n_plane * (size_t)b->n_dft, sizeof *b->line);
    return b->line ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for lines of %d planes", b->n_plane);
}

static dif_status transform_lines(const line_build *b, dif_error *err)
{
    dif_status first_bad = DIF_OK;
#pragma omp parallel for schedule(dynamic)
    for (int l = 0; l < b->n_plane; l++) {
        dif_error detail;
        const dif_status status = dif_fft_rows(b->line + 2 * (size_t)l * (size_t)b->n_dft, 1, b->n_dft, false, &detail);
        if (status != DIF_OK)
#pragma omp critical
            first_bad = dif_fail(err, status, "%s", detail.text);
    }
    return first_bad;
}

static dif_status build_along_axis(line_build *b, bool along_x, bool flip, double k_max, dif_error *err)
{
    const dif_field *field = b->field;
    const double pitch_um = along_x ? field->pitch_x_um : field->pitch_y_um;
    b->n_sample = along_x ? field->nx : field->ny;
    b->n_dft = dif_axis_layout(&b->sheet->s, b->n_sample, pitch_um, k_max);
    dif_status status = allocate_line(b, err);
    if (status != DIF_OK)
        return status;
    dif_axis_correct(&b->sheet->s, b->n_sample, pitch_um, along_x ? flip : !flip, along_x ? b->wx : b->wy);
    if (along_x) {
#pragma omp parallel for schedule(dynamic)
        for (int ix0 = 0; ix0 < field->nx; ix0 += DIF_SHEET_BLOCK)
            collapse_columns(b, ix0, flip);
    } else {
#pragma omp parallel for schedule(dynamic, 16)
        for (int iy = 0; iy < field->ny; iy++)
            collapse_row(b, iy, flip);
    }
    status = transform_lines(b, err);
    if (status == DIF_OK)
        store_bins(b, NULL);
    return status;
}

static dif_status build_rotated(line_build *b, double azimuth_rad, double k_max, double tol_spread, dif_error *err)
{
    const dif_field *field = b->field;
    dif_sheet *sheet = b->sheet;
    spread sp = {
        .kernel = dif_kernel_make(tol_spread, SIGMA_SPREAD), .cos_az = cos(azimuth_rad), .sin_az = sin(azimuth_rad)};
    const double s_max = fabs(dif_field_x_um(field, 0) * sp.cos_az) + fabs(dif_field_y_um(field, 0) * sp.sin_az);
    /* Bins reach a few steps beyond k_max; a step is at most pi/(sigma s_max). */
    const double margin = DIF_PI / (sheet->s.kernel.sigma * fmax(s_max, 1e-3)) * (sheet->s.kernel.width + 2);
    sp.pitch_um = DIF_PI / (SIGMA_SPREAD * (k_max + margin));
    const double n_sample = 2.0 * ceil(s_max / sp.pitch_um + 0.5 * sp.kernel.width + 1.0) + 1.0;
    if (!(n_sample < 1 << 24))
        return dif_fail(err, DIF_ERR_SIZE, "%g samples along the azimuth", n_sample);
    b->n_sample = (int)n_sample;
    b->n_dft = dif_axis_layout(&sheet->s, b->n_sample, sp.pitch_um, k_max);
    sheet->s.shift_um = 0.0; /* positions are exact here */
    sheet->info.bound += sp.kernel.bound;
    dif_status status = allocate_line(b, err);
    if (status != DIF_OK)
        return status;
    sp.lateral_gain = dif_kernel_reciprocal(&sheet->s.kernel);
    sp.span_um = DIF_PI / (sheet->s.kernel.sigma * sheet->s.step);
    status = spread_field(b, &sp, err);
    if (status == DIF_OK)
        status = transform_lines(b, err);
    double *gain = dif_alloc((size_t)sheet->s.n, sizeof *gain);
    if (status == DIF_OK && !gain)
        status = dif_fail(err, DIF_ERR_NOMEM, "no memory for %d gains", sheet->s.n);
    if (status == DIF_OK) {
        for (int i = 0; i < sheet->s.n; i++)
            gain[i] = 1.0 / dif_kernel_transform(&sp.kernel, (sheet->s.first + i) * sheet->s.step * sp.pitch_um);
        store_bins(b, gain);
    }
    dif_release(gain);
    return status;
}

/* Quarter turns of an azimuth: 0 ... 3, or -1 if it lies along no axis. */
static int quarter_turns(double azimuth_rad)
{
    const double quarters = azimuth_rad / (0.5 * DIF_PI), whole = nearbyint(quarters);
    return fabs(quarters - whole) < 1e-14 * fmax(1.0, fabs(whole)) ? dif_bin_wrap((int)fmod(whole, 4.0), 4) : -1;
}

dif_status dif_sheet_create_line(const dif_field *field, const dif_window *window, double azimuth_rad,
                                 const dif_band *band, double tol, const dif_sheet_opts *opts, dif_sheet **out,
                                 dif_error *err)
{
    *out = NULL;
    if (!(fabs(azimuth_rad) < 1e6))
        return dif_fail(err, DIF_ERR_ARG, "azimuth = %g rad", azimuth_rad);
    const int quarter = quarter_turns(azimuth_rad), n_lateral = quarter < 0 ? 2 : 1;
    line_build b = {.field = field};
    dif_status status = dif_sheet_begin(field, window, band, tol, opts, n_lateral, SIGMA_LINE, &b.sheet, err);
    if (status != DIF_OK)
        return status;
    b.sheet->is_line = b.sheet->info.is_line = true;
    b.sheet->info.azimuth_rad = azimuth_rad;
    b.factors = dif_sheet_factors(b.sheet, &b.n_plane);
    const double k_max = band->k_lateral_max_rad_per_um;
    status = dif_sheet_window(b.sheet, field, window, &b.wx, &b.wy, err);
    if (status == DIF_OK)
        status = quarter < 0 ? build_rotated(&b, azimuth_rad, k_max, 0.2 * tol, err)
                             : build_along_axis(&b, quarter % 2 == 0, quarter >= 2, k_max, err);
    dif_release(b.wx);
    dif_release(b.wy);
    dif_release(b.line);
    if (status == DIF_OK)
        *out = b.sheet;
    else
        dif_sheet_free(b.sheet);
    return status;
}
