/* Reading. */
#include "core/io/exr_io.h"

#include <openexr.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/number.h"

static const size_t BLOCK_MAX = (size_t)1 << 30;

struct dif_exr {
    dif_source source;
    exr_context_t context;
    int nx, ny, x0, y0; /* data window */
    bool tiled;
    bool no_memory;   /* the library was refused memory; it does not always say so in its result */
    char reason[160]; /* first complaint of the library */
};

void *dif_exr_alloc(size_t n_byte)
{
    return n_byte <= BLOCK_MAX ? dif_alloc(n_byte, 1) : NULL;
}

bool dif_exr_is(const dif_source *source)
{
    return dif_source_has(source, 0, "\x76\x2f\x31\x01", 4);
}

static int64_t read_bytes(exr_const_context_t context, void *self, void *buffer, uint64_t n, uint64_t offset,
                          exr_stream_error_func_ptr_t complain)
{
    (void)context;
    (void)complain;
    const dif_source *source = &((dif_exr *)self)->source;
    if (offset >= source->n)
        return 0;
    const uint64_t n_left = source->n - offset;
    const uint64_t n_copy = n < n_left ? n : n_left;
    memcpy(buffer, source->data + offset, n_copy);
    return (int64_t)n_copy;
}

static int64_t size_bytes(exr_const_context_t context, void *self)
{
    (void)context;
    return (int64_t)((dif_exr *)self)->source.n;
}

/* Keeps the first complaint: it names the cause, later ones name its consequences. */
static void keep_reason(exr_const_context_t context, exr_result_t code, const char *message)
{
    void *self = NULL;
    if (context && exr_get_user_data(context, &self) == EXR_ERR_SUCCESS && self) {
        dif_exr *exr = self;
        exr->no_memory |= code == EXR_ERR_OUT_OF_MEMORY;
        if (!exr->reason[0])
            snprintf(exr->reason, sizeof exr->reason, "%s", message);
    }
}

static dif_status fail_library(const dif_exr *exr, exr_result_t code, const char *what, dif_error *err)
{
    if (code == EXR_ERR_OUT_OF_MEMORY || exr->no_memory)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %s: out of memory", exr->source.name, what);
    const char *reason = exr->reason[0] ? exr->reason : exr_get_default_error_message(code);
    const dif_status status = code == EXR_ERR_FEATURE_NOT_IMPLEMENTED ? DIF_ERR_UNSUPPORTED : DIF_ERR_FORMAT;
    return dif_fail(err, status, "%s: %s: %.110s", exr->source.name, what, reason);
}

static exr_result_t start_read(dif_exr *exr)
{
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    how.error_handler_fn = keep_reason;
    how.alloc_fn = dif_exr_alloc;
    how.free_fn = dif_release;
    how.user_data = exr;
    how.read_fn = read_bytes;
    how.size_fn = size_bytes;
    how.max_tile_width = how.max_tile_height = DIF_FIELD_SIDE_MAX;
    how.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    return exr_start_read(&exr->context, "memory", &how);
}

/* One plain part of at least one sample, in scanlines or tiles. */
static dif_status check_part(dif_exr *exr, dif_error *err)
{
    int n_part = 0;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_attr_box2i_t window = {0};
    exr_result_t code = exr_get_count(exr->context, &n_part);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_storage(exr->context, 0, &storage);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_data_window(exr->context, 0, &window);
    if (code != EXR_ERR_SUCCESS)
        return fail_library(exr, code, "EXR header", err);
    if (n_part != 1)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: EXR of %d parts, want one", exr->source.name, n_part);
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: deep EXR, want plain pixels", exr->source.name);
    const long long nx = (long long)window.max.x - window.min.x + 1, ny = (long long)window.max.y - window.min.y + 1;
    /* Tables may be wider than heightfields; only their product is bounded. */
    if (nx < 1 || ny < 1)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %lld x %lld samples, want at least 1 x 1", exr->source.name, nx, ny);
    if (nx > DIF_FIELD_SAMPLES_MAX / ny)
        return dif_fail(err, DIF_ERR_SIZE, "%s: %lld x %lld samples, want at most %d together", exr->source.name, nx,
                        ny, (int)DIF_FIELD_SAMPLES_MAX);
    exr->nx = (int)nx;
    exr->ny = (int)ny;
    exr->x0 = window.min.x;
    exr->y0 = window.min.y;
    exr->tiled = storage == EXR_STORAGE_TILED;
    return DIF_OK;
}

dif_status dif_exr_open(const dif_source *source, dif_exr **out, dif_error *err)
{
    *out = NULL;
    dif_exr *exr = dif_alloc(1, sizeof *exr);
    if (!exr)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: EXR reader", source->name);
    exr->source = *source;
    const exr_result_t code = start_read(exr);
    dif_status status = code == EXR_ERR_SUCCESS ? DIF_OK : fail_library(exr, code, "EXR header", err);
    if (!status)
        status = check_part(exr, err);
    if (status) {
        dif_exr_close(exr);
        return status;
    }
    *out = exr;
    return DIF_OK;
}

void dif_exr_close(dif_exr *exr)
{
    if (!exr)
        return;
    if (exr->context)
        exr_finish(&exr->context);
    dif_release(exr);
}

void dif_exr_size(const dif_exr *exr, int *nx, int *ny)
{
    *nx = exr->nx;
    *ny = exr->ny;
}

static const exr_attribute_t *find_attribute(const dif_exr *exr, const char *name)
{
    const exr_attribute_t *attribute = NULL;
    return exr_get_attribute_by_name(exr->context, 0, name, &attribute) == EXR_ERR_SUCCESS ? attribute : NULL;
}

static const char *text_of(const exr_attribute_t *attribute)
{
    if (!attribute || attribute->type != EXR_ATTR_STRING || !attribute->string)
        return NULL;
    return attribute->string->str ? attribute->string->str : "";
}

const char *dif_exr_text(const dif_exr *exr, const char *name)
{
    return text_of(find_attribute(exr, name));
}

bool dif_exr_number(const dif_exr *exr, const char *name, double *value)
{
    const exr_attribute_t *attribute = find_attribute(exr, name);
    const char *text = text_of(attribute);
    if (!attribute)
        return false;
    if (text)
        return dif_number_all(text, strlen(text), '.', value);
    if (attribute->type == EXR_ATTR_DOUBLE)
        *value = attribute->d;
    else if (attribute->type == EXR_ATTR_FLOAT)
        *value = (double)attribute->f;
    else if (attribute->type == EXR_ATTR_INT)
        *value = attribute->i;
    else
        return false;
    return true;
}

static bool is_in(const char *word, const char *const *list)
{
    for (; *list; list++) {
        if (strcmp(word, *list) == 0)
            return true;
    }
    return false;
}

dif_status dif_exr_take_manifest(const dif_exr *exr, const char *const *skip, dif_manifest *manifest, dif_error *err)
{
    const size_t n_prefix = strlen(DIF_EXR_PREFIX);
    int32_t n = 0;
    exr_result_t code = exr_get_attribute_count(exr->context, 0, &n);
    for (int32_t i = 0; code == EXR_ERR_SUCCESS && i < n; i++) {
        const exr_attribute_t *attribute = NULL;
        code = exr_get_attribute_by_index(exr->context, 0, EXR_ATTR_LIST_FILE_ORDER, i, &attribute);
        const char *text = code == EXR_ERR_SUCCESS ? text_of(attribute) : NULL;
        if (!text || strncmp(attribute->name, DIF_EXR_PREFIX, n_prefix) != 0 || is_in(attribute->name, skip))
            continue;
        const dif_status status = dif_manifest_set(manifest, attribute->name + n_prefix, text, err);
        if (status)
            return status;
    }
    return code == EXR_ERR_SUCCESS ? DIF_OK : fail_library(exr, code, "EXR attributes", err);
}

static dif_status find_channel(const dif_exr *exr, const char *name, char found[DIF_EXR_CHANNEL_SIZE], dif_error *err)
{
    const exr_attr_chlist_t *list = NULL;
    const exr_result_t code = exr_get_channels(exr->context, 0, &list);
    if (code != EXR_ERR_SUCCESS || !list || list->num_channels < 1)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: EXR without channels", exr->source.name);
    const exr_attr_chlist_entry_t *entry = NULL;
    for (int i = 0; i < list->num_channels; i++) {
        if (strcmp(list->entries[i].name.str, name ? name : "R") == 0)
            entry = &list->entries[i];
    }
    if (!entry && name)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: no channel '%.30s', the first of %d is '%.30s'", exr->source.name,
                        name, list->num_channels, list->entries[0].name.str);
    if (!entry)
        entry = &list->entries[0];
    if (entry->pixel_type != EXR_PIXEL_FLOAT && entry->pixel_type != EXR_PIXEL_HALF)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: channel '%.30s' holds integers, want float or half",
                        exr->source.name, entry->name.str);
    if (entry->x_sampling != 1 || entry->y_sampling != 1)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: channel '%.30s' is subsampled %d x %d, want 1 x 1",
                        exr->source.name, entry->name.str, entry->x_sampling, entry->y_sampling);
    if (strlen(entry->name.str) >= DIF_EXR_CHANNEL_SIZE)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: channel name of %zu bytes", exr->source.name,
                        strlen(entry->name.str));
    memcpy(found, entry->name.str, strlen(entry->name.str) + 1);
    return DIF_OK;
}

/* A chunk is a strip of lines or a tile. */
typedef struct chunk_grid {
    int nx, ny;         /* chunks along x, y */
    int size_x, size_y; /* samples of a full one */
} chunk_grid;

static exr_result_t find_chunks(const dif_exr *exr, chunk_grid *grid)
{
    int32_t size_x = exr->nx, size_y = 0;
    exr_result_t code;
    if (exr->tiled)
        code = exr_get_tile_sizes(exr->context, 0, 0, 0, &size_x, &size_y);
    else
        code = exr_get_scanlines_per_chunk(exr->context, 0, &size_y);
    if (code != EXR_ERR_SUCCESS)
        return code;
    if (size_x < 1 || size_y < 1)
        return EXR_ERR_FILE_BAD_HEADER;
    *grid = (chunk_grid){(exr->nx - 1) / size_x + 1, (exr->ny - 1) / size_y + 1, size_x, size_y};
    return EXR_ERR_SUCCESS;
}

/* Looks a chunk up and checks it against its place: the decoder trusts these numbers. */
static exr_result_t chunk_info(const dif_exr *exr, const chunk_grid *grid, int cx, int cy, exr_chunk_info_t *info)
{
    exr_result_t code;
    const int y = exr->y0 + cy * grid->size_y;
    if (exr->tiled)
        code = exr_read_tile_chunk_info(exr->context, 0, cx, cy, 0, 0, info);
    else
        code = exr_read_scanline_chunk_info(exr->context, 0, y, info);
    if (code != EXR_ERR_SUCCESS)
        return code;
    const int left_x = exr->nx - cx * grid->size_x, left_y = exr->ny - cy * grid->size_y;
    const int want_x = left_x < grid->size_x ? left_x : grid->size_x;
    const int want_y = left_y < grid->size_y ? left_y : grid->size_y;
    const bool place_ok = exr->tiled ? info->start_x == cx && info->start_y == cy : info->start_y == y;
    const bool fits = info->data_offset <= exr->source.n && info->packed_size <= exr->source.n - info->data_offset;
    if (!place_ok || !fits || info->width != want_x || info->height != want_y)
        return EXR_ERR_CORRUPT_CHUNK;
    return EXR_ERR_SUCCESS;
}

/* Sends the named channel of the pipeline's chunk to its place in the picture, others nowhere. */
static void aim_channel(const dif_exr *exr, const char *name, float *to, exr_decode_pipeline_t *decode)
{
    for (int i = 0; i < decode->channel_count; i++) {
        exr_coding_channel_info_t *channel = &decode->channels[i];
        channel->decode_to_ptr = NULL;
        if (strcmp(channel->channel_name, name) == 0) {
            channel->decode_to_ptr = (uint8_t *)to;
            channel->user_data_type = EXR_PIXEL_FLOAT;
            channel->user_bytes_per_element = sizeof(float);
            channel->user_pixel_stride = sizeof(float);
            channel->user_line_stride = exr->nx * (int32_t)sizeof(float);
        }
    }
}

static exr_result_t decode_chunk(const dif_exr *exr, const exr_chunk_info_t *info, const char *name, float *to,
                                 exr_decode_pipeline_t *decode, bool *ready)
{
    exr_result_t code = *ready ? exr_decoding_update(exr->context, 0, info, decode)
                               : exr_decoding_initialize(exr->context, 0, info, decode);
    if (code != EXR_ERR_SUCCESS)
        return code;
    *ready = true;
    aim_channel(exr, name, to, decode);
    code = exr_decoding_choose_default_routines(exr->context, 0, decode);
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(exr->context, 0, decode) : code;
}

/* Walks over all chunks; with pixel NULL it only checks them, so that memory is asked for only by whole files. */
static exr_result_t walk_chunks(const dif_exr *exr, const chunk_grid *grid, const char *name, float *pixel)
{
    exr_decode_pipeline_t decode = EXR_DECODE_PIPELINE_INITIALIZER;
    bool ready = false;
    exr_result_t code = EXR_ERR_SUCCESS;
    for (int cy = 0; cy < grid->ny && code == EXR_ERR_SUCCESS; cy++) {
        for (int cx = 0; cx < grid->nx && code == EXR_ERR_SUCCESS; cx++) {
            exr_chunk_info_t info = {0};
            code = chunk_info(exr, grid, cx, cy, &info);
            if (code != EXR_ERR_SUCCESS || !pixel)
                continue;
            float *to = pixel + (size_t)cy * (size_t)grid->size_y * (size_t)exr->nx + (size_t)cx * (size_t)grid->size_x;
            code = decode_chunk(exr, &info, name, to, &decode, &ready);
        }
    }
    if (ready)
        exr_decoding_destroy(exr->context, &decode);
    return code;
}

dif_status dif_exr_read_channel(dif_exr *exr, const char *name, float **pixel, char found[DIF_EXR_CHANNEL_SIZE],
                                dif_error *err)
{
    *pixel = NULL;
    if (exr->nx > INT32_MAX / (int)sizeof(float))
        return dif_fail(err, DIF_ERR_SIZE, "%s: lines of %d samples", exr->source.name, exr->nx);
    const dif_status status = find_channel(exr, name, found, err);
    if (status)
        return status;
    chunk_grid grid = {0};
    exr_result_t code = find_chunks(exr, &grid);
    if (code == EXR_ERR_SUCCESS)
        code = walk_chunks(exr, &grid, found, NULL);
    if (code != EXR_ERR_SUCCESS)
        return fail_library(exr, code, "EXR pixels", err);
    float *out = dif_alloc((size_t)exr->nx * (size_t)exr->ny, sizeof *out);
    if (!out)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %d x %d samples", exr->source.name, exr->nx, exr->ny);
    code = walk_chunks(exr, &grid, found, out);
    if (code != EXR_ERR_SUCCESS) {
        dif_release(out);
        return fail_library(exr, code, "EXR pixels", err);
    }
    *pixel = out;
    return DIF_OK;
}
