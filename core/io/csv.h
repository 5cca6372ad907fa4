/* Rows and cells of a CSV file. Separator comma, semicolon, tab or blanks, found from the first row; `#` comments above
 * it are kept as keys. Internal to core/io. Does not: know columns. */
#ifndef DIF_CSV_H
#define DIF_CSV_H

#include <stdbool.h>

#include "core/io/manifest.h"
#include "core/io/source.h"

typedef struct dif_csv {
    const dif_source *source;
    char *owned;          /* transcoded text, or NULL        */
    const char *at, *end; /* what is left                    */
    const char *row;      /* the current row                 */
    const char *row_end;
    const char *cell; /* where its next cell begins, NULL after the last one */
    long line;        /* of the current row, from 1          */
    char separator;   /* decimal commas may occur if it is no comma */
} dif_csv;

/* Begins with the first row, which is current then. Comments above it of the form `# key: value` are set in *keys.
 * Status DIF_ERR_FORMAT (no row), DIF_ERR_NOMEM. The caller calls dif_csv_close in any case. */
DIF_MUST_USE dif_status dif_csv_open(const dif_source *source, dif_csv *csv, dif_manifest *keys, dif_error *err);
void dif_csv_close(dif_csv *csv);

/* Goes to the next row that is neither empty nor a comment; false at the end. */
bool dif_csv_next_row(dif_csv *csv);

/* The next cell of the current row, without blanks and quotes around it; false after the last one. */
bool dif_csv_next_cell(dif_csv *csv, const char **cell, size_t *n);

/* Cells of the current row, counted from its beginning; the next cell stays what it was. */
long dif_csv_count_cells(const dif_csv *csv);

/* Reads a cell as a number; *value NaN for an empty cell or nan. Status DIF_ERR_FORMAT with the line and column's name. */
DIF_MUST_USE dif_status dif_csv_number(const dif_csv *csv, const char *cell, size_t n, const char *column,
                                       double *value, dif_error *err);

/* True if a cell is this name (lower case) in any case. */
bool dif_csv_name_is(const char *cell, size_t n, const char *name);

/* Columns by name. */
typedef struct dif_csv_column {
    const char *names[4]; /* accepted names, any case; NULL-terminated */
    bool needed;
} dif_csv_column;

/* Finds columns in the current row, which must be the header: role[i] is the index in columns[n_column] of its cell i, or
 * -1; of several cells for one column the first counts. role[*n_cell] is freed with dif_release.
 * Status DIF_ERR_FORMAT (a needed column is missing), DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_csv_find_columns(const dif_csv *csv, const dif_csv_column *columns, int n_column,
                                             signed char **role, long *n_cell, dif_error *err);

/* Reads the current row: value[n_column] by role, NaN where there is no such column.
 * Status DIF_ERR_FORMAT: ragged (both counts) or not a number */
DIF_MUST_USE dif_status dif_csv_read_row(dif_csv *csv, const dif_csv_column *columns, int n_column,
                                         const signed char *role, long n_cell, double *value, dif_error *err);

#endif
