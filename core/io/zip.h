/* Files within a zip archive in memory, through libzip. Internal to core/io.
 * Does not: write, decrypt, or unpack more than it is asked for. */
#ifndef DIF_ZIP_H
#define DIF_ZIP_H

#include "core/io/source.h"

enum { DIF_ZIP_CHUNK = 1 << 14 };

typedef struct dif_zip dif_zip; /* an opened archive; owns the library's handle */

bool dif_zip_is(const dif_source *source);

/* Opens an archive in memory, which must outlive *out. Status DIF_ERR_FORMAT, DIF_ERR_NOMEM; *out NULL on failure */
DIF_MUST_USE dif_status dif_zip_open(const dif_source *source, dif_zip **out, dif_error *err);
void dif_zip_close(dif_zip *zip);

/* The number of the file whose path is folder[n_folder] and then path; letters may differ in case, slashes in direction.
 * -1 if there is none. */
long long dif_zip_find(const dif_zip *zip, const char *folder, size_t n_folder, const char *path);

/* The number of the file of this name with the shortest folder, whose length goes to *n_folder; -1 if there is none. */
long long dif_zip_find_name(const dif_zip *zip, const char *name, size_t *n_folder);

/* Path of a file, valid until dif_zip_close. */
const char *dif_zip_path(const dif_zip *zip, long long index);

/* What the archive says that a file unpacks to, in bytes.
 * Status    DIF_ERR_FORMAT (no size, or one that its packed bytes cannot hold: deflate packs to a 1032nd at most),
 *           DIF_ERR_UNSUPPORTED (encrypted, or packed otherwise than by deflate) */
DIF_MUST_USE dif_status dif_zip_size(const dif_zip *zip, long long index, unsigned long long *n, dif_error *err);

/* Takes the next piece: DIF_ZIP_CHUNK bytes but for the last one. */
typedef dif_status dif_zip_sink(void *self, const unsigned char *data, size_t n, dif_error *err);

/* Unpacks a file piece by piece. Its check sum is held against the archive's.
 * Status as dif_zip_size, DIF_ERR_FORMAT (damaged), DIF_ERR_NOMEM, or what the sink returns */
DIF_MUST_USE dif_status dif_zip_read(dif_zip *zip, long long index, dif_zip_sink *sink, void *self, dif_error *err);

#endif
