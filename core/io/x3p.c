/* x3p (ISO 25178-72, ISO 5436-2): a zip archive of main.xml, which describes a matrix, and the file of its samples. */
#include "core/io/x3p.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/md5.h"
#include "core/io/sample.h"
#include "core/io/x3p_xml.h"
#include "core/io/zip.h"

enum { VALID_SPARE = 64 }; /* bytes that may follow the bitmap */

/* An opened file. */
typedef struct x3p {
    const dif_source *source;
    dif_zip *zip;
    dif_x3p_document document;
    size_t n_folder; /* main.xml lies in a folder with a path of so many characters */
    long long main;  /* its number in the archive                                   */
    int nx, ny, nz;
    dif_sample_kind kind;
    char main_md5[33];
    char warning[sizeof((dif_raw *)NULL)->warning];
} x3p;

bool dif_x3p_is(const dif_source *source)
{
    return dif_zip_is(source);
}

static void warn(x3p *file, const char *sentence)
{
    const size_t n = strlen(file->warning);
    if (n + strlen(sentence) + 3 <= sizeof file->warning)
        snprintf(file->warning + n, sizeof file->warning - n, "%s%s", n ? "; " : "", sentence);
}

/* main.xml goes to the parser and into its check sum. */
typedef struct main_sink {
    dif_x3p_parser *parser;
    dif_md5 sum;
} main_sink;

static dif_status take_main(void *self, const unsigned char *data, size_t n, dif_error *err)
{
    main_sink *sink = self;
    dif_md5_add(&sink->sum, data, n);
    return dif_x3p_parser_take(sink->parser, data, n, err);
}

static dif_status read_main(x3p *file, dif_error *err)
{
    main_sink sink = {.sum = dif_md5_begin()};
    file->main = dif_zip_find_name(file->zip, "main.xml", &file->n_folder);
    if (file->main < 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: a zip archive without main.xml: not an x3p surface",
                        file->source->name);
    dif_status status = dif_x3p_parser_create(file->source, &file->document, &sink.parser, err);
    if (!status)
        status = dif_zip_read(file->zip, file->main, take_main, &sink, err);
    if (!status)
        status = dif_x3p_parser_end(sink.parser, err);
    dif_x3p_parser_free(sink.parser);
    dif_md5_hex(&sink.sum, file->main_md5);
    return status;
}

/* A matrix whose x and y run in equal steps; profiles and clouds of points are something else. */
static dif_status check_feature(x3p *file, dif_error *err)
{
    const dif_x3p_document *document = &file->document;
    const char *name = file->source->name;
    if (document->feature[0] && strcmp(document->feature, "SUR") != 0)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: x3p with FeatureType %.20s, want SUR (a surface)", name,
                        document->feature);
    const dif_x3p_axis *axes[2] = {&document->x, &document->y};
    for (int i = 0; i < 2; i++) {
        if (axes[i]->axis_type[0] && strcmp(axes[i]->axis_type, "I") != 0)
            return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: x3p with AxisType %.20s along %c, want I (equal steps)",
                            name, axes[i]->axis_type, 'x' + i);
        if (axes[i]->increment < 0.0)
            return dif_fail(err, DIF_ERR_FORMAT, "%s: the increment along %c is %g m, want > 0", name, 'x' + i,
                            axes[i]->increment);
    }
    if (document->z.axis_type[0] && strcmp(document->z.axis_type, "A") != 0)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: x3p with AxisType %.20s along z, want A (heights)", name,
                        document->z.axis_type);
    /* "ISO5436 - 2000" is written with a hyphen or a dash; what may follow some day is no reason to refuse a file */
    if (strncmp(document->revision, "ISO5436", 7) != 0)
        warn(file, "main.xml names no revision of ISO5436");
    return DIF_OK;
}

static dif_status take_count(const x3p *file, const char *what, double said, double missing, int n_max, int *n,
                             dif_error *err)
{
    const double value = isnan(said) ? missing : said;
    if (isnan(value))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: no %s in main.xml", file->source->name, what);
    if (!(value >= 1.0 && value == floor(value)))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %s is %g, want a whole number >= 1", file->source->name, what, value);
    if (value > n_max)
        return dif_fail(err, DIF_ERR_SIZE, "%s: %s is %g, want at most %d", file->source->name, what, value, n_max);
    *n = (int)value;
    return DIF_OK;
}

static dif_status take_size(x3p *file, dif_error *err)
{
    static const struct {
        const char *name;
        dif_sample_kind kind;
    } TYPES[] = {{"I", DIF_SAMPLE_S16}, {"L", DIF_SAMPLE_S32}, {"F", DIF_SAMPLE_F32}, {"D", DIF_SAMPLE_F64}};
    const dif_x3p_document *document = &file->document;
    dif_status status = take_count(file, "SizeX", document->nx, NAN, DIF_FIELD_SIDE_MAX, &file->nx, err);
    if (!status)
        status = take_count(file, "SizeY", document->ny, NAN, DIF_FIELD_SIDE_MAX, &file->ny, err);
    if (!status)
        status = take_count(file, "SizeZ", document->nz, 1.0, DIF_CHANNELS_MAX, &file->nz, err);
    if (!status)
        status = dif_raw_check_size(file->source, file->nx, file->ny, err);
    if (status)
        return status;
    for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; i++) {
        if (strcmp(document->z.data_type, TYPES[i].name) == 0) {
            file->kind = TYPES[i].kind;
            return DIF_OK;
        }
    }
    if (!document->points[0])
        return DIF_OK; /* a list is text whatever its type */
    return dif_fail(err, DIF_ERR_FORMAT, "%s: the DataType of z is '%.20s', want I, L, F or D", file->source->name,
                    document->z.data_type);
}

/* The first word of a check sum's file. */
typedef struct word_sink {
    char word[DIF_X3P_TEXT];
    size_t n;
} word_sink;

static dif_status take_word(void *self, const unsigned char *data, size_t n, dif_error *err)
{
    (void)err;
    word_sink *sink = self;
    for (size_t i = 0; i < n && data[i] > ' ' && sink->n < sizeof sink->word - 1; i++)
        sink->word[sink->n++] = (char)data[i];
    return DIF_OK;
}

static bool is_same_sum(const char *said, const char *hex)
{
    for (size_t i = 0; i < 33; i++) {
        const char c = said[i] >= 'A' && said[i] <= 'F' ? (char)(said[i] + 32) : said[i];
        if (c != hex[i])
            return false;
    }
    return true;
}

/* A wrong sum is told and no more: programs that rewrite main.xml forget it, and zip has sums of its own. */
static void check_main_sum(x3p *file)
{
    word_sink sink = {.n = 0};
    const char *name = file->document.checksum[0] ? file->document.checksum : "md5checksum.hex";
    const char *folder = dif_zip_path(file->zip, file->main);
    const long long index = dif_zip_find(file->zip, folder, file->n_folder, name);
    unsigned long long n = 0;
    if (index < 0 || dif_zip_size(file->zip, index, &n, NULL) || n > DIF_ZIP_CHUNK ||
        dif_zip_read(file->zip, index, take_word, &sink, NULL))
        return; /* no sum, nothing to compare */
    if (sink.n > 0 && !is_same_sum(sink.word, file->main_md5))
        warn(file, "wrong MD5 check sum of main.xml");
}

static void close_x3p(x3p *file)
{
    dif_x3p_document_free(&file->document);
    dif_zip_close(file->zip);
    file->zip = NULL;
}

static dif_status open_x3p(const dif_source *source, x3p *file, dif_error *err)
{
    *file = (x3p){.source = source};
    dif_status status = dif_zip_open(source, &file->zip, err);
    if (!status)
        status = read_main(file, err);
    if (!status)
        status = check_feature(file, err);
    if (!status)
        status = take_size(file, err);
    if (status) {
        close_x3p(file);
        return status;
    }
    check_main_sum(file);
    return DIF_OK;
}

/* Samples of the layer that is read; they begin at sample `first` of the file. */
typedef struct point_sink {
    dif_sample_kind kind;
    size_t first, n, n_seen;
    double *z; /* z[n] */
    dif_md5 sum;
} point_sink;

/* Pieces hold whole samples: DIF_ZIP_CHUNK is a multiple of each size. */
static dif_status take_points(void *self, const unsigned char *data, size_t n, dif_error *err)
{
    (void)err;
    point_sink *sink = self;
    const size_t size = dif_sample_size(sink->kind), begin = sink->n_seen, end = begin + n / size;
    const size_t from = begin > sink->first ? begin : sink->first;
    const size_t to = end < sink->first + sink->n ? end : sink->first + sink->n;
    dif_md5_add(&sink->sum, data, n);
    if (from < to)
        dif_sample_read(sink->kind, data + (from - begin) * size, to - from, sink->z + (from - sink->first));
    sink->n_seen = end;
    return DIF_OK;
}

/* The number and size of a file that main.xml refers to. */
static dif_status find_linked(const x3p *file, const char *path, long long *index, unsigned long long *n,
                              dif_error *err)
{
    *index = dif_zip_find(file->zip, dif_zip_path(file->zip, file->main), file->n_folder, path);
    if (*index < 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: main.xml refers to '%.60s', which is not in the archive",
                        file->source->name, path);
    return dif_zip_size(file->zip, *index, n, err);
}

static dif_status read_points(x3p *file, int layer, dif_raw *raw, dif_error *err)
{
    const dif_x3p_document *document = &file->document;
    const size_t n = (size_t)file->nx * (size_t)file->ny;
    const unsigned long long n_want = (unsigned long long)n * (unsigned)file->nz * dif_sample_size(file->kind);
    unsigned long long n_have = 0;
    long long index = 0;
    dif_status status = find_linked(file, document->points, &index, &n_have, err);
    if (status)
        return status;
    if (n_have != n_want)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %llu bytes of samples, want %llu for %d x %d x %d of type %.20s",
                        file->source->name, n_have, n_want, file->nx, file->ny, file->nz, document->z.data_type);
    status = dif_raw_allocate(file->source, file->nx, file->ny, raw, err);
    if (status)
        return status;
    point_sink sink = {.kind = file->kind, .first = (size_t)layer * n, .n = n, .z = raw->z, .sum = dif_md5_begin()};
    status = dif_zip_read(file->zip, index, take_points, &sink, err);
    char hex[33];
    dif_md5_hex(&sink.sum, hex);
    if (!status && document->points_md5[0] && !is_same_sum(document->points_md5, hex))
        warn(file, "wrong MD5 check sum of the samples");
    return status;
}

/* Bits of points, lowest first; a bit of 0 is a point that was not measured. */
typedef struct valid_sink {
    size_t first, n, n_seen; /* in bits */
    double *z;
    dif_md5 sum;
} valid_sink;

static dif_status take_valid(void *self, const unsigned char *data, size_t n, dif_error *err)
{
    (void)err;
    valid_sink *sink = self;
    dif_md5_add(&sink->sum, data, n);
    for (size_t i = 0; i < 8 * n; i++) {
        const size_t at = sink->n_seen + i;
        if (at >= sink->first && at < sink->first + sink->n && !(data[i / 8] >> i % 8 & 1))
            sink->z[at - sink->first] = NAN;
    }
    sink->n_seen += 8 * n;
    return DIF_OK;
}

static dif_status read_valid(x3p *file, int layer, dif_raw *raw, dif_error *err)
{
    const dif_x3p_document *document = &file->document;
    const size_t n = (size_t)file->nx * (size_t)file->ny;
    const unsigned long long n_want = ((unsigned long long)n * (unsigned)file->nz + 7) / 8;
    unsigned long long n_have = 0;
    long long index = 0;
    dif_status status = find_linked(file, document->valid, &index, &n_have, err);
    if (status)
        return status;
    if (n_have < n_want || n_have > n_want + VALID_SPARE)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %llu bytes of valid points, want %llu for %d x %d x %d",
                        file->source->name, n_have, n_want, file->nx, file->ny, file->nz);
    valid_sink sink = {.first = (size_t)layer * n, .n = n, .z = raw->z, .sum = dif_md5_begin()};
    status = dif_zip_read(file->zip, index, take_valid, &sink, err);
    char hex[33];
    dif_md5_hex(&sink.sum, hex);
    if (!status && document->valid_md5[0] && !is_same_sum(document->valid_md5, hex))
        warn(file, "wrong MD5 check sum of the valid points");
    return status;
}

static dif_status take_list(x3p *file, int layer, dif_raw *raw, dif_error *err)
{
    const size_t n = (size_t)file->nx * (size_t)file->ny;
    if (file->document.n_value != n * (size_t)file->nz)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %zu points in main.xml, want %zu for %d x %d x %d",
                        file->source->name, file->document.n_value, n * (size_t)file->nz, file->nx, file->ny, file->nz);
    const dif_status status = dif_raw_allocate(file->source, file->nx, file->ny, raw, err);
    if (!status)
        memcpy(raw->z, file->document.value + (size_t)layer * n, n * sizeof *raw->z);
    return status;
}

/* Scale and offset of heights hold for every type, floating point included. */
static void take_scale(x3p *file, dif_raw *raw)
{
    const dif_x3p_axis *z = &file->document.z;
    const double increment = isnan(z->increment) ? 1.0 : z->increment, offset = isnan(z->offset) ? 0.0 : z->offset;
    const bool is_float = file->kind == DIF_SAMPLE_F32 || file->kind == DIF_SAMPLE_F64;
    if (file->document.x.increment > 0.0 && file->document.y.increment > 0.0) { /* else the file does not say */
        raw->pitch_x_um = file->document.x.increment * 1e6;
        raw->pitch_y_um = file->document.y.increment * 1e6;
    }
    if (increment != 0.0)
        raw->unit_um = increment * 1e6;
    raw->offset_um = offset * 1e6;
    if (is_float && increment != 1.0) {
        char sentence[80];
        snprintf(sentence, sizeof sentence, "floating-point heights are times the file's Increment of %.4g", increment);
        warn(file, sentence);
    }
}

static void name_layer(int layer, int n_layer, char name[DIF_CHANNEL_NAME_SIZE])
{
    name[0] = '\0';
    if (n_layer > 1)
        snprintf(name, DIF_CHANNEL_NAME_SIZE, "layer %d", layer + 1);
}

dif_status dif_x3p_list(const dif_source *source, dif_channels *out, dif_error *err)
{
    x3p file;
    dif_status status = open_x3p(source, &file, err);
    if (status)
        return status;
    dif_channel channel = {.unit = "m", .nx = file.nx, .ny = file.ny, .is_height = true};
    for (int i = 0; i < file.nz && !status; i++) {
        name_layer(i, file.nz, channel.name);
        status = dif_channels_add(source, &channel, out, err);
    }
    close_x3p(&file);
    return status;
}

dif_status dif_x3p_read(const dif_source *source, int index, dif_raw *raw, dif_error *err)
{
    x3p file;
    *raw = dif_raw_empty("x3p");
    dif_status status = open_x3p(source, &file, err);
    if (status)
        return status;
    char name[DIF_CHANNEL_NAME_SIZE];
    name_layer(index, file.nz, name);
    dif_raw_set_title(raw, name, strlen(name));
    status = (file.document.points[0] ? read_points : take_list)(&file, index, raw, err);
    if (!status && file.document.valid[0])
        status = read_valid(&file, index, raw, err);
    take_scale(&file, raw);
    memcpy(raw->warning, file.warning, sizeof raw->warning);
    close_x3p(&file);
    if (status)
        dif_raw_free(raw);
    return status;
}
