#include "core/io/directions.h"

#include <string.h>

#include "core/alloc.h"
#include "core/io/table_impl.h"

enum { N_ANGLE = DIF_N_DIRECTION - 1 };

typedef struct angle_list {
    double (*angle)[N_ANGLE]; /* angle[n_room], owned */
    size_t n, n_room;
} angle_list;

static dif_status push(const dif_source *source, angle_list *list, const double *angle, dif_error *err)
{
    if (list->n == list->n_room) {
        const size_t n_room = list->n_room ? 2 * list->n_room : 256;
        double(*grown)[N_ANGLE] = dif_alloc(n_room, sizeof *grown);
        if (!grown)
            return dif_fail(err, DIF_ERR_NOMEM, "%s: %zu directions", source->name, n_room);
        if (list->n)
            memcpy(grown, list->angle, list->n * sizeof *grown);
        dif_release(list->angle);
        list->angle = grown;
        list->n_room = n_room;
    }
    memcpy(list->angle[list->n++], angle, sizeof *list->angle);
    return DIF_OK;
}

static dif_status read_rows(dif_csv *csv, angle_list *list, dif_error *err)
{
    dif_csv_column columns[N_ANGLE];
    signed char *role = NULL;
    long n_cell = 0;
    memcpy(columns, dif_direction_columns, sizeof columns);
    dif_status status = dif_csv_find_columns(csv, columns, N_ANGLE, &role, &n_cell, err);
    while (!status && dif_csv_next_row(csv)) {
        double value[DIF_N_DIRECTION];
        status = dif_csv_read_row(csv, columns, N_ANGLE, role, n_cell, value, err);
        value[DIF_COLUMN_LAMBDA] = 1.0; /* any: the check wants one */
        if (!status)
            status = dif_csv_check_direction(csv, value, err);
        if (!status)
            status = push(csv->source, list, value, err);
    }
    dif_release(role);
    if (!status && list->n == 0)
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: no rows below the header", csv->source->name);
    return status;
}

dif_status dif_directions_parse(const unsigned char *data, size_t n, const char *name, size_t *n_direction,
                                double (**degrees)[4], dif_error *err)
{
    const dif_source source = dif_source_of(data, n, name);
    dif_manifest keys = {0};
    angle_list list = {0};
    dif_csv csv;
    *n_direction = 0;
    *degrees = NULL;
    if (n == 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: empty file", source.name);
    dif_status status = dif_csv_open(&source, &csv, &keys, err);
    if (!status)
        status = read_rows(&csv, &list, err);
    if (status) {
        dif_release(list.angle);
    } else {
        *degrees = list.angle;
        *n_direction = list.n;
    }
    dif_csv_close(&csv);
    dif_manifest_free(&keys);
    return status;
}
