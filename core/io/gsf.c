/* Gwyddion Simple Field: "Name = value" lines, 1 to 4 NUL bytes up to a multiple of 4, float32 little-endian rows from
 * the top. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/field_raw.h"
#include "core/io/number.h"
#include "core/io/unit.h"

static const char MAGIC[] = "Gwyddion Simple Field 1.0\n";

/* The value of "key = value" in header[n], trimmed, or NULL. */
static const char *find_value(const char *header, size_t n, const char *key, size_t *n_value)
{
    const char *end = header + n;
    for (const char *line = header; line < end;) {
        const char *stop = memchr(line, '\n', (size_t)(end - line));
        stop = stop ? stop : end;
        const char *equal = memchr(line, '=', (size_t)(stop - line));
        if (equal) {
            const char *key_end = equal, *value = equal + 1, *value_end = stop;
            while (line < key_end && *line == ' ')
                line++;
            while (line < key_end && key_end[-1] == ' ')
                key_end--;
            while (value < value_end && (*value == ' ' || *value == '\t'))
                value++;
            while (value < value_end && (value_end[-1] == ' ' || value_end[-1] == '\t' || value_end[-1] == '\r'))
                value_end--;
            if ((size_t)(key_end - line) == strlen(key) && memcmp(line, key, strlen(key)) == 0) {
                *n_value = (size_t)(value_end - value);
                return value;
            }
        }
        line = stop + 1;
    }
    return NULL;
}

typedef struct gsf_header {
    const dif_source *source;
    const char *text; /* text[n], the lines after the magic one */
    size_t n;
} gsf_header;

/* The number of a key, or `missing` if there is no such key. */
static dif_status read_number(const gsf_header *header, const char *key, double missing, double *out, dif_error *err)
{
    size_t n = 0;
    const char *value = find_value(header->text, header->n, key, &n);
    *out = missing;
    if (!value)
        return DIF_OK;
    if (dif_number_all(value, n, '.', out) && isfinite(*out))
        return DIF_OK;
    char quote[DIF_QUOTE_SIZE];
    dif_quote(value, n, quote);
    return dif_fail(err, DIF_ERR_FORMAT, "%s: %s is '%s', want a finite number", header->source->name, key, quote);
}

static dif_status read_count(const gsf_header *header, const char *key, long long *out, dif_error *err)
{
    double value = 0.0;
    const dif_status status = read_number(header, key, NAN, &value, err);
    if (status)
        return status;
    if (isnan(value))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: no %s in the header", header->source->name, key);
    if (value != floor(value) || fabs(value) > 1e15)
        return dif_fail(err, fabs(value) > 1e15 ? DIF_ERR_SIZE : DIF_ERR_FORMAT,
                        "%s: %s is %g, want a whole number up to %d", header->source->name, key, value,
                        (int)DIF_FIELD_SIDE_MAX);
    *out = (long long)value;
    return DIF_OK;
}

/* The unit of a key: NaN if it is missing or empty (a dimensionless field) or no length, which then stands in `other`. */
static void read_unit(const gsf_header *header, const char *key, double *unit_um, char other[DIF_CHANNEL_UNIT_SIZE])
{
    size_t n = 0;
    const char *value = find_value(header->text, header->n, key, &n);
    *unit_um = NAN;
    if (value && n > 0 && !dif_unit_parse(value, n, unit_um))
        dif_text_copy(other, DIF_CHANNEL_UNIT_SIZE, value, n);
}

/* Pitches from XReal, YReal; without a unit the file's 1.0 is no length and the pitch stays unknown. */
static dif_status read_scale(const gsf_header *header, dif_raw *raw, dif_error *err)
{
    double unit_um = NAN, x_real = 1.0, y_real = 1.0;
    char lateral[DIF_CHANNEL_UNIT_SIZE] = "";
    read_unit(header, "XYUnits", &unit_um, lateral);
    if (lateral[0])
        return dif_fail(err, DIF_ERR_FORMAT,
                        "%s: XYUnits is '%s', want a length (pm, nm, um, mm, m): not a heightfield",
                        header->source->name, lateral);
    read_unit(header, "ZUnits", &raw->unit_um, raw->unit);
    dif_status status = read_number(header, "XReal", 1.0, &x_real, err);
    if (!status)
        status = read_number(header, "YReal", 1.0, &y_real, err);
    if (status || isnan(unit_um))
        return status;
    if (!(x_real > 0.0 && y_real > 0.0))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: XReal, YReal are %g, %g, want > 0", header->source->name, x_real,
                        y_real);
    raw->pitch_x_um = x_real * unit_um / raw->nx;
    raw->pitch_y_um = y_real * unit_um / raw->ny;
    return DIF_OK;
}

static double float_from_little(const unsigned char byte[4])
{
    const uint32_t bits =
        (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static dif_status read_samples(const gsf_header *header, size_t n_header, long long nx, long long ny, dif_raw *raw,
                               dif_error *err)
{
    const dif_source *source = header->source;
    dif_status status = dif_raw_check_size(source, nx, ny, err);
    if (status)
        return status;
    const size_t n_want = (size_t)nx * (size_t)ny * 4, n_have = source->n - n_header;
    if (n_have != n_want)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %zu bytes of samples, want %zu for %lld x %lld%s", source->name,
                        n_have, n_want, nx, ny, n_have < n_want ? " (truncated?)" : "");
    status = dif_raw_allocate(source, nx, ny, raw, err);
    if (status)
        return status;
    const unsigned char *byte = source->data + n_header;
    for (size_t i = 0; i < n_want / 4; i++)
        raw->z[i] = float_from_little(byte + 4 * i);
    return DIF_OK;
}

dif_status dif_gsf_read(const dif_source *source, dif_raw *raw, dif_error *err)
{
    *raw = dif_raw_empty("gsf");
    const size_t n_magic = sizeof MAGIC - 1;
    const unsigned char *nul = memchr(source->data, '\0', source->n);
    if (!dif_source_has(source, 0, MAGIC, n_magic) || !nul)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: the GSF header does not end with a NUL byte (truncated?)",
                        source->name);
    const gsf_header header = {source, (const char *)source->data + n_magic, (size_t)(nul - source->data) - n_magic};
    const size_t n_header = ((size_t)(nul - source->data) / 4 + 1) * 4;
    if (n_header > source->n)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: ends within its header (truncated?)", source->name);
    for (const unsigned char *pad = nul; pad < source->data + n_header; pad++) {
        if (*pad)
            return dif_fail(err, DIF_ERR_FORMAT, "%s: the GSF header is not padded with NUL bytes", source->name);
    }
    long long nx = 0, ny = 0;
    dif_status status = read_count(&header, "XRes", &nx, err);
    if (!status)
        status = read_count(&header, "YRes", &ny, err);
    if (!status)
        status = read_samples(&header, n_header, nx, ny, raw, err);
    if (!status)
        status = read_scale(&header, raw, err);
    if (status) {
        dif_raw_free(raw);
        return status;
    }
    size_t n_title = 0;
    const char *title = find_value(header.text, header.n, "Title", &n_title);
    if (title)
        dif_raw_set_title(raw, title, n_title);
    return DIF_OK;
}

static size_t header_room(const dif_manifest *manifest)
{
    size_t n = 512;
    for (int i = 0; manifest && i < manifest->n; i++)
        n += strlen(manifest->item[i].key) + strlen(manifest->item[i].value) + 32;
    return n;
}

/* Writes the header lines into text[room]; returns their length. */
static size_t put_header(const dif_field *field, const dif_manifest *manifest, char *text, size_t room)
{
    char x_real[DIF_NUMBER_SIZE], y_real[DIF_NUMBER_SIZE];
    dif_number_print_short(field->nx * field->pitch_x_um / 1e6, x_real);
    dif_number_print_short(field->ny * field->pitch_y_um / 1e6, y_real);
    int n = snprintf(text, room,
                     "%sXRes = %d\nYRes = %d\nXReal = %s\nYReal = %s\nXYUnits = m\nZUnits = m\nTitle = height\n", MAGIC,
                     field->nx, field->ny, x_real, y_real);
    for (int i = 0; manifest && i < manifest->n; i++)
        n +=
            snprintf(text + n, room - (size_t)n, "diffbench.%s = %s\n", manifest->item[i].key, manifest->item[i].value);
    return (size_t)n;
}

dif_status dif_gsf_encode(const dif_field *field, const dif_manifest *manifest, unsigned char **data, size_t *n,
                          dif_error *err)
{
    const size_t room = header_room(manifest), n_sample = dif_field_n(field);
    unsigned char *out = dif_alloc(room + 4 * n_sample, 1);
    *data = NULL;
    if (!out)
        return dif_fail(err, DIF_ERR_NOMEM, "GSF of %d x %d samples", field->nx, field->ny);
    const size_t n_header = (put_header(field, manifest, (char *)out, room) / 4 + 1) * 4; /* the block is zero-filled */
    for (size_t i = 0; i < n_sample; i++) {
        const float z_m = (float)(field->z_um[i] / 1e6);
        uint32_t bits;
        memcpy(&bits, &z_m, sizeof bits);
        for (int k = 0; k < 4; k++)
            out[n_header + 4 * i + (size_t)k] = (unsigned char)(bits >> (8 * k));
    }
    *data = out;
    *n = n_header + 4 * n_sample;
    return DIF_OK;
}
