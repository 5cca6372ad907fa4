/* strerror_r */
#define _POSIX_C_SOURCE 200809L

#include "core/io/source.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"

static bool is_continuation(char byte)
{
    return ((unsigned char)byte & 0xc0u) == 0x80u;
}

void dif_name_short(const char *name, char out[DIF_NAME_SIZE])
{
    const size_t n = strlen(name);
    if (n < DIF_NAME_SIZE) {
        memcpy(out, name, n + 1);
    } else {
        const char *tail = name + n - (DIF_NAME_SIZE - 4);
        while (is_continuation(*tail))
            tail++;
        memcpy(out, "...", 3);
        memcpy(out + 3, tail, strlen(tail) + 1);
    }
    for (char *c = out; *c; c++) {
        if ((unsigned char)*c < 0x20u || *c == 0x7f)
            *c = '?';
    }
}

dif_source dif_source_of(const unsigned char *data, size_t n, const char *name)
{
    dif_source source = {.data = data, .n = n};
    dif_name_short(name, source.name);
    return source;
}

bool dif_source_has(const dif_source *source, size_t at, const void *magic, size_t n)
{
    return source->n >= n && at <= source->n - n && memcmp(source->data + at, magic, n) == 0;
}

void dif_quote(const char *text, size_t n, char out[DIF_QUOTE_SIZE])
{
    size_t n_out = n < DIF_QUOTE_SIZE - 1 ? n : DIF_QUOTE_SIZE - 1;
    while (n_out < n && n_out > 0 && is_continuation(text[n_out]))
        n_out--;
    for (size_t i = 0; i < n_out; i++)
        out[i] = (unsigned char)text[i] < 0x20u || text[i] == 0x7f ? '?' : text[i];
    out[n_out] = '\0';
}

dif_status(dif_fail_named)(dif_error *err, const char *name, dif_status status)
{
    if (err) {
        char text[sizeof err->text], short_name[DIF_NAME_SIZE];
        memcpy(text, err->text, sizeof text);
        dif_name_short(name, short_name);
        const int n_left = (int)(sizeof text - strlen(short_name) - 3);
        snprintf(err->text, sizeof err->text, "%s: %.*s", short_name, n_left, text);
        err->status = status;
    }
    return status;
}

dif_status(dif_fail_errno)(dif_error *err, const char *name, const char *what, int number)
{
    char short_name[DIF_NAME_SIZE], reason[80];
    dif_name_short(name, short_name);
    if (strerror_r(number, reason, sizeof reason) != 0)
        snprintf(reason, sizeof reason, "error %d", number);
    return dif_fail(err, DIF_ERR_IO, "%s: %s: %s", short_name, what, reason);
}

/* Appends a code point as UTF-8. */
static size_t put_utf8(uint32_t code, char *out)
{
    if (code < 0x80) {
        out[0] = (char)code;
        return 1;
    }
    const int n_more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
    static const unsigned char LEAD[] = {0, 0xc0, 0xe0, 0xf0};
    out[0] = (char)(LEAD[n_more] | (code >> (6 * n_more)));
    for (int i = 1; i <= n_more; i++)
        out[i] = (char)(0x80u | ((code >> (6 * (n_more - i))) & 0x3fu));
    return (size_t)n_more + 1;
}

/* UTF-16 units of data[n] to UTF-8; false at a lone surrogate. out holds 3 bytes a unit. */
static bool decode_utf16(const unsigned char *data, size_t n, bool big, char *out, size_t *n_out)
{
    size_t used = 0;
    uint32_t high = 0;
    for (size_t i = 0; i + 1 < n; i += 2) {
        const uint32_t unit = big ? (uint32_t)data[i] << 8 | data[i + 1] : (uint32_t)data[i + 1] << 8 | data[i];
        const bool is_low = unit >= 0xdc00 && unit < 0xe000;
        if (is_low != (high != 0))
            return false;
        if (unit >= 0xd800 && unit < 0xdc00) {
            high = unit;
        } else if (is_low) {
            used += put_utf8(0x10000u + ((high - 0xd800u) << 10) + (unit - 0xdc00u), out + used);
            high = 0;
        } else {
            used += put_utf8(unit, out + used);
        }
    }
    *n_out = used;
    return high == 0;
}

static dif_status text_from_utf16(const dif_source *source, bool big, const char **text, size_t *n, char **owned,
                                  dif_error *err)
{
    if (source->n % 2 != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: UTF-16 text of an odd number of bytes (%zu)", source->name,
                        source->n);
    char *out = dif_alloc(source->n / 2, 3);
    if (!out)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: text of %zu bytes", source->name, source->n);
    if (!decode_utf16(source->data + 2, source->n - 2, big, out, n)) {
        dif_release(out);
        return dif_fail(err, DIF_ERR_FORMAT, "%s: broken UTF-16 text (lone surrogate)", source->name);
    }
    *text = *owned = out;
    return DIF_OK;
}

dif_status dif_source_text(const dif_source *source, const char **text, size_t *n, char **owned, dif_error *err)
{
    *text = (const char *)source->data;
    *n = source->n;
    *owned = NULL;
    dif_status status = DIF_OK;
    if (dif_source_has(source, 0, "\xff\xfe", 2) || dif_source_has(source, 0, "\xfe\xff", 2))
        status = text_from_utf16(source, source->data[0] == 0xfe, text, n, owned, err);
    else if (dif_source_has(source, 0, "\xef\xbb\xbf", 3)) {
        *text += 3;
        *n -= 3;
    }
    if (status)
        return status;
    const char *nul = *n ? memchr(*text, '\0', *n) : NULL;
    if (nul) {
        const size_t at = (size_t)(nul - *text);
        dif_release(*owned);
        *owned = NULL;
        return dif_fail(err, DIF_ERR_FORMAT, "%s: unknown format, and no text (NUL at byte %zu)", source->name, at);
    }
    return DIF_OK;
}
