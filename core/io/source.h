/* The bytes being parsed with a name for messages, and how messages about them are put together.
 * Internal to core/io. Does not: open files. */
#ifndef DIF_SOURCE_H
#define DIF_SOURCE_H

#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

enum { DIF_NAME_SIZE = 100, DIF_QUOTE_SIZE = 28 };

typedef struct dif_source {
    const unsigned char *data; /* data[n], not owned, not NUL-terminated */
    size_t n;
    char name[DIF_NAME_SIZE]; /* for messages: a path, its beginning left out if it is long */
} dif_source;

dif_source dif_source_of(const unsigned char *data, size_t n, const char *name);

/* True if the bytes at offset `at` are the n bytes of magic. */
bool dif_source_has(const dif_source *source, size_t at, const void *magic, size_t n);

/* Copies a path for a message: the end is what tells files apart, so a long one loses its beginning. */
void dif_name_short(const char *name, char out[DIF_NAME_SIZE]);

/* Copies text from a file for a message: at most DIF_QUOTE_SIZE - 1 bytes, control characters as '?'. */
void dif_quote(const char *text, size_t n, char out[DIF_QUOTE_SIZE]);

/* Puts "name: " before the text of *err (if not NULL) and returns the status. */
dif_status dif_fail_named(dif_error *err, const char *name, dif_status status);
#ifdef __clang_analyzer__ /* as for dif_fail */
#define dif_fail_named(err, name, status) ((void)(dif_fail_named)(err, name, status), (status))
#endif

/* DIF_ERR_IO with "name: what: reason", the reason being that of an errno. */
dif_status dif_fail_errno(dif_error *err, const char *name, const char *what, int number);
#ifdef __clang_analyzer__
#define dif_fail_errno(err, name, what, number) ((void)(dif_fail_errno)(err, name, what, number), DIF_ERR_IO)
#endif

/* UTF-8 text of a source: skips a UTF-8 byte order mark, transcodes UTF-16 (byte order mark required) into a new
 * block. *text[*n] stays valid as long as the source and *owned; the caller gives *owned (may be NULL) to dif_release.
 * Status DIF_ERR_FORMAT for broken UTF-16 or NUL bytes, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_source_text(const dif_source *source, const char **text, size_t *n, char **owned,
                                        dif_error *err);

#endif
