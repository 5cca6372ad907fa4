/* Gwyddion's own files: a container of data fields "/N/data" with titles "/N/data/title", rows from the top. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/field_raw.h"
#include "core/io/gwy_tree.h"
#include "core/io/sample.h"
#include "core/io/unit.h"

/* One "/N/data". */
typedef struct gwy_field {
    long number;
    int nx, ny;
    double size_x, size_y;        /* in base units; NaN = not said                 */
    const char *unit_xy, *unit_z; /* NUL-terminated                                */
    const char *title;            /* likewise                                      */
    const unsigned char *z;       /* z[n] doubles, little-endian; NULL = none      */
    uint32_t n;
} gwy_field;

bool dif_gwy_is_file(const dif_source *source)
{
    return dif_source_has(source, 0, "GWYP", 4) || dif_source_has(source, 0, "GWYO", 4);
}

/* N of "/N" + end, -1 for any other key. */
static long number_of(const char *key, const char *end)
{
    long number = 0;
    int n_digit = 0;
    if (*key++ != '/')
        return -1;
    for (; *key >= '0' && *key <= '9' && n_digit < 9; n_digit++)
        number = 10 * number + (*key++ - '0');
    return n_digit > 0 && strcmp(key, end) == 0 ? number : -1;
}

/* The unit of an object GwySIUnit; "" if it says none. */
static const char *unit_of(const dif_gwy_item *item)
{
    const char *name;
    dif_gwy_items items;
    dif_gwy_item unit;
    size_t n_byte;
    if (!dif_gwy_object(item->value, item->n_byte, false, &name, &items, &n_byte))
        return "";
    while (dif_gwy_next(&items, &unit)) {
        if (dif_gwy_is(&unit, "unitstr", 's'))
            return (const char *)unit.value;
    }
    return "";
}

static dif_status fail_structure(const dif_source *source, dif_error *err)
{
    return dif_fail(err, DIF_ERR_FORMAT, "%s: Gwyddion file with broken items (truncated or damaged?)", source->name);
}

/* What an object GwyDataField says. */
static dif_status take_field(const dif_source *source, const dif_gwy_item *object, gwy_field *field, dif_error *err)
{
    const char *name;
    dif_gwy_items items;
    dif_gwy_item item;
    size_t n_byte;
    field->size_x = field->size_y = NAN;
    field->unit_xy = field->unit_z = field->title = "";
    if (!dif_gwy_object(object->value, object->n_byte, false, &name, &items, &n_byte))
        return fail_structure(source, err);
    while (dif_gwy_next(&items, &item)) {
        if (dif_gwy_is(&item, "xres", 'i'))
            field->nx = dif_gwy_int(&item);
        else if (dif_gwy_is(&item, "yres", 'i'))
            field->ny = dif_gwy_int(&item);
        else if (dif_gwy_is(&item, "xreal", 'd'))
            field->size_x = dif_gwy_double(&item);
        else if (dif_gwy_is(&item, "yreal", 'd'))
            field->size_y = dif_gwy_double(&item);
        else if (dif_gwy_is(&item, "si_unit_xy", 'o'))
            field->unit_xy = unit_of(&item);
        else if (dif_gwy_is(&item, "si_unit_z", 'o'))
            field->unit_z = unit_of(&item);
        else if (dif_gwy_is(&item, "data", 'D')) {
            field->z = item.value;
            field->n = item.n;
        }
    }
    return items.broken ? fail_structure(source, err) : DIF_OK;
}

typedef struct gwy_fields {
    gwy_field *field; /* field[n], owned, by number */
    int n;
} gwy_fields;

static bool is_field(const dif_gwy_item *item)
{
    return item->type == 'o' && strcmp((const char *)item->value, "GwyDataField") == 0 &&
           number_of(item->name, "/data") >= 0;
}

/* Walks over the outermost container. */
static dif_status open_container(const dif_source *source, dif_gwy_items *items, dif_error *err)
{
    const char *name;
    size_t n_byte;
    if (!dif_gwy_object(source->data + 4, source->n - 4, source->data[3] == 'O', &name, items, &n_byte))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: Gwyddion file that ends within its container (truncated?)",
                        source->name);
    if (strcmp(name, "GwyContainer") != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: Gwyddion file without a container", source->name);
    return DIF_OK;
}

/* How many fields there are, and whether all items can be read. */
static dif_status count_fields(const dif_source *source, dif_gwy_items items, int *n, dif_error *err)
{
    dif_gwy_item item;
    *n = 0;
    while (dif_gwy_next(&items, &item)) {
        if (is_field(&item) && ++*n > DIF_CHANNELS_MAX)
            return dif_fail(err, DIF_ERR_SIZE, "%s: more than %d channels", source->name, (int)DIF_CHANNELS_MAX);
    }
    if (items.broken)
        return fail_structure(source, err);
    if (*n == 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: a Gwyddion file without images", source->name);
    return DIF_OK;
}

static int by_number(const void *a, const void *b)
{
    const long na = ((const gwy_field *)a)->number, nb = ((const gwy_field *)b)->number;
    return (na > nb) - (na < nb);
}

static void take_titles(dif_gwy_items items, gwy_fields *fields)
{
    dif_gwy_item item;
    while (dif_gwy_next(&items, &item)) {
        const gwy_field key = {.number = item.type == 's' ? number_of(item.name, "/data/title") : -1};
        gwy_field *field = bsearch(&key, fields->field, (size_t)fields->n, sizeof key, by_number);
        if (field)
            field->title = (const char *)item.value;
    }
}

static dif_status read_fields(const dif_source *source, gwy_fields *out, dif_error *err)
{
    dif_gwy_items items, left;
    dif_gwy_item item;
    int n = 0;
    *out = (gwy_fields){0};
    dif_status status = open_container(source, &items, err);
    if (!status)
        status = count_fields(source, items, &n, err);
    if (status)
        return status;
    out->field = dif_alloc((size_t)n, sizeof *out->field);
    if (!out->field)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: list of channels", source->name);
    for (left = items; !status && dif_gwy_next(&left, &item);) {
        if (!is_field(&item))
            continue;
        gwy_field *field = &out->field[out->n++];
        field->number = number_of(item.name, "/data");
        status = take_field(source, &item, field, err);
    }
    if (status) {
        dif_release(out->field);
        *out = (gwy_fields){0};
        return status;
    }
    qsort(out->field, (size_t)out->n, sizeof *out->field, by_number);
    take_titles(items, out);
    return DIF_OK;
}

/* Lengths are in metres: by the format's rule a prefix of a unit does not count, "nm" is "m". */
static bool is_length(const char *unit, bool *has_prefix)
{
    double unit_um = 0.0;
    const bool is = dif_unit_parse_si(unit, strlen(unit), &unit_um);
    *has_prefix = is && unit_um != 1e6;
    return is;
}

dif_status dif_gwy_list(const dif_source *source, dif_channels *out, dif_error *err)
{
    gwy_fields fields;
    bool has_prefix;
    dif_status status = read_fields(source, &fields, err);
    if (status)
        return status;
    out->preferred = -1;
    int first_unitless = -1;
    for (int i = 0; i < fields.n && !status; i++) {
        const gwy_field *field = &fields.field[i];
        dif_channel channel = {.nx = field->nx, .ny = field->ny, .is_height = is_length(field->unit_z, &has_prefix)};
        dif_text_copy(channel.name, sizeof channel.name, field->title, strlen(field->title));
        const char *unit = channel.is_height ? "m" : field->unit_z;
        dif_text_copy(channel.unit, sizeof channel.unit, unit, strlen(unit));
        status = dif_channels_add(source, &channel, out, err);
        if (channel.is_height && out->preferred < 0)
            out->preferred = i;
        if (!*unit && first_unitless < 0)
            first_unitless = i;
    }
    if (out->preferred < 0)
        out->preferred = first_unitless; /* may be heights for which --z-unit is all that is missing */
    dif_release(fields.field);
    return status;
}

static dif_status take_samples(const dif_source *source, const gwy_field *field, dif_raw *raw, dif_error *err)
{
    dif_status status = dif_raw_check_size(source, field->nx, field->ny, err);
    if (status)
        return status;
    if (!field->z || field->n != (uint32_t)field->nx * (uint32_t)field->ny)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %lu samples, want %d x %d", source->name, (unsigned long)field->n,
                        field->nx, field->ny);
    status = dif_raw_allocate(source, field->nx, field->ny, raw, err);
    if (!status)
        dif_sample_read(DIF_SAMPLE_F64, field->z, field->n, raw->z);
    return status;
}

dif_status dif_gwy_read(const dif_source *source, int index, dif_raw *raw, dif_error *err)
{
    gwy_fields fields;
    bool xy_prefix = false, z_prefix = false;
    *raw = dif_raw_empty("gwy");
    dif_status status = read_fields(source, &fields, err);
    if (status)
        return status;
    const gwy_field *field = &fields.field[index];
    status = take_samples(source, field, raw, err);
    if (status)
        goto cleanup;
    if (is_length(field->unit_xy, &xy_prefix) && field->size_x > 0.0 && isfinite(field->size_x) &&
        field->size_y > 0.0 && isfinite(field->size_y)) {
        raw->pitch_x_um = field->size_x * 1e6 / field->nx;
        raw->pitch_y_um = field->size_y * 1e6 / field->ny;
    }
    if (is_length(field->unit_z, &z_prefix))
        raw->unit_um = 1e6;
    else
        dif_text_copy(raw->unit, sizeof raw->unit, field->unit_z, strlen(field->unit_z));
    if (xy_prefix || z_prefix)
        snprintf(raw->warning, sizeof raw->warning, "lengths are taken in m, although the file names '%.10s'",
                 xy_prefix ? field->unit_xy : field->unit_z);
    dif_raw_set_title(raw, field->title, strlen(field->title));
cleanup:
    dif_release(fields.field);
    if (status)
        dif_raw_free(raw);
    return status;
}
