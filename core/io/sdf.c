/* Surface Data File (ISO 25178-71, before that BCR): the binary form behind 81 packed bytes, and the text form. */
#include <math.h>
#include <string.h>

#include "core/io/field_raw.h"
#include "core/io/number.h"
#include "core/io/sample.h"

enum { MAGIC_SIZE = 8, BINARY_HEADER = 81, KEY_SIZE = 16, LINE_SIZE = 256 };
enum { AT_POINTS = 42, AT_PROFILES = 44, AT_X_SCALE = 46, AT_Y_SCALE = 54, AT_Z_SCALE = 62, AT_TYPES = 78 };

typedef struct sdf_header {
    double n_point, n_profile;          /* NaN = not said                     */
    double x_scale, y_scale, z_scale;   /* metres a sample, a profile, a unit */
    double compression, type, checksum; /* of the file's numbers              */
} sdf_header;

static bool is_text_form(const dif_source *source)
{
    return dif_source_has(source, 0, "a", 1);
}

/* What the header says, as far as it can be right. A scale of zero is none. */
static dif_status take_header(const dif_source *source, const sdf_header *header, dif_raw *raw, dif_error *err)
{
    if (header->compression != 0.0)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: SDF with compression %g, want 0 (none)", source->name,
                        header->compression);
    if (header->checksum != 0.0)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: SDF with check sum of kind %g, want 0 (none)", source->name,
                        header->checksum);
    if (!(header->type >= 0.0 && header->type < (double)DIF_SAMPLE_KINDS && header->type == floor(header->type)))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: SDF with DataType %g, want 0 to 7", source->name, header->type);
    const double sides[2] = {header->n_point, header->n_profile};
    static const char *const NAMES[2] = {"NumPoints", "NumProfiles"};
    for (int i = 0; i < 2; i++) {
        if (isnan(sides[i]))
            return dif_fail(err, DIF_ERR_FORMAT, "%s: no %s in the SDF header", source->name, NAMES[i]);
        if (!(fabs(sides[i]) < 1e15 && sides[i] == floor(sides[i])))
            return dif_fail(err, DIF_ERR_FORMAT, "%s: %s is %g, want a whole number", source->name, NAMES[i], sides[i]);
    }
    if (header->x_scale < 0.0 || header->y_scale < 0.0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: Xscale, Yscale are %g, %g m, want > 0", source->name, header->x_scale,
                        header->y_scale);
    if (isfinite(header->x_scale * header->y_scale) && header->x_scale != 0.0 && header->y_scale != 0.0) {
        raw->pitch_x_um = header->x_scale * 1e6;
        raw->pitch_y_um = header->y_scale * 1e6;
    }
    if (isfinite(header->z_scale) && header->z_scale != 0.0)
        raw->unit_um = header->z_scale * 1e6;
    return dif_raw_check_size(source, (long long)header->n_point, (long long)header->n_profile, err);
}

static double number_at(const dif_source *source, size_t at, dif_sample_kind kind)
{
    double value = 0.0;
    dif_sample_read(kind, source->data + at, 1, &value);
    return value;
}

/* Integer types keep their lowest value for points that were not measured. */
static void mark_missing(dif_sample_kind kind, dif_raw *raw)
{
    if (kind != DIF_SAMPLE_S16 && kind != DIF_SAMPLE_S32)
        return;
    const double missing = kind == DIF_SAMPLE_S16 ? -32768.0 : -2147483648.0;
    const size_t n = (size_t)raw->nx * (size_t)raw->ny;
    for (size_t i = 0; i < n; i++) {
        if (raw->z[i] == missing)
            raw->z[i] = NAN;
    }
}

static dif_status read_binary(const dif_source *source, dif_raw *raw, dif_error *err)
{
    if (source->n < BINARY_HEADER)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: ends within its SDF header of %d bytes (truncated?)", source->name,
                        (int)BINARY_HEADER);
    const unsigned char *types = source->data + AT_TYPES;
    const sdf_header header = {
        .n_point = number_at(source, AT_POINTS, DIF_SAMPLE_U16),
        .n_profile = number_at(source, AT_PROFILES, DIF_SAMPLE_U16),
        .x_scale = number_at(source, AT_X_SCALE, DIF_SAMPLE_F64),
        .y_scale = number_at(source, AT_Y_SCALE, DIF_SAMPLE_F64),
        .z_scale = number_at(source, AT_Z_SCALE, DIF_SAMPLE_F64),
        .compression = types[0],
        .type = types[1],
        .checksum = types[2],
    };
    dif_status status = take_header(source, &header, raw, err);
    if (status)
        return status;
    const dif_sample_kind kind = (dif_sample_kind)types[1];
    const long long nx = (long long)header.n_point, ny = (long long)header.n_profile;
    const size_t n = (size_t)nx * (size_t)ny, n_want = n * dif_sample_size(kind), n_have = source->n - BINARY_HEADER;
    if (n_have < n_want) /* a trailer of remarks may follow */
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %zu bytes of samples, want %zu for %lld x %lld (truncated?)",
                        source->name, n_have, n_want, nx, ny);
    status = dif_raw_allocate(source, nx, ny, raw, err);
    if (status)
        return status;
    dif_sample_read(kind, source->data + BINARY_HEADER, n, raw->z);
    mark_missing(kind, raw);
    return DIF_OK;
}

/* What is left of the text. */
typedef struct text_part {
    const char *at, *end;
} text_part;

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\0';
}

/* The next line without blanks around it; false at the end. */
static bool next_line(text_part *part, text_part *line)
{
    if (part->at >= part->end)
        return false;
    const char *stop = memchr(part->at, '\n', (size_t)(part->end - part->at));
    stop = stop ? stop : part->end;
    *line = (text_part){part->at, stop};
    part->at = stop < part->end ? stop + 1 : stop;
    while (line->at < line->end && is_blank(*line->at))
        line->at++;
    while (line->at < line->end && is_blank(line->end[-1]))
        line->end--;
    return true;
}

/* Case of letters does not count in keys. */
static bool is_key(const char *text, size_t n, const char *key)
{
    if (strlen(key) != n)
        return false;
    for (size_t i = 0; i < n; i++) {
        const char c = text[i] >= 'A' && text[i] <= 'Z' ? (char)(text[i] + 32) : text[i];
        if (c != key[i])
            return false;
    }
    return true;
}

/* Takes "Key = value"; a key that is not of use is left alone. */
static dif_status take_line(const dif_source *source, text_part line, sdf_header *header, dif_error *err)
{
    const struct {
        const char *key;
        double *value;
    } keys[] = {
        {"numpoints", &header->n_point},       {"numprofiles", &header->n_profile}, {"xscale", &header->x_scale},
        {"yscale", &header->y_scale},          {"zscale", &header->z_scale},        {"datatype", &header->type},
        {"compression", &header->compression}, {"checktype", &header->checksum},
    };
    char quote[DIF_QUOTE_SIZE];
    dif_quote(line.at, (size_t)(line.end - line.at), quote);
    const char *equal = line.at < line.end ? memchr(line.at, '=', (size_t)(line.end - line.at)) : NULL;
    if (!equal)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: SDF header line '%s', want key = value", source->name, quote);
    const char *key_end = equal;
    while (key_end > line.at && is_blank(key_end[-1]))
        key_end--;
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        if (!is_key(line.at, (size_t)(key_end - line.at), keys[i].key))
            continue;
        if (!dif_number_all(equal + 1, (size_t)(line.end - equal - 1), '.', keys[i].value))
            return dif_fail(err, DIF_ERR_FORMAT, "%s: SDF header line '%s', want a number", source->name, quote);
    }
    return DIF_OK;
}

/* Reads up to the line "*" that ends the header; *part is left behind it. */
static dif_status read_text_header(const dif_source *source, text_part *part, sdf_header *header, dif_error *err)
{
    text_part line;
    while (next_line(part, &line)) {
        if (line.at == line.end || *line.at == ';')
            continue;
        if (*line.at == '*')
            return DIF_OK;
        const dif_status status = take_line(source, line, header, err);
        if (status)
            return status;
    }
    return dif_fail(err, DIF_ERR_FORMAT, "%s: the SDF header does not end with a line '*' (truncated?)", source->name);
}

/* The next word of the numbers: empty at their end, which is a "*" or that of the file. Remarks run from ; to the end of
 * a line. */
static text_part next_word(text_part *part)
{
    text_part word = {part->end, part->end};
    while (part->at < part->end && (is_blank(*part->at) || *part->at == ';')) {
        const bool is_remark = *part->at == ';';
        do
            part->at++;
        while (is_remark && part->at < part->end && *part->at != '\n');
    }
    if (part->at >= part->end || *part->at == '*')
        return word;
    word.at = part->at;
    while (part->at < part->end && !is_blank(*part->at))
        part->at++;
    word.end = part->at;
    return word;
}

static bool take_number(text_part word, double *value)
{
    const size_t n = (size_t)(word.end - word.at);
    if (is_key(word.at, n, "bad")) {
        *value = NAN;
        return true;
    }
    return dif_number_parse(word.at, word.end, '.', value) == word.end;
}

static dif_status read_text_numbers(const dif_source *source, text_part *part, dif_raw *raw, dif_error *err)
{
    const size_t n = (size_t)raw->nx * (size_t)raw->ny;
    char quote[DIF_QUOTE_SIZE];
    for (size_t i = 0; i < n; i++) {
        const text_part word = next_word(part);
        if (word.at == word.end)
            return dif_fail(err, DIF_ERR_FORMAT, "%s: %zu numbers, want %zu for %d x %d (truncated?)", source->name, i,
                            n, raw->nx, raw->ny);
        if (!take_number(word, &raw->z[i])) {
            dif_quote(word.at, (size_t)(word.end - word.at), quote);
            return dif_fail(err, DIF_ERR_FORMAT, "%s: number %zu is '%s', want a number or BAD", source->name, i + 1,
                            quote);
        }
    }
    const text_part more = next_word(part);
    if (more.at == more.end)
        return DIF_OK;
    dif_quote(more.at, (size_t)(more.end - more.at), quote);
    return dif_fail(err, DIF_ERR_FORMAT, "%s: '%s' after %zu numbers, want a line '*'", source->name, quote, n);
}

static dif_status read_text(const dif_source *source, dif_raw *raw, dif_error *err)
{
    const char *text = (const char *)source->data;
    text_part part = {text, text + source->n}, line;
    sdf_header header = {.n_point = NAN, .n_profile = NAN, .x_scale = NAN, .y_scale = NAN, .z_scale = NAN};
    (void)next_line(&part, &line); /* the magic one */
    dif_status status = read_text_header(source, &part, &header, err);
    if (!status)
        status = take_header(source, &header, raw, err);
    if (status)
        return status;
    const size_t n = (size_t)header.n_point * (size_t)header.n_profile, n_left = (size_t)(part.end - part.at);
    if (n_left < 2 * n - 1) /* a digit and a blank each, before memory is asked for */
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %zu bytes of numbers, too few for %g x %g (truncated?)", source->name,
                        n_left, header.n_point, header.n_profile);
    status = dif_raw_allocate(source, (long long)header.n_point, (long long)header.n_profile, raw, err);
    return status ? status : read_text_numbers(source, &part, raw, err);
}

bool dif_sdf_is(const dif_source *source)
{
    return source->n >= MAGIC_SIZE && (source->data[0] == 'a' || source->data[0] == 'b') &&
           (dif_source_has(source, 1, "BCR-", 4) || dif_source_has(source, 1, "ISO-", 4));
}

dif_status dif_sdf_read(const dif_source *source, dif_raw *raw, dif_error *err)
{
    *raw = dif_raw_empty("sdf");
    const dif_status status = (is_text_form(source) ? read_text : read_binary)(source, raw, err);
    if (status)
        dif_raw_free(raw);
    return status;
}
