#include "core/nmm.h"

#include <math.h>
#include <stddef.h>

#include "core/spectrum.h"

dif_status dif_nmm_check(const dif_nmm *nmm, dif_error *err)
{
    if (!(nmm->extent_um > 0.0 && nmm->extent_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "an extent of %g um, want > 0", nmm->extent_um);
    if (!(nmm->lambda_min_um > 0.0 && nmm->lambda_min_um < nmm->lambda_max_um && nmm->lambda_max_um < 1e6))
        return dif_fail(err, DIF_ERR_ARG, "wavelengths %g ... %g um, want 0 < min < max", nmm->lambda_min_um,
                        nmm->lambda_max_um);
    if (!(nmm->n_fixed >= 1 && nmm->n_fixed <= DIF_NMM_FIXED_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d fixed wavelengths, want 1 ... %d", nmm->n_fixed, DIF_NMM_FIXED_MAX);
    if (!(nmm->line_area_per_um >= 0.0 && nmm->line_area_per_um < 1e9))
        return dif_fail(err, DIF_ERR_ARG, "a line of area %g per um, want >= 0", nmm->line_area_per_um);
    if (!(2.0 * nmm->extent_um / nmm->lambda_min_um < 1e7))
        return dif_fail(err, DIF_ERR_SIZE, "an extent of %g um has more than 1e7 bins", nmm->extent_um);
    return DIF_OK;
}

int dif_nmm_count_max(const dif_nmm *nmm)
{
    const double bins = 2.0 * nmm->extent_um * (1.0 / nmm->lambda_min_um - 1.0 / nmm->lambda_max_um) + 2.0;
    return (int)fmax(bins, nmm->n_fixed);
}

int dif_nmm_bins(const dif_nmm *nmm, double s, int *first)
{
    const double reach = nmm->extent_um * s;
    *first = (int)fmax(ceil(reach / nmm->lambda_max_um * (1.0 - 1e-12)), 1.0);
    const int last = (int)floor(reach / nmm->lambda_min_um * (1.0 + 1e-12));
    const int n = last - *first + 1, least = nmm->line_area_per_um > 0.0 ? 1 : nmm->n_fixed;
    return n >= least ? n : 0;
}

static double fixed_um(const dif_nmm *nmm, int i)
{
    return nmm->lambda_min_um + (nmm->lambda_max_um - nmm->lambda_min_um) * (i + 0.5) / nmm->n_fixed;
}

/* dif_nmm_wavelengths with the weights `stride` apart. */
static int sample(const dif_nmm *nmm, double s, double *lambda_um, double *weight_um, int stride)
{
    const double range_um = nmm->lambda_max_um - nmm->lambda_min_um;
    int first;
    const int n = dif_nmm_bins(nmm, s, &first);
    for (int i = 0; i < n; i++) {
        lambda_um[i] = nmm->extent_um * s / (first + i);
        const double step = nmm->line_area_per_um > 0.0 ? nmm->line_area_per_um : 1.0 / nmm->extent_um;
        weight_um[(size_t)i * (size_t)stride] = nmm->jacobian ? lambda_um[i] * lambda_um[i] * step / s : range_um / n;
    }
    if (n > 0)
        return n;
    for (int i = 0; i < nmm->n_fixed; i++) {
        lambda_um[i] = fixed_um(nmm, i);
        weight_um[(size_t)i * (size_t)stride] = range_um / nmm->n_fixed;
    }
    return nmm->n_fixed;
}

int dif_nmm_wavelengths(const dif_nmm *nmm, double s, double *lambda_um, double *weight_um)
{
    return sample(nmm, s, lambda_um, weight_um, 1);
}

double dif_nmm_nearest_um(const dif_nmm *nmm, double s, double lambda_um)
{
    int first;
    const int n = dif_nmm_bins(nmm, s, &first);
    if (n > 0) {
        const double bin = rint(nmm->extent_um * s / lambda_um);
        return nmm->extent_um * s / fmin(fmax(bin, first), first + n - 1.0);
    }
    const double share = (lambda_um - nmm->lambda_min_um) / (nmm->lambda_max_um - nmm->lambda_min_um);
    return fixed_um(nmm, (int)fmin(fmax(floor(share * nmm->n_fixed), 0.0), nmm->n_fixed - 1.0));
}

/* D65 times the observer, unscaled. */
static void raw_density(double lambda_um, double out[3])
{
    const double light = dif_spectrum_d65(lambda_um);
    dif_spectrum_observer(lambda_um, out);
    for (int c = 0; c < 3; c++)
        out[c] *= light;
}

dif_status dif_nmm_scale(double scale[3], dif_error *err)
{
    enum { N = 401, AT = 170 }; /* 380 ... 780 nm in 1 nm; 550 nm, where every channel has weight */
    double lambda_um[N], weight[N][3], raw[3];
    for (int i = 0; i < N; i++)
        lambda_um[i] = 0.38 + 0.001 * i;
    const dif_status status = dif_spectrum_weights(N, lambda_um, weight, err);
    raw_density(lambda_um[AT], raw);
    for (int c = 0; c < 3; c++)
        scale[c] = status == DIF_OK ? weight[AT][c] / (0.001 * raw[c]) : 0.0;
    return status;
}

int dif_nmm_weights(const dif_nmm *nmm, const double scale[3], double s, double *lambda_um, double (*xyz_weight)[3])
{
    double sum[3] = {0.0, 0.0, 0.0}, white[3];
    int first;
    const bool fixed = dif_nmm_bins(nmm, s, &first) == 0;
    const int n = sample(nmm, s, lambda_um, &xyz_weight[0][0], 3);
    for (int i = 0; i < n; i++) {
        const double step_um = xyz_weight[i][0];
        raw_density(lambda_um[i], xyz_weight[i]);
        for (int c = 0; c < 3; c++) {
            xyz_weight[i][c] *= scale[c] * step_um;
            sum[c] += xyz_weight[i][c];
        }
    }
    dif_spectrum_white(white);
    for (int i = 0; i < n && fixed; i++)
        for (int c = 0; c < 3; c++)
            xyz_weight[i][c] *= sum[c] > 0.0 ? white[c] / sum[c] : 1.0;
    return n;
}
