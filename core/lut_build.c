/* Building the table, a row (a ring in the (u, v) plane) at a time. On a ring the power is band-limited in azimuth, so
 * small rings are sampled only as densely as they need and widened by the DFT. */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "core/alloc.h"
#include "core/fft.h"
#include "core/lut_impl.h"
#include "core/response.h"
#include "core/sheet.h"
#include "core/spectrum.h"
#include "core/units.h"

enum {
    PROBE_MAPS = 40, /* nodes when the number of maps is being found    */
    PROBE_ROWS = 16, /* rows that are looked at for it                  */
    BATCH = DIF_RESPONSE_GRID
};

/* One build. */
typedef struct lut_job {
    dif_lut *lut;
    const dif_lut_opts *opts;
    int n_lambda;
    const double *lambda_um;
    double (*weight)[3];
    double reach_um;   /* longest distance within the patch: the band limit of |P|^2 */
    double tol_sheet;  /* amplitude tolerance of the sheets                             */
    int n_node;        /* Chebyshev nodes in use                                       */
    float *sums;       /* sums[row's samples][n_node][3], all rows                     */
    size_t *row_at;    /* where a row's sums begin, row_at[n_radius + 1]               */
    double done, span; /* share of the build that lies before the sums, and that of the sums */
} lut_job;

static void begin_stage(const lut_job *job, const char *name)
{
    if (job->opts->stage)
        job->opts->stage(job->opts->progress_self, name);
}

/* `share` of the sums that are being made. */
static void draw_progress(const lut_job *job, double share)
{
    if (job->opts->progress)
        job->opts->progress(job->opts->progress_self, job->done + job->span * share);
}

static double height_range(double s)
{
    return sqrt(fmax(4.0 - s * s, 0.0));
}

/* Chebyshev node n of n_node on [0, range]. */
static double node_w(int n, int n_node, double range)
{
    return 0.5 * range * (1.0 + cos(DIF_PI * (n + 0.5) / n_node));
}

/* Samples that a ring of radius s needs: the Bessel functions of its band limit k s R die out within a few z^(1/3). */
static int ring_samples(const lut_job *job, double s)
{
    const double z = DIF_TWO_PI / job->lambda_um[0] * s * job->reach_um;
    const double wanted = 2.0 * (z + 8.0 * cbrt(z) + 8.0);
    const int n = wanted < job->lut->n_azimuth ? dif_fft_size((int)wanted) : job->lut->n_azimuth;
    return n < job->lut->n_azimuth ? n : job->lut->n_azimuth;
}

static int row_samples(const lut_job *job, int row)
{
    return (int)(job->row_at[row + 1] - job->row_at[row]);
}

/* Adds one ring: all wavelengths, all nodes. */
static void add_row(const lut_job *job, const dif_sheet *sheet, double share, int row)
{
    const int n_ring = row_samples(job, row), n_node = job->n_node;
    const double s = dif_lut_radius(job->lut, row), range = height_range(s);
    float *sums = job->sums + 3 * (size_t)n_node * job->row_at[row];
    for (int il = 0; il < job->n_lambda; il++) {
        const double k = DIF_TWO_PI / job->lambda_um[il];
        double kz[PROBE_MAPS + DIF_LUT_MAP_MAX], kx[BATCH], ky[BATCH];
        float power[BATCH * (PROBE_MAPS + DIF_LUT_MAP_MAX)];
        float w[3];
        for (int c = 0; c < 3; c++)
            w[c] = (float)(share * job->weight[il][c]);
        for (int n = 0; n < n_node; n++)
            kz[n] = k * node_w(n, n_node, range);
        for (int first = 0; first < n_ring; first += BATCH) {
            const int count = n_ring - first < BATCH ? n_ring - first : BATCH;
            for (int i = 0; i < count; i++) {
                const double turn = DIF_TWO_PI * (first + i) / n_ring;
                kx[i] = k * s * cos(turn);
                ky[i] = k * s * sin(turn);
            }
            dif_response_volume_columns(sheet, count, kx, ky, n_node, kz, power);
            float *at = sums + 3 * (size_t)n_node * (size_t)first;
            for (int i = 0; i < count * n_node; i++)
                for (int c = 0; c < 3; c++)
                    at[3 * i + c] += w[c] * power[i];
        }
    }
}

/* Values at the nodes to Chebyshev coefficients, in place, for one sample: value[n_node][3]. */
static void to_coefficients(int n_node, const double *cosine, float *value)
{
    double coef[PROBE_MAPS + DIF_LUT_MAP_MAX][3];
    for (int m = 0; m < n_node; m++)
        for (int c = 0; c < 3; c++) {
            double sum = 0.0;
            for (int n = 0; n < n_node; n++)
                sum += (double)value[3 * n + c] * cosine[m * (2 * n + 1) % (4 * n_node)];
            coef[m][c] = sum * (m == 0 ? 1.0 : 2.0) / n_node;
        }
    for (int m = 0; m < n_node; m++)
        for (int c = 0; c < 3; c++)
            value[3 * m + c] = (float)coef[m][c];
}

/* cos(pi j / (2 n_node)), j < 4 n_node. */
static void fill_cosine(int n_node, double *cosine)
{
    for (int j = 0; j < 4 * n_node; j++)
        cosine[j] = cos(DIF_PI * j / (2.0 * n_node));
}

static dif_band band_of(const lut_job *job)
{
    const double k_max = DIF_TWO_PI / job->lambda_um[0];
    return (dif_band){2.0 * k_max, 0.0, 2.0 * k_max};
}

/* Lays out the sums of the rows to be done (every `stride`-th). */
static dif_status begin_sums(lut_job *job, int n_node, int stride, dif_error *err)
{
    job->n_node = n_node;
    for (int row = 0; row < job->lut->n_radius; row++) {
        const int n = row % stride ? 0 : ring_samples(job, dif_lut_radius(job->lut, row));
        job->row_at[row + 1] = job->row_at[row] + (size_t)n;
    }
    job->sums = dif_alloc(3 * (size_t)n_node * job->row_at[job->lut->n_radius], sizeof *job->sums);
    return job->sums ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for the sums of a table");
}

/* All rows of one window. Rows grow with their number, so do their costs: the widest come first, so that no thread is
 * left with one at the end. `i_window` of `n_window`: for the progress. */
static void sum_window(const lut_job *job, const dif_sheet *sheet, double share, int i_window, int n_window)
{
    const int n = job->lut->n_radius;
#pragma omp parallel for schedule(dynamic)
    for (int row = n - 1; row >= 0; row--) {
        add_row(job, sheet, share, row);
        if (omp_get_thread_num() == 0) /* the calling one */
            draw_progress(job, (i_window + 1.0 - (double)job->row_at[row] / (double)job->row_at[n]) / n_window);
    }
}

/* Sums of all laid-out rows over all windows, turned into coefficients. */
static dif_status sum_rows(const lut_job *job, const dif_field *field, int n_window, const dif_window *windows,
                           const double *share, dif_error *err)
{
    const dif_band band = band_of(job);
    double cosine[4 * (PROBE_MAPS + DIF_LUT_MAP_MAX)];
    for (int w = 0; w < n_window; w++) {
        dif_sheet *sheet;
        begin_stage(job, "sheet");
        const dif_status status = dif_sheet_create_volume(field, windows + w, &band, job->tol_sheet, NULL, &sheet, err);
        if (status != DIF_OK)
            return status;
        if (dif_sheet_info_of(sheet).n_plane > DIF_RESPONSE_PLANES) {
            const int n_plane = dif_sheet_info_of(sheet).n_plane;
            dif_sheet_free(sheet);
            return dif_fail(err, DIF_ERR_SIZE, "heights too large for a table: %d planes, want <= %d", n_plane,
                            DIF_RESPONSE_PLANES);
        }
        begin_stage(job, "rings");
        sum_window(job, sheet, share[w], w, n_window);
        dif_sheet_free(sheet);
    }
    begin_stage(job, "texels");
    fill_cosine(job->n_node, cosine);
    const size_t n = job->row_at[job->lut->n_radius];
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < n; i++)
        to_coefficients(job->n_node, cosine, job->sums + 3 * (size_t)job->n_node * i);
    return DIF_OK;
}

/* tail[m] = largest sum of |coefficients| from map m on: what dropping them changes at most. */
static void survey(const lut_job *job, double *tail)
{
    const size_t n = job->row_at[job->lut->n_radius];
    for (int m = 0; m < job->n_node; m++)
        tail[m] = 0.0;
    for (size_t i = 0; i < n; i++) {
        const float *coef = job->sums + 3 * (size_t)job->n_node * i;
        double sum[3] = {0.0};
        for (int m = job->n_node - 1; m >= 0; m--)
            for (int c = 0; c < 3; c++) {
                sum[c] += fabs((double)coef[3 * m + c]);
                tail[m] = fmax(tail[m], sum[c]);
            }
    }
}

/* How many maps the tolerance needs, from a few rows with many nodes. */
static dif_status find_maps(lut_job *job, const dif_field *field, const dif_window *window, double tol, dif_error *err)
{
    const double one = 1.0;
    double tail[PROBE_MAPS];
    const int stride = job->lut->n_radius > PROBE_ROWS ? job->lut->n_radius / PROBE_ROWS : 1;
    job->span = 0.1;
    dif_status status = begin_sums(job, PROBE_MAPS, stride, err);
    if (status == DIF_OK)
        status = sum_rows(job, field, 1, window, &one, err);
    if (status == DIF_OK) {
        survey(job, tail);
        int n_map = 1;
        while (n_map < PROBE_MAPS && tail[n_map] > 0.5 * tol)
            n_map++;
        job->lut->n_map = n_map;
    }
    dif_release(job->sums);
    job->sums = NULL;
    job->done = job->span;
    return status;
}

/* One channel of one map around a ring, widened from n to n_azimuth samples by its DFT. */
static dif_status widen(int n, int n_azimuth, double *ring, double *wide, dif_error *err)
{
    memset(wide, 0, 2 * (size_t)n_azimuth * sizeof *wide);
    dif_status status = dif_fft_rows(ring, 1, n, false, err);
    if (status != DIF_OK)
        return status;
    for (int q = -(n - 1) / 2; q <= (n - 1) / 2; q++) {
        const double *from = ring + 2 * (q < 0 ? q + n : q);
        double *to = wide + 2 * (q < 0 ? q + n_azimuth : q);
        /* conjugate in, conjugate out: the inverse transform by the forward one */
        to[0] = from[0] / n;
        to[1] = -from[1] / n;
    }
    return dif_fft_rows(wide, 1, n_azimuth, false, err);
}

/* Moves one row's coefficients into the table; ring and wide are work space of 2 n_azimuth doubles. */
static dif_status store_row(const lut_job *job, int row, double *ring, double *wide, dif_error *err)
{
    dif_lut *lut = job->lut;
    const int n = row_samples(job, row), n_value = 3 * lut->n_map, n_sum = 3 * job->n_node;
    const float *from = job->sums + (size_t)n_sum * job->row_at[row];
    float *to = lut->coef + (size_t)n_value * (size_t)lut->n_azimuth * (size_t)row;
    for (int value = 0; value < n_value; value++) {
        for (int i = 0; i < n; i++) {
            ring[2 * i] = (double)from[i * n_sum + value];
            ring[2 * i + 1] = 0.0;
        }
        const double *source = ring;
        if (n < lut->n_azimuth) {
            const dif_status status = widen(n, lut->n_azimuth, ring, wide, err);
            if (status != DIF_OK)
                return status;
            source = wide;
        }
        for (int i = 0; i < lut->n_azimuth; i++)
            to[i * n_value + value] = (float)source[2 * i];
    }
    return DIF_OK;
}

static dif_status store_rows(const lut_job *job, dif_error *err)
{
    const int n_thread = omp_get_max_threads();
    const size_t n_work = 4 * (size_t)job->lut->n_azimuth;
    double *work = dif_alloc(n_work * (size_t)n_thread, sizeof *work);
    if (!work)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for rows of a table");
    dif_status bad = DIF_OK;
#pragma omp parallel for schedule(dynamic) num_threads(n_thread)
    for (int row = 0; row < job->lut->n_radius; row++) {
        double *mine = work + n_work * (size_t)omp_get_thread_num();
        dif_error detail;
        const dif_status status = store_row(job, row, mine, mine + n_work / 2, &detail);
        if (status != DIF_OK)
#pragma omp critical
            bad = dif_fail(err, status, "%s", detail.text);
    }
    dif_release(work);
    return bad;
}

/* Averages the table over a disc of the source's radius in (u, v): equal shares of three rings of points. */
static dif_status blur(dif_lut *lut, double radius, dif_error *err)
{
    const size_t texel = 3 * (size_t)lut->n_map, n = texel * (size_t)lut->n_azimuth * (size_t)lut->n_radius;
    float *out = dif_alloc(n, sizeof *out);
    if (!out)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory to blur a table");
#pragma omp parallel for schedule(dynamic)
    for (int row = 0; row < lut->n_radius; row++)
        for (int column = 0; column < lut->n_azimuth; column++)
            dif_lut_disc_average(lut, dif_lut_radius(lut, row), DIF_TWO_PI * column / lut->n_azimuth, radius,
                                 out + texel * ((size_t)row * (size_t)lut->n_azimuth + (size_t)column));
    dif_release(lut->coef);
    lut->coef = out;
    return DIF_OK;
}

static dif_status check(int n_window, int n_lambda, const double *lambda_um, double tol, const dif_lut_opts *opts,
                        dif_error *err)
{
    if (n_window < 1 || n_lambda < 1)
        return dif_fail(err, DIF_ERR_ARG, "%d windows and %d wavelengths, want at least one each", n_window, n_lambda);
    for (int i = 0; i < n_lambda; i++)
        if (!(lambda_um[i] > 0.0 && lambda_um[i] < 1e6))
            return dif_fail(err, DIF_ERR_ARG, "wavelength %g um, want > 0", lambda_um[i]);
    if (!(tol >= 1e-6 && tol < 1.0))
        return dif_fail(err, DIF_ERR_TOL, "tol = %g, want 1e-6 <= tol < 1 (the table is stored in float)", tol);
    if (!(opts->n_azimuth >= 16 && opts->n_azimuth <= 16384 && opts->n_radius >= 8 && opts->n_radius <= 4096))
        return dif_fail(err, DIF_ERR_ARG, "table of %d azimuths x %d radii, want 16 ... 16384 x 8 ... 4096",
                        opts->n_azimuth, opts->n_radius);
    if (opts->n_map != DIF_LUT_MAPS_FROM_TOL && !(opts->n_map >= 1 && opts->n_map <= DIF_LUT_MAP_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d maps, want 1 ... %d", opts->n_map, DIF_LUT_MAP_MAX);
    if (!(opts->source_diameter_rad >= 0.0 && opts->source_diameter_rad < 0.5))
        return dif_fail(err, DIF_ERR_ARG, "source of %g rad, want 0 ... 0.5", opts->source_diameter_rad);
    return DIF_OK;
}

/* Radius up to which rows are even: four widths of the coherence spot at a middle wavelength. */
static double even_radius(const dif_field *field, const dif_window *window)
{
    const double flat_um = fmin(field->nx * field->pitch_x_um, field->ny * field->pitch_y_um) / sqrt(12.0);
    const double sigma_um = window->kind == DIF_WINDOW_GAUSS ? fmin(window->sigma_um, flat_um) : flat_um;
    return fmin(4.0 * 0.55 / (DIF_TWO_PI * sigma_um), 0.5);
}

static dif_status build(lut_job *job, const dif_field *field, int n_window, const dif_window *windows,
                        const double *share, double tol, dif_error *err)
{
    dif_lut *lut = job->lut;
    double tail[PROBE_MAPS + DIF_LUT_MAP_MAX];
    /* an amplitude error e changes a power of at most 1 by at most 2 e */
    job->tol_sheet = 0.1 * tol;
    dif_status status = dif_spectrum_weights(job->n_lambda, job->lambda_um, job->weight, err);
    if (status == DIF_OK && lut->n_map == DIF_LUT_MAPS_FROM_TOL)
        status = find_maps(job, field, windows, tol, err);
    /* Two nodes beyond the kept maps measure what is dropped. */
    job->span = 0.9 - job->done;
    if (status == DIF_OK)
        status = begin_sums(job, lut->n_map + 2, 1, err);
    if (status == DIF_OK)
        status = sum_rows(job, field, n_window, windows, share, err);
    if (status != DIF_OK)
        return status;
    survey(job, tail);
    lut->tail = tail[lut->n_map];
    lut->coef = dif_alloc((size_t)lut->n_radius * (size_t)lut->n_azimuth, 3 * (size_t)lut->n_map * sizeof *lut->coef);
    if (!lut->coef)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for a table of %d maps", lut->n_map);
    status = store_rows(job, err);
    if (status == DIF_OK && job->opts->source_diameter_rad > 0.0)
        begin_stage(job, "blur");
    if (status == DIF_OK && job->opts->source_diameter_rad > 0.0)
        status = blur(lut, sin(0.5 * job->opts->source_diameter_rad), err);
    return status;
}

dif_status dif_lut_create(const dif_field *field, int n_window, const dif_window *windows, const double *share,
                          int n_lambda, const double *lambda_um, double tol, const dif_lut_opts *opts, dif_lut *out,
                          dif_error *err)
{
    const dif_lut_opts defaults = dif_lut_opts_default();
    const dif_lut_opts *o = opts ? opts : &defaults;
    *out = (dif_lut){0};
    dif_status status = check(n_window, n_lambda, lambda_um, tol, o, err);
    if (status != DIF_OK)
        return status;
    lut_job job = {.lut = out, .opts = o, .n_lambda = n_lambda, .lambda_um = lambda_um};
    job.reach_um = hypot((field->nx - 1) * field->pitch_x_um, (field->ny - 1) * field->pitch_y_um);
    *out = (dif_lut){
        .n_azimuth = o->n_azimuth, .n_radius = o->n_radius, .n_map = o->n_map, .s0 = even_radius(field, windows)};
    job.weight = dif_alloc((size_t)n_lambda, sizeof *job.weight);
    job.row_at = dif_alloc((size_t)o->n_radius + 1, sizeof *job.row_at);
    if (job.weight && job.row_at)
        status = build(&job, field, n_window, windows, share, tol, err);
    else
        status = dif_fail(err, DIF_ERR_NOMEM, "no memory for a table of %d wavelengths", n_lambda);
    dif_release(job.weight);
    dif_release(job.row_at);
    dif_release(job.sums);
    if (status != DIF_OK)
        dif_lut_free(out);
    else if (o->progress)
        o->progress(o->progress_self, 1.0);
    return status;
}
