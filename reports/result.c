#include "reports/result.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/field_io.h"
#include "core/io/file.h"
#include "core/io/table_io.h"

enum { PATH_SIZE = 4096 };
static const size_t file_size_max = (size_t)1 << 30;

const json_t *dif_result_at(const json_t *doc, const char *path)
{
    char key[64];
    while (doc && *path) {
        const size_t n = strcspn(path, ".");
        if (n >= sizeof key)
            return NULL;
        memcpy(key, path, n);
        key[n] = '\0';
        doc = json_object_get(doc, key);
        path += n + (path[n] == '.');
    }
    return doc;
}

double dif_result_number(const json_t *doc, const char *path)
{
    const json_t *at = dif_result_at(doc, path);
    return json_is_number(at) ? json_number_value(at) : (double)NAN;
}

const char *dif_result_text(const json_t *doc, const char *path)
{
    const json_t *at = dif_result_at(doc, path);
    return json_is_string(at) ? json_string_value(at) : "";
}

bool dif_result_true(const json_t *doc, const char *path)
{
    return json_is_true(dif_result_at(doc, path));
}

/* FOLDER/NAME, refusing names that leave the folder. */
static dif_status join(const char *folder, const char *name, char path[PATH_SIZE], dif_error *err)
{
    if (!*name || *name == '.' || strchr(name, '/'))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: \"%s\" is not the name of a result file", folder, name);
    const int n = snprintf(path, PATH_SIZE, "%s/%s", folder, name);
    if (n < 0 || n >= PATH_SIZE)
        return dif_fail(err, DIF_ERR_SIZE, "%.100s...: path too long", folder);
    return DIF_OK;
}

static dif_status load_json(const char *path, const char *schema, json_t **out, dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    dif_status status = dif_file_read(path, file_size_max, &data, &n, err);
    if (status != DIF_OK)
        return status;
    json_error_t why;
    json_t *doc = json_loadb((const char *)data, n, JSON_REJECT_DUPLICATES, &why);
    dif_release(data);
    if (!doc)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: line %d: %s", path, why.line, why.text);
    if (strcmp(dif_result_text(doc, "schema"), schema) != 0) {
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: not a result file: \"schema\" is not \"%s\"", path, schema);
        json_decref(doc);
        return status;
    }
    *out = doc;
    return DIF_OK;
}

dif_status dif_result_list_load(const char *folder, json_t **list, dif_error *err)
{
    *list = NULL;
    char path[PATH_SIZE];
    dif_status status = join(folder, "results.json", path, err);
    if (status == DIF_OK)
        status = load_json(path, DIF_RESULT_LIST_SCHEMA, list, err);
    if (status != DIF_OK)
        return status;
    const json_t *surfaces = dif_result_at(*list, "surfaces");
    size_t i;
    json_t *name;
    if (!json_is_object(dif_result_at(*list, "provenance")))
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: no \"provenance\" in it", path);
    if (!json_is_array(surfaces) || json_array_size(surfaces) == 0)
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: \"surfaces\" is not a list of file names", path);
    json_array_foreach(surfaces, i, name)
    {
        if (!json_is_string(name))
            status = dif_fail(err, DIF_ERR_FORMAT, "%s: \"surfaces\"[%zu] is not a file name", path, i);
    }
    if (status != DIF_OK) {
        json_decref(*list);
        *list = NULL;
    }
    return status;
}

/* One line of numbers into row[n_column]; false if it is anything else. */
static bool parse_row(const char *line, const char *end, int n_column, double *row)
{
    for (int i = 0; i < n_column; i++) {
        char *stop;
        row[i] = strtod(line, &stop);
        if (stop == line || stop > end)
            return false;
        if (i + 1 < n_column) {
            if (*stop != ',')
                return false;
            stop++;
        }
        line = stop;
    }
    return line == end;
}

static dif_status parse_columns(const char *path, const char *text, const char *header, dif_columns *out,
                                dif_error *err)
{
    bool has_header = false;
    int n_line = 0;
    while (*text) {
        n_line++;
        const char *end = text + strcspn(text, "\n");
        const char *next = *end ? end + 1 : end;
        if (end > text && end[-1] == '\r')
            end--;
        if (*text != '#' && end > text) {
            const size_t n = (size_t)(end - text);
            if (!has_header) {
                if (n != strlen(header) || strncmp(text, header, n) != 0)
                    return dif_fail(err, DIF_ERR_FORMAT, "%s: line %d: want the columns %s", path, n_line, header);
                has_header = true;
            } else if (!parse_row(text, end, out->n_column, out->value + (size_t)out->n_row * (size_t)out->n_column)) {
                return dif_fail(err, DIF_ERR_FORMAT, "%s: line %d: want %d numbers", path, n_line, out->n_column);
            } else {
                out->n_row++;
            }
        }
        text = next;
    }
    return has_header ? DIF_OK : dif_fail(err, DIF_ERR_FORMAT, "%s: want the columns %s", path, header);
}

dif_status dif_columns_read(const char *path, const char *header, int n_column, dif_columns *out, dif_error *err)
{
    *out = (dif_columns){.n_column = n_column};
    unsigned char *data = NULL;
    size_t n = 0, n_line = 1;
    dif_status status = dif_file_read(path, file_size_max, &data, &n, err);
    if (status != DIF_OK)
        return status;
    for (size_t i = 0; i < n; i++)
        n_line += data[i] == '\n';
    out->value = dif_alloc(n_line, (size_t)n_column * sizeof(double));
    if (!out->value)
        status = dif_fail(err, DIF_ERR_NOMEM, "%s: %zu lines", path, n_line);
    else if (n_line > INT_MAX)
        status = dif_fail(err, DIF_ERR_SIZE, "%s: %zu lines", path, n_line);
    else
        status = parse_columns(path, (const char *)data, header, out, err);
    dif_release(data);
    if (status != DIF_OK)
        dif_columns_free(out);
    return status;
}

void dif_columns_free(dif_columns *columns)
{
    if (!columns)
        return;
    dif_release(columns->value);
    *columns = (dif_columns){0};
}

/* The parts that a surface's page is made of. */
static dif_status check_parts(const char *path, const json_t *doc, dif_error *err)
{
    static const char *const parts[] = {"files",       "surface", "plan",   "measure", "check",      "fit_table",
                                        "fit_surface", "maxima",  "energy", "domain",  "provenance", "verdicts"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const json_t *part = json_object_get(doc, parts[i]);
        if (!json_is_object(part) && !json_is_array(part))
            return dif_fail(err, DIF_ERR_FORMAT, "%s: no \"%s\" in it", path, parts[i]);
    }
    return DIF_OK;
}

static dif_status load_height(const char *path, dif_field *field, dif_error *err)
{
    const dif_field_request request = dif_field_request_default();
    dif_field_file file;
    dif_status status = dif_field_read(path, &request, &file, err);
    if (status != DIF_OK)
        return status;
    *field = file.field;
    file.field = (dif_field){0};
    dif_field_file_free(&file);
    return DIF_OK;
}

static dif_status load_table(const char *path, dif_table *table, dif_error *err)
{
    dif_manifest manifest = {0};
    const dif_status status = dif_table_read(path, table, &manifest, err);
    dif_manifest_free(&manifest);
    return status;
}

static dif_status load_files(const char *folder, dif_result *out, dif_error *err)
{
    char path[PATH_SIZE];
    dif_status status = join(folder, dif_result_text(out->doc, "files.height"), path, err);
    if (status == DIF_OK)
        status = load_height(path, &out->field, err);
    if (status == DIF_OK)
        status = join(folder, dif_result_text(out->doc, "files.table"), path, err);
    if (status == DIF_OK)
        status = load_table(path, &out->table, err);
    if (status == DIF_OK)
        status = join(folder, dif_result_text(out->doc, "files.maxima"), path, err);
    if (status == DIF_OK)
        status = dif_columns_read(path, DIF_RESULT_MAXIMA_HEADER, DIF_MAXIMA_N, &out->maxima, err);
    if (status == DIF_OK)
        status = join(folder, dif_result_text(out->doc, "files.lines"), path, err);
    if (status == DIF_OK)
        status = dif_columns_read(path, DIF_RESULT_LINES_HEADER, DIF_LINES_N, &out->lines, err);
    return status;
}

dif_status dif_result_doc_load(const char *folder, const char *name, json_t **doc, dif_error *err)
{
    *doc = NULL;
    char path[PATH_SIZE];
    dif_status status = join(folder, name, path, err);
    if (status == DIF_OK)
        status = load_json(path, DIF_RESULT_SCHEMA, doc, err);
    if (status == DIF_OK)
        status = check_parts(path, *doc, err);
    if (status != DIF_OK) {
        json_decref(*doc);
        *doc = NULL;
    }
    return status;
}

dif_status dif_result_load(const char *folder, const char *name, dif_result *out, dif_error *err)
{
    *out = (dif_result){.folder = folder};
    dif_status status = dif_result_doc_load(folder, name, &out->doc, err);
    if (status == DIF_OK)
        status = load_files(folder, out, err);
    if (status != DIF_OK)
        dif_result_free(out);
    return status;
}

void dif_result_free(dif_result *result)
{
    if (!result)
        return;
    json_decref(result->doc);
    dif_field_free(&result->field);
    dif_table_free(&result->table);
    dif_columns_free(&result->maxima);
    dif_columns_free(&result->lines);
    *result = (dif_result){0};
}

/* Big-endian, as PNG has it. */
static unsigned long be32(const unsigned char *at)
{
    return (unsigned long)at[0] << 24 | (unsigned long)at[1] << 16 | (unsigned long)at[2] << 8 | (unsigned long)at[3];
}

/* Signature, header with a size, and the end mark in its place. */
static dif_status check_png(const char *path, dif_picture *picture, dif_error *err)
{
    static const unsigned char head[] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR", tail[] = "\0\0\0\0IEND\xae\x42\x60\x82";
    const size_t n_head = sizeof head - 1, n_tail = sizeof tail - 1;
    if (picture->n < n_head + 8 || memcmp(picture->png, head, n_head) != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: not a PNG picture", path);
    const unsigned long nx = be32(picture->png + n_head), ny = be32(picture->png + n_head + 4);
    if (nx < 1 || ny < 1 || nx > 65536 || ny > 65536)
        return dif_fail(err, DIF_ERR_SIZE, "%s: a picture of %lu x %lu pixels, want 1 ... 65536", path, nx, ny);
    if (picture->n < n_head + 8 + n_tail || memcmp(picture->png + picture->n - n_tail, tail, n_tail) != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: the picture ends early", path);
    picture->nx = (int)nx;
    picture->ny = (int)ny;
    return DIF_OK;
}

dif_status dif_picture_load(const dif_result *result, const char *name, dif_picture *out, dif_error *err)
{
    char path[PATH_SIZE];
    *out = (dif_picture){0};
    dif_status status = join(result->folder, name, path, err);
    if (status == DIF_OK)
        status = dif_file_read(path, file_size_max, &out->png, &out->n, err);
    if (status == DIF_OK)
        status = check_png(path, out, err);
    if (status != DIF_OK)
        dif_picture_free(out);
    return status;
}

void dif_picture_free(dif_picture *picture)
{
    if (!picture)
        return;
    dif_release(picture->png);
    *picture = (dif_picture){0};
}
