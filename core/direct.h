/* The direct sum in double precision: the slow truth that everything else is held against.
 * Does not: approximate. Threaded over pixels or queries; sines and cosines come from libm. */
#ifndef DIF_DIRECT_H
#define DIF_DIRECT_H

#include <stddef.h>

#include "core/field.h"
#include "core/vec.h"
#include "core/window.h"

#ifdef __cplusplus
extern "C" {
#endif

/* P / sum W at n points kappa[n] in rad/um; core/conventions.h.
 *
 * Status    DIF_ERR_NOMEM
 * Cost      O(n nx ny) */
DIF_MUST_USE dif_status dif_direct_amplitudes(const dif_field *field, const dif_window *window, size_t n,
                                              const dif_vec3 *kappa, double (*amp)[2], dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
