/* The Gaussian mean line as a local straight line, one axis after the other, by the discrete Fourier transform.
 *
 *   s(u) = exp(-pi (u / (alpha cutoff))^2),  alpha = sqrt(ln 2 / pi)                                   ISO 16610-21
 *   mean line at x: the value at x of the straight line fitted to the heights of the axis with weights s(x' - x)
 *
 * Inside, the line's slope drops out and the plain Gaussian mean is left; at the edges it keeps a tilt from bending. */
#include <string.h>

#include "core/alloc.h"
#include "core/fft.h"
#include "core/prep_impl.h"
#include "core/units.h"

static const double REACH = 1.0; /* in cut-offs: the weight there is 6e-7 */

/* One axis: n samples, m the transform's length. */
typedef struct mean_line {
    int n, m;
    double (*kernel)[2];   /* transform of s + i u s             */
    double (*buffer)[2];   /* a line being worked on             */
    double *own, *from_t1; /* value = own[i] T0 + from_t1[i] T1  */
} mean_line;

static double weight(double u, double cutoff)
{
    const double alpha2 = log(2.0) / DIF_PI, r = u / cutoff;
    return exp(-DIF_PI * r * r / alpha2);
}

static void mean_line_free(mean_line *m)
{
    dif_release(m->kernel);
    dif_release(m->buffer);
    dif_release(m->own);
    dif_release(m->from_t1);
}

/* Sums of s u^k over the samples that sample i sees, and from them what T0 = sum s z and T1 = sum s u z count. */
static void find_shares(mean_line *m, int reach, double cutoff)
{
    for (int i = 0; i < m->n; i++) {
        double s0 = 0.0, s1 = 0.0, s2 = 0.0;
        const int low = i < reach ? -i : -reach, high = m->n - 1 - i < reach ? m->n - 1 - i : reach;
        for (int u = low; u <= high; u++) {
            const double s = weight(u, cutoff);
            s0 += s;
            s1 += s * u;
            s2 += s * u * u;
        }
        const double d = s0 * s2 - s1 * s1;
        m->own[i] = d > 0.0 ? s2 / d : 1.0 / s0;
        m->from_t1[i] = d > 0.0 ? -s1 / d : 0.0;
    }
}

/* cutoff in samples */
static dif_status mean_line_make(int n, double cutoff, mean_line *m, dif_error *err)
{
    const int reach = (int)fmin(ceil(REACH * cutoff), n - 1.0);
    *m = (mean_line){.n = n, .m = dif_fft_size(n + reach)};
    m->kernel = dif_alloc((size_t)m->m, sizeof *m->kernel);
    m->buffer = dif_alloc((size_t)m->m, sizeof *m->buffer);
    m->own = dif_alloc((size_t)n, sizeof *m->own);
    m->from_t1 = dif_alloc((size_t)n, sizeof *m->from_t1);
    if (!m->kernel || !m->buffer || !m->own || !m->from_t1)
        return dif_fail(err, DIF_ERR_NOMEM, "mean line of %d samples", n);
    for (int u = -reach; u <= reach; u++) { /* sum over u of k[u] z[i + u]: reversed, so that it is a convolution */
        double *k = m->kernel[u <= 0 ? -u : m->m - u];
        k[0] += weight(u, cutoff);
        k[1] += u * weight(u, cutoff);
    }
    find_shares(m, reach, cutoff);
    return dif_fft_rows(m->kernel, 1, m->m, false, err);
}

/* Puts the mean line of n samples, `step` apart in z, in their place. */
static dif_status take_line(const mean_line *m, double *z, size_t step, dif_error *err)
{
    double(*b)[2] = m->buffer;
    memset(b, 0, (size_t)m->m * sizeof *b);
    for (int i = 0; i < m->n; i++)
        b[i][0] = z[(size_t)i * step];
    dif_status status = dif_fft_rows(b, 1, m->m, false, err);
    for (int i = 0; i < m->m && !status; i++) { /* the conjugate: the next transform goes back */
        const double re = b[i][0] * m->kernel[i][0] - b[i][1] * m->kernel[i][1];
        const double im = b[i][0] * m->kernel[i][1] + b[i][1] * m->kernel[i][0];
        b[i][0] = re;
        b[i][1] = -im;
    }
    if (!status)
        status = dif_fft_rows(b, 1, m->m, false, err);
    for (int i = 0; i < m->n && !status; i++)
        z[(size_t)i * step] = (m->own[i] * b[i][0] - m->from_t1[i] * b[i][1]) / m->m;
    return status;
}

/* Replaces n_line lines by their mean lines. */
static dif_status take_axis(double *z, int n_line, size_t jump, int n, size_t step, double cutoff, dif_error *err)
{
    mean_line m = {0};
    dif_status status = mean_line_make(n, cutoff, &m, err);
    for (int k = 0; k < n_line && !status; k++)
        status = take_line(&m, z + (size_t)k * jump, step, err);
    mean_line_free(&m);
    return status;
}

dif_status dif_prep_highpass(dif_field *field, double cutoff_um, dif_error *err)
{
    dif_status status = dif_prep_check_whole(field, "the high-pass", err);
    if (status)
        return status;
    const double least_um = 2.0 * fmax(field->pitch_x_um, field->pitch_y_um);
    if (!(cutoff_um > least_um && isfinite(cutoff_um)))
        return dif_fail(err, DIF_ERR_ARG, "cut-off %g um, want more than two pitches (%g um)", cutoff_um, least_um);
    const size_t n = dif_field_n(field), nx = (size_t)field->nx;
    double *mean = dif_alloc(n, sizeof *mean);
    if (!mean)
        return dif_fail(err, DIF_ERR_NOMEM, "mean surface of %zu heights", n);
    const double offset = dif_prep_state_of(field).mean_um; /* costs digits in the transform */
    for (size_t i = 0; i < n; i++)
        mean[i] = field->z_um[i] - offset;
    status = take_axis(mean, field->ny, nx, field->nx, 1, cutoff_um / field->pitch_x_um, err);
    if (!status)
        status = take_axis(mean, field->nx, 1, field->ny, nx, cutoff_um / field->pitch_y_um, err);
    for (size_t i = 0; i < n && !status; i++)
        field->z_um[i] -= offset + mean[i];
    dif_release(mean);
    return status;
}
