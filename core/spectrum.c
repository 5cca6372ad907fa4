#include "core/spectrum.h"

#include <math.h>

#include "core/cie_data.h"

static const double FIRST_NM = 380.0, LAST_NM = 780.0;

/* Place of a wavelength in a table of the given step: index and share of the next entry; -1 outside. */
static int place(double lambda_um, double step_nm, int n, double *share)
{
    /* a picometre of room, so that 380 nm written in micrometres is inside */
    const double nm = lambda_um * 1e3, room = 1e-6;
    if (!(nm >= FIRST_NM - room && nm <= LAST_NM + room))
        return -1;
    const double at = fmin(fmax((nm - FIRST_NM) / step_nm, 0.0), n - 1.0);
    const int index = at >= n - 1.0 ? n - 2 : (int)at;
    *share = at - index;
    return index;
}

void dif_spectrum_observer(double lambda_um, double xyz_bar[3])
{
    double share;
    const int i = place(lambda_um, 1.0, DIF_CIE_N_OBSERVER, &share);
    for (int c = 0; c < 3; c++)
        xyz_bar[c] = i < 0 ? 0.0 : (1.0 - share) * dif_cie_observer[i][c] + share * dif_cie_observer[i + 1][c];
}

double dif_spectrum_d65(double lambda_um)
{
    double share;
    const int i = place(lambda_um, 5.0, DIF_CIE_N_D65, &share);
    return i < 0 ? 0.0 : (1.0 - share) * dif_cie_d65[i] + share * dif_cie_d65[i + 1];
}

/* The trapezoid's share of wavelength i. */
static double step_at(int n, const double *lambda_um, int i)
{
    if (n == 1)
        return 1.0;
    const double before = i > 0 ? lambda_um[i] - lambda_um[i - 1] : 0.0;
    const double after = i < n - 1 ? lambda_um[i + 1] - lambda_um[i] : 0.0;
    return 0.5 * (before + after);
}

/* Unscaled weights and their sums. */
static void raw_weights(int n, const double *lambda_um, double (*weight)[3], double sum[3])
{
    sum[0] = sum[1] = sum[2] = 0.0;
    for (int i = 0; i < n; i++) {
        const double light = dif_spectrum_d65(lambda_um[i]) * step_at(n, lambda_um, i);
        double bar[3];
        dif_spectrum_observer(lambda_um[i], bar);
        for (int c = 0; c < 3; c++) {
            weight[i][c] = light * bar[c];
            sum[c] += weight[i][c];
        }
    }
}

void dif_spectrum_white(double xyz[3])
{
    /* ASTM E308; the 1 nm sum of the full tables gives 0.950468, 1, 1.088828 */
    xyz[0] = 0.95047;
    xyz[1] = 1.0;
    xyz[2] = 1.08883;
}

dif_status dif_spectrum_weights(int n, const double *lambda_um, double (*weight)[3], dif_error *err)
{
    double white[3], sum[3];
    for (int i = 1; i < n; i++)
        if (!(lambda_um[i] > lambda_um[i - 1]))
            return dif_fail(err, DIF_ERR_ARG, "wavelengths must ascend: %g um follows %g um", lambda_um[i],
                            lambda_um[i - 1]);
    raw_weights(n, lambda_um, weight, sum);
    if (!(sum[1] > 0.0))
        return dif_fail(err, DIF_ERR_ARG, "no wavelength inside 380 ... 780 nm: nothing to see");
    dif_spectrum_white(white);
    for (int i = 0; i < n; i++)
        for (int c = 0; c < 3; c++)
            weight[i][c] *= n == 1 || !(sum[c] > 0.0) ? 1.0 / sum[1] : white[c] / sum[c];
    return DIF_OK;
}
