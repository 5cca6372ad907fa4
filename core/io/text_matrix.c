/* Matrices of numbers as text: one row a line, the first at the top; and x y z lists on a regular grid. */
#include <math.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/field_raw.h"
#include "core/io/number.h"
#include "core/io/text_header.h"
#include "core/io/text_xyz.h"

enum { BLANKS = ' ' }; /* separator of columns: any number of blanks and tabs */

typedef struct line_reader {
    const char *at, *end; /* what is left            */
    const char *line;     /* the current line[n]     */
    size_t n;
    long number; /* of the current line, from 1 */
} line_reader;

static bool next_line(line_reader *reader)
{
    if (reader->at >= reader->end)
        return false;
    const char *stop = memchr(reader->at, '\n', (size_t)(reader->end - reader->at));
    stop = stop ? stop : reader->end;
    reader->line = reader->at;
    reader->n = (size_t)(stop - reader->at);
    while (reader->n > 0 && (reader->line[reader->n - 1] == '\r' || reader->line[reader->n - 1] == ' '))
        reader->n--;
    while (reader->n > 0 && reader->line[0] == ' ') {
        reader->line++;
        reader->n--;
    }
    reader->at = stop + 1;
    reader->number++;
    return true;
}

static bool is_comment(const line_reader *reader)
{
    return reader->n > 0 && (reader->line[0] == '#' || reader->line[0] == '%');
}

/* A cell that stands for a missing point. */
static bool is_missing(const char *cell, size_t n)
{
    static const char *const MARKS[] = {"",   "BAD", "bad", "***",       "NaN",     "nan",     "NAN",
                                        "--", "N/A", "NA",  "-nan(ind)", "1.#QNAN", "-1.#IND", "1.#IND"};
    for (size_t i = 0; i < sizeof MARKS / sizeof *MARKS; i++) {
        if (strlen(MARKS[i]) == n && memcmp(cell, MARKS[i], n) == 0)
            return true;
    }
    return false;
}

/* Whether a line holds cells rather than a header: its first word is a number or a mark of a missing point. */
static bool is_data(const line_reader *reader)
{
    const char *end = reader->line + reader->n, *word = reader->line;
    while (word < end && (*word == ' ' || *word == '\t' || *word == ',' || *word == ';'))
        word++;
    const char *stop = word;
    while (stop < end && *stop != ' ' && *stop != '\t' && *stop != ',' && *stop != ';')
        stop++;
    double value = 0.0;
    return stop == word || dif_number_parse(word, stop, '.', &value) == stop || is_missing(word, (size_t)(stop - word));
}

/* What separates cells and decimals, from the characters of all rows. */
typedef struct text_style {
    char separator, decimal;
} text_style;

typedef struct style_marks {
    bool semicolon, tab, comma, dot;
    bool comma_at_blank; /* a comma beside a blank or at an end of a line    */
    bool blank_inside;   /* blanks, and nothing else, between two other characters */
} style_marks;

static void mark_line(const line_reader *reader, style_marks *marks)
{
    for (size_t i = 0; i < reader->n; i++) {
        const char c = reader->line[i], before = i > 0 ? reader->line[i - 1] : ' ';
        const char after = i + 1 < reader->n ? reader->line[i + 1] : ' ';
        marks->semicolon |= c == ';';
        marks->tab |= c == '\t';
        marks->dot |= c == '.';
        marks->comma |= c == ',';
        marks->comma_at_blank |= c == ',' && (before == ' ' || before == '\t' || after == ' ' || after == '\t');
        if (c == ' ' && before != ' ' && before != '\t' && before != ';' && before != ',') {
            size_t next = i;
            while (next < reader->n && reader->line[next] == ' ')
                next++;
            const char far = next < reader->n ? reader->line[next] : ',';
            marks->blank_inside |= far != '\t' && far != ';' && far != ',';
        }
    }
}

static text_style find_style(line_reader reader)
{
    style_marks marks = {0};
    while (next_line(&reader)) {
        if (!is_comment(&reader))
            mark_line(&reader, &marks);
    }
    const char decimal = marks.comma && !marks.dot ? ',' : '.';
    if (marks.semicolon)
        return (text_style){';', decimal};
    /* A decimal comma needs another separator: 1,5 2,5 has one; 1,5,2,5 and 1, 5, 2 have not. */
    const bool comma_is_decimal = decimal == ',' && !marks.comma_at_blank && (marks.tab || marks.blank_inside);
    if (marks.comma && !comma_is_decimal)
        return (text_style){',', '.'};
    return (text_style){marks.tab && !marks.blank_inside ? '\t' : BLANKS, decimal};
}

typedef struct number_rows {
    const dif_source *source;
    text_style style;
    double *value; /* value[n_room], owned */
    size_t n, n_room;
    long n_row, n_column;
    long first_line; /* number of the line of row 0 */
} number_rows;

static dif_status push(number_rows *matrix, double value, dif_error *err)
{
    if (matrix->n == matrix->n_room) {
        if (matrix->n >= DIF_FIELD_SAMPLES_MAX)
            return dif_fail(err, DIF_ERR_SIZE, "%s: more than %d numbers", matrix->source->name,
                            (int)DIF_FIELD_SAMPLES_MAX);
        const size_t n_room = matrix->n_room ? 2 * matrix->n_room : 1024;
        double *grown = dif_alloc(n_room, sizeof *grown);
        if (!grown)
            return dif_fail(err, DIF_ERR_NOMEM, "%s: %zu numbers", matrix->source->name, n_room);
        if (matrix->n)
            memcpy(grown, matrix->value, matrix->n * sizeof *grown);
        dif_release(matrix->value);
        matrix->value = grown;
        matrix->n_room = n_room;
    }
    matrix->value[matrix->n++] = value;
    return DIF_OK;
}

static dif_status fail_cell(const number_rows *matrix, long line, long column, const char *cell, size_t n,
                            dif_error *err)
{
    char quote[DIF_QUOTE_SIZE];
    dif_quote(cell, n, quote);
    return dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld, value %ld is '%s', want a number", matrix->source->name, line,
                    column, quote);
}

/* Where the cell that begins at `at` ends. */
static const char *cell_end(const number_rows *matrix, const char *at, const char *end)
{
    if (matrix->style.separator != BLANKS) {
        const char *stop = memchr(at, matrix->style.separator, (size_t)(end - at));
        return stop ? stop : end;
    }
    while (at < end && *at != ' ' && *at != '\t')
        at++;
    return at;
}

/* Blanks that belong to no cell. */
static const char *skip_blanks(const number_rows *matrix, const char *at, const char *end)
{
    while (at < end && (*at == ' ' || (*at == '\t' && matrix->style.separator != '\t')))
        at++;
    return at;
}

/* Appends the numbers of a line; *n_cell counts them. */
static dif_status read_cells(number_rows *matrix, const line_reader *reader, long *n_cell, dif_error *err)
{
    const char *end = reader->line + reader->n;
    *n_cell = 0;
    for (const char *at = skip_blanks(matrix, reader->line, end); at < end; at = skip_blanks(matrix, at, end)) {
        const char *stop = cell_end(matrix, at, end);
        size_t n = (size_t)(stop - at);
        while (n > 0 && (at[n - 1] == ' ' || at[n - 1] == '\t'))
            n--;
        double value = 0.0;
        ++*n_cell;
        if (is_missing(at, n))
            value = NAN;
        else if (dif_number_parse(at, at + n, matrix->style.decimal, &value) != at + n)
            return fail_cell(matrix, reader->number, *n_cell, at, n, err);
        const dif_status status = push(matrix, value, err);
        if (status)
            return status;
        at = stop < end ? stop + 1 : end; /* a separator that ends the line begins no cell */
    }
    return DIF_OK;
}

static bool ends_with_separator(const number_rows *matrix, const line_reader *reader)
{
    return matrix->style.separator != BLANKS && reader->n > 0 && reader->line[reader->n - 1] == matrix->style.separator;
}

static dif_status read_rows(number_rows *matrix, line_reader reader, dif_error *err)
{
    while (next_line(&reader)) {
        if (reader.n == 0 || is_comment(&reader))
            continue;
        long n_cell = 0;
        const dif_status status = read_cells(matrix, &reader, &n_cell, err);
        if (status)
            return status;
        if (n_cell == 0)
            continue;
        if (n_cell == matrix->n_column - 1 && ends_with_separator(matrix, &reader)) { /* an empty last cell */
            const dif_status status_last = push(matrix, NAN, err);
            if (status_last)
                return status_last;
            n_cell++;
        }
        if (matrix->n_row == 0) {
            matrix->n_column = n_cell;
            matrix->first_line = reader.number;
        } else if (n_cell != matrix->n_column) {
            return dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld has %ld values, want %ld as in line %ld",
                            matrix->source->name, reader.number, n_cell, matrix->n_column, matrix->first_line);
        }
        matrix->n_row++;
    }
    if (matrix->n_row == 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: no numbers", matrix->source->name);
    return DIF_OK;
}

/* Reads the lines above the numbers; *reader is left at the first row. */
static dif_status read_header(const dif_source *source, line_reader *reader, dif_text_header *header, dif_error *err)
{
    for (line_reader ahead = *reader; next_line(&ahead); *reader = ahead) {
        const bool is_remark = ahead.n > 0 && ahead.line[0] == ';' && (ahead.n == 1 || ahead.line[1] == ' ');
        if (is_comment(&ahead) || is_remark) {
            dif_text_header_comment(header, ahead.line + 1, ahead.n - 1);
        } else if (ahead.n > 0 && !dif_text_header_pairs(header, ahead.line, ahead.n)) {
            if (is_data(&ahead))
                return DIF_OK;
            char quote[DIF_QUOTE_SIZE];
            dif_quote(ahead.line, ahead.n, quote);
            return dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld is '%s', want numbers, a # comment or key=value",
                            source->name, ahead.number, quote);
        }
    }
    return DIF_OK;
}

static dif_status check_said_size(const number_rows *matrix, const dif_text_header *header, dif_error *err)
{
    const bool rows_ok = isnan(header->n_row) || header->n_row == (double)matrix->n_row;
    const bool columns_ok = isnan(header->n_column) || header->n_column == (double)matrix->n_column;
    if (rows_ok && columns_ok)
        return DIF_OK;
    return dif_fail(err, DIF_ERR_FORMAT, "%s: %ld rows of %ld values, want %g of %g as the header says",
                    matrix->source->name, matrix->n_row, matrix->n_column, header->n_row, header->n_column);
}

static dif_status check_lengths(const dif_source *source, const dif_text_header *header, dif_error *err)
{
    const double said[] = {header->width_um, header->height_um, header->pitch_um, header->unit_um};
    static const char *const NAMES[] = {"width", "height", "pixel size", "height unit"};
    for (int i = 0; i < 4; i++) {
        if (!isnan(said[i]) && !(said[i] > 0.0 && isfinite(said[i])))
            return dif_fail(err, DIF_ERR_FORMAT, "%s: the header's %s is %g um, want > 0", source->name, NAMES[i],
                            said[i]);
    }
    return DIF_OK;
}

/* Moves the numbers into *raw with what the header says of them. */
static void fill_raw(number_rows *matrix, const dif_text_header *header, dif_raw *raw)
{
    raw->nx = (int)matrix->n_column;
    raw->ny = (int)matrix->n_row;
    raw->z = matrix->value;
    matrix->value = NULL;
    raw->pitch_x_um = isnan(header->width_um) ? header->pitch_um : header->width_um / raw->nx;
    raw->pitch_y_um = isnan(header->height_um) ? raw->pitch_x_um : header->height_um / raw->ny;
    if (isnan(raw->pitch_x_um))
        raw->pitch_x_um = raw->pitch_y_um;
    raw->unit_um = header->unit_um;
    if (header->title)
        dif_raw_set_title(raw, header->title, header->n_title);
}

static dif_status read_text(const dif_source *source, const char *text, size_t n, number_rows *matrix, dif_raw *raw,
                            dif_error *err)
{
    line_reader reader = {.at = text, .end = text + n};
    dif_text_header header = dif_text_header_empty();
    dif_status status = read_header(source, &reader, &header, err);
    if (!status)
        status = check_lengths(source, &header, err);
    if (status)
        return status;
    matrix->style = find_style(reader);
    status = read_rows(matrix, reader, err);
    if (!status)
        status = check_said_size(matrix, &header, err);
    if (status)
        return status;
    const bool says_size = !isnan(header.width_um) || !isnan(header.pitch_um) || !isnan(header.n_column);
    if (matrix->n_column == 3 && matrix->n_row > 3 && !says_size)
        return dif_text_xyz_read(source, matrix->value, (size_t)matrix->n_row, raw, err);
    status = dif_raw_check_size(source, matrix->n_column, matrix->n_row, err);
    if (!status)
        fill_raw(matrix, &header, raw);
    return status;
}

dif_status dif_text_matrix_read(const dif_source *source, dif_raw *raw, dif_error *err)
{
    *raw = dif_raw_empty("text");
    const char *text = NULL;
    char *owned = NULL;
    size_t n = 0;
    dif_status status = dif_source_text(source, &text, &n, &owned, err);
    if (status)
        return status;
    number_rows matrix = {.source = source};
    status = read_text(source, text, n, &matrix, raw, err);
    dif_release(matrix.value);
    dif_release(owned);
    return status;
}
