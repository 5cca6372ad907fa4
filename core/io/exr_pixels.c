/* Reading: channels and pixels. */
#include "core/io/exr_impl.h"

#include <string.h>

#include "core/alloc.h"

int dif_exr_n_channel(const dif_exr *exr)
{
    const exr_attr_chlist_t *list = NULL;
    const exr_result_t code = exr_get_channels(exr->context, 0, &list);
    return code == EXR_ERR_SUCCESS && list ? list->num_channels : 0;
}

static const exr_attr_chlist_entry_t *entry_at(const dif_exr *exr, int i)
{
    const exr_attr_chlist_t *list = NULL;
    return exr_get_channels(exr->context, 0, &list) == EXR_ERR_SUCCESS ? &list->entries[i] : NULL;
}

const char *dif_exr_channel_name(const dif_exr *exr, int i)
{
    return entry_at(exr, i)->name.str;
}

static const exr_attr_chlist_entry_t *find_entry(const dif_exr *exr, const char *name)
{
    const exr_attr_chlist_entry_t *found = NULL;
    const int n = dif_exr_n_channel(exr);
    for (int i = 0; i < n; i++) {
        const exr_attr_chlist_entry_t *entry = entry_at(exr, i);
        if (strcmp(entry->name.str, name) == 0)
            found = entry;
    }
    return found;
}

static dif_status check_entry(const dif_exr *exr, const exr_attr_chlist_entry_t *entry, dif_error *err)
{
    if (entry->pixel_type != EXR_PIXEL_FLOAT && entry->pixel_type != EXR_PIXEL_HALF)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: channel '%.30s' holds integers, want float or half",
                        exr->source.name, entry->name.str);
    if (entry->x_sampling != 1 || entry->y_sampling != 1)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: channel '%.30s' is subsampled %d x %d, want 1 x 1",
                        exr->source.name, entry->name.str, entry->x_sampling, entry->y_sampling);
    return DIF_OK;
}

static dif_status find_channel(const dif_exr *exr, const char *name, char found[DIF_EXR_CHANNEL_SIZE], dif_error *err)
{
    if (dif_exr_n_channel(exr) < 1)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: EXR without channels", exr->source.name);
    const exr_attr_chlist_entry_t *entry = find_entry(exr, name ? name : "R");
    if (!entry && name)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: no channel '%.30s', the first of %d is '%.30s'", exr->source.name,
                        name, dif_exr_n_channel(exr), dif_exr_channel_name(exr, 0));
    if (!entry)
        entry = entry_at(exr, 0);
    const dif_status status = check_entry(exr, entry, err);
    if (status)
        return status;
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

/* Sends the wanted channels of the pipeline's chunk, whose first sample is `at`, to their places, others nowhere. */
static void aim_channels(const dif_exr *exr, int n, const dif_exr_target *target, size_t at,
                         exr_decode_pipeline_t *decode)
{
    for (int i = 0; i < decode->channel_count; i++) {
        exr_coding_channel_info_t *channel = &decode->channels[i];
        channel->decode_to_ptr = NULL;
        for (int k = 0; k < n; k++) {
            if (strcmp(channel->channel_name, target[k].name) != 0)
                continue;
            const int32_t n_byte = target[k].stride * (int32_t)sizeof(float);
            channel->decode_to_ptr = (uint8_t *)(target[k].pixel + at * (size_t)target[k].stride);
            channel->user_data_type = EXR_PIXEL_FLOAT;
            channel->user_bytes_per_element = sizeof(float);
            channel->user_pixel_stride = n_byte;
            channel->user_line_stride = exr->nx * n_byte;
        }
    }
}

static exr_result_t decode_chunk(const dif_exr *exr, const exr_chunk_info_t *info, int n, const dif_exr_target *target,
                                 size_t at, exr_decode_pipeline_t *decode, bool *ready)
{
    exr_result_t code = *ready ? exr_decoding_update(exr->context, 0, info, decode)
                               : exr_decoding_initialize(exr->context, 0, info, decode);
    if (code != EXR_ERR_SUCCESS)
        return code;
    *ready = true;
    aim_channels(exr, n, target, at, decode);
    code = exr_decoding_choose_default_routines(exr->context, 0, decode);
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(exr->context, 0, decode) : code;
}

/* Walks over all chunks; without targets it only checks them, so that memory is asked for only by whole files. */
static exr_result_t walk_chunks(const dif_exr *exr, int n, const dif_exr_target *target)
{
    exr_decode_pipeline_t decode = EXR_DECODE_PIPELINE_INITIALIZER;
    chunk_grid grid = {0};
    bool ready = false;
    exr_result_t code = find_chunks(exr, &grid);
    for (int cy = 0; code == EXR_ERR_SUCCESS && cy < grid.ny; cy++) {
        for (int cx = 0; cx < grid.nx && code == EXR_ERR_SUCCESS; cx++) {
            exr_chunk_info_t info = {0};
            code = chunk_info(exr, &grid, cx, cy, &info);
            if (code != EXR_ERR_SUCCESS || n == 0)
                continue;
            const size_t at = (size_t)cy * (size_t)grid.size_y * (size_t)exr->nx + (size_t)cx * (size_t)grid.size_x;
            code = decode_chunk(exr, &info, n, target, at, &decode, &ready);
        }
    }
    if (ready)
        exr_decoding_destroy(exr->context, &decode);
    return code;
}

dif_status dif_exr_check_pixels(dif_exr *exr, dif_error *err)
{
    const exr_result_t code = walk_chunks(exr, 0, NULL);
    return code == EXR_ERR_SUCCESS ? DIF_OK : dif_exr_fail(exr, code, "EXR pixels", err);
}

dif_status dif_exr_read_targets(dif_exr *exr, int n, const dif_exr_target *target, dif_error *err)
{
    for (int k = 0; k < n; k++) {
        const exr_attr_chlist_entry_t *entry = find_entry(exr, target[k].name);
        if (exr->nx > INT32_MAX / (int)sizeof(float) / target[k].stride)
            return dif_fail(err, DIF_ERR_SIZE, "%s: lines of %d samples", exr->source.name, exr->nx);
        if (!entry)
            return dif_fail(err, DIF_ERR_FORMAT, "%s: no channel '%.30s'", exr->source.name, target[k].name);
        const dif_status status = check_entry(exr, entry, err);
        if (status)
            return status;
    }
    const exr_result_t code = walk_chunks(exr, n, target);
    return code == EXR_ERR_SUCCESS ? DIF_OK : dif_exr_fail(exr, code, "EXR pixels", err);
}

dif_status dif_exr_read_channel(dif_exr *exr, const char *name, float **pixel, char found[DIF_EXR_CHANNEL_SIZE],
                                dif_error *err)
{
    *pixel = NULL;
    if (exr->nx > INT32_MAX / (int)sizeof(float))
        return dif_fail(err, DIF_ERR_SIZE, "%s: lines of %d samples", exr->source.name, exr->nx);
    dif_status status = find_channel(exr, name, found, err);
    if (!status)
        status = dif_exr_check_pixels(exr, err);
    if (status)
        return status;
    float *out = dif_alloc((size_t)exr->nx * (size_t)exr->ny, sizeof *out);
    if (!out)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %d x %d samples", exr->source.name, exr->nx, exr->ny);
    const dif_exr_target target = {found, out, 1};
    status = dif_exr_read_targets(exr, 1, &target, err);
    if (status)
        dif_release(out);
    else
        *pixel = out;
    return status;
}
