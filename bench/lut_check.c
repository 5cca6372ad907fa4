#include "bench/lut_check.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "bench/measure_impl.h"
#include "core/alloc.h"
#include "core/colour.h"
#include "core/spectrum.h"
#include "core/units.h"

enum { SOURCE_POINTS = 64 };
#define TOL_FULL 1e-6

dif_status dif_lut_measure(const dif_field *field, int n_lambda, const double *lambda_um, double tol,
                           const dif_measure_opts *opts, const dif_lut_opts *how, dif_lut *out, int *n_window,
                           dif_error *err)
{
    dif_window_set set = {0};
    *out = (dif_lut){0};
    dif_status status = dif_measure_check_opts(field, tol, opts, err);
    if (status == DIF_OK)
        status = dif_window_set_make(field, opts, &set, err);
    if (status == DIF_OK) {
        const int threads = dif_measure_threads(opts);
        status = dif_lut_create(field, set.n, set.window, set.share, n_lambda, lambda_um, tol, how, out, err);
        omp_set_num_threads(threads);
    }
    *n_window = set.n;
    dif_window_set_free(&set);
    return status;
}

/* One comparison. */
typedef struct check_job {
    const dif_lut *lut;
    int n, n_lambda, n_point; /* n_point: points of the source, 1 or SOURCE_POINTS */
    const double *lambda_um;
    double radius; /* of the source in (u, v) */
    double (*weight)[3];
    dif_query *pair;    /* pair[n]: the directions, wavelength unused    */
    dif_query *query;   /* query[n][n_point][n_lambda]                   */
    dif_sample *sample; /* of each query                                 */
    double (*got)[3], (*full)[3], *value;
} check_job;

static void job_free(check_job *job)
{
    dif_release(job->weight);
    dif_release(job->pair);
    dif_release(job->query);
    dif_release(job->sample);
    dif_release(job->got);
    dif_release(job->full);
    dif_release(job->value);
}

static dif_status job_make(check_job *job, dif_error *err)
{
    const size_t n = (size_t)job->n, n_query = n * (size_t)job->n_point * (size_t)job->n_lambda;
    job->weight = dif_alloc((size_t)job->n_lambda, sizeof *job->weight);
    job->pair = dif_alloc(n, sizeof *job->pair);
    job->query = dif_alloc(n_query, sizeof *job->query);
    job->sample = dif_alloc(n_query, sizeof *job->sample);
    job->got = dif_alloc(n, sizeof *job->got);
    job->full = dif_alloc(n, sizeof *job->full);
    job->value = dif_alloc(n, sizeof *job->value);
    if (!job->weight || !job->pair || !job->query || !job->sample || !job->got || !job->full || !job->value)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory to check %d directions", job->n);
    return dif_spectrum_weights(job->n_lambda, job->lambda_um, job->weight, err);
}

/* splitmix64 in [0, 1) */
static double random_unit(unsigned long long *state)
{
    unsigned long long z = (*state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static dif_vec3 random_direction(unsigned long long *state)
{
    const double theta = asin(sqrt(random_unit(state)));
    return dif_vec3_from_angles_rad(theta, DIF_TWO_PI * random_unit(state));
}

/* A pair of directions above the surface whose transfer is q, |q| < 2, q.z < 0: -q/2 plus and minus a level vector. */
static void pair_of(dif_vec3 q, dif_query *out)
{
    const double s = hypot(q.x, q.y), across = sqrt(fmax(1.0 - 0.25 * dif_vec3_dot(q, q), 0.0));
    const double x = s > 0.0 ? -q.y / s : 1.0, y = s > 0.0 ? q.x / s : 0.0;
    out->wi = (dif_vec3){-0.5 * q.x + across * x, -0.5 * q.y + across * y, -0.5 * q.z};
    out->wo = (dif_vec3){-0.5 * q.x - across * x, -0.5 * q.y - across * y, -0.5 * q.z};
}

/* The queries of one direction pair: every point of the source (a spiral of even density), every wavelength. */
static void fill_queries(const check_job *job, int i)
{
    const dif_vec3 q = dif_vec3_transfer(job->pair[i].wi, job->pair[i].wo);
    for (int p = 0; p < job->n_point; p++) {
        const double r = job->radius * sqrt((p + 0.5) / job->n_point), turn = 2.39996322972865332 * p;
        const dif_vec3 at = {q.x + r * cos(turn), q.y + r * sin(turn), q.z};
        dif_query query = job->pair[i];
        if (job->radius > 0.0)
            pair_of(at, &query);
        for (int il = 0; il < job->n_lambda; il++) {
            query.lambda_um = job->lambda_um[il];
            job->query[((size_t)i * (size_t)job->n_point + (size_t)p) * (size_t)job->n_lambda + (size_t)il] = query;
        }
    }
}

/* Direction pairs; none so near the rim that a point of the source has no directions. */
static void fill_pairs(const check_job *job, unsigned seed)
{
    unsigned long long state = seed;
    for (int i = 0; i < job->n;) {
        dif_query *pair = job->pair + i;
        pair->wi = random_direction(&state);
        pair->wo = random_direction(&state);
        const dif_vec3 q = dif_vec3_transfer(pair->wi, pair->wo);
        const double s = hypot(q.x, q.y) + job->radius;
        if (pair->wi.z > 1e-6 && pair->wo.z > 1e-6 && s * s + q.z * q.z < 3.999)
            fill_queries(job, i++);
    }
}

static void fill_colours(const check_job *job)
{
    for (int i = 0; i < job->n; i++) {
        const dif_vec3 q = dif_vec3_transfer(job->pair[i].wi, job->pair[i].wo);
        dif_lut_eval(job->lut, q.x, q.y, q.z, job->got[i]);
        const dif_sample *sample = job->sample + (size_t)i * (size_t)job->n_point * (size_t)job->n_lambda;
        for (int k = 0; k < job->n_point * job->n_lambda; k++)
            for (int c = 0; c < 3; c++)
                job->full[i][c] += job->weight[k % job->n_lambda][c] * sample[k].power / job->n_point;
    }
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double quantile(const check_job *job, double share)
{
    return job->value[(size_t)rint(share * (job->n - 1))];
}

/* Sorts the values. */
static dif_lut_errors errors_of(const check_job *job)
{
    qsort(job->value, (size_t)job->n, sizeof *job->value, compare_doubles);
    return (dif_lut_errors){quantile(job, 0.5), quantile(job, 0.95), quantile(job, 1.0)};
}

static double colour_difference(const double a[3], const double b[3], double exposure)
{
    double scaled_a[3], scaled_b[3], lab_a[3], lab_b[3];
    for (int c = 0; c < 3; c++) {
        scaled_a[c] = exposure * a[c];
        scaled_b[c] = exposure * b[c];
    }
    dif_colour_lab_from_xyz(scaled_a, lab_a);
    dif_colour_lab_from_xyz(scaled_b, lab_b);
    return dif_colour_difference_2000(lab_a, lab_b);
}

static void judge(const check_job *job, dif_lut_check *out)
{
    double worst = -1.0;
    out->n = job->n;
    for (int i = 0; i < job->n; i++)
        job->value[i] = job->full[i][1];
    out->brightest = errors_of(job).worst;
    const double white = quantile(job, 0.99);
    out->exposure = white > 0.0 ? 1.0 / white : 1.0;
    for (int i = 0; i < job->n; i++)
        job->value[i] = fabs(job->got[i][1] - job->full[i][1]) / job->full[i][1];
    out->relative = errors_of(job);
    for (int i = 0; i < job->n; i++) {
        job->value[i] = 0.0;
        for (int c = 0; c < 3; c++)
            job->value[i] = fmax(job->value[i], fabs(job->got[i][c] - job->full[i][c]) / out->brightest);
        if (job->value[i] <= worst)
            continue;
        worst = job->value[i];
        out->worst_wi = job->pair[i].wi;
        out->worst_wo = job->pair[i].wo;
        out->worst_y = job->got[i][1];
        out->worst_full_y = job->full[i][1];
    }
    out->of_peak = errors_of(job);
    for (int i = 0; i < job->n; i++)
        job->value[i] = colour_difference(job->got[i], job->full[i], out->exposure);
    out->de = errors_of(job);
}

dif_status dif_lut_check_random(const dif_field *field, const dif_lut *lut, int n_lambda, const double *lambda_um,
                                double source_diameter_rad, const dif_measure_opts *opts, int n, unsigned seed,
                                dif_lut_check *out, dif_error *err)
{
    check_job job = {.lut = lut, .n = n, .n_lambda = n_lambda, .lambda_um = lambda_um};
    dif_measure_opts full = *opts;
    *out = (dif_lut_check){0};
    if (n < 1)
        return dif_fail(err, DIF_ERR_ARG, "%d directions to check, want >= 1", n);
    job.n_point = source_diameter_rad > 0.0 ? SOURCE_POINTS : 1;
    job.radius = sin(0.5 * source_diameter_rad);
    full.method = DIF_METHOD_SHEET;
    full.quantity = DIF_QUANTITY_POWER;
    full.progress = NULL;
    dif_status status = job_make(&job, err);
    if (status == DIF_OK) {
        fill_pairs(&job, seed);
        status = dif_measure_queries(field, (size_t)n * (size_t)job.n_point * (size_t)n_lambda, job.query, TOL_FULL,
                                     &full, job.sample, NULL, err);
    }
    if (status == DIF_OK) {
        fill_colours(&job);
        judge(&job, out);
    }
    job_free(&job);
    return status;
}
