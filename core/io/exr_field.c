/* Heightfields as EXR: float heights in micrometres, pitches and units as attributes. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/number.h"
#include "core/io/unit.h"

#define PITCH_X DIF_EXR_PREFIX "pitch_x_um"
#define PITCH_Y DIF_EXR_PREFIX "pitch_y_um"
#define Z_UNIT  DIF_EXR_PREFIX "z_unit"

/* Gwyddion's keys may be strings or numbers; numbers become text in one of a few buffers, in turn. */
typedef struct key_source {
    const dif_exr *exr;
    char text[4][DIF_NUMBER_SIZE];
    int next;
} key_source;

static const char *look_up(void *self, const char *key)
{
    key_source *keys = self;
    const char *text = dif_exr_text(keys->exr, key);
    double value = 0.0;
    if (text || !dif_exr_number(keys->exr, key, &value))
        return text;
    char *buffer = keys->text[keys->next++ % 4];
    dif_number_print_short(value, buffer);
    return buffer;
}

/* Refuses our own files that hold something else. */
static dif_status check_kind(const dif_source *source, const dif_exr *exr, dif_error *err)
{
    if (dif_exr_text(exr, DIF_EXR_PREFIX "fixed_angle"))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: a response table, want a heightfield", source->name);
    const char *layout = dif_exr_text(exr, DIF_EXR_PREFIX "layout");
    if (layout)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: holds '%.40s', want a heightfield", source->name, layout);
    return DIF_OK;
}

/* Our own attributes, which win over Gwyddion's. */
static dif_status take_own(const dif_source *source, const dif_exr *exr, dif_raw *raw, dif_error *err)
{
    double x_um = NAN, y_um = NAN;
    const bool has_x = dif_exr_number(exr, PITCH_X, &x_um), has_y = dif_exr_number(exr, PITCH_Y, &y_um);
    if (has_x || has_y) {
        if (!(x_um > 0.0 && isfinite(x_um) && y_um > 0.0 && isfinite(y_um)))
            return dif_fail(err, DIF_ERR_FORMAT, "%s: " PITCH_X ", " PITCH_Y " are %g, %g, want finite numbers > 0",
                            source->name, x_um, y_um);
        raw->pitch_x_um = x_um;
        raw->pitch_y_um = y_um;
    }
    const char *unit = dif_exr_text(exr, Z_UNIT);
    if (unit && !dif_unit_parse(unit, strlen(unit), &raw->unit_um))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: " Z_UNIT " is '%.20s', want a length unit", source->name, unit);
    return DIF_OK;
}

/* The one unit of all channels, as text; empty if the file says none. */
static const char *unit_of(const dif_exr *exr)
{
    static const char *const KEYS[] = {Z_UNIT, "Gwy::ZUnit", "Gwy::ZUnits"};
    for (size_t i = 0; i < sizeof KEYS / sizeof *KEYS; i++) {
        const char *unit = dif_exr_text(exr, KEYS[i]);
        if (unit)
            return unit;
    }
    return "";
}

dif_status dif_exr_field_list(const dif_source *source, dif_channels *out, dif_error *err)
{
    dif_exr *exr = NULL;
    dif_channel channel = {0};
    dif_status status = dif_exr_open(source, &exr, err);
    if (status)
        return status;
    status = check_kind(source, exr, err);
    dif_exr_size(exr, &channel.nx, &channel.ny);
    if (!status)
        status = dif_raw_check_size(source, channel.nx, channel.ny, err);
    const char *unit = unit_of(exr);
    double unit_um = 0.0;
    dif_text_copy(channel.unit, sizeof channel.unit, unit, strlen(unit));
    channel.is_height = dif_unit_parse(unit, strlen(unit), &unit_um);
    for (int i = 0; i < dif_exr_n_channel(exr) && !status; i++) {
        const char *name = dif_exr_channel_name(exr, i);
        dif_text_copy(channel.name, sizeof channel.name, name, strlen(name));
        status = dif_channels_add(source, &channel, out, err);
        if (strcmp(name, "R") == 0)
            out->preferred = i;
    }
    if (!status && out->n == 0)
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: no channels", source->name);
    dif_exr_close(exr);
    return status;
}

static dif_status take_pixels(const dif_source *source, const float *pixel, dif_raw *raw, dif_error *err)
{
    const dif_status status = dif_raw_allocate(source, raw->nx, raw->ny, raw, err);
    if (status)
        return status;
    const size_t n = (size_t)raw->nx * (size_t)raw->ny;
    for (size_t i = 0; i < n; i++)
        raw->z[i] = (double)pixel[i];
    return DIF_OK;
}

dif_status dif_exr_field_read(const dif_source *source, int index, dif_raw *raw, dif_error *err)
{
    *raw = dif_raw_empty("exr");
    dif_exr *exr = NULL;
    float *pixel = NULL;
    char found[DIF_EXR_CHANNEL_SIZE] = "";
    dif_status status = dif_exr_open(source, &exr, err);
    if (status)
        return status;
    dif_exr_size(exr, &raw->nx, &raw->ny);
    status = dif_raw_check_size(source, raw->nx, raw->ny, err);
    if (!status)
        status = dif_exr_read_channel(exr, dif_exr_channel_name(exr, index), &pixel, found, err);
    if (!status)
        status = take_pixels(source, pixel, raw, err);
    if (status)
        goto cleanup;
    dif_raw_set_title(raw, found, strlen(found));
    key_source keys = {.exr = exr};
    status = dif_raw_take_gwy_keys(source, look_up, &keys, raw, err);
    if (!status)
        status = take_own(source, exr, raw, err);
cleanup:
    dif_release(pixel);
    dif_exr_close(exr);
    if (status)
        dif_raw_free(raw);
    return status;
}

dif_status dif_exr_field_encode(const dif_field *field, const dif_manifest *manifest, unsigned char **data, size_t *n,
                                dif_error *err)
{
    const size_t n_sample = dif_field_n(field);
    *data = NULL;
    float *pixel = dif_alloc(n_sample, sizeof *pixel);
    if (!pixel)
        return dif_fail(err, DIF_ERR_NOMEM, "EXR of %d x %d samples", field->nx, field->ny);
    for (size_t i = 0; i < n_sample; i++)
        pixel[i] = (float)field->z_um[i];
    const double x_real_m = field->nx * field->pitch_x_um / 1e6, y_real_m = field->ny * field->pitch_y_um / 1e6;
    /* Gwyddion looks for its lengths as doubles and for its units as strings */
    const dif_exr_attribute attributes[] = {
        {PITCH_X, NULL, field->pitch_x_um}, {PITCH_Y, NULL, field->pitch_y_um}, {Z_UNIT, "um", 0.0},
        {"Gwy::XReal", NULL, x_real_m},     {"Gwy::YReal", NULL, y_real_m},     {"Gwy::XYUnit", "m", 0.0},
        {"Gwy::ZUnit", "um", 0.0},          {"Gwy::Title", "height", 0.0},
    };
    const dif_exr_layer layer = {"height", pixel, 1};
    const dif_exr_image image = {.nx = field->nx,
                                 .ny = field->ny,
                                 .layer = &layer,
                                 .n_layer = 1,
                                 .attribute = attributes,
                                 .n_attribute = sizeof attributes / sizeof *attributes,
                                 .manifest = manifest};
    const dif_status status = dif_exr_encode(&image, data, n, err);
    dif_release(pixel);
    return status;
}
