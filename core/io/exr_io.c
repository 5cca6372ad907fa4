/* Reading: the file, its size and attributes. */
#include "core/io/exr_impl.h"

#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/number.h"

static const size_t BLOCK_MAX = (size_t)1 << 30;

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

dif_status dif_exr_fail(const dif_exr *exr, exr_result_t code, const char *what, dif_error *err)
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
        return dif_exr_fail(exr, code, "EXR header", err);
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
    /* The library drops an attribute that finds no memory and says nothing but this. */
    const bool ok = code == EXR_ERR_SUCCESS && !exr->no_memory;
    dif_status status = ok ? DIF_OK : dif_exr_fail(exr, code, "EXR header", err);
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
    return code == EXR_ERR_SUCCESS ? DIF_OK : dif_exr_fail(exr, code, "EXR attributes", err);
}
