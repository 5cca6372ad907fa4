#include "bench/energy.h"

#include <math.h>

#include "core/alloc.h"
#include "core/units.h"

/* Directions one integral may ask for: 40 bytes of result and 56 of query each, so below 400 MB. */
static const double DIRECTIONS_MAX = 4e6;

/* Rule of the hemisphere: Gauss-Legendre in theta over [0, pi/2] (n_theta nodes), on each ring the trapezoid in phi.
 *
 * |P|^2 is the transform of the surface's autocorrelation, which ends at the patch (or where the Gaussian has died), so
 * that both rules converge at once when they have more points than the largest phase has half turns; and d omega =
 * sin theta d theta d phi leaves no singularity at the rim, where f itself grows like 1/cos theta. */
typedef struct hemisphere {
    int n_theta;
    double phase; /* largest phase difference of two points of the surface, rad */
} hemisphere;

/* Width of the autocorrelation of the windowed patch along one axis. */
static double reach_um(const dif_measure_opts *opts, double side_um)
{
    /* exp(-x^2 / (4 sigma^2)) < 1e-7 beyond 8 sigma */
    return opts->window == DIF_WINDOW_GAUSS ? fmin(side_um, 8.0 * opts->sigma_um) : side_um;
}

static dif_status plan_hemisphere(const dif_field *field, double lambda_um, const dif_measure_opts *opts,
                                  hemisphere *out, dif_error *err)
{
    dif_field_stats stats;
    const dif_status status = dif_field_stats_of(field, &stats, err);
    if (status)
        return status;
    const double x_um = reach_um(opts, field->nx * field->pitch_x_um);
    const double y_um = reach_um(opts, field->ny * field->pitch_y_um);
    const double z_um = stats.max_um - stats.min_um;
    const double phase = DIF_TWO_PI / lambda_um * sqrt(x_um * x_um + y_um * y_um + z_um * z_um);
    /* over [0, pi/2] a phase of p has a range of p; Gauss-Legendre needs half of that in nodes, the trapezoid all of it */
    const double n_theta = ceil(0.5 * phase) + 24.0;
    if (!(n_theta * (phase + 24.0) <= DIRECTIONS_MAX))
        return dif_fail(err, DIF_ERR_SIZE,
                        "energy integral needs %.2g directions, want at most %.0g: a smaller patch or window, or a "
                        "longer wavelength",
                        n_theta * (phase + 24.0), DIRECTIONS_MAX);
    *out = (hemisphere){.n_theta = (int)n_theta, .phase = phase};
    return DIF_OK;
}

/* Node i (of n) and weight of Gauss-Legendre on [-1, 1], by Newton's method on the Legendre polynomial. */
static void gauss_legendre(int n, int i, double *x, double *weight)
{
    double at = cos(DIF_PI * (i + 0.75) / (n + 0.5));
    double slope = 1.0;
    for (int pass = 0; pass < 8; pass++) {
        double before = 1.0, p = at; /* P_0, P_1 */
        for (int k = 2; k <= n; k++) {
            const double next = ((2 * k - 1) * at * p - (k - 1) * before) / k;
            before = p;
            p = next;
        }
        slope = n * (before - at * p) / (1.0 - at * at);
        at -= p / slope;
    }
    *x = at;
    *weight = 2.0 / ((1.0 - at * at) * slope * slope);
}

static int ring_count(const hemisphere *rule, double sin_theta)
{
    return (int)ceil(rule->phase * sin_theta) + 24;
}

/* Writes queries and weights cos theta sin theta d theta d phi (NULL: only counts); returns their number. */
static size_t fill_hemisphere(const hemisphere *rule, dif_vec3 wi, double lambda_um, dif_query *query, double *weight)
{
    size_t n = 0;
    for (int i = 0; i < rule->n_theta; i++) {
        double x, w;
        gauss_legendre(rule->n_theta, i, &x, &w);
        const double theta = 0.25 * DIF_PI * (1.0 + x);
        const int n_phi = ring_count(rule, sin(theta));
        for (int j = 0; j < n_phi && query; j++) {
            const double phi = DIF_TWO_PI * (j + 0.5) / n_phi;
            query[n + (size_t)j] =
                (dif_query){.wi = wi, .wo = dif_vec3_from_angles_rad(theta, phi), .lambda_um = lambda_um};
            weight[n + (size_t)j] = 0.25 * DIF_PI * w * DIF_TWO_PI / n_phi * cos(theta) * sin(theta);
        }
        n += (size_t)n_phi;
    }
    return n;
}

dif_status dif_energy_albedo(const dif_field *field, dif_vec3 wi, double lambda_um, double tol,
                             const dif_measure_opts *opts, double *albedo, dif_error *err)
{
    *albedo = 0.0;
    if (!(wi.z > 0.0))
        return dif_fail(err, DIF_ERR_ARG, "incident direction with cosine %g, want a cosine > 0", wi.z);
    if (!(lambda_um > 0.0 && isfinite(lambda_um)))
        return dif_fail(err, DIF_ERR_ARG, "wavelength %.9g nm, want a finite number > 0", dif_nm_from_um(lambda_um));
    const dif_measure_opts used = opts ? *opts : dif_measure_opts_default();
    hemisphere rule;
    dif_status status = plan_hemisphere(field, lambda_um, &used, &rule, err);
    if (status)
        return status;
    const size_t n = fill_hemisphere(&rule, wi, lambda_um, NULL, NULL);
    dif_query *query = dif_alloc(n, sizeof *query);
    double *weight = dif_alloc(n, sizeof *weight);
    dif_sample *sample = dif_alloc(n, sizeof *sample);
    if (!query || !weight || !sample) {
        status = dif_fail(err, DIF_ERR_NOMEM, "energy integral over %zu directions", n);
        goto cleanup;
    }
    fill_hemisphere(&rule, wi, lambda_um, query, weight);
    dif_measure_stats stats;
    status = dif_measure_queries(field, n, query, tol, &used, sample, &stats, err);
    if (status)
        goto cleanup;
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += weight[i] * sample[i].brdf_per_sr;
    *albedo = sum;
cleanup:
    dif_release(query);
    dif_release(weight);
    dif_release(sample);
    return status;
}

double dif_energy_order_sum(const dif_grating *grating, dif_vec3 wi, double lambda_um)
{
    int m_min, m_max;
    if (!dif_grating_order_range(wi, grating->period_um, grating->psi_rad, lambda_um, &m_min, &m_max))
        return 0.0;
    double sum = 0.0;
    for (int m = m_min; m <= m_max; m++)
        sum += dif_grating_efficiency(grating, wi, lambda_um, 1.0, m);
    return sum;
}
