/* EXR files of every kind the library can write, in memory: what other programs hand to the reader. */
#ifndef DIF_TEST_EXR_SAMPLE_H
#define DIF_TEST_EXR_SAMPLE_H

#include "tests/near.h"

#include <openexr.h>
#include <string.h>

enum { EXR_SAMPLE_SIZE = 1 << 20, EXR_SAMPLE_CHANNELS = 4 };

typedef struct exr_sample {
    int nx, ny, x0, y0, n_channel, tile; /* tile 0: scanlines */
    const char *names[EXR_SAMPLE_CHANNELS];
    exr_pixel_type_t type;
    exr_compression_t compression;
    int n_part, sampling;
    const char *keys[4], *texts[4]; /* string attributes, NULL ends */
    unsigned char *data;            /* data[EXR_SAMPLE_SIZE], written */
    size_t n;
} exr_sample;

/* Channel c of the sample (ix, iy): smooth, exact as half. */
static inline float exr_sample_value(int c, int ix, int iy)
{
    return 0.25f * (float)ix - 0.5f * (float)iy + 16.0f * (float)c;
}

static inline int64_t exr_sample_put(exr_const_context_t context, void *self, const void *buffer, uint64_t n,
                                     uint64_t offset, exr_stream_error_func_ptr_t complain)
{
    (void)context;
    (void)complain;
    exr_sample *sample = self;
    if (offset + n > EXR_SAMPLE_SIZE)
        return -1;
    memcpy(sample->data + offset, buffer, n);
    sample->n = offset + n > sample->n ? offset + n : sample->n;
    return (int64_t)n;
}

static inline void exr_sample_header(exr_context_t context, const exr_sample *sample, int part)
{
    const exr_attr_box2i_t window = {.min = {.x = sample->x0, .y = sample->y0},
                                     .max = {.x = sample->x0 + sample->nx - 1, .y = sample->y0 + sample->ny - 1}};
    const exr_attr_v2f_t centre = {.x = 0.0f, .y = 0.0f};
    int index = 0;
    const exr_storage_t storage = sample->tile ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE;
    char name[16];
    snprintf(name, sizeof name, "part%d", part);
    assert_int_equal(exr_add_part(context, sample->n_part > 1 ? name : NULL, storage, &index), EXR_ERR_SUCCESS);
    assert_int_equal(exr_initialize_required_attr(context, index, &window, &window, 1.0f, &centre, 1.0f,
                                                  EXR_LINEORDER_INCREASING_Y, sample->compression),
                     EXR_ERR_SUCCESS);
    if (sample->tile)
        assert_int_equal(exr_set_tile_descriptor(context, index, (uint32_t)sample->tile, (uint32_t)sample->tile,
                                                 EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN),
                         EXR_ERR_SUCCESS);
    for (int c = 0; c < sample->n_channel; c++)
        assert_int_equal(exr_add_channel(context, index, sample->names[c], sample->type, EXR_PERCEPTUALLY_LINEAR,
                                         sample->sampling, sample->sampling),
                         EXR_ERR_SUCCESS);
    for (int i = 0; i < 4 && sample->keys[i]; i++)
        assert_int_equal(exr_attr_set_string(context, index, sample->keys[i], sample->texts[i]), EXR_ERR_SUCCESS);
}

/* Encodes one chunk at column x0, row y0 of the picture. */
static inline void exr_sample_chunk(exr_context_t context, int part, const exr_sample *sample,
                                    const exr_chunk_info_t *info, int x0, int y0)
{
    static float pixel[EXR_SAMPLE_CHANNELS][1 << 16];
    exr_encode_pipeline_t encode = EXR_ENCODE_PIPELINE_INITIALIZER;
    assert_int_equal(exr_encoding_initialize(context, part, info, &encode), EXR_ERR_SUCCESS);
    assert_in_range(info->width * info->height, 1, 1 << 16);
    for (int i = 0; i < encode.channel_count; i++) {
        exr_coding_channel_info_t *channel = &encode.channels[i];
        int c = 0;
        while (strcmp(sample->names[c], channel->channel_name) != 0)
            c++;
        for (int y = 0; y < info->height; y++) {
            for (int x = 0; x < info->width; x++) {
                const float value = exr_sample_value(c, x0 + x, y0 + y);
                const uint32_t whole = (uint32_t)(x + y);
                memcpy(&pixel[i][y * info->width + x], sample->type == EXR_PIXEL_UINT ? (const void *)&whole : &value,
                       4);
            }
        }
        channel->encode_from_ptr = (const uint8_t *)pixel[i];
        channel->user_data_type = sample->type == EXR_PIXEL_UINT ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = 4;
        channel->user_pixel_stride = 4;
        channel->user_line_stride = 4 * info->width;
    }
    assert_int_equal(exr_encoding_choose_default_routines(context, part, &encode), EXR_ERR_SUCCESS);
    assert_int_equal(exr_encoding_run(context, part, &encode), EXR_ERR_SUCCESS);
    exr_encoding_destroy(context, &encode);
}

static inline void exr_sample_pixels(exr_context_t context, int part, const exr_sample *sample)
{
    int32_t n_line = 0;
    exr_chunk_info_t info;
    if (sample->tile) {
        for (int ty = 0; ty * sample->tile < sample->ny; ty++) {
            for (int tx = 0; tx * sample->tile < sample->nx; tx++) {
                assert_int_equal(exr_write_tile_chunk_info(context, part, tx, ty, 0, 0, &info), EXR_ERR_SUCCESS);
                exr_sample_chunk(context, part, sample, &info, tx * sample->tile, ty * sample->tile);
            }
        }
        return;
    }
    assert_int_equal(exr_get_scanlines_per_chunk(context, part, &n_line), EXR_ERR_SUCCESS);
    for (int y = 0; y < sample->ny; y += n_line) {
        assert_int_equal(exr_write_scanline_chunk_info(context, part, sample->y0 + y, &info), EXR_ERR_SUCCESS);
        exr_sample_chunk(context, part, sample, &info, 0, y);
    }
}

/* A sample's first form: one float channel, scanlines, ZIP. */
static inline exr_sample exr_sample_make(int nx, int ny)
{
    static unsigned char data[EXR_SAMPLE_SIZE];
    const exr_sample sample = {.nx = nx,
                               .ny = ny,
                               .n_channel = 1,
                               .names = {"height"},
                               .type = EXR_PIXEL_FLOAT,
                               .compression = EXR_COMPRESSION_ZIP,
                               .n_part = 1,
                               .sampling = 1,
                               .data = data};
    return sample;
}

static inline void exr_sample_write(exr_sample *sample)
{
    exr_context_t context = NULL;
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    how.user_data = sample;
    how.write_fn = exr_sample_put;
    sample->n = 0;
    memset(sample->data, 0, EXR_SAMPLE_SIZE);
    assert_int_equal(exr_start_write(&context, "sample", EXR_WRITE_FILE_DIRECTLY, &how), EXR_ERR_SUCCESS);
    for (int part = 0; part < sample->n_part; part++)
        exr_sample_header(context, sample, part);
    assert_int_equal(exr_write_header(context), EXR_ERR_SUCCESS);
    for (int part = 0; part < sample->n_part; part++)
        exr_sample_pixels(context, part, sample);
    assert_int_equal(exr_finish(&context), EXR_ERR_SUCCESS);
}

#endif
