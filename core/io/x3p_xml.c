#include "core/io/x3p_xml.h"

#include <expat.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/field_raw.h"
#include "core/io/number.h"

enum { PATH_SIZE = 256, TOKEN_MAX = 1 << 20, XML_BASE_MAX = 1 << 24, XML_POINT_MAX = 128, BLOCK_HEAD = 64 };

struct dif_x3p_parser {
    const dif_source *source;
    dif_x3p_document *document;
    XML_Parser expat;
    char path[PATH_SIZE]; /* of the element being read: "/Record1/Revision", without the root and prefixes */
    size_t n_path;
    int depth;
    int row;                 /* of LEAVES, whose text is being read; -1 = none */
    char text[DIF_X3P_TEXT]; /* text[n_text] of that element                   */
    size_t n_text;
    long long n_taken;
    dif_status status; /* of the first failure in a callback */
    dif_error *err;    /* of the call in progress            */
};

/* The elements that matter. Numbers are doubles, texts have DIF_X3P_TEXT bytes. */
typedef enum leaf_kind { LEAF_TEXT, LEAF_NUMBER, LEAF_DATUM } leaf_kind;

#define AT(member) offsetof(dif_x3p_document, member)
static const struct {
    const char *path;
    leaf_kind kind;
    size_t at;
} LEAVES[] = {
    {"/Record1/Revision", LEAF_TEXT, AT(revision)},
    {"/Record1/FeatureType", LEAF_TEXT, AT(feature)},
    {"/Record1/Axes/CX/AxisType", LEAF_TEXT, AT(x.axis_type)},
    {"/Record1/Axes/CX/Increment", LEAF_NUMBER, AT(x.increment)},
    {"/Record1/Axes/CY/AxisType", LEAF_TEXT, AT(y.axis_type)},
    {"/Record1/Axes/CY/Increment", LEAF_NUMBER, AT(y.increment)},
    {"/Record1/Axes/CZ/AxisType", LEAF_TEXT, AT(z.axis_type)},
    {"/Record1/Axes/CZ/DataType", LEAF_TEXT, AT(z.data_type)},
    {"/Record1/Axes/CZ/Increment", LEAF_NUMBER, AT(z.increment)},
    {"/Record1/Axes/CZ/Offset", LEAF_NUMBER, AT(z.offset)},
    {"/Record3/MatrixDimension/SizeX", LEAF_NUMBER, AT(nx)},
    {"/Record3/MatrixDimension/SizeY", LEAF_NUMBER, AT(ny)},
    {"/Record3/MatrixDimension/SizeZ", LEAF_NUMBER, AT(nz)},
    {"/Record3/DataLink/PointDataLink", LEAF_TEXT, AT(points)},
    {"/Record3/DataLink/MD5ChecksumPointData", LEAF_TEXT, AT(points_md5)},
    {"/Record3/DataLink/ValidPointsLink", LEAF_TEXT, AT(valid)},
    {"/Record3/DataLink/MD5ChecksumValidPoints", LEAF_TEXT, AT(valid_md5)},
    {"/Record3/DataList/Datum", LEAF_DATUM, 0},
    {"/Record4/ChecksumFile", LEAF_TEXT, AT(checksum)},
};
#undef AT

/* Expat wants to resize blocks, so each carries its size. */
static void *heap_take(size_t n)
{
    unsigned char *block = n <= SIZE_MAX - BLOCK_HEAD ? dif_alloc(n + BLOCK_HEAD, 1) : NULL;
    if (!block)
        return NULL;
    memcpy(block, &n, sizeof n);
    return block + BLOCK_HEAD;
}

static void heap_give(void *block)
{
    if (block)
        dif_release((unsigned char *)block - BLOCK_HEAD);
}

static void *heap_resize(void *block, size_t n)
{
    size_t n_old = 0;
    void *grown = heap_take(n);
    if (!grown || !block)
        return grown;
    memcpy(&n_old, (unsigned char *)block - BLOCK_HEAD, sizeof n_old);
    memcpy(grown, block, n < n_old ? n : n_old);
    heap_give(block);
    return grown;
}

/* Remembers the first failure of a callback and stops expat. */
static void stop(dif_x3p_parser *parser, dif_status status)
{
    if (!parser->status)
        parser->status = status;
    XML_StopParser(parser->expat, XML_FALSE);
}

static const char *local_name(const char *name)
{
    const char *colon = strrchr(name, ':');
    return colon ? colon + 1 : name;
}

static void on_start(void *self, const XML_Char *name, const XML_Char **attributes)
{
    (void)attributes;
    dif_x3p_parser *parser = self;
    const char *local = local_name(name), *file = parser->source->name;
    const size_t n = strlen(local);
    parser->row = -1;
    if (parser->depth++ == 0) {
        if (strcmp(local, "ISO5436_2") != 0)
            stop(parser,
                 dif_fail(parser->err, DIF_ERR_FORMAT, "%s: main.xml is a '%.40s', want ISO5436_2", file, local));
        return;
    }
    if (n + 2 > PATH_SIZE - parser->n_path) {
        stop(parser, dif_fail(parser->err, DIF_ERR_FORMAT, "%s: main.xml is nested too deeply", file));
        return;
    }
    parser->path[parser->n_path] = '/';
    memcpy(parser->path + parser->n_path + 1, local, n + 1);
    parser->n_path += n + 1;
    for (size_t i = 0; i < sizeof LEAVES / sizeof *LEAVES; i++) {
        if (strcmp(LEAVES[i].path, parser->path) == 0)
            parser->row = (int)i;
    }
    parser->n_text = 0;
}

static void on_text(void *self, const XML_Char *text, int n)
{
    dif_x3p_parser *parser = self;
    if (parser->row < 0)
        return;
    if ((size_t)n > sizeof parser->text - 1 - parser->n_text) {
        stop(parser, dif_fail(parser->err, DIF_ERR_FORMAT, "%s: %.60s of main.xml has more than %d characters",
                              parser->source->name, parser->path, (int)DIF_X3P_TEXT - 1));
        return;
    }
    memcpy(parser->text + parser->n_text, text, (size_t)n);
    parser->n_text += (size_t)n;
}

static dif_status push_value(dif_x3p_parser *parser, double value)
{
    dif_x3p_document *document = parser->document;
    if (document->n_value == document->n_room) {
        const size_t n_room = document->n_room ? 2 * document->n_room : 256;
        double *grown = dif_alloc(n_room, sizeof *grown);
        if (!grown)
            return dif_fail(parser->err, DIF_ERR_NOMEM, "%s: %zu points", parser->source->name, n_room);
        if (document->n_value)
            memcpy(grown, document->value, document->n_value * sizeof *grown);
        dif_release(document->value);
        document->value = grown;
        document->n_room = n_room;
    }
    document->value[document->n_value++] = value;
    return DIF_OK;
}

static double n_point_of(const dif_x3p_document *document)
{
    const double n = document->nx * document->ny * (isnan(document->nz) ? 1.0 : document->nz);
    return n > 0.0 ? fmin(n, DIF_FIELD_SAMPLES_MAX) : 0.0;
}

/* One point "x;y;z" or "z"; nothing is a point that was not measured. */
static dif_status take_datum(dif_x3p_parser *parser, const char *text, size_t n)
{
    if ((double)parser->document->n_value >= n_point_of(parser->document))
        return dif_fail(parser->err, DIF_ERR_FORMAT, "%s: more points in the list than SizeX SizeY SizeZ = %.15g",
                        parser->source->name, n_point_of(parser->document));
    double value = NAN;
    const char *z = text + n;
    while (z > text && z[-1] != ';')
        z--;
    const size_t n_z = (size_t)(text + n - z);
    if (n_z == 0)
        return push_value(parser, NAN);
    if (!dif_number_all(z, n_z, '.', &value)) {
        char quote[DIF_QUOTE_SIZE];
        dif_quote(text, n, quote);
        return dif_fail(parser->err, DIF_ERR_FORMAT, "%s: point %zu is '%s', want numbers", parser->source->name,
                        parser->document->n_value + 1, quote);
    }
    return push_value(parser, value);
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

static dif_status take_leaf(dif_x3p_parser *parser)
{
    const char *text = parser->text;
    size_t n = parser->n_text;
    for (; n > 0 && is_blank(*text); text++)
        n--;
    while (n > 0 && is_blank(text[n - 1]))
        n--;
    unsigned char *target = (unsigned char *)parser->document + LEAVES[parser->row].at;
    if (LEAVES[parser->row].kind == LEAF_DATUM)
        return take_datum(parser, text, n);
    if (LEAVES[parser->row].kind == LEAF_TEXT) {
        memcpy(target, text, n);
        target[n] = '\0';
        return DIF_OK;
    }
    double value = NAN;
    if (n > 0 && (!dif_number_all(text, n, '.', &value) || !isfinite(value))) {
        char quote[DIF_QUOTE_SIZE];
        dif_quote(text, n, quote);
        return dif_fail(parser->err, DIF_ERR_FORMAT, "%s: %.60s is '%s', want a finite number", parser->source->name,
                        parser->path + 1, quote);
    }
    memcpy(target, &value, sizeof value);
    return DIF_OK;
}

static void on_end(void *self, const XML_Char *name)
{
    (void)name;
    dif_x3p_parser *parser = self;
    if (parser->row >= 0) {
        const dif_status status = take_leaf(parser);
        if (status)
            stop(parser, status);
    }
    parser->row = -1;
    parser->depth--;
    while (parser->n_path > 0 && parser->path[parser->n_path] != '/')
        parser->n_path--;
    parser->path[parser->n_path] = '\0';
}

static void on_doctype(void *self, const XML_Char *name, const XML_Char *system, const XML_Char *public,
                       int has_internal)
{
    (void)name, (void)system, (void)public, (void)has_internal;
    dif_x3p_parser *parser = self;
    stop(parser, dif_fail(parser->err, DIF_ERR_FORMAT,
                          "%s: main.xml declares a document type, which is not read: its entities can grow without end",
                          parser->source->name));
}

dif_status dif_x3p_parser_create(const dif_source *source, dif_x3p_document *document, dif_x3p_parser **out,
                                 dif_error *err)
{
    static const XML_Memory_Handling_Suite HEAP = {heap_take, heap_resize, heap_give};
    const dif_x3p_axis nothing = {.increment = NAN, .offset = NAN};
    *document = (dif_x3p_document){.x = nothing, .y = nothing, .z = nothing, .nx = NAN, .ny = NAN, .nz = NAN};
    dif_x3p_parser *parser = dif_alloc(1, sizeof *parser);
    *out = NULL;
    if (parser)
        parser->expat = XML_ParserCreate_MM(NULL, &HEAP, NULL);
    if (!parser || !parser->expat) {
        dif_release(parser);
        return dif_fail(err, DIF_ERR_NOMEM, "%s: reading main.xml", source->name);
    }
    parser->source = source;
    parser->document = document;
    parser->row = -1;
    XML_SetUserData(parser->expat, parser);
    XML_SetElementHandler(parser->expat, on_start, on_end);
    XML_SetCharacterDataHandler(parser->expat, on_text);
    XML_SetStartDoctypeDeclHandler(parser->expat, on_doctype);
    *out = parser;
    return DIF_OK;
}

void dif_x3p_parser_free(dif_x3p_parser *parser)
{
    if (!parser)
        return;
    XML_ParserFree(parser->expat);
    dif_release(parser);
}

void dif_x3p_document_free(dif_x3p_document *document)
{
    dif_release(document->value);
    *document = (dif_x3p_document){0};
}

static dif_status feed(dif_x3p_parser *parser, const void *text, size_t n, int is_last, dif_error *err)
{
    parser->err = err;
    if (XML_Parse(parser->expat, text, (int)n, is_last) != XML_STATUS_ERROR)
        return DIF_OK;
    if (parser->status)
        return parser->status;
    const enum XML_Error code = XML_GetErrorCode(parser->expat);
    return dif_fail(err, code == XML_ERROR_NO_MEMORY ? DIF_ERR_NOMEM : DIF_ERR_FORMAT, "%s: main.xml, line %lu: %.60s",
                    parser->source->name, (unsigned long)XML_GetCurrentLineNumber(parser->expat),
                    XML_ErrorString(code));
}

dif_status dif_x3p_parser_take(void *self, const unsigned char *text, size_t n, dif_error *err)
{
    dif_x3p_parser *parser = self;
    const double n_max = XML_BASE_MAX + XML_POINT_MAX * n_point_of(parser->document);
    parser->n_taken += (long long)n;
    if ((double)parser->n_taken > n_max)
        return dif_fail(err, DIF_ERR_SIZE, "%s: main.xml has more than %.15g bytes, which is the most for %.15g points",
                        parser->source->name, n_max, n_point_of(parser->document));
    const dif_status status = feed(parser, text, n, 0, err);
    if (status)
        return status;
    if (parser->n_taken - XML_GetCurrentByteIndex(parser->expat) > TOKEN_MAX) /* expat keeps what is not complete */
        return dif_fail(err, DIF_ERR_SIZE, "%s: main.xml, line %lu: one token of more than %d bytes",
                        parser->source->name, (unsigned long)XML_GetCurrentLineNumber(parser->expat), (int)TOKEN_MAX);
    return DIF_OK;
}

dif_status dif_x3p_parser_end(dif_x3p_parser *parser, dif_error *err)
{
    return feed(parser, "", 0, 1, err);
}
