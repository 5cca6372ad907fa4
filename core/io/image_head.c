#include "core/io/image_head.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"

static const unsigned char PNG_MAGIC[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
enum { PNG_OVERHEAD = 12, PNG_HEAD = 13, PNG_KEY_MAX = 79, ITXT_BETWEEN = 5, BMP_HEAD_MIN = 26 };

static uint32_t big32(const unsigned char *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static uint32_t little32(const unsigned char *at)
{
    return (uint32_t)at[3] << 24 | (uint32_t)at[2] << 16 | (uint32_t)at[1] << 8 | at[0];
}

static uint32_t little16(const unsigned char *at)
{
    return (uint32_t)at[1] << 8 | at[0];
}

static bool is_png(const unsigned char *data, size_t n)
{
    return n >= sizeof PNG_MAGIC && memcmp(data, PNG_MAGIC, sizeof PNG_MAGIC) == 0;
}

static bool is_tiff(const unsigned char *data, size_t n)
{
    return n >= 4 && (memcmp(data, "II*\0", 4) == 0 || memcmp(data, "MM\0*", 4) == 0 || memcmp(data, "II+\0", 4) == 0 ||
                      memcmp(data, "MM\0+", 4) == 0);
}

static bool is_bmp(const unsigned char *data, size_t n)
{
    return n >= 2 && data[0] == 'B' && data[1] == 'M';
}

bool dif_image_is(const unsigned char *data, size_t n)
{
    return is_png(data, n) || is_tiff(data, n) || is_bmp(data, n);
}

/* CRC-32 of ISO 3309, four bits at a time. */
static uint32_t crc32(const unsigned char *data, size_t n)
{
    static const uint32_t TABLE[16] = {0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac, 0x76dc4190, 0x6b6b51f4,
                                       0x4db26158, 0x5005713c, 0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c,
                                       0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c};
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < n; i++) {
        crc ^= data[i];
        crc = TABLE[crc & 15u] ^ crc >> 4;
        crc = TABLE[crc & 15u] ^ crc >> 4;
    }
    return ~crc;
}

/* A chunk at offset `at`: its type and data; false if the file ends in it. */
typedef struct png_chunk {
    const unsigned char *type, *data;
    size_t n;
} png_chunk;

static bool png_chunk_at(const unsigned char *data, size_t n, size_t at, png_chunk *chunk)
{
    if (at > n || n - at < PNG_OVERHEAD)
        return false;
    chunk->n = big32(data + at);
    chunk->type = data + at + 4;
    chunk->data = data + at + 8;
    return chunk->n <= n - at - PNG_OVERHEAD;
}

static dif_status check_png_head(const png_chunk *chunk, dif_image_head *out, dif_error *err)
{
    if (chunk->n != PNG_HEAD || memcmp(chunk->type, "IHDR", 4) != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "PNG does not begin with its header chunk");
    out->nx = big32(chunk->data);
    out->ny = big32(chunk->data + 4);
    return DIF_OK;
}

static dif_status read_png(const unsigned char *data, size_t n, dif_image_head *out, dif_error *err)
{
    bool has_pixels = false;
    png_chunk chunk = {0};
    for (size_t at = sizeof PNG_MAGIC; png_chunk_at(data, n, at, &chunk); at += chunk.n + PNG_OVERHEAD) {
        if (big32(chunk.data + chunk.n) != crc32(chunk.type, chunk.n + 4))
            return dif_fail(err, DIF_ERR_FORMAT, "PNG is damaged: wrong check sum of the chunk at byte %zu", at);
        if (at == sizeof PNG_MAGIC) {
            const dif_status status = check_png_head(&chunk, out, err);
            if (status)
                return status;
        }
        has_pixels |= memcmp(chunk.type, "IDAT", 4) == 0;
        if (memcmp(chunk.type, "IEND", 4) == 0)
            return has_pixels ? DIF_OK : dif_fail(err, DIF_ERR_FORMAT, "PNG without pixels");
    }
    return dif_fail(err, DIF_ERR_FORMAT, "PNG of %zu bytes ends before its end chunk (truncated?)", n);
}

static unsigned char *put_big32(unsigned char *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> (24 - 8 * i));
    return to + 4;
}

/* Puts a chunk of up to three pieces; returns where the next one begins. */
static unsigned char *put_chunk(unsigned char *to, const char *type, const char *const piece[3], const size_t n[3])
{
    unsigned char *at = put_big32(to, (uint32_t)(n[0] + n[1] + n[2]));
    memcpy(at, type, 4);
    at += 4;
    for (int i = 0; i < 3; i++) {
        if (n[i])
            memcpy(at, piece[i], n[i]);
        at += n[i];
    }
    return put_big32(at, crc32(to + 4, (size_t)(at - to) - 4));
}

/* Makes room for n_more bytes behind the header chunk; returns where they begin, NULL without memory. The old block goes
 * when they are filled. */
static unsigned char *open_gap(const unsigned char *png, size_t n, size_t n_more)
{
    const size_t n_head = sizeof PNG_MAGIC + PNG_HEAD + PNG_OVERHEAD;
    unsigned char *out = dif_alloc(n + n_more, 1);
    if (out)
        memcpy(out, png, n_head);
    return out ? out + n_head : NULL;
}

/* Puts the rest of the old file at `at`, where the new chunks end that begin at `gap`, and takes its place. */
static void close_gap(unsigned char *gap, unsigned char *at, unsigned char **png, size_t *n)
{
    const size_t n_head = sizeof PNG_MAGIC + PNG_HEAD + PNG_OVERHEAD;
    unsigned char *out = gap - n_head;
    memcpy(at, *png + n_head, *n - n_head);
    *n = (size_t)(at - out) + *n - n_head;
    dif_release(*png);
    *png = out;
}

static const char PREFIX[] = "diffbench.";

/* Bytes that put_manifest takes at most. */
static size_t manifest_room(const dif_manifest *manifest)
{
    size_t n = 0;
    for (int i = 0; manifest && i < manifest->n; i++)
        n += PNG_OVERHEAD + sizeof PREFIX + strlen(manifest->item[i].key) + ITXT_BETWEEN +
             strlen(manifest->item[i].value);
    return n;
}

static unsigned char *put_manifest(unsigned char *at, const dif_manifest *manifest)
{
    enum { KEY_MAX = PNG_KEY_MAX - (int)sizeof PREFIX + 1 };
    for (int i = 0; manifest && i < manifest->n; i++) {
        char key[128];
        const int n_key = snprintf(key, sizeof key, "%s%.*s", PREFIX, KEY_MAX, manifest->item[i].key);
        /* keyword NUL, not compressed, no method, no language NUL, no translation NUL, text in UTF-8 */
        at = put_chunk(at, "iTXt", (const char *[3]){key, "\0\0\0\0", manifest->item[i].value},
                       (const size_t[3]){(size_t)n_key, ITXT_BETWEEN, strlen(manifest->item[i].value)});
    }
    return at;
}

dif_status dif_png_add_texts(const dif_manifest *manifest, unsigned char **png, size_t *n, dif_error *err)
{
    const size_t n_more = PNG_OVERHEAD + 1 + manifest_room(manifest);
    unsigned char *gap = open_gap(*png, *n, n_more);
    if (!gap)
        return dif_fail(err, DIF_ERR_NOMEM, "PNG of %zu bytes", *n + n_more);
    /* sRGB, perceptual */
    unsigned char *at = put_chunk(gap, "sRGB", (const char *[3]){"", NULL, NULL}, (const size_t[3]){1, 0, 0});
    close_gap(gap, put_manifest(at, manifest), png, n);
    return DIF_OK;
}

dif_status dif_png_add_keys(int n_key, const dif_png_key *key, const dif_manifest *manifest, unsigned char **png,
                            size_t *n, dif_error *err)
{
    size_t n_more = manifest_room(manifest);
    for (int i = 0; i < n_key; i++)
        n_more += PNG_OVERHEAD + strlen(key[i].key) + 1 + strlen(key[i].text);
    unsigned char *gap = open_gap(*png, *n, n_more), *at = gap;
    if (!gap)
        return dif_fail(err, DIF_ERR_NOMEM, "PNG of %zu bytes", *n + n_more);
    for (int i = 0; i < n_key; i++)
        at = put_chunk(at, "tEXt", (const char *[3]){key[i].key, key[i].text, NULL},
                       (const size_t[3]){strlen(key[i].key) + 1, strlen(key[i].text), 0});
    close_gap(gap, put_manifest(at, manifest), png, n);
    return DIF_OK;
}

bool dif_png_text(const unsigned char *data, size_t n, const char *key, char *text, size_t size)
{
    const size_t n_key = strlen(key) + 1; /* its NUL separates it from the text */
    png_chunk chunk = {0};
    if (!is_png(data, n))
        return false;
    for (size_t at = sizeof PNG_MAGIC; png_chunk_at(data, n, at, &chunk); at += chunk.n + PNG_OVERHEAD) {
        if (memcmp(chunk.type, "tEXt", 4) != 0 || chunk.n < n_key || memcmp(chunk.data, key, n_key) != 0)
            continue;
        const size_t n_text = chunk.n - n_key;
        const size_t n_copy = n_text < size - 1 ? n_text : size - 1;
        memcpy(text, chunk.data + n_key, n_copy);
        text[n_copy] = '\0';
        return true;
    }
    return false;
}

static dif_status read_bmp(const unsigned char *data, size_t n, dif_image_head *out, dif_error *err)
{
    if (n < BMP_HEAD_MIN)
        return dif_fail(err, DIF_ERR_FORMAT, "BMP of %zu bytes ends within its header (truncated?)", n);
    const uint32_t n_head = little32(data + 14);
    if (n_head < 40 || n < 54)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "BMP with a header of %u bytes, want one of 40 or more", n_head);
    const int64_t nx = (int32_t)little32(data + 18), height = (int32_t)little32(data + 22);
    const int64_t ny = height < 0 ? -height : height; /* negative: stored from the top */
    const uint32_t n_bit = little16(data + 28), compression = little32(data + 30), start = little32(data + 10);
    if (compression != 0 || (n_bit != 8 && n_bit != 24 && n_bit != 32))
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "BMP of %u bits with compression %u, want 8, 24 or 32 without", n_bit,
                        compression);
    out->nx = nx;
    out->ny = ny;
    if (nx < 1 || ny < 1 || nx > (1 << 20) || ny > (1 << 20))
        return DIF_OK; /* the caller refuses the size */
    const uint64_t n_row = ((uint64_t)nx * n_bit + 31) / 32 * 4;
    if (start > n || n_row * (uint64_t)ny > n - start)
        return dif_fail(err, DIF_ERR_FORMAT, "BMP of %zu bytes is shorter than its %lld x %lld pixels (truncated?)", n,
                        (long long)nx, (long long)ny);
    return DIF_OK;
}

dif_status dif_image_head_read(const unsigned char *data, size_t n, dif_image_head *out, dif_error *err)
{
    *out = (dif_image_head){0};
    dif_status status = DIF_OK;
    if (is_png(data, n)) {
        memcpy(out->format, "png", 4);
        status = read_png(data, n, out, err);
    } else if (is_tiff(data, n)) {
        memcpy(out->format, "tiff", 5);
        status = dif_tiff_head_read(data, n, out, err);
    } else if (is_bmp(data, n)) {
        memcpy(out->format, "bmp", 4);
        status = read_bmp(data, n, out, err);
    } else {
        status = dif_fail(err, DIF_ERR_FORMAT, "not a PNG, TIFF or BMP image");
    }
    return status;
}
