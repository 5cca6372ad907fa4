/* Lateral periods of a surface: peaks of its windowed power spectrum. */
#include <math.h>
#include <stdbool.h>

#include "bench/fit.h"
#include "bench/fit_spectrum.h"
#include "core/alloc.h"
#include "core/fft.h"
#include "core/units.h"

/* Waves of fewer than this many periods over the patch are form, not texture. */
#define PERIODS_MIN 2.5
enum { NEIGHBOUR = 2, PEAKS = 64 };

/* Power spectrum power[ny][nx] of the levelled, Hann-windowed heights. */
typedef struct spectrum {
    int nx, ny;
    double *power;
    double total;  /* over the half plane, form excluded */
    double fx, fy; /* bin spacing, per um */
} spectrum;

static double hann(int i, int n)
{
    return 0.5 - 0.5 * cos(DIF_TWO_PI * (i + 0.5) / n);
}

/* Heights minus their least-squares plane (on a symmetric grid the three terms are orthogonal). */
static void plane_of(const dif_field *field, double plane[3])
{
    double sum = 0.0, sx = 0.0, sy = 0.0, xx = 0.0, yy = 0.0;
    for (int iy = 0; iy < field->ny; iy++)
        for (int ix = 0; ix < field->nx; ix++) {
            const double z = field->z_um[(size_t)iy * (size_t)field->nx + (size_t)ix];
            const double x = dif_field_x_um(field, ix), y = dif_field_y_um(field, iy);
            sum += z;
            sx += z * x;
            sy += z * y;
            xx += x * x;
            yy += y * y;
        }
    plane[0] = sum / (double)dif_field_n(field);
    plane[1] = xx > 0.0 ? sx / xx : 0.0;
    plane[2] = yy > 0.0 ? sy / yy : 0.0;
}

/* In-place transform of columns through a row buffer of complex numbers. */
static dif_status transform_columns(double *data, int nx, int ny, dif_error *err)
{
    double *column = dif_alloc(2 * (size_t)ny, sizeof *column);
    dif_status status = column ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for a spectrum");
    for (int ix = 0; ix < nx && status == DIF_OK; ix++) {
        for (int iy = 0; iy < ny; iy++)
            for (size_t part = 0; part < 2; part++)
                column[2 * (size_t)iy + part] = data[2 * ((size_t)iy * (size_t)nx + (size_t)ix) + part];
        status = dif_fft_rows(column, 1, ny, false, err);
        for (int iy = 0; iy < ny; iy++)
            for (size_t part = 0; part < 2; part++)
                data[2 * ((size_t)iy * (size_t)nx + (size_t)ix) + part] = column[2 * (size_t)iy + part];
    }
    dif_release(column);
    return status;
}

/* Signed frequency of a bin, cycles per um; y runs against iy. */
static double frequency_x(const spectrum *s, int bin)
{
    return s->fx * (bin <= s->nx / 2 ? bin : bin - s->nx);
}

static double frequency_y(const spectrum *s, int bin)
{
    return -s->fy * (bin <= s->ny / 2 ? bin : bin - s->ny);
}

static bool is_texture(const spectrum *s, int bx, int by)
{
    const double fx = frequency_x(s, bx), fy = frequency_y(s, by);
    return hypot(fx / s->fx, fy / s->fy) >= PERIODS_MIN;
}

/* One of each pair of opposite frequencies: the upper half plane and the positive half of its edge. */
static bool is_upper(const spectrum *s, int bx, int by)
{
    const double fy = frequency_y(s, by);
    return fy > 0.0 || (fy == 0.0 && frequency_x(s, bx) > 0.0);
}

static dif_status spectrum_make(const dif_field *field, spectrum *s, dif_error *err)
{
    double plane[3];
    *s = (spectrum){.nx = dif_fft_size(field->nx), .ny = dif_fft_size(field->ny)};
    s->fx = 1.0 / (s->nx * field->pitch_x_um);
    s->fy = 1.0 / (s->ny * field->pitch_y_um);
    const size_t n = (size_t)s->nx * (size_t)s->ny;
    double *data = dif_alloc(2 * n, sizeof *data);
    s->power = dif_alloc(n, sizeof *s->power);
    dif_status status = data && s->power ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for a spectrum");
    if (status == DIF_OK) {
        plane_of(field, plane);
        for (int iy = 0; iy < field->ny; iy++)
            for (int ix = 0; ix < field->nx; ix++) {
                const double flat =
                    plane[0] + plane[1] * dif_field_x_um(field, ix) + plane[2] * dif_field_y_um(field, iy);
                data[2 * ((size_t)iy * (size_t)s->nx + (size_t)ix)] =
                    (field->z_um[(size_t)iy * (size_t)field->nx + (size_t)ix] - flat) * hann(ix, field->nx) *
                    hann(iy, field->ny);
            }
        status = dif_fft_rows(data, s->ny, s->nx, false, err);
    }
    if (status == DIF_OK)
        status = transform_columns(data, s->nx, s->ny, err);
    for (int by = 0; by < s->ny && status == DIF_OK; by++)
        for (int bx = 0; bx < s->nx; bx++) {
            const size_t at = (size_t)by * (size_t)s->nx + (size_t)bx;
            s->power[at] = data[2 * at] * data[2 * at] + data[2 * at + 1] * data[2 * at + 1];
            if (is_upper(s, bx, by) && is_texture(s, bx, by))
                s->total += s->power[at];
        }
    dif_release(data);
    return status;
}

static double power_at(const spectrum *s, int bx, int by)
{
    const int x = (bx % s->nx + s->nx) % s->nx, y = (by % s->ny + s->ny) % s->ny;
    return s->power[(size_t)y * (size_t)s->nx + (size_t)x];
}

/* Vertex of the parabola through three log powers, in bins; a Hann peak is nearly Gaussian. */
static double vertex(double before, double here, double after)
{
    const double a = log(before + 1e-300), b = log(here + 1e-300), c = log(after + 1e-300);
    const double bend = a - 2.0 * b + c;
    const double at = bend < 0.0 ? 0.5 * (a - c) / bend : 0.0;
    return fmin(fmax(at, -0.5), 0.5);
}

static bool is_peak(const spectrum *s, int bx, int by)
{
    const double here = power_at(s, bx, by);
    for (int dy = -NEIGHBOUR; dy <= NEIGHBOUR; dy++)
        for (int dx = -NEIGHBOUR; dx <= NEIGHBOUR; dx++)
            if ((dx || dy) && power_at(s, bx + dx, by + dy) >= here)
                return false;
    return here > 0.0;
}

static double share_around(const spectrum *s, int bx, int by)
{
    double sum = 0.0;
    for (int dy = -NEIGHBOUR; dy <= NEIGHBOUR; dy++)
        for (int dx = -NEIGHBOUR; dx <= NEIGHBOUR; dx++)
            sum += power_at(s, bx + dx, by + dy);
    return sum / s->total;
}

static dif_spectrum_wave wave_at(const spectrum *s, int bx, int by)
{
    const double dx = vertex(power_at(s, bx - 1, by), power_at(s, bx, by), power_at(s, bx + 1, by));
    const double dy = vertex(power_at(s, bx, by - 1), power_at(s, bx, by), power_at(s, bx, by + 1));
    return (dif_spectrum_wave){.fx_per_um = frequency_x(s, bx) + dx * s->fx,
                               .fy_per_um = frequency_y(s, by) - dy * s->fy,
                               .share = share_around(s, bx, by)};
}

/* Keeps the n_max strongest, strongest first. */
static void keep(dif_spectrum_wave wave, int n_max, dif_spectrum_wave *list, int *n)
{
    int at = *n < n_max ? (*n)++ : n_max;
    if (at == n_max && wave.share <= list[n_max - 1].share)
        return;
    for (at = at < n_max ? at : n_max - 1; at > 0 && list[at - 1].share < wave.share; at--)
        list[at] = list[at - 1];
    list[at] = wave;
}

dif_status dif_fit_spectrum_waves(const dif_field *field, int n_max, dif_spectrum_wave *wave, int *n_out,
                                  dif_error *err)
{
    spectrum s = {0};
    *n_out = 0;
    dif_status status = dif_field_check(field, err);
    if (status == DIF_OK && n_max < 1)
        status = dif_fail(err, DIF_ERR_ARG, "%d peaks, want >= 1", n_max);
    if (status == DIF_OK)
        status = spectrum_make(field, &s, err);
    for (int by = 0; by < s.ny && status == DIF_OK; by++)
        for (int bx = 0; bx < s.nx; bx++)
            if (is_upper(&s, bx, by) && is_texture(&s, bx, by) && is_peak(&s, bx, by))
                keep(wave_at(&s, bx, by), n_max, wave, n_out);
    dif_release(s.power);
    return status;
}

dif_status dif_fit_spectrum_peaks(const dif_field *field, int n_max, dif_spectrum_peak *peak, int *n_out,
                                  dif_error *err)
{
    dif_spectrum_wave wave[PEAKS];
    const int n_wave = n_max < PEAKS ? n_max : PEAKS;
    const dif_status status = dif_fit_spectrum_waves(field, n_wave, wave, n_out, err);
    for (int i = 0; i < *n_out; i++) {
        const double psi = atan2(wave[i].fy_per_um, wave[i].fx_per_um);
        peak[i] = (dif_spectrum_peak){.period_um = 1.0 / hypot(wave[i].fx_per_um, wave[i].fy_per_um),
                                      .psi_rad = psi >= DIF_PI ? psi - DIF_PI : psi,
                                      .share = wave[i].share};
    }
    return status;
}
