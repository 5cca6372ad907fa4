/* Writing, into memory: the caller puts the bytes on disk in one atomic step. */
#include <openexr.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"

enum { NAME_SIZE = 256, NAME_SHORT_MAX = 31 }; /* longer names need a flag of the file */

typedef struct memory_file {
    unsigned char *data; /* owned */
    size_t n, n_room;
} memory_file;

static int64_t write_bytes(exr_const_context_t context, void *self, const void *buffer, uint64_t n, uint64_t offset,
                           exr_stream_error_func_ptr_t complain)
{
    (void)context;
    (void)complain;
    memory_file *file = self;
    const uint64_t n_want = offset + n;
    if (n_want > file->n_room) {
        const size_t n_room = n_want > 2 * file->n_room ? n_want : 2 * file->n_room;
        unsigned char *data = dif_alloc(n_room, 1);
        if (!data)
            return -1;
        if (file->n)
            memcpy(data, file->data, file->n);
        dif_release(file->data);
        file->data = data;
        file->n_room = n_room;
    }
    memcpy(file->data + offset, buffer, n);
    file->n = n_want > file->n ? n_want : file->n;
    return (int64_t)n;
}

/* The library holds its lock while it complains about a file being written, so nothing may be asked of it here; the code
 * it returns says enough. */
static void ignore_reason(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context;
    (void)code;
    (void)message;
}

static exr_result_t put_attributes(exr_context_t context, const dif_exr_image *image)
{
    exr_result_t code = EXR_ERR_SUCCESS;
    for (int i = 0; i < image->n_attribute && code == EXR_ERR_SUCCESS; i++) {
        const dif_exr_attribute *attribute = &image->attribute[i];
        code = attribute->text ? exr_attr_set_string(context, 0, attribute->name, attribute->text)
                               : exr_attr_set_double(context, 0, attribute->name, attribute->number);
    }
    return code;
}

static bool is_taken(const dif_exr_image *image, const char *name)
{
    for (int i = 0; i < image->n_attribute; i++) {
        if (strcmp(image->attribute[i].name, name) == 0)
            return true;
    }
    return false;
}

static exr_result_t put_manifest(exr_context_t context, const dif_exr_image *image)
{
    exr_result_t code = EXR_ERR_SUCCESS;
    bool has_long = false;
    char name[NAME_SIZE];
    for (int i = 0; image->manifest && i < image->manifest->n && code == EXR_ERR_SUCCESS; i++) {
        const dif_manifest_item *item = &image->manifest->item[i];
        const int n = snprintf(name, sizeof name, DIF_EXR_PREFIX "%s", item->key);
        if (is_taken(image, name))
            continue;
        if (n > NAME_SHORT_MAX && !has_long) {
            code = exr_set_longname_support(context, 1);
            has_long = true;
        }
        if (code == EXR_ERR_SUCCESS)
            code = exr_attr_set_string(context, 0, name, item->value);
    }
    return code;
}

/* Primaries and white of IEC 61966-2-1. */
static const exr_attr_chromaticities_t SRGB = {.red_x = 0.64f,
                                               .red_y = 0.33f,
                                               .green_x = 0.3f,
                                               .green_y = 0.6f,
                                               .blue_x = 0.15f,
                                               .blue_y = 0.06f,
                                               .white_x = 0.3127f,
                                               .white_y = 0.329f};

static exr_result_t put_header(exr_context_t context, const dif_exr_image *image)
{
    int part = 0;
    exr_result_t code = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr_simple(context, part, image->nx, image->ny,
                                                   image->is_plain ? EXR_COMPRESSION_NONE : EXR_COMPRESSION_ZIP);
    for (int i = 0; i < image->n_layer && code == EXR_ERR_SUCCESS; i++)
        code = exr_add_channel(context, part, image->layer[i].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1);
    if (code == EXR_ERR_SUCCESS && image->is_srgb)
        code = exr_attr_set_chromaticities(context, part, "chromaticities", &SRGB);
    if (code == EXR_ERR_SUCCESS)
        code = put_attributes(context, image);
    if (code == EXR_ERR_SUCCESS)
        code = put_manifest(context, image);
    return code == EXR_ERR_SUCCESS ? exr_write_header(context) : code;
}

static void aim_channels(const dif_exr_image *image, int y, exr_encode_pipeline_t *encode)
{
    for (int i = 0; i < encode->channel_count; i++) {
        exr_coding_channel_info_t *channel = &encode->channels[i];
        const dif_exr_layer *layer = image->layer;
        while (strcmp(layer->name, channel->channel_name) != 0)
            layer++;
        const size_t first = (size_t)y * (size_t)image->nx * (size_t)layer->stride;
        const int32_t n_byte = layer->stride * (int32_t)sizeof(float);
        channel->encode_from_ptr = (const uint8_t *)(layer->pixel + first);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = sizeof(float);
        channel->user_pixel_stride = n_byte;
        channel->user_line_stride = image->nx * n_byte;
    }
}

static exr_result_t put_pixels(exr_context_t context, const dif_exr_image *image)
{
    exr_encode_pipeline_t encode = EXR_ENCODE_PIPELINE_INITIALIZER;
    int32_t n_line = 0;
    bool ready = false;
    exr_result_t code = exr_get_scanlines_per_chunk(context, 0, &n_line);
    for (int y = 0; y < image->ny && code == EXR_ERR_SUCCESS; y += n_line) {
        exr_chunk_info_t info = {0};
        code = exr_write_scanline_chunk_info(context, 0, y, &info);
        if (code == EXR_ERR_SUCCESS)
            code = ready ? exr_encoding_update(context, 0, &info, &encode)
                         : exr_encoding_initialize(context, 0, &info, &encode);
        if (code != EXR_ERR_SUCCESS)
            break;
        ready = true;
        aim_channels(image, y, &encode);
        code = exr_encoding_choose_default_routines(context, 0, &encode);
        if (code == EXR_ERR_SUCCESS)
            code = exr_encoding_run(context, 0, &encode);
    }
    if (ready)
        exr_encoding_destroy(context, &encode);
    return code;
}

static exr_result_t write_image(const dif_exr_image *image, memory_file *file)
{
    exr_context_t context = NULL;
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    how.error_handler_fn = ignore_reason;
    how.alloc_fn = dif_exr_alloc;
    how.free_fn = dif_release;
    how.user_data = file;
    how.write_fn = write_bytes;
    exr_result_t code = exr_start_write(&context, "memory", EXR_WRITE_FILE_DIRECTLY, &how);
    if (code != EXR_ERR_SUCCESS)
        return code;
    code = put_header(context, image);
    if (code == EXR_ERR_SUCCESS)
        code = put_pixels(context, image);
    const exr_result_t code_finish = exr_finish(&context); /* writes the table of chunks */
    return code == EXR_ERR_SUCCESS ? code_finish : code;
}

dif_status dif_exr_encode(const dif_exr_image *image, unsigned char **data, size_t *n, dif_error *err)
{
    *data = NULL;
    *n = 0;
    for (int i = 0; i < image->n_layer; i++)
        if (image->nx > INT32_MAX / (int)sizeof(float) / image->layer[i].stride)
            return dif_fail(err, DIF_ERR_SIZE, "EXR lines of %d samples", image->nx);
    memory_file file = {0};
    const exr_result_t code = write_image(image, &file);
    if (code != EXR_ERR_SUCCESS) {
        dif_release(file.data);
        if (code == EXR_ERR_OUT_OF_MEMORY || code == EXR_ERR_WRITE_IO)
            return dif_fail(err, DIF_ERR_NOMEM, "EXR of %d x %d samples", image->nx, image->ny);
        return dif_fail(err, DIF_ERR_FOREIGN, "EXR of %d x %d samples: %s", image->nx, image->ny,
                        exr_get_default_error_message(code));
    }
    *data = file.data;
    *n = file.n;
    return DIF_OK;
}
