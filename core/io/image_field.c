/* Grey pictures as heights: 0 to 2^bits - 1. */
#include <math.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/field_raw.h"
#include "core/io/image_cv.h"
#include "core/io/image_head.h"

/* Values of PNG text chunks; a key's text stays until four others were looked up. */
typedef struct png_keys {
    const dif_source *source;
    char text[4][128];
    int next;
} png_keys;

static const char *look_up(void *self, const char *key)
{
    png_keys *keys = self;
    char *text = keys->text[keys->next % 4];
    if (!dif_png_text(keys->source->data, keys->source->n, key, text, sizeof keys->text[0]))
        return NULL;
    keys->next++;
    return text;
}

dif_status dif_image_field_read(const dif_source *source, dif_raw *raw, dif_error *err)
{
    *raw = dif_raw_empty("");
    dif_image image;
    dif_image_head head;
    dif_status status = dif_image_head_read(source->data, source->n, &head, err);
    if (!status)
        status = dif_image_decode(source->data, source->n, &image, err);
    if (status)
        return dif_fail_named(err, source->name, status);
    *raw = dif_raw_empty(head.format);
    raw->bits = image.bits;
    status = dif_raw_allocate(source, image.nx, image.ny, raw, err);
    if (!status) {
        for (size_t i = 0; i < (size_t)image.nx * (size_t)image.ny; i++)
            raw->z[i] = image.value[i];
        png_keys keys = {.source = source};
        status = dif_raw_take_gwy_keys(source, look_up, &keys, raw, err);
    }
    dif_release(image.value);
    if (status)
        dif_raw_free(raw);
    return status;
}
