/* Whole files in and out: bounded reading, atomic writing (temporary file, flush, fsync, rename).
 * Does not: parse. */
#ifndef DIF_FILE_H
#define DIF_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* True if a path ends in an ending such as ".png" and is more than that. */
bool dif_file_ends_in(const char *path, const char *ending);

/* Reads a regular file (or a pipe) whole; data[n] is followed by a NUL. Status DIF_ERR_IO (missing, directory,
 * unreadable), DIF_ERR_SIZE (over n_max), DIF_ERR_NOMEM. The caller frees with dif_release. */
DIF_MUST_USE dif_status dif_file_read(const char *path, size_t n_max, unsigned char **data, size_t *n, dif_error *err);

/* An output being written beside its final place. */
typedef struct dif_outfile {
    FILE *stream;
    char *path, *path_tmp; /* owned; path is what a symbolic link leads to */
} dif_outfile;

/* Opens PATH.tmp.PID for writing. "-" is not special. A PATH that exists and is neither a regular file nor a
 * directory (a device, a pipe) is written directly: it must not be replaced. Status DIF_ERR_IO, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_outfile_open(const char *path, dif_outfile *out, dif_error *err);

/* Writes a block. Status DIF_ERR_IO with the path and the reason (disk full). */
DIF_MUST_USE dif_status dif_outfile_write(dif_outfile *out, const void *data, size_t n, dif_error *err);

/* Flushes, syncs and renames; on any error the old file stays and the temporary one is removed. Frees *out. */
DIF_MUST_USE dif_status dif_outfile_commit(dif_outfile *out, dif_error *err);

/* Drops what was written; accepts a zeroed struct. */
void dif_outfile_abort(dif_outfile *out);

/* For libraries that write by name: the temporary name is out->path_tmp; commit works the same (stream NULL). */
DIF_MUST_USE dif_status dif_outfile_reserve(const char *path, dif_outfile *out, dif_error *err);

/* Writes a whole block atomically. */
DIF_MUST_USE dif_status dif_file_write(const char *path, const void *data, size_t n, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
