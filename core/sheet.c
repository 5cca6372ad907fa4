/* What the line and the volume form share: checks, kernels, axes, storage. */
#include "core/sheet.h"

#include <math.h>

#include "core/alloc.h"
#include "core/fft.h"
#include "core/series.h"
#include "core/sheet_impl.h"
#include "core/units.h"

/* float keeps about seven digits; below this tolerance planes are stored in double. */
#define TOL_SINGLE 5e-7
#define TOL_MIN    1e-13
/* Flat surfaces get this half-range, so that the plane spacing stays finite. */
#define HALF_MIN_UM  1e-6
#define SIGMA_PLANES 2.0
#define SIGMA_MAX    3.0
/* Past this size an index into the planes would not be an int. */
enum { BINS_MAX = 1 << 26 };

dif_sheet_opts dif_sheet_opts_default(void)
{
    return (dif_sheet_opts){
        .basis = DIF_BASIS_WAVES, .n_terms = DIF_TERMS_FROM_TOL, .single = true, .force_single = false};
}

double dif_sheet_rounding(bool single)
{
    return single ? 1.5e-7 : 4e-15;
}

static dif_status check(const dif_field *field, const dif_window *window, const dif_band *band, double tol,
                        dif_error *err)
{
    const dif_status status = dif_field_check(field, err);
    if (status != DIF_OK)
        return status;
    if (window->kind == DIF_WINDOW_GAUSS && !(window->sigma_um > 0.0 && window->sigma_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "window sigma = %g um, want > 0", window->sigma_um);
    if (!(band->k_lateral_max_rad_per_um >= 0.0 && band->k_lateral_max_rad_per_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "largest lateral frequency = %g rad/um", band->k_lateral_max_rad_per_um);
    if (!(band->kz_min_rad_per_um >= 0.0 && band->kz_max_rad_per_um >= band->kz_min_rad_per_um &&
          band->kz_max_rad_per_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "range of kappa_z = %g ... %g rad/um", band->kz_min_rad_per_um,
                        band->kz_max_rad_per_um);
    if (!(tol >= TOL_MIN && tol < 1.0))
        return dif_fail(err, DIF_ERR_TOL, "tol = %g, want %g <= tol < 1", tol, TOL_MIN);
    return DIF_OK;
}

static void height_range(const dif_field *field, double *mid_um, double *half_um)
{
    double min = field->z_um[0], max = min;
    for (size_t i = 1, n = dif_field_n(field); i < n; i++) {
        const double z = field->z_um[i];
        min = z < min ? z : min;
        max = z > max ? z : max;
    }
    *mid_um = 0.5 * (min + max);
    /* A hair more, so that rounding never puts a height outside. */
    *half_um = fmax(0.5 * (max - min) * (1.0 + 1e-14), HALF_MIN_UM);
}

/* A kernel that reaches tol: where the widest one does not at this oversampling, more of that. */
static dif_kernel reach(double tol, double sigma)
{
    dif_kernel kernel = dif_kernel_make(tol, sigma);
    while (kernel.bound > tol && sigma < SIGMA_MAX)
        kernel = dif_kernel_make(tol, sigma += 0.5);
    return kernel;
}

/* The waves' planes cover kz_min ... kz_max with half a kernel on each side. */
static void lay_out_waves(dif_sheet *sheet, const dif_band *band, double tol_axis)
{
    dif_axis *z = &sheet->z;
    z->kernel = reach(tol_axis, SIGMA_PLANES);
    z->step = DIF_PI / (z->kernel.sigma * sheet->half_um);
    /* First taps as core/response.c places them, with a hair of room for rounding. */
    const double half = 0.5 * z->kernel.width, hair = 1e-6;
    z->first = (int)ceil(band->kz_min_rad_per_um / z->step - half - hair);
    z->n = (int)ceil(band->kz_max_rad_per_um / z->step - half + hair) + z->kernel.width - z->first;
}

/* Rounding of the terms that cancel: 1 for waves; for powers, terms as large as x^n/n! cancel down to at most 1. */
static double cancellation(const dif_sheet *sheet, const dif_band *band)
{
    return sheet->basis == DIF_BASIS_WAVES ? 1.0 : dif_series_taylor_peak(band->kz_max_rad_per_um * sheet->half_um);
}

static void lay_out_powers(dif_sheet *sheet, const dif_band *band, const dif_sheet_opts *opts, double tol_axis)
{
    const double x_max = band->kz_max_rad_per_um * sheet->half_um;
    const int order =
        opts->n_terms == DIF_TERMS_FROM_TOL ? dif_series_taylor_order(x_max, tol_axis) : opts->n_terms - 1;
    sheet->z.n = order + 1;
    sheet->z.kernel.bound = dif_series_taylor_bound(x_max, order);
    sheet->info.bound = cancellation(sheet, band) * dif_sheet_rounding(sheet->info.single);
}

static bool float_suffices(const dif_sheet *sheet, const dif_band *band, double tol)
{
    return tol >= TOL_SINGLE && cancellation(sheet, band) * dif_sheet_rounding(true) < 0.5 * tol;
}

dif_status dif_sheet_begin(const dif_field *field, const dif_window *window, const dif_band *band, double tol,
                           const dif_sheet_opts *opts, int n_lateral, double sigma_lateral, dif_sheet **out,
                           dif_error *err)
{
    const dif_sheet_opts defaults = dif_sheet_opts_default();
    const dif_sheet_opts *o = opts ? opts : &defaults;
    *out = NULL;
    const dif_status status = check(field, window, band, tol, err);
    if (status != DIF_OK)
        return status;
    if (o->n_terms != DIF_TERMS_FROM_TOL && !(o->n_terms >= 1 && o->n_terms <= 4096))
        return dif_fail(err, DIF_ERR_ARG, "%d Taylor terms, want 1 ... 4096", o->n_terms);
    dif_sheet *sheet = dif_alloc(1, sizeof *sheet);
    if (!sheet)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for a sheet");
    sheet->basis = o->basis;
    height_range(field, &sheet->mid_um, &sheet->half_um);
    sheet->info.single = o->force_single || (o->single && float_suffices(sheet, band, tol));
    /* Half of the tolerance goes to the planes, whose taps are one vector; the lateral kernels share the rest. */
    const double tol_kernels = fmax(tol - dif_sheet_rounding(sheet->info.single), 0.5 * tol);
    sheet->s.kernel = reach(0.5 * tol_kernels / n_lateral, sigma_lateral);
    if (o->basis == DIF_BASIS_WAVES)
        lay_out_waves(sheet, band, 0.5 * tol_kernels);
    else
        lay_out_powers(sheet, band, o, 0.5 * tol_kernels);
    if (sheet->z.n > 1 << 20) {
        dif_sheet_free(sheet);
        return dif_fail(err, DIF_ERR_SIZE, "heights span %g um: too many planes", 2.0 * sheet->half_um);
    }
    *out = sheet;
    return DIF_OK;
}

dif_plane_factors dif_sheet_factors(const dif_sheet *sheet, int *n_plane)
{
    dif_plane_factors factors = {
        .basis = sheet->basis, .mid_um = sheet->mid_um, .half_um = sheet->half_um, .step = sheet->z.step};
    const int first = sheet->z.first, last = first + sheet->z.n - 1;
    factors.first = first > 0 ? first : 0;
    *n_plane = (-first > last ? -first : last) - factors.first + 1;
    if (sheet->basis == DIF_BASIS_WAVES)
        factors.height_gain = dif_kernel_reciprocal(&sheet->z.kernel);
    return factors;
}

int dif_axis_layout(dif_axis *axis, int n, double pitch_um, double k_max)
{
    const double n_dft_wanted = ceil(axis->kernel.sigma * n) + 1.0;
    if (!(n_dft_wanted < BINS_MAX))
        return 0;
    int n_dft = dif_fft_size((int)n_dft_wanted);
    axis->step = DIF_TWO_PI / (n_dft * pitch_um);
    axis->shift_um = (n / 2 - 0.5 * (n - 1)) * pitch_um;
    const int width = axis->kernel.width;
    const double reach = ceil(k_max / axis->step) + 0.5 * width + 1.0;
    if (2.0 * reach + 1.0 < n_dft) {
        axis->first = -(int)reach;
        axis->n = 2 * (int)reach + 1;
        axis->period = 0;
    } else { /* the band is wider than the sampled spectrum: store one period and fold points into it */
        axis->first = -(n_dft / 2) - width;
        axis->n = 2 * (n_dft / 2 + width) + 1; /* symmetric about bin 0 */
        axis->period = n_dft;
    }
    return n_dft;
}

void dif_axis_correct(const dif_axis *axis, int n, double pitch_um, bool mirrored, double *weight)
{
    for (int i = 0; i < n; i++) {
        const int at = (mirrored ? n - 1 - i : i) - n / 2;
        weight[i] /= dif_kernel_transform(&axis->kernel, axis->step * pitch_um * at);
    }
}

dif_status dif_sheet_window(dif_sheet *sheet, const dif_field *field, const dif_window *window, double **wx,
                            double **wy, dif_error *err)
{
    *wx = dif_alloc((size_t)field->nx, sizeof **wx);
    *wy = dif_alloc((size_t)field->ny, sizeof **wy);
    if (!*wx || !*wy)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for window weights");
    const dif_window_sums sums = dif_window_fill(window, field, *wx, *wy);
    if (!(sums.w > 0.0))
        return dif_fail(err, DIF_ERR_ARG, "the window misses every sample");
    sheet->info.sum_w = sums.w;
    sheet->info.area_um2 = field->pitch_x_um * field->pitch_y_um * sums.w * sums.w / sums.w2;
    for (int ix = 0; ix < field->nx; ix++)
        (*wx)[ix] /= sums.w;
    return DIF_OK;
}

static void fill_polynomials(dif_sheet *sheet)
{
    const dif_kernel *kernels[3] = {&sheet->s.kernel, &sheet->y.kernel, &sheet->z.kernel};
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k <= kernels[axis]->degree; k++)
            for (int tap = 0; tap < kernels[axis]->width; tap++) {
                const size_t at = (size_t)(k * 3 + axis) * DIF_SHEET_TAPS + (size_t)tap;
                if (sheet->coef_f)
                    sheet->coef_f[at] = (float)kernels[axis]->coef[k][tap];
                else
                    sheet->coef_d[at] = kernels[axis]->coef[k][tap];
            }
}

static int max3(int a, int b, int c)
{
    const int ab = a > b ? a : b;
    return ab > c ? ab : c;
}

static void describe(dif_sheet *sheet)
{
    const double axes[3] = {sheet->s.kernel.bound, sheet->y.kernel.bound, sheet->z.kernel.bound};
    double product = 1.0;
    for (int i = 0; i < 3; i++)
        product *= 1.0 + axes[i];
    sheet->info.bound += product - 1.0 + dif_sheet_rounding(sheet->info.single);
    sheet->info.n_plane = sheet->z.n;
    sheet->info.n_tap = sheet->s.kernel.width;
    sheet->info.n_bin_x = sheet->s.n;
    sheet->info.n_bin_y = sheet->is_line ? 1 : sheet->y.n;
}

dif_status dif_sheet_allocate(dif_sheet *sheet, dif_error *err)
{
    describe(sheet);
    sheet->stride = sheet->z.n;
    const size_t n_bin = (size_t)sheet->s.n * (size_t)sheet->info.n_bin_y;
    const size_t n_complex = n_bin * (size_t)sheet->stride + DIF_SHEET_PAD;
    const size_t size = sheet->info.single ? sizeof(float) : sizeof(double);
    sheet->info.n_byte = 2 * n_complex * size;
    sheet->degree = max3(sheet->s.kernel.degree, sheet->y.kernel.degree, sheet->z.kernel.degree);
    const size_t n_coef = (size_t)(sheet->degree + 1) * 3 * DIF_SHEET_TAPS;
    if (n_complex / (size_t)sheet->stride < n_bin)
        return dif_fail(err, DIF_ERR_SIZE, "planes of %d x %d bins", sheet->s.n, sheet->info.n_bin_y);
    sheet->planes = dif_alloc(2 * n_complex, size);
    if (sheet->info.single)
        sheet->coef_f = dif_alloc(n_coef, sizeof(float));
    else
        sheet->coef_d = dif_alloc(n_coef, sizeof(double));
    if (!sheet->planes || (!sheet->coef_f && !sheet->coef_d))
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu bytes of planes", sheet->info.n_byte);
    fill_polynomials(sheet);
    return DIF_OK;
}

void dif_sheet_free(dif_sheet *sheet)
{
    if (!sheet)
        return;
    dif_release(sheet->planes);
    dif_release(sheet->coef_f);
    dif_release(sheet->coef_d);
    dif_release(sheet);
}

dif_sheet_info dif_sheet_info_of(const dif_sheet *sheet)
{
    return sheet->info;
}

/* Whether all taps of a point are stored; core/response.c folds the same way. */
static bool axis_covers(const dif_axis *axis, double kappa)
{
    double at = kappa / axis->step;
    if (axis->period)
        at -= axis->period * nearbyint(at / axis->period);
    const double first = ceil(at - axis->first - 0.5 * axis->kernel.width);
    return first >= 0.0 && first + axis->kernel.width <= axis->n;
}

bool dif_sheet_covers(const dif_sheet *sheet, dif_vec3 kappa)
{
    const double c = cos(sheet->info.azimuth_rad), s = sin(sheet->info.azimuth_rad);
    const bool depth = sheet->basis == DIF_BASIS_POWERS || axis_covers(&sheet->z, -kappa.z);
    if (sheet->is_line)
        return depth && axis_covers(&sheet->s, c * kappa.x + s * kappa.y);
    return depth && axis_covers(&sheet->s, kappa.x) && axis_covers(&sheet->y, kappa.y);
}
