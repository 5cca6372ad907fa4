/* CSV from the verbs: to a file, atomically, or to stdout; provenance as `#` lines.
 * Does not: response tables (core/io/table_io.h). */
#ifndef DIF_CSV_OUT_H
#define DIF_CSV_OUT_H

#include <stdio.h>

#include "core/io/file.h"
#include "core/io/manifest.h"

typedef struct dif_csv_out {
    FILE *stream;
    dif_outfile file; /* unused on stdout */
} dif_csv_out;

/* path NULL or "-" is stdout. */
DIF_MUST_USE dif_status dif_csv_out_open(const char *path, dif_csv_out *out, dif_error *err);

/* Commits the file; errors of stdout are found when the program ends. */
DIF_MUST_USE dif_status dif_csv_out_close(dif_csv_out *out, dif_error *err);

/* `# key: value` lines. */
void dif_csv_out_provenance(FILE *stream, const dif_manifest *manifest);

#endif
