/* gmtime_r */
#define _POSIX_C_SOURCE 200809L

#include "core/io/manifest.h"

#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "core/alloc.h"
#include "core/io/sha256.h"
#include "core/io/source.h"

#ifndef DIF_VERSION
#error "DIF_VERSION must come from the build"
#endif

enum { CHUNK = 1 << 16, TEXT_SIZE = 1024 };

/* core/conventions.h in short, for readers of the outputs */
static const char *const CONVENTIONS[][2] = {
    {"frame", "right-handed, x right, y up, z to the viewer, row 0 at the top, pixel pitch = size / samples"},
    {"directions", "wi, wo unit, both away from the surface; -theta means azimuth + 180 deg"},
    {"signs",
     "amplitude sum exp(+i k (u x + v y + w h)), (u, v, w) = -(wi + wo); sin theta_i + sin theta_m = m lambda / d"},
    {"units", "heights and pitches um, wavelengths nm, angles deg, unless a name says otherwise"},
};

/* Length of the UTF-8 sequence at text (1 to 4), 0 if it is not one. */
static size_t utf8_length(const char *text)
{
    const unsigned char lead = (unsigned char)text[0];
    const size_t n = lead < 0x80 ? 1 : lead >= 0xc2 && lead < 0xe0 ? 2 : lead >= 0xe0 && lead < 0xf0 ? 3 : 4;
    if (lead >= 0xf5 || (lead >= 0x80 && lead < 0xc2))
        return 0;
    for (size_t i = 1; i < n; i++) {
        if (((unsigned char)text[i] & 0xc0u) != 0x80u)
            return 0;
    }
    const unsigned char next = n > 1 ? (unsigned char)text[1] : 0x80;
    const bool is_overlong = (lead == 0xe0 && next < 0xa0) || (lead == 0xf0 && next < 0x90);
    const bool is_outside = (lead == 0xed && next >= 0xa0) || (lead == 0xf4 && next >= 0x90);
    return is_overlong || is_outside ? 0 : n;
}

/* A copy that is UTF-8 without control characters: those become blanks, broken bytes '?'. */
static char *clean_copy(const char *text)
{
    char *copy = dif_alloc(strlen(text) + 1, 1);
    if (!copy)
        return NULL;
    for (size_t i = 0; text[i];) {
        const size_t n = utf8_length(text + i);
        if (n == 0)
            copy[i] = '?';
        else if (n == 1)
            copy[i] = (unsigned char)text[i] < 0x20u || text[i] == 0x7f ? ' ' : text[i];
        else
            memcpy(copy + i, text + i, n);
        i += n ? n : 1;
    }
    return copy;
}

static dif_manifest_item *find(const dif_manifest *manifest, const char *key)
{
    for (int i = 0; i < manifest->n; i++) {
        if (strcmp(manifest->item[i].key, key) == 0)
            return &manifest->item[i];
    }
    return NULL;
}

/* Room for one more item: the list is copied into one of twice the size when n is a power of two. */
static bool reserve(dif_manifest *manifest)
{
    const size_t n = (size_t)manifest->n;
    if (n != 0 && (n & (n - 1)) != 0)
        return true;
    dif_manifest_item *item = dif_alloc(n ? 2 * n : 1, sizeof *item);
    if (!item)
        return false;
    if (n)
        memcpy(item, manifest->item, n * sizeof *item);
    dif_release(manifest->item);
    manifest->item = item;
    return true;
}

dif_status dif_manifest_set(dif_manifest *manifest, const char *key, const char *value, dif_error *err)
{
    dif_manifest_item *old = find(manifest, key);
    char *new_key = old ? NULL : clean_copy(key);
    char *new_value = clean_copy(value);
    if (!new_value || (!old && (!new_key || !reserve(manifest)))) {
        dif_release(new_key);
        dif_release(new_value);
        return dif_fail(err, DIF_ERR_NOMEM, "manifest of %d items", manifest->n);
    }
    if (old) {
        dif_release(old->value);
        old->value = new_value;
    } else {
        manifest->item[manifest->n++] = (dif_manifest_item){.key = new_key, .value = new_value};
    }
    return DIF_OK;
}

dif_status dif_manifest_setf(dif_manifest *manifest, dif_error *err, const char *key, const char *format, ...)
{
    char text[TEXT_SIZE];
    va_list args;
    va_start(args, format);
    const int n = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (n < 0 || n >= (int)sizeof text)
        return dif_fail(err, DIF_ERR_ARG, "manifest value of %s is longer than %d bytes", key, TEXT_SIZE - 1);
    return dif_manifest_set(manifest, key, text, err);
}

const char *dif_manifest_get(const dif_manifest *manifest, const char *key)
{
    const dif_manifest_item *item = find(manifest, key);
    return item ? item->value : NULL;
}

void dif_manifest_free(dif_manifest *manifest)
{
    if (!manifest)
        return;
    for (int i = 0; i < manifest->n; i++) {
        dif_release(manifest->item[i].key);
        dif_release(manifest->item[i].value);
    }
    dif_release(manifest->item);
    *manifest = (dif_manifest){0};
}

static bool is_plain_word(const char *word)
{
    return *word &&
           word[strspn(word, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_+-./:,=@%")] == '\0';
}

/* Adds a word to a command line as a shell would take it back; with text NULL only counts. */
static size_t put_word(const char *word, char *text)
{
    size_t n = 0;
    const bool plain = is_plain_word(word);
#define PUT(c) (text ? (void)(text[n] = (c)) : (void)0, n++)
    if (!plain)
        PUT('\'');
    for (; *word; word++) {
        if (*word == '\'') {
            PUT('\'');
            PUT('\\');
            PUT('\'');
        }
        PUT(*word);
    }
    if (!plain)
        PUT('\'');
#undef PUT
    return n;
}

static dif_status set_command(dif_manifest *manifest, int argc, char *const *argv, dif_error *err)
{
    size_t n = 1;
    for (int i = 0; i < argc; i++)
        n += put_word(argv[i], NULL) + 1;
    char *text = dif_alloc(n, 1);
    if (!text)
        return dif_fail(err, DIF_ERR_NOMEM, "command line of %zu bytes", n);
    size_t at = 0;
    for (int i = 0; i < argc; i++) {
        if (i > 0)
            text[at++] = ' ';
        at += put_word(argv[i], text + at);
    }
    const dif_status status = dif_manifest_set(manifest, "command", text, err);
    dif_release(text);
    return status;
}

/* Now, or the time of SOURCE_DATE_EPOCH. */
static dif_status set_created(dif_manifest *manifest, dif_error *err)
{
    time_t when = time(NULL);
    const char *epoch = getenv("SOURCE_DATE_EPOCH");
    if (epoch && *epoch) {
        char *end = NULL;
        errno = 0;
        const long long seconds = strtoll(epoch, &end, 10);
        /* 253402300799 is the last second of the year 9999 */
        if (*end || errno || seconds < 0 || seconds > 253402300799)
            return dif_fail(err, DIF_ERR_ARG, "SOURCE_DATE_EPOCH is '%.40s', want seconds since 1970", epoch);
        when = (time_t)seconds;
    }
    struct tm utc;
    char text[32];
    if (!gmtime_r(&when, &utc) || strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0)
        return dif_fail(err, DIF_ERR_ARG, "the clock shows no valid time");
    return dif_manifest_set(manifest, "created", text, err);
}

dif_status dif_manifest_begin(dif_manifest *manifest, int argc, char *const *argv, dif_error *err)
{
    dif_status status = dif_manifest_set(manifest, "program", "diffbench", err);
    if (!status)
        status = dif_manifest_set(manifest, "version", DIF_VERSION, err);
    if (!status)
        status = set_command(manifest, argc, argv, err);
    if (!status)
        status = set_created(manifest, err);
    for (size_t i = 0; !status && i < sizeof CONVENTIONS / sizeof *CONVENTIONS; i++)
        status = dif_manifest_set(manifest, CONVENTIONS[i][0], CONVENTIONS[i][1], err);
    return status;
}

/* Sum and size of a file, read in pieces. */
static dif_status sum_file(const char *path, char hex[65], unsigned long long *n_byte, dif_error *err)
{
    char name[DIF_NAME_SIZE];
    dif_name_short(path, name);
    struct stat about;
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return dif_fail(err, DIF_ERR_IO, "%s: cannot open to take its sum", name);
    dif_status status = DIF_OK;
    unsigned char *chunk = NULL;
    if (fstat(fileno(stream), &about) != 0 || S_ISDIR(about.st_mode)) {
        status = dif_fail(err, DIF_ERR_IO, "%s: is a directory, want a file", name);
        goto cleanup;
    }
    chunk = dif_alloc(CHUNK, 1);
    if (!chunk) {
        status = dif_fail(err, DIF_ERR_NOMEM, "%s: %d bytes to read it", name, CHUNK);
        goto cleanup;
    }
    dif_sha256 sha = dif_sha256_begin();
    for (size_t n = 1; n > 0;) {
        n = fread(chunk, 1, CHUNK, stream);
        dif_sha256_add(&sha, chunk, n);
    }
    if (ferror(stream))
        status = dif_fail(err, DIF_ERR_IO, "%s: cannot read to take its sum", name);
    *n_byte = (unsigned long long)sha.n_byte;
    dif_sha256_end(&sha, hex);
cleanup:
    dif_release(chunk);
    fclose(stream);
    return status;
}

dif_status dif_manifest_add_input(dif_manifest *manifest, const char *path, dif_error *err)
{
    char hex[65], tail[16] = "", key[48];
    unsigned long long n_byte = 0;
    dif_status status = sum_file(path, hex, &n_byte, err);
    if (status)
        return status;
    /* further inputs are input_2, input_3, ... */
    int i = 1;
    for (snprintf(key, sizeof key, "input"); find(manifest, key); snprintf(key, sizeof key, "input%s", tail))
        snprintf(tail, sizeof tail, "_%d", ++i);
    status = dif_manifest_set(manifest, key, path, err);
    snprintf(key, sizeof key, "input%s_sha256", tail);
    if (!status)
        status = dif_manifest_set(manifest, key, hex, err);
    snprintf(key, sizeof key, "input%s_bytes", tail);
    if (!status)
        status = dif_manifest_setf(manifest, err, key, "%llu", n_byte);
    return status;
}
