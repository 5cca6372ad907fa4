/* Reading a sheet. Points travel in batches: their places on the axes first, then the tap sums. */
#include "core/response.h"

#include <assert.h>
#include <math.h>

#include "core/sheet_impl.h"
#include "core/simd.h"

enum { BATCH = 64 };

/* A point on one axis: first tap (index into the stored bins) and offset from the tap row's centre. */
typedef struct dif_place {
    int first;
    double offset;
} dif_place;

/* Where kappa falls on an axis. */
DIF_INLINE dif_place place_on(const dif_axis *axis, double inv_step, double kappa)
{
    double at = kappa * inv_step;
    if (axis->period)
        at -= axis->period * nearbyint(at / axis->period);
    at -= axis->first;
    const double first = ceil(at - 0.5 * axis->kernel.width);
    return (dif_place){(int)first, at - first - 0.5 * (axis->kernel.width - 1)};
}

#define DIF_REAL    float
#define DIF_LZ      8
#define DIF_NAME(x) f8_##x
#include "core/response_taps.h"

#define DIF_REAL    float
#define DIF_LZ      16
#define DIF_NAME(x) f16_##x
#include "core/response_taps.h"

#define DIF_REAL    double
#define DIF_LZ      8
#define DIF_NAME(x) d8_##x
#include "core/response_taps.h"

#define DIF_REAL    double
#define DIF_LZ      16
#define DIF_NAME(x) d16_##x
#include "core/response_taps.h"

static inline bool inside(const dif_axis *axis, const dif_place *place)
{
    return place->first >= 0 && place->first + axis->kernel.width <= axis->n;
}

/* The Taylor planes have no taps in kappa_z: every term counts. Horner in -i kappa_z half. */
static void powers_point(const dif_sheet *sheet, double ks, double ky, double kz, double *amp)
{
    double tap_s[DIF_KERNEL_WIDTH_MAX], tap_y[DIF_KERNEL_WIDTH_MAX] = {1.0};
    const dif_place s = place_on(&sheet->s, 1.0 / sheet->s.step, ks);
    dif_place y = {0, 0.0};
    int width_y = 1;
    dif_kernel_taps(&sheet->s.kernel, s.offset, tap_s);
    if (!sheet->is_line) {
        y = place_on(&sheet->y, 1.0 / sheet->y.step, ky);
        dif_kernel_taps(&sheet->y.kernel, y.offset, tap_y);
        width_y = sheet->y.kernel.width;
    }
    double re = 0.0, im = 0.0;
    const double x = kz * sheet->half_um;
    for (int n = sheet->z.n - 1; n >= 0; n--) {
        double term[2] = {0.0, 0.0};
        for (int i = 0; i < sheet->s.kernel.width; i++)
            for (int j = 0; j < width_y; j++) {
                const size_t bin = (size_t)(s.first + i) * (size_t)sheet->info.n_bin_y + (size_t)(y.first + j);
                const size_t at = 2 * (bin * (size_t)sheet->stride + (size_t)n);
                const double w = tap_s[i] * tap_y[j];
                for (int part = 0; part < 2; part++)
                    term[part] += w * (sheet->info.single ? (double)((const float *)sheet->planes)[at + (size_t)part]
                                                          : ((const double *)sheet->planes)[at + (size_t)part]);
            }
        /* sum <- term + sum * (-i x) / (n + 1) */
        const double share = x / (n + 1), re_old = re;
        re = term[0] + share * im;
        im = term[1] - share * re_old;
        if (sheet->info.single) {
            re = (double)(float)re;
            im = (double)(float)im;
        }
    }
    amp[0] = re;
    amp[1] = im;
}

/* Raw amplitudes (without the phases of the reference point) of up to BATCH points of a line. */
static void line_batch(const dif_sheet *sheet, int n, const double *ks, const double *kz, double (*amp)[2])
{
    dif_place s[BATCH], z[BATCH];
    if (sheet->basis == DIF_BASIS_POWERS) {
        for (int i = 0; i < n; i++)
            powers_point(sheet, ks[i], 0.0, kz[i], amp[i]);
        return;
    }
    const double inv_s = 1.0 / sheet->s.step, inv_z = 1.0 / sheet->z.step;
    for (int i = 0; i < n; i++) {
        s[i] = place_on(&sheet->s, inv_s, ks[i]);
        z[i] = place_on(&sheet->z, inv_z, kz[i]);
        assert(inside(&sheet->s, s + i) && inside(&sheet->z, z + i));
    }
    const bool wide = sheet->z.kernel.width > 8;
    if (sheet->info.single)
        (wide ? f16_line_points : f8_line_points)(sheet, sheet->coef_f, n, s, z, amp);
    else
        (wide ? d16_line_points : d8_line_points)(sheet, sheet->coef_d, n, s, z, amp);
}

static void volume_batch(const dif_sheet *sheet, int n, const dif_vec3 *kappa, double (*amp)[2])
{
    dif_place x[BATCH], y[BATCH], z[BATCH];
    if (sheet->basis == DIF_BASIS_POWERS) {
        for (int i = 0; i < n; i++)
            powers_point(sheet, kappa[i].x, kappa[i].y, -kappa[i].z, amp[i]);
        return;
    }
    const double inv_x = 1.0 / sheet->s.step, inv_y = 1.0 / sheet->y.step, inv_z = 1.0 / sheet->z.step;
    for (int i = 0; i < n; i++) {
        x[i] = place_on(&sheet->s, inv_x, kappa[i].x);
        y[i] = place_on(&sheet->y, inv_y, kappa[i].y);
        z[i] = place_on(&sheet->z, inv_z, -kappa[i].z);
        assert(inside(&sheet->s, x + i) && inside(&sheet->y, y + i) && inside(&sheet->z, z + i));
    }
    const bool wide = sheet->z.kernel.width > 8;
    if (sheet->info.single)
        (wide ? f16_volume_points : f8_volume_points)(sheet, sheet->coef_f, n, x, y, z, amp);
    else
        (wide ? d16_volume_points : d8_volume_points)(sheet, sheet->coef_d, n, x, y, z, amp);
}

/* Refers an amplitude to the field's frame: height zero and the true sample positions. */
static void turn(double phase, double *amp)
{
    const double c = cos(phase), s = sin(phase), re = amp[0], im = amp[1];
    amp[0] = c * re - s * im;
    amp[1] = c * im + s * re;
}

void dif_response_line(const dif_sheet *sheet, size_t n, const double *ks, const double *kz, double (*amp)[2])
{
    for (size_t i = 0; i < n; i += BATCH) {
        const int count = n - i < BATCH ? (int)(n - i) : BATCH;
        line_batch(sheet, count, ks + i, kz + i, amp + i);
    }
    for (size_t i = 0; i < n; i++)
        turn(ks[i] * sheet->s.shift_um - kz[i] * sheet->mid_um, amp[i]);
}

void dif_response_line_power(const dif_sheet *sheet, double k_rad_per_um, size_t n, const double *s, const double *c,
                             double scale, double *power)
{
    for (size_t i = 0; i < n; i += BATCH) {
        const int count = n - i < BATCH ? (int)(n - i) : BATCH;
        double ks[BATCH], kz[BATCH], amp[BATCH][2];
        for (int j = 0; j < count; j++) {
            ks[j] = k_rad_per_um * s[i + (size_t)j];
            kz[j] = k_rad_per_um * c[i + (size_t)j];
        }
        line_batch(sheet, count, ks, kz, amp);
        for (int j = 0; j < count; j++)
            power[i + (size_t)j] += scale * (amp[j][0] * amp[j][0] + amp[j][1] * amp[j][1]);
    }
}

void dif_response_volume(const dif_sheet *sheet, size_t n, const dif_vec3 *kappa, double (*amp)[2])
{
    for (size_t i = 0; i < n; i += BATCH) {
        const int count = n - i < BATCH ? (int)(n - i) : BATCH;
        volume_batch(sheet, count, kappa + i, amp + i);
    }
    for (size_t i = 0; i < n; i++)
        turn(kappa[i].x * sheet->s.shift_um + kappa[i].y * sheet->y.shift_um + kappa[i].z * sheet->mid_um, amp[i]);
}

void dif_response_volume_grid(const dif_sheet *sheet, int nx, const double *kx, int ny, const double *ky,
                              const double *kz, size_t kz_stride, float *power, size_t power_stride)
{
    dif_place x[DIF_RESPONSE_GRID], y[DIF_RESPONSE_GRID];
    const double inv_x = 1.0 / sheet->s.step, inv_y = 1.0 / sheet->y.step;
    assert(sheet->basis == DIF_BASIS_WAVES && nx <= DIF_RESPONSE_GRID && ny <= DIF_RESPONSE_GRID);
    for (int i = 0; i < nx; i++) {
        x[i] = place_on(&sheet->s, inv_x, kx[i]);
        assert(inside(&sheet->s, x + i));
    }
    for (int j = 0; j < ny; j++) {
        y[j] = place_on(&sheet->y, inv_y, ky[j]);
        assert(inside(&sheet->y, y + j));
    }
    const bool wide = sheet->z.kernel.width > 8;
    if (sheet->info.single)
        (wide ? f16_grid : f8_grid)(sheet, sheet->coef_f, nx, x, ny, y, kz, kz_stride, power, power_stride);
    else
        (wide ? d16_grid : d8_grid)(sheet, sheet->coef_d, nx, x, ny, y, kz, kz_stride, power, power_stride);
}

void dif_response_volume_columns(const dif_sheet *sheet, int n, const double *kx, const double *ky, int n_z,
                                 const double *kz, float *power)
{
    dif_place x[DIF_RESPONSE_GRID], y[DIF_RESPONSE_GRID], z[DIF_RESPONSE_DEPTHS];
    const double inv_x = 1.0 / sheet->s.step, inv_y = 1.0 / sheet->y.step, inv_z = 1.0 / sheet->z.step;
    assert(sheet->basis == DIF_BASIS_WAVES && sheet->z.n <= DIF_RESPONSE_PLANES);
    assert(n <= DIF_RESPONSE_GRID && n_z <= DIF_RESPONSE_DEPTHS);
    for (int i = 0; i < n; i++) {
        x[i] = place_on(&sheet->s, inv_x, kx[i]);
        y[i] = place_on(&sheet->y, inv_y, ky[i]);
        assert(inside(&sheet->s, x + i) && inside(&sheet->y, y + i));
    }
    for (int k = 0; k < n_z; k++) {
        z[k] = place_on(&sheet->z, inv_z, kz[k]);
        assert(inside(&sheet->z, z + k));
    }
    if (sheet->info.single)
        f8_columns(sheet, sheet->coef_f, n, x, y, n_z, z, power);
    else
        d8_columns(sheet, sheet->coef_d, n, x, y, n_z, z, power);
}
