/* Directions without a wavelength as CSV: columns theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg by name, others are left
 * out, so that queries (core/io/table_io.h) are directions, too.
 * Does not: measure. */
#ifndef DIF_DIRECTIONS_H
#define DIF_DIRECTIONS_H

#include <stddef.h>

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads degrees[*n_direction][4] in that order, freed with dif_release; missing azimuths are 0.
 * Status    DIF_ERR_FORMAT with the line; |theta| >= 90 likewise; DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_directions_parse(const unsigned char *data, size_t n, const char *name, size_t *n_direction,
                                             double (**degrees)[4], dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
