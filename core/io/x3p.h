/* Surfaces as x3p (ISO 25178-72). Internal to core/io. Does not: read profiles or clouds of points. */
#ifndef DIF_X3P_H
#define DIF_X3P_H

#include "core/io/field_raw.h"

bool dif_x3p_is(const dif_source *source);

/* The layers of the matrix: one unless SizeZ says more. Status as dif_x3p_read. */
DIF_MUST_USE dif_status dif_x3p_list(const dif_source *source, dif_channels *out, dif_error *err);

/* Reads a layer; points that are not valid are NaN, wrong MD5 sums a warning. Memory is asked for only after the sizes in
 * the archive fit SizeX SizeY SizeZ and the archive's own length.
 * Status DIF_ERR_FORMAT, DIF_ERR_SIZE, DIF_ERR_UNSUPPORTED (profiles, points, encryption), DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_x3p_read(const dif_source *source, int index, dif_raw *raw, dif_error *err);

#endif
