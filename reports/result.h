/* The result files of one report, as they lie in its folder:
 *
 *   results.json        {"schema", "title", "provenance": {...}, "surfaces": ["NAME.json", ...]}
 *   NAME.json           everything measured on one surface, in nm, um and degrees; keys as the page reads them
 *   NAME.height.exr     the heightfield            NAME.table.exr, NAME.table.csv   the response table
 *   NAME.maxima.csv     DIF_RESULT_MAXIMA columns  NAME.lines.csv                   DIF_RESULT_LINES columns
 *   NAME.map.png, NAME.map-level.png               the BRDF map's colours and its luminance, if it was measured
 *   NAME.map.exr                                   its numbers, for others
 *   NAME.slopes.png, NAME.normals.png, NAME.view.png
 *                                                  slopes, normals and a view from afar, if they were measured
 *   NAME.study-I-K.png                             picture K of study I, if studies were asked for
 *
 * "map", "methods", "gpu", "render", "slopes" and "study" are parts of NAME.json that may be absent; "gpu" holds cases as
 * reports/compare.h has them, or the reason why there are none.
 * Numbers that do not exist are null. Files are named relative to the folder and may not leave it.
 * Does not: compute results. */
#ifndef DIF_RESULT_H
#define DIF_RESULT_H

#include <jansson.h>

#include "core/field.h"
#include "core/plan.h"

#define DIF_RESULT_SCHEMA      "diffbench result 1"
#define DIF_RESULT_LIST_SCHEMA "diffbench results 1"

/* Columns of NAME.maxima.csv and NAME.lines.csv, in this order. */
#define DIF_RESULT_MAXIMA_HEADER "lambda_nm,angle_deg,value,order,residual_deg,period_nm,is_global,at_edge,on_line"
#define DIF_RESULT_LINES_HEADER  "f_per_um,power_mean,n_cell"

enum dif_result_maxima_column {
    DIF_MAXIMA_LAMBDA_NM,
    DIF_MAXIMA_ANGLE_DEG,
    DIF_MAXIMA_VALUE,
    DIF_MAXIMA_ORDER,
    DIF_MAXIMA_RESIDUAL_DEG,
    DIF_MAXIMA_PERIOD_NM,
    DIF_MAXIMA_IS_GLOBAL,
    DIF_MAXIMA_AT_EDGE,
    DIF_MAXIMA_ON_LINE, /* within twice the line's rms width of its order: not a side lobe or a neighbour's */
    DIF_MAXIMA_N
};
enum dif_result_lines_column { DIF_LINES_F_PER_UM, DIF_LINES_POWER_MEAN, DIF_LINES_N_CELL, DIF_LINES_N };

/* Numbers of a CSV file, value[n_row * n_column], NaN = nan. */
typedef struct dif_columns {
    int n_row, n_column;
    double *value; /* owned */
} dif_columns;

typedef struct dif_result {
    const char *folder; /* borrowed: where further pictures lie */
    json_t *doc;        /* owned reference */
    dif_field field;
    dif_table table;
    dif_columns maxima, lines;
} dif_result;

/* Loads FOLDER/results.json and checks its shape. Status DIF_ERR_IO, DIF_ERR_FORMAT, DIF_ERR_NOMEM.
 * Owns      the caller drops *list with json_decref */
DIF_MUST_USE dif_status dif_result_list_load(const char *folder, json_t **list, dif_error *err);

/* Loads and checks FOLDER/NAME alone, without the pictures and tables it names; the caller drops *doc. */
DIF_MUST_USE dif_status dif_result_doc_load(const char *folder, const char *name, json_t **doc, dif_error *err);

/* Loads one surface's files; `folder` must outlive *out. Status as dif_report_build; *out zeroed on failure. */
DIF_MUST_USE dif_status dif_result_load(const char *folder, const char *name, dif_result *out, dif_error *err);
void dif_result_free(dif_result *result);

/* Reads a CSV of numbers whose first line that is not a comment equals `header`. */
DIF_MUST_USE dif_status dif_columns_read(const char *path, const char *header, int n_column, dif_columns *out,
                                         dif_error *err);
void dif_columns_free(dif_columns *columns);

/* A PNG file as it is, to be put into the page. */
typedef struct dif_picture {
    unsigned char *png; /* owned */
    size_t n;
    int nx, ny;
} dif_picture;

/* Reads a picture of the result's folder and checks that it is a whole PNG of at least one pixel.
 * Status    DIF_ERR_IO, DIF_ERR_FORMAT, DIF_ERR_SIZE, DIF_ERR_NOMEM; *out zeroed on failure */
DIF_MUST_USE dif_status dif_picture_load(const dif_result *result, const char *name, dif_picture *out, dif_error *err);
void dif_picture_free(dif_picture *picture);

/* Members by dotted path ("fit_table.period_nm"): NULL, NaN, "" or false where there is none of that type. */
const json_t *dif_result_at(const json_t *doc, const char *path);
double dif_result_number(const json_t *doc, const char *path);
const char *dif_result_text(const json_t *doc, const char *path);
bool dif_result_true(const json_t *doc, const char *path);

#endif
