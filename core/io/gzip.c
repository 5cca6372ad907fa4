#define ZLIB_CONST
#include "core/io/gzip.h"

#include <limits.h>
#include <string.h>
#include <zlib.h>

#include "core/alloc.h"

enum { WINDOW_BITS = 15 + 16, ROOM_MIN = 1 << 12 }; /* 16: a gzip header, and nothing else */

static void *take_heap(void *self, unsigned n, unsigned size)
{
    (void)self;
    return dif_alloc(n, size);
}

static void give_heap(void *self, void *block)
{
    (void)self;
    dif_release(block);
}

typedef struct unpacked {
    unsigned char *data; /* data[n_room], owned */
    size_t n, n_room, n_max;
} unpacked;

static dif_status grow(const dif_source *source, unpacked *out, dif_error *err)
{
    if (out->n_room >= out->n_max)
        return dif_fail(err, DIF_ERR_SIZE, "%s: the gzip archive holds more than %zu bytes", source->name, out->n_max);
    size_t n_room = out->n_room > 0 ? 2 * out->n_room : 4 * source->n;
    n_room = n_room < ROOM_MIN ? ROOM_MIN : n_room;
    n_room = n_room > out->n_max ? out->n_max : n_room;
    unsigned char *data = dif_alloc(n_room, 1);
    if (!data)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %zu bytes of a gzip archive", source->name, n_room);
    if (out->n)
        memcpy(data, out->data, out->n);
    dif_release(out->data);
    out->data = data;
    out->n_room = n_room;
    return DIF_OK;
}

static dif_status fail_stream(const dif_source *source, const z_stream *stream, int code, dif_error *err)
{
    if (code == Z_MEM_ERROR)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: unpacking a gzip archive", source->name);
    if (code == Z_BUF_ERROR)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: the gzip archive ends before its data do (truncated?)", source->name);
    return dif_fail(err, DIF_ERR_FORMAT, "%s: damaged gzip archive: %.60s", source->name,
                    stream->msg ? stream->msg : "not understood");
}

/* Unpacks one member, up to its check sum; `at` moves behind it. */
static dif_status unpack_member(const dif_source *source, z_stream *stream, size_t *at, unpacked *out, dif_error *err)
{
    int code = Z_OK;
    while (code == Z_OK) {
        const size_t n_left = source->n - *at;
        if (out->n == out->n_room) {
            const dif_status status = grow(source, out, err);
            if (status)
                return status;
        }
        const size_t n_free = out->n_room - out->n;
        stream->next_in = source->data + *at;
        stream->avail_in = n_left < UINT_MAX ? (unsigned)n_left : UINT_MAX;
        stream->next_out = out->data + out->n;
        stream->avail_out = (unsigned)n_free; /* at most DIF_GZIP_OUT_MAX */
        code = inflate(stream, Z_NO_FLUSH);
        *at = (size_t)(stream->next_in - source->data);
        out->n = out->n_room - stream->avail_out;
    }
    return code == Z_STREAM_END ? DIF_OK : fail_stream(source, stream, code, err);
}

/* What follows a member: another one, or bytes that fill a block of a tape. */
static bool is_filling(const dif_source *source, size_t at)
{
    while (at < source->n && source->data[at] == 0)
        at++;
    return at == source->n;
}

bool dif_gzip_is(const dif_source *source)
{
    return dif_source_has(source, 0, "\x1f\x8b", 2);
}

dif_status dif_gzip_unpack(const dif_source *source, size_t n_max, unsigned char **data, size_t *n, dif_error *err)
{
    unpacked out = {.n_max = n_max};
    z_stream stream = {.zalloc = take_heap, .zfree = give_heap};
    *data = NULL;
    *n = 0;
    if (inflateInit2(&stream, WINDOW_BITS) != Z_OK)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: unpacking a gzip archive", source->name);
    dif_status status = DIF_OK;
    for (size_t at = 0; !status && (at == 0 || !is_filling(source, at));) {
        status = unpack_member(source, &stream, &at, &out, err);
        if (!status && inflateReset(&stream) != Z_OK)
            status = dif_fail(err, DIF_ERR_FOREIGN, "%s: zlib cannot begin anew", source->name);
    }
    inflateEnd(&stream);
    if (status) {
        dif_release(out.data);
        return status;
    }
    *data = out.data;
    *n = out.n;
    return DIF_OK;
}

dif_status dif_gzip_open(dif_source *source, unsigned char **owned, dif_error *err)
{
    *owned = NULL;
    if (!dif_gzip_is(source))
        return DIF_OK;
    size_t n = 0;
    const dif_status status = dif_gzip_unpack(source, DIF_GZIP_OUT_MAX, owned, &n, err);
    if (!status) {
        source->data = *owned;
        source->n = n;
    }
    return status;
}
