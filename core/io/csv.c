#include "core/io/csv.h"

#include <math.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/number.h"

enum { KEYS_MAX = 1000, KEY_SIZE = 64 };

/* The next line into row..row_end, blanks and carriage returns at its ends left out. */
static bool next_line(dif_csv *csv)
{
    if (csv->at >= csv->end)
        return false;
    const char *stop = memchr(csv->at, '\n', (size_t)(csv->end - csv->at));
    stop = stop ? stop : csv->end;
    csv->row = csv->at;
    csv->row_end = stop;
    while (csv->row < csv->row_end && (csv->row_end[-1] == '\r' || csv->row_end[-1] == ' '))
        csv->row_end--;
    while (csv->row < csv->row_end && *csv->row == ' ')
        csv->row++;
    csv->cell = csv->row;
    csv->at = stop + 1;
    csv->line++;
    return true;
}

bool dif_csv_next_row(dif_csv *csv)
{
    while (next_line(csv)) {
        if (csv->row < csv->row_end && *csv->row != '#')
            return true;
    }
    csv->row = csv->row_end = csv->cell = NULL;
    return false;
}

static bool is_key_char(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.';
}

/* Takes "# key: value" of the current line. */
static dif_status take_key(const dif_csv *csv, dif_manifest *keys, dif_error *err)
{
    const char *key = csv->row + 1, *end = csv->row_end;
    while (key < end && *key == ' ')
        key++;
    const char *key_end = key;
    while (key_end < end && is_key_char(*key_end))
        key_end++;
    const size_t n_key = (size_t)(key_end - key);
    if (n_key == 0 || n_key >= KEY_SIZE || key_end == end || *key_end != ':' || keys->n >= KEYS_MAX)
        return DIF_OK;
    const char *value = key_end + 1;
    while (value < end && *value == ' ')
        value++;
    char name[KEY_SIZE];
    memcpy(name, key, n_key);
    name[n_key] = '\0';
    char *text = dif_alloc((size_t)(end - value) + 1, 1);
    if (!text)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: header of line %ld", csv->source->name, csv->line);
    memcpy(text, value, (size_t)(end - value));
    const dif_status status = dif_manifest_set(keys, name, text, err);
    dif_release(text);
    return status;
}

/* Comma, semicolon, tab, blank: the first of them in the first row. */
static void find_separator(dif_csv *csv)
{
    static const char SEPARATORS[] = ",;\t ";
    const size_t n = (size_t)(csv->row_end - csv->row);
    csv->separator = ',';
    for (const char *s = SEPARATORS; *s; s++) {
        if (memchr(csv->row, *s, n)) {
            csv->separator = *s;
            break;
        }
    }
    /* 0,5;1,5: names have no commas, numbers of the first row may */
    if (csv->separator == ',' && (memchr(csv->row, ';', n) || memchr(csv->row, '\t', n)))
        csv->separator = memchr(csv->row, ';', n) ? ';' : '\t';
}

dif_status dif_csv_open(const dif_source *source, dif_csv *csv, dif_manifest *keys, dif_error *err)
{
    *csv = (dif_csv){.source = source};
    size_t n = 0;
    dif_status status = dif_source_text(source, &csv->at, &n, &csv->owned, err);
    csv->end = csv->at + n;
    while (!status && next_line(csv)) {
        if (csv->row == csv->row_end)
            continue;
        if (*csv->row != '#') {
            find_separator(csv);
            return DIF_OK;
        }
        status = take_key(csv, keys, err);
    }
    return status ? status : dif_fail(err, DIF_ERR_FORMAT, "%s: no row of data, want CSV", source->name);
}

void dif_csv_close(dif_csv *csv)
{
    dif_release(csv->owned);
    *csv = (dif_csv){0};
}

/* Where the cell that begins at `at` ends. */
static const char *cell_end(const dif_csv *csv, const char *at)
{
    while (at < csv->row_end && *at != csv->separator)
        at++;
    return at;
}

/* The beginning of the cell behind a separator; blanks count as one. */
static const char *after_separator(const dif_csv *csv, const char *stop)
{
    if (stop >= csv->row_end)
        return NULL;
    stop++;
    while (csv->separator == ' ' && stop < csv->row_end && *stop == ' ')
        stop++;
    return stop;
}

bool dif_csv_next_cell(dif_csv *csv, const char **cell, size_t *n)
{
    if (!csv->cell)
        return false;
    const char *at = csv->cell, *stop = cell_end(csv, at);
    csv->cell = after_separator(csv, stop);
    while (at < stop && (*at == ' ' || *at == '\t'))
        at++;
    while (at < stop && (stop[-1] == ' ' || stop[-1] == '\t'))
        stop--;
    if (stop - at >= 2 && *at == '"' && stop[-1] == '"') {
        at++;
        stop--;
    }
    *cell = at;
    *n = (size_t)(stop - at);
    return true;
}

long dif_csv_count_cells(const dif_csv *csv)
{
    long n = 0;
    for (const char *at = csv->row; at; at = after_separator(csv, cell_end(csv, at)))
        n++;
    return n;
}

dif_status dif_csv_number(const dif_csv *csv, const char *cell, size_t n, const char *column, double *value,
                          dif_error *err)
{
    *value = NAN;
    const char decimal = csv->separator != ',' && memchr(cell, ',', n) ? ',' : '.';
    if (n == 0 || dif_number_parse(cell, cell + n, decimal, value) == cell + n)
        return DIF_OK;
    char quote[DIF_QUOTE_SIZE];
    dif_quote(cell, n, quote);
    return dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld: %s is '%s', want a number", csv->source->name, csv->line,
                    column, quote);
}

bool dif_csv_name_is(const char *cell, size_t n, const char *name)
{
    if (strlen(name) != n)
        return false;
    for (size_t i = 0; i < n; i++) {
        const char c = cell[i] >= 'A' && cell[i] <= 'Z' ? (char)(cell[i] + ('a' - 'A')) : cell[i];
        if (c != name[i])
            return false;
    }
    return true;
}

static int find_role(const char *cell, size_t n, const dif_csv_column *columns, int n_column)
{
    for (int k = 0; k < n_column; k++) {
        for (const char *const *name = columns[k].names; *name; name++) {
            if (dif_csv_name_is(cell, n, *name))
                return k;
        }
    }
    return -1;
}

dif_status dif_csv_find_columns(const dif_csv *csv, const dif_csv_column *columns, int n_column, signed char **role,
                                long *n_cell, dif_error *err)
{
    unsigned long found = 0;
    *n_cell = dif_csv_count_cells(csv);
    *role = dif_alloc((size_t)*n_cell, sizeof **role);
    if (!*role)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %ld columns", csv->source->name, *n_cell);
    dif_csv header = *csv;
    header.cell = header.row;
    const char *cell = NULL;
    size_t n = 0;
    for (long i = 0; dif_csv_next_cell(&header, &cell, &n); i++) {
        const int k = find_role(cell, n, columns, n_column);
        (*role)[i] = -1;
        if (k >= 0 && !(found >> k & 1u)) {
            (*role)[i] = (signed char)k;
            found |= 1ul << k;
        }
    }
    for (int k = 0; k < n_column; k++) {
        if (columns[k].needed && !(found >> k & 1u)) {
            dif_release(*role);
            *role = NULL;
            return dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld: no column %s", csv->source->name, csv->line,
                            columns[k].names[0]);
        }
    }
    return DIF_OK;
}

dif_status dif_csv_read_row(dif_csv *csv, const dif_csv_column *columns, int n_column, const signed char *role,
                            long n_cell, double *value, dif_error *err)
{
    for (int k = 0; k < n_column; k++)
        value[k] = NAN;
    const char *cell = NULL;
    size_t n = 0;
    long i = 0;
    for (; dif_csv_next_cell(csv, &cell, &n); i++) {
        const int k = i < n_cell ? role[i] : -1;
        if (k < 0)
            continue;
        const dif_status status = dif_csv_number(csv, cell, n, columns[k].names[0], &value[k], err);
        if (status)
            return status;
    }
    if (i != n_cell)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld has %ld cells, want %ld as in the header", csv->source->name,
                        csv->line, i, n_cell);
    return DIF_OK;
}
