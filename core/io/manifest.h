/* Provenance: an ordered list of key = value texts that travels with every output, and sha256.
 * Does not: know what the keys mean. */
#ifndef DIF_MANIFEST_H
#define DIF_MANIFEST_H

#include <stddef.h>
#include <stdint.h>

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dif_manifest_item {
    char *key, *value; /* owned, UTF-8, no line ends */
} dif_manifest_item;

typedef struct dif_manifest {
    int n;
    dif_manifest_item *item; /* owned */
} dif_manifest;

/* A zeroed struct is an empty manifest. Setting a key again replaces its value; line ends become blanks. */
DIF_MUST_USE dif_status dif_manifest_set(dif_manifest *manifest, const char *key, const char *value, dif_error *err);
DIF_MUST_USE dif_status dif_manifest_setf(dif_manifest *manifest, dif_error *err, const char *key, const char *format,
                                          ...) DIF_PRINTF(4, 5);

/* Value of a key, or NULL. */
const char *dif_manifest_get(const dif_manifest *manifest, const char *key);
void dif_manifest_free(dif_manifest *manifest);

/* What every output says of itself: program, version, command line, conventions, created (SOURCE_DATE_EPOCH if set). */
DIF_MUST_USE dif_status dif_manifest_begin(dif_manifest *manifest, int argc, char *const *argv, dif_error *err);

/* Adds `input`, its sha256 and size. */
DIF_MUST_USE dif_status dif_manifest_add_input(dif_manifest *manifest, const char *path, dif_error *err);

/* sha256 of a block as 64 hex digits and a NUL. */
void dif_sha256_hex(const void *data, size_t n, char hex[65]);

#ifdef __cplusplus
}
#endif
#endif
