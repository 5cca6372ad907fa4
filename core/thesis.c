#include "core/thesis.h"

#include <math.h>
#include <string.h>

#include "core/alloc.h"
#include "core/fft.h"
#include "core/units.h"

enum { BLOCK = 64, DIRECT_MAX = 16, SIGMAS = 4 };

/* One lateral axis: its bins and how far a sample reads. */
typedef struct axis {
    int n_sample;
    double step;  /* of bins, rad/um                              */
    double reach; /* SIGMAS sigma_f in bins, at least one bin     */
    int first, n; /* bins kept                                    */
    bool falls;   /* positions fall with the index (y)            */
} axis;

struct dif_thesis {
    axis x, y;
    double sigma_um, height_um;
    int n_term;
    bool single;
    double *coef; /* coef[y.n][x.n][2][n_term]: i^n F{(h/height)^n} / (nx ny), owned */
};

static axis axis_make(int n_sample, double pitch_um, double sigma_um, double k_min, double k_max, bool falls)
{
    axis out = {.n_sample = n_sample, .step = DIF_TWO_PI / (n_sample * pitch_um), .falls = falls};
    out.reach = fmax(SIGMAS / (sigma_um * out.step), 1.0);
    const double first = ceil(k_min / out.step - out.reach), last = floor(k_max / out.step + out.reach);
    if (first > -1e6 && last < 1e6 && last >= first) {
        out.first = (int)first;
        out.n = (int)(last - first) + 1;
    }
    return out;
}

/* The index in a DFT of n samples that bin q of an axis has. */
static int dft_index(const axis *a, int q)
{
    const int at = (a->falls ? -q : q) % a->n_sample;
    return at < 0 ? at + a->n_sample : at;
}

/* Everything one transform of a power needs; the long axis has more bins than the short one. */
typedef struct work {
    const axis *along, *across; /* long and short                                           */
    double *power;              /* power[along.n_sample][across.n_sample]                   */
    double *height;             /* the same, heights / height_um                            */
    double (*line)[2];          /* line[across.n][along.n_sample]                           */
    double (*block)[2];         /* block[BLOCK][across.n_sample]                            */
    double (*phasor)[2];        /* phasor[across.n][across.n_sample] if summed directly     */
} work;

static dif_status work_make(work *w, const dif_thesis *thesis, const dif_field *field, dif_error *err)
{
    const bool x_long = thesis->x.n >= thesis->y.n;
    w->along = x_long ? &thesis->x : &thesis->y;
    w->across = x_long ? &thesis->y : &thesis->x;
    const size_t n_long = (size_t)w->along->n_sample, n_short = (size_t)w->across->n_sample,
                 n_bin = (size_t)w->across->n;
    w->power = dif_alloc(n_long * n_short, sizeof *w->power);
    w->height = dif_alloc(n_long * n_short, sizeof *w->height);
    w->line = dif_alloc(n_bin * n_long, sizeof *w->line);
    if (n_bin <= DIRECT_MAX)
        w->phasor = dif_alloc(n_bin * n_short, sizeof *w->phasor);
    else
        w->block = dif_alloc(BLOCK * n_short, sizeof *w->block);
    if (!w->power || !w->height || !w->line || (!w->phasor && !w->block))
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for powers of %d x %d heights", field->nx, field->ny);
    for (size_t i = 0; i < n_long; i++)
        for (size_t j = 0; j < n_short; j++) {
            const size_t at = x_long ? j * n_long + i : i * n_short + j;
            w->height[i * n_short + j] = field->z_um[at] / thesis->height_um;
            w->power[i * n_short + j] = 1.0 / ((double)n_long * (double)n_short);
        }
    for (size_t q = 0; w->phasor && q < n_bin; q++)
        for (size_t j = 0; j < n_short; j++) {
            const int at = dft_index(w->across, w->across->first + (int)q);
            const double turns = (double)((size_t)at * j % n_short) / (double)n_short;
            w->phasor[q * n_short + j][0] = cos(DIF_TWO_PI * turns);
            w->phasor[q * n_short + j][1] = sin(DIF_TWO_PI * turns);
        }
    return DIF_OK;
}

static void work_free(work *w)
{
    dif_release(w->power);
    dif_release(w->height);
    dif_release(w->line);
    dif_release(w->block);
    dif_release(w->phasor);
}

/* Sums across, few bins: a dot product each. */
static void reduce_direct(const work *w)
{
    const size_t n_long = (size_t)w->along->n_sample, n_short = (size_t)w->across->n_sample;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < n_long; i++)
        for (size_t q = 0; q < (size_t)w->across->n; q++) {
            const double *power = w->power + i * n_short;
            const double(*phasor)[2] = (const double(*)[2])w->phasor + q * n_short;
            double re = 0.0, im = 0.0;
#pragma omp simd reduction(+ : re, im)
            for (size_t j = 0; j < n_short; j++) {
                re += power[j] * phasor[j][0];
                im += power[j] * phasor[j][1];
            }
            w->line[q * n_long + i][0] = re;
            w->line[q * n_long + i][1] = im;
        }
}

/* Sums across, many bins: a DFT of each row. */
static dif_status reduce_dft(const work *w, dif_error *err)
{
    const size_t n_long = (size_t)w->along->n_sample, n_short = (size_t)w->across->n_sample;
    for (size_t first = 0; first < n_long; first += BLOCK) {
        const size_t n = n_long - first < BLOCK ? n_long - first : BLOCK;
        for (size_t i = 0; i < n * n_short; i++) {
            w->block[i][0] = w->power[first * n_short + i];
            w->block[i][1] = 0.0;
        }
        const dif_status status = dif_fft_rows(w->block, (int)n, (int)n_short, false, err);
        if (status != DIF_OK)
            return status;
        for (int q = 0; q < w->across->n; q++) {
            const size_t at = (size_t)dft_index(w->across, w->across->first + q);
            for (size_t i = 0; i < n; i++)
                memcpy(w->line[(size_t)q * n_long + first + i], w->block[i * n_short + at], sizeof *w->line);
        }
    }
    return DIF_OK;
}

/* Coefficients of term n from the current powers. */
static dif_status add_term(dif_thesis *thesis, const work *w, int term, dif_error *err)
{
    const size_t n_long = (size_t)w->along->n_sample, n_term = (size_t)thesis->n_term;
    const bool x_long = w->along == &thesis->x;
    dif_status status = DIF_OK;
    if (w->phasor)
        reduce_direct(w);
    else
        status = reduce_dft(w, err);
    if (status == DIF_OK)
        status = dif_fft_rows(w->line, w->across->n, w->along->n_sample, false, err);
    for (int a = 0; a < w->along->n && status == DIF_OK; a++)
        for (int q = 0; q < w->across->n; q++) {
            const size_t bin =
                x_long ? (size_t)q * (size_t)thesis->x.n + (size_t)a : (size_t)a * (size_t)thesis->x.n + (size_t)q;
            const double *from = w->line[(size_t)q * n_long + (size_t)dft_index(w->along, w->along->first + a)];
            double *to = thesis->coef + bin * 2 * n_term + (size_t)term;
            /* times i^term */
            const int turn = term % 4;
            to[0] = turn == 0 ? from[0] : turn == 1 ? -from[1] : turn == 2 ? -from[0] : from[1];
            to[n_term] = turn == 0 ? from[1] : turn == 1 ? from[0] : turn == 2 ? -from[1] : -from[0];
        }
    return status;
}

static dif_status check(const dif_field *field, double sigma_um, const dif_thesis_box *box, int n_term, dif_error *err)
{
    if (!(sigma_um > 0.0 && sigma_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "sigma = %g um, want > 0", sigma_um);
    if (!(n_term >= 1 && n_term <= DIF_THESIS_TERMS_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d terms, want 1 ... %d", n_term, DIF_THESIS_TERMS_MAX);
    if (!(box->kx_min <= box->kx_max && box->ky_min <= box->ky_max))
        return dif_fail(err, DIF_ERR_ARG, "an empty box of frequencies");
    return dif_field_check(field, err);
}

static dif_status fill(dif_thesis *thesis, const dif_field *field, dif_error *err)
{
    const size_t n_bin = (size_t)thesis->x.n * (size_t)thesis->y.n, n = dif_field_n(field);
    work w = {0};
    dif_status status = DIF_OK;
    thesis->coef = dif_alloc(n_bin, 2 * (size_t)thesis->n_term * sizeof *thesis->coef);
    if (!thesis->coef)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d terms of %zu bins", thesis->n_term, n_bin);
    thesis->height_um = 0.0;
    for (size_t i = 0; i < n; i++)
        thesis->height_um = fmax(thesis->height_um, fabs(field->z_um[i]));
    if (!(thesis->height_um > 0.0))
        thesis->height_um = 1.0;
    status = work_make(&w, thesis, field, err);
    for (int term = 0; term < thesis->n_term && status == DIF_OK; term++) {
        status = add_term(thesis, &w, term, err);
        for (size_t i = 0; i < n; i++)
            w.power[i] *= w.height[i];
    }
    work_free(&w);
    return status;
}

dif_status dif_thesis_create(const dif_field *field, double sigma_um, const dif_thesis_box *box, int n_term,
                             bool single, dif_thesis **out, dif_error *err)
{
    *out = NULL;
    dif_status status = check(field, sigma_um, box, n_term, err);
    if (status != DIF_OK)
        return status;
    dif_thesis *thesis = dif_alloc(1, sizeof *thesis);
    if (!thesis)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for a series");
    thesis->x = axis_make(field->nx, field->pitch_x_um, sigma_um, box->kx_min, box->kx_max, false);
    thesis->y = axis_make(field->ny, field->pitch_y_um, sigma_um, box->ky_min, box->ky_max, true);
    thesis->sigma_um = sigma_um;
    thesis->n_term = n_term;
    thesis->single = single;
    status = thesis->x.n > 0 && thesis->y.n > 0 ? fill(thesis, field, err)
                                                : dif_fail(err, DIF_ERR_SIZE, "more than 1e6 bins along an axis");
    if (status == DIF_OK)
        *out = thesis;
    else
        dif_thesis_free(thesis);
    return status;
}

void dif_thesis_free(dif_thesis *thesis)
{
    if (!thesis)
        return;
    dif_release(thesis->coef);
    dif_release(thesis);
}

/* The series of one bin, in double. */
static void sum_double(const double *coef, const double *factor, int n_term, double *sum)
{
    double re = 0.0, im = 0.0;
#pragma omp simd reduction(+ : re, im)
    for (int n = 0; n < n_term; n++) {
        re += factor[n] * coef[n];
        im += factor[n] * coef[n_term + n];
    }
    sum[0] = re;
    sum[1] = im;
}

/* The same as a shader would: factors, coefficients and sums in float, in order. */
static void sum_single(const double *coef, const double *factor, int n_term, double *sum)
{
    float re = 0.0f, im = 0.0f;
    for (int n = 0; n < n_term; n++) {
        re += (float)factor[n] * (float)coef[n];
        im += (float)factor[n] * (float)coef[n_term + n];
    }
    sum[0] = (double)re;
    sum[1] = (double)im;
}

/* Bins of an axis that a sample at kappa reads, clipped to those kept. */
static void reach_of(const axis *a, double kappa, int *first, int *end)
{
    const double at = kappa / a->step;
    *first = (int)fmax(ceil(at - a->reach) - a->first, 0.0);
    *end = (int)fmin(floor(at + a->reach) - a->first + 1.0, a->n);
}

static void read_point(const dif_thesis *thesis, dif_vec3 kappa, const double *factor, double *amp)
{
    const double s = thesis->sigma_um;
    int x0, x1, y0, y1;
    reach_of(&thesis->x, kappa.x, &x0, &x1);
    reach_of(&thesis->y, kappa.y, &y0, &y1);
    amp[0] = amp[1] = 0.0;
    for (int qy = y0; qy < y1; qy++)
        for (int qx = x0; qx < x1; qx++) {
            const double dx = s * (kappa.x - thesis->x.step * (qx + thesis->x.first));
            const double dy = s * (kappa.y - thesis->y.step * (qy + thesis->y.first));
            const double w = exp(-0.5 * (dx * dx + dy * dy));
            const size_t bin = (size_t)qy * (size_t)thesis->x.n + (size_t)qx;
            const double *coef = thesis->coef + bin * 2 * (size_t)thesis->n_term;
            double sum[2] = {0.0, 0.0};
            (thesis->single ? sum_single : sum_double)(coef, factor, thesis->n_term, sum);
            amp[0] += w * sum[0];
            amp[1] += w * sum[1];
        }
}

void dif_thesis_amplitudes(const dif_thesis *thesis, size_t n, const dif_vec3 *kappa, const double *k_rad_per_um,
                           double (*amp)[2])
{
    double factor[DIF_THESIS_TERMS_MAX], last = -1.0;
    for (size_t i = 0; i < n; i++) {
        if (k_rad_per_um[i] != last) {
            last = k_rad_per_um[i];
            factor[0] = 1.0;
            for (int t = 1; t < thesis->n_term; t++)
                factor[t] = factor[t - 1] * last * thesis->height_um / t;
        }
        read_point(thesis, kappa[i], factor, amp[i]);
    }
}
