#include "core/io/zip.h"

#include <string.h>
#include <zip.h>

#include "core/alloc.h"

enum { DEFLATE_RATIO = 1032, ENTRIES_MAX = 1 << 16 };

struct dif_zip {
    const dif_source *source;
    zip_t *handle;
    long long n_file;
};

bool dif_zip_is(const dif_source *source)
{
    return dif_source_has(source, 0, "PK\x03\x04", 4);
}

static dif_status fail_library(const dif_source *source, const char *what, zip_error_t *reason, dif_error *err)
{
    const bool no_memory = zip_error_code_zip(reason) == ZIP_ER_MEMORY;
    return dif_fail(err, no_memory ? DIF_ERR_NOMEM : DIF_ERR_FORMAT, "%s: %.60s: %.60s", source->name, what,
                    zip_error_strerror(reason));
}

dif_status dif_zip_open(const dif_source *source, dif_zip **out, dif_error *err)
{
    zip_error_t reason;
    dif_zip *zip = dif_alloc(1, sizeof *zip);
    *out = NULL;
    if (!zip)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: opening a zip archive", source->name);
    dif_status status = DIF_OK;
    zip_error_init(&reason);
    zip_source_t *bytes = zip_source_buffer_create(source->data, source->n, 0, &reason);
    zip->source = source;
    zip->handle = bytes ? zip_open_from_source(bytes, ZIP_RDONLY, &reason) : NULL;
    if (!zip->handle) {
        status = fail_library(source, "damaged zip archive (truncated?)", &reason, err);
        zip_source_free(bytes);
    } else if ((zip->n_file = zip_get_num_entries(zip->handle, 0)) > ENTRIES_MAX) {
        status = dif_fail(err, DIF_ERR_SIZE, "%s: more than %d files in a zip archive", source->name, (int)ENTRIES_MAX);
    }
    zip_error_fini(&reason);
    if (status) {
        dif_zip_close(zip);
        return status;
    }
    *out = zip;
    return DIF_OK;
}

void dif_zip_close(dif_zip *zip)
{
    if (!zip)
        return;
    if (zip->handle)
        zip_discard(zip->handle); /* the archive's bytes are not ours to change */
    dif_release(zip);
}

const char *dif_zip_path(const dif_zip *zip, long long index)
{
    const char *path = zip_get_name(zip->handle, (zip_uint64_t)index, ZIP_FL_ENC_RAW);
    return path ? path : "";
}

/* A letter as paths are compared. */
static char plain(char c)
{
    return c == '\\' ? '/' : (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
}

static bool is_same(const char *a, const char *b, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (plain(a[i]) != plain(b[i]))
            return false;
    }
    return true;
}

long long dif_zip_find(const dif_zip *zip, const char *folder, size_t n_folder, const char *path)
{
    while (*path == '/' || *path == '\\' || (path[0] == '.' && (path[1] == '/' || path[1] == '\\')))
        path++;
    const size_t n_path = strlen(path);
    for (long long i = 0; i < zip->n_file; i++) {
        const char *found = dif_zip_path(zip, i);
        if (strlen(found) == n_folder + n_path && is_same(found, folder, n_folder) &&
            is_same(found + n_folder, path, n_path))
            return i;
    }
    return -1;
}

long long dif_zip_find_name(const dif_zip *zip, const char *name, size_t *n_folder)
{
    const size_t n_name = strlen(name);
    long long best = -1;
    for (long long i = 0; i < zip->n_file; i++) {
        const char *path = dif_zip_path(zip, i);
        const size_t n = strlen(path);
        if (n < n_name || !is_same(path + n - n_name, name, n_name) ||
            (n > n_name && plain(path[n - n_name - 1]) != '/'))
            continue;
        if (best < 0 || n - n_name < *n_folder) {
            best = i;
            *n_folder = n - n_name;
        }
    }
    return best;
}

dif_status dif_zip_size(const dif_zip *zip, long long index, unsigned long long *n, dif_error *err)
{
    const zip_uint64_t want = ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
    const char *name = zip->source->name;
    zip_stat_t about;
    char quote[DIF_QUOTE_SIZE];
    const char *path = dif_zip_path(zip, index);
    dif_quote(path, strlen(path), quote);
    if (zip_stat_index(zip->handle, (zip_uint64_t)index, 0, &about) != 0 || (about.valid & want) != want)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: the zip archive says too little of %s", name, quote);
    if (about.encryption_method != ZIP_EM_NONE)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: %s is encrypted", name, quote);
    if (about.comp_method != ZIP_CM_STORE && about.comp_method != ZIP_CM_DEFLATE)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: %s is packed by method %d, want stored or deflate", name, quote,
                        (int)about.comp_method);
    const zip_uint64_t ratio = about.comp_method == ZIP_CM_STORE ? 1 : DEFLATE_RATIO;
    if (about.comp_size > zip->source->n || about.size > ratio * about.comp_size)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %s cannot unpack from %llu to %llu bytes (damaged?)", name, quote,
                        (unsigned long long)about.comp_size, (unsigned long long)about.size);
    *n = about.size;
    return DIF_OK;
}

/* Fills a piece as far as the file goes; -1 on failure. */
static zip_int64_t fill(zip_file_t *file, unsigned char piece[DIF_ZIP_CHUNK])
{
    zip_int64_t n = 0;
    while (n < DIF_ZIP_CHUNK) {
        const zip_int64_t n_more = zip_fread(file, piece + n, (zip_uint64_t)(DIF_ZIP_CHUNK - n));
        if (n_more < 0)
            return -1;
        if (n_more == 0)
            break;
        n += n_more;
    }
    return n;
}

dif_status dif_zip_read(dif_zip *zip, long long index, dif_zip_sink *sink, void *self, dif_error *err)
{
    unsigned char piece[DIF_ZIP_CHUNK];
    unsigned long long n_want = 0, n_have = 0;
    dif_status status = dif_zip_size(zip, index, &n_want, err);
    if (status)
        return status;
    zip_file_t *file = zip_fopen_index(zip->handle, (zip_uint64_t)index, 0);
    if (!file)
        return fail_library(zip->source, dif_zip_path(zip, index), zip_get_error(zip->handle), err);
    for (;;) {
        const zip_int64_t n = fill(file, piece);
        if (n < 0)
            status = fail_library(zip->source, dif_zip_path(zip, index), zip_file_get_error(file), err);
        else if ((n_have += (unsigned long long)n) > n_want || (n < DIF_ZIP_CHUNK && n_have != n_want))
            status = dif_fail(err, DIF_ERR_FORMAT, "%s: a file of the zip archive has not the %llu bytes it claims",
                              zip->source->name, n_want);
        else if (n > 0)
            status = sink(self, piece, (size_t)n, err);
        if (status || n < DIF_ZIP_CHUNK)
            break;
    }
    zip_fclose(file);
    return status;
}
