#include "core/io/field_raw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/number.h"
#include "core/io/unit.h"

dif_raw dif_raw_empty(const char *format)
{
    dif_raw raw = {.pitch_x_um = NAN, .pitch_y_um = NAN, .step_x = NAN, .step_y = NAN, .unit_um = NAN};
    snprintf(raw.format, sizeof raw.format, "%s", format);
    return raw;
}

void dif_raw_free(dif_raw *raw)
{
    dif_release(raw->z);
    raw->z = NULL;
}

dif_status dif_raw_check_size(const dif_source *source, long long nx, long long ny, dif_error *err)
{
    if (nx < 1 || ny < 1)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %lld x %lld samples, want at least 1 x 1", source->name, nx, ny);
    if (nx > DIF_FIELD_SIDE_MAX || ny > DIF_FIELD_SIDE_MAX)
        return dif_fail(err, DIF_ERR_SIZE, "%s: %lld x %lld samples, want at most %d a side", source->name, nx, ny,
                        (int)DIF_FIELD_SIDE_MAX);
    if (nx * ny > DIF_FIELD_SAMPLES_MAX)
        return dif_fail(err, DIF_ERR_SIZE, "%s: %lld x %lld samples, want at most %d together", source->name, nx, ny,
                        (int)DIF_FIELD_SAMPLES_MAX);
    return DIF_OK;
}

dif_status dif_raw_allocate(const dif_source *source, long long nx, long long ny, dif_raw *raw, dif_error *err)
{
    const dif_status status = dif_raw_check_size(source, nx, ny, err);
    if (status)
        return status;
    raw->z = dif_alloc((size_t)nx * (size_t)ny, sizeof *raw->z);
    if (!raw->z)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %lld x %lld samples", source->name, nx, ny);
    raw->nx = (int)nx;
    raw->ny = (int)ny;
    return DIF_OK;
}

/* Bytes of the well-formed UTF-8 character at text[n], 0 if there is none. */
static size_t character_size(const char *text, size_t n)
{
    static const unsigned char LEADS[] = {0x00, 0xc2, 0xe0, 0xf0}, ENDS[] = {0x80, 0xe0, 0xf0, 0xf5};
    const unsigned char *byte = (const unsigned char *)text;
    for (size_t more = 0; more < 4 && more < n; more++) {
        if (byte[0] < LEADS[more] || byte[0] >= ENDS[more])
            continue;
        for (size_t i = 1; i <= more; i++) {
            if ((byte[i] & 0xc0u) != 0x80u)
                return 0;
        }
        const bool overlong = (byte[0] == 0xe0u && byte[1] < 0xa0u) || (byte[0] == 0xf0u && byte[1] < 0x90u);
        const bool no_code = (byte[0] == 0xedu && byte[1] > 0x9fu) || (byte[0] == 0xf4u && byte[1] > 0x8fu);
        return overlong || no_code ? 0 : more + 1;
    }
    return 0;
}

void dif_text_copy(char *out, size_t size, const char *text, size_t n)
{
    size_t used = 0;
    for (size_t i = 0; i < n;) {
        const size_t n_byte = character_size(text + i, n - i);
        if (used + (n_byte ? n_byte : 1) > size - 1)
            break;
        if (n_byte > 1)
            memcpy(out + used, text + i, n_byte);
        else
            out[used] = n_byte == 0 ? '?' : (unsigned char)text[i] < 0x20u || text[i] == 0x7f ? ' ' : text[i];
        used += n_byte ? n_byte : 1;
        i += n_byte ? n_byte : 1;
    }
    out[used] = '\0';
}

void dif_raw_set_title(dif_raw *raw, const char *text, size_t n)
{
    dif_text_copy(raw->title, sizeof raw->title, text, n);
}

/* The number of a key times a unit; *out stays if the key is missing. */
static dif_status take_number(const dif_source *source, const char *key, const char *text, double unit, double *out,
                              dif_error *err)
{
    double value = 0.0;
    if (!text)
        return DIF_OK;
    if (!dif_number_all(text, strlen(text), '.', &value) || !isfinite(value)) {
        char quote[DIF_QUOTE_SIZE];
        dif_quote(text, strlen(text), quote);
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %s is '%s', want a finite number", source->name, key, quote);
    }
    *out = value * unit;
    return DIF_OK;
}

/* The length unit of the first of two keys that is there, *unit_um stays without; false if it is no length. */
static bool take_unit(dif_key_lookup *lookup, void *self, const char *const keys[2], double *unit_um)
{
    const char *text = lookup(self, keys[0]);
    if (!text)
        text = lookup(self, keys[1]);
    return !text || !*text || dif_unit_parse(text, strlen(text), unit_um);
}

static dif_status take_extents(const dif_source *source, dif_key_lookup *lookup, void *self, dif_raw *raw,
                               dif_error *err)
{
    static const char *const UNIT_KEYS[2] = {"Gwy::XYUnit", "Gwy::XYUnits"};
    double unit_um = 1e6, size_x_um = NAN, size_y_um = NAN;
    const char *x_text = lookup(self, "Gwy::XReal"), *y_text = lookup(self, "Gwy::YReal");
    if (!x_text && !y_text)
        return DIF_OK;
    if (!take_unit(lookup, self, UNIT_KEYS, &unit_um))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: Gwy::XYUnit is no length unit", source->name);
    dif_status status = take_number(source, "Gwy::XReal", x_text ? x_text : y_text, unit_um, &size_x_um, err);
    if (!status)
        status = take_number(source, "Gwy::YReal", y_text ? y_text : x_text, unit_um, &size_y_um, err);
    if (status)
        return status;
    if (!(size_x_um > 0.0 && size_y_um > 0.0))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: Gwy::XReal, YReal are %g, %g um, want > 0", source->name, size_x_um,
                        size_y_um);
    raw->pitch_x_um = size_x_um / raw->nx;
    raw->pitch_y_um = size_y_um / raw->ny;
    return DIF_OK;
}

static dif_status take_heights(const dif_source *source, dif_key_lookup *lookup, void *self, dif_raw *raw,
                               dif_error *err)
{
    static const char *const UNIT_KEYS[2] = {"Gwy::ZUnit", "Gwy::ZUnits"};
    double unit_um = NAN, min_um = NAN, max_um = NAN, scale = 1.0;
    const bool is_length = take_unit(lookup, self, UNIT_KEYS, &unit_um);
    if (!is_length) {
        const char *unit = lookup(self, UNIT_KEYS[0]);
        if (!unit)
            unit = lookup(self, UNIT_KEYS[1]);
        dif_text_copy(raw->unit, sizeof raw->unit, unit, strlen(unit));
    }
    if (!(unit_um > 0.0))
        return DIF_OK;
    if (raw->bits == 0) {
        const dif_status status = take_number(source, "Gwy::ZScale", lookup(self, "Gwy::ZScale"), 1.0, &scale, err);
        raw->unit_um = unit_um * scale;
        return status;
    }
    dif_status status = take_number(source, "Gwy::ZMin", lookup(self, "Gwy::ZMin"), unit_um, &min_um, err);
    if (!status)
        status = take_number(source, "Gwy::ZMax", lookup(self, "Gwy::ZMax"), unit_um, &max_um, err);
    if (status || isnan(min_um) || isnan(max_um))
        return status;
    raw->offset_um = min_um;
    raw->unit_um = (max_um - min_um) / (double)((1 << raw->bits) - 1);
    return DIF_OK;
}

dif_status dif_raw_take_gwy_keys(const dif_source *source, dif_key_lookup *lookup, void *self, dif_raw *raw,
                                 dif_error *err)
{
    const char *title = lookup(self, "Gwy::Title");
    if (title)
        dif_raw_set_title(raw, title, strlen(title));
    const dif_status status = take_extents(source, lookup, self, raw, err);
    return status ? status : take_heights(source, lookup, self, raw, err);
}
