/* gzip archives made in memory. */
#ifndef DIF_TEST_GZIP_SAMPLE_H
#define DIF_TEST_GZIP_SAMPLE_H

#include "tests/near.h"

#include <string.h>
#include <zlib.h>

/* Packs data[n] as one member into out[room]; returns its length. */
static inline size_t gzip_sample(const void *data, size_t n, unsigned char *out, size_t room)
{
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = (Bytef *)(uintptr_t)data;
    stream.avail_in = (uInt)n;
    stream.next_out = out;
    stream.avail_out = (uInt)room;
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    const size_t n_out = room - stream.avail_out;
    deflateEnd(&stream);
    return n_out;
}

#endif
