/* Lists of points x y z that form a regular grid. Internal to core/io. */
#ifndef DIF_TEXT_XYZ_H
#define DIF_TEXT_XYZ_H

#include "core/io/field_raw.h"

/* Given     point[n][3]  x, y, z in any order
 * Gives     *raw with step_x, step_y in the list's numbers; the largest y is the top row, because y points up
 *           (core/conventions.h)
 * Status    DIF_ERR_FORMAT if the points are no full grid to 1e-3 of its steps, DIF_ERR_SIZE, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_text_xyz_read(const dif_source *source, const double *point, size_t n, dif_raw *raw,
                                          dif_error *err);

#endif
