/* gzip archives (RFC 1952) in memory, through zlib. Internal to core/io. */
#ifndef DIF_GZIP_H
#define DIF_GZIP_H

#include "core/io/source.h"

enum { DIF_GZIP_OUT_MAX = 1 << 30 }; /* bytes that an archive may hold: 1 GiB */

bool dif_gzip_is(const dif_source *source);

/* Unpacks all members of an archive into *data[*n], freed with dif_release. Memory grows with what really comes out, to
 * at most n_max and half of that while it grows.
 * Given     n_max  bytes that the archive may hold, 1 ... DIF_GZIP_OUT_MAX
 * Status    DIF_ERR_FORMAT (damaged, truncated), DIF_ERR_SIZE (more than n_max), DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_gzip_unpack(const dif_source *source, size_t n_max, unsigned char **data, size_t *n,
                                        dif_error *err);

/* If *source is an archive, it becomes what the archive holds, under the same name. The caller gives *owned (NULL if it is
 * none) to dif_release after use. Status as dif_gzip_unpack with DIF_GZIP_OUT_MAX. */
DIF_MUST_USE dif_status dif_gzip_open(dif_source *source, unsigned char **owned, dif_error *err);

#endif
