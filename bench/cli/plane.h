/* The plane of incidence that a user did not name, and the spatial frequencies that a fit should see.
 * Does not: measure. */
#ifndef DIF_PLANE_H
#define DIF_PLANE_H

#include "bench/fit.h"

typedef struct dif_cli_plane {
    double azimuth_deg;
    double f_min_per_um, f_max_per_um; /* of |f|: below it lies the mirror beam; f_max may be infinite */
    bool has_structure;
    dif_spectrum_peak structure; /* that the plane was chosen by */
} dif_cli_plane;

/* The plane crosses the strongest structure unless azimuth_deg is a number; spatial frequencies below half of that
 * structure's, as the plane sees it, are left to the mirror beam; of a grating, orders 1 to 3 are kept.
 *
 * Given     known  the structure, or NULL: found in the power spectrum
 * Status    that of dif_fit_spectrum_peaks */
DIF_MUST_USE dif_status dif_cli_plane_choose(const dif_field *field, const dif_spectrum_peak *known, bool is_grating,
                                             double sigma_um, double azimuth_deg, dif_cli_plane *out, dif_error *err);

#endif
