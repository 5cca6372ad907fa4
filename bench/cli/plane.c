#include "bench/cli/plane.h"

#include <math.h>

#include "core/units.h"

dif_status dif_cli_plane_choose(const dif_field *field, const dif_spectrum_peak *known, bool is_grating,
                                double sigma_um, double azimuth_deg, dif_cli_plane *out, dif_error *err)
{
    int n = 1;
    *out = (dif_cli_plane){.azimuth_deg = azimuth_deg, .f_max_per_um = (double)INFINITY};
    if (known)
        out->structure = *known;
    const dif_status status = known ? DIF_OK : dif_fit_spectrum_peaks(field, 1, &out->structure, &n, err);
    if (status != DIF_OK)
        return status;
    out->has_structure = n > 0;
    if (isnan(azimuth_deg))
        out->azimuth_deg = n > 0 ? dif_deg_from_rad(out->structure.psi_rad) : 0.0;
    /* eight rms widths of the line of the window, where there is no structure to go by */
    out->f_min_per_um = 8.0 / (2.0 * sqrt(2.0) * DIF_PI * sigma_um);
    if (n == 0)
        return DIF_OK;
    const double across_rad = out->structure.psi_rad - dif_rad_from_deg(out->azimuth_deg);
    const double f_per_um = fabs(cos(across_rad)) / out->structure.period_um;
    out->f_min_per_um = fmax(out->f_min_per_um, 0.5 * f_per_um);
    if (is_grating)
        out->f_max_per_um = fmax(3.5 * f_per_um, 2.0 * out->f_min_per_um);
    return DIF_OK;
}
