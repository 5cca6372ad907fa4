/* Reading small CSV files in tests: comments (#) and the header line are skipped, cells are split at commas. */
#ifndef DIF_TEST_ROWS_H
#define DIF_TEST_ROWS_H

#include <stdio.h>
#include <string.h>

enum { TEST_ROW_CELLS = 16 };

typedef struct test_row {
    char line[512];
    char *cell[TEST_ROW_CELLS];
    int n;
} test_row;

/* The next row of numbers or words; 0 at the end. The first row that is no comment is taken as the header. */
static inline int test_row_next(FILE *file, int *n_read, test_row *row)
{
    while (fgets(row->line, sizeof row->line, file)) {
        if (row->line[0] == '#' || (*n_read)++ == 0)
            continue;
        row->line[strcspn(row->line, "\r\n")] = '\0';
        row->n = 0;
        for (char *at = row->line; at && row->n < TEST_ROW_CELLS; row->n++) {
            row->cell[row->n] = at;
            at = strchr(at, ',');
            if (at)
                *at++ = '\0';
        }
        return 1;
    }
    return 0;
}

/* Opens folder/name; fails the program's test by returning NULL. */
static inline FILE *test_rows_open(const char *folder, const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return fopen(path, "r");
}

#endif
