/* Heightfields as a text matrix with the header of Gwyddion's exports, which says scale and unit. */
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/field_raw.h"
#include "core/io/number.h"

enum { HEADER_ROOM = 256, CELL_ROOM = 25 }; /* "-1.2345678901234567e-308" and what separates it */

static size_t header_room(const dif_manifest *manifest)
{
    size_t n = HEADER_ROOM;
    for (int i = 0; manifest && i < manifest->n; i++)
        n += strlen(manifest->item[i].key) + strlen(manifest->item[i].value) + 32;
    return n;
}

static size_t put_header(const dif_field *field, const dif_manifest *manifest, char *text, size_t room)
{
    char width[DIF_NUMBER_SIZE], height[DIF_NUMBER_SIZE];
    dif_number_print_short(field->nx * field->pitch_x_um, width);
    dif_number_print_short(field->ny * field->pitch_y_um, height);
    int n = snprintf(text, room, "# Channel: height\n# Width: %s \xc2\xb5m\n# Height: %s \xc2\xb5m\n# Value units: m\n",
                     width, height);
    for (int i = 0; manifest && i < manifest->n; i++)
        n += snprintf(text + n, room - (size_t)n, "# diffbench.%s: %s\n", manifest->item[i].key,
                      manifest->item[i].value);
    return (size_t)n;
}

dif_status dif_text_field_encode(const dif_field *field, const dif_manifest *manifest, unsigned char **data, size_t *n,
                                 dif_error *err)
{
    const size_t room = header_room(manifest), n_sample = dif_field_n(field);
    char number[DIF_NUMBER_SIZE];
    char *text = dif_alloc(room + CELL_ROOM * n_sample, 1);
    *data = NULL;
    *n = 0;
    if (!text)
        return dif_fail(err, DIF_ERR_NOMEM, "text of %d x %d samples", field->nx, field->ny);
    size_t used = put_header(field, manifest, text, room);
    for (size_t i = 0; i < n_sample; i++) {
        const size_t n_digit = dif_number_print_short(field->z_um[i] / 1e6, number);
        memcpy(text + used, number, n_digit);
        used += n_digit;
        text[used++] = (i + 1) % (size_t)field->nx ? '\t' : '\n';
    }
    *data = (unsigned char *)text;
    *n = used;
    return DIF_OK;
}
