/* Tables and queries from CSV: which layout it is, matrices, queries. */
#include <math.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/table_impl.h"
#include "core/units.h"

const dif_csv_column dif_direction_columns[DIF_N_DIRECTION] = {
    [DIF_COLUMN_THETA_I] = {{"theta_i_deg", NULL}, true},
    [DIF_COLUMN_PHI_I] = {{"phi_i_deg", NULL}, false},
    [DIF_COLUMN_THETA_R] = {{"theta_r_deg", NULL}, true},
    [DIF_COLUMN_PHI_R] = {{"phi_r_deg", NULL}, false},
    [DIF_COLUMN_LAMBDA] = {{"lambda_nm", "wavelength_nm", NULL}, true},
};

dif_status dif_csv_check_direction(const dif_csv *csv, double value[DIF_N_DIRECTION], dif_error *err)
{
    for (int k = 0; k < DIF_N_DIRECTION; k++) {
        const bool is_phi = k == DIF_COLUMN_PHI_I || k == DIF_COLUMN_PHI_R;
        if (is_phi && isnan(value[k]))
            value[k] = 0.0;
        const bool good = is_phi                   ? isfinite(value[k])
                          : k == DIF_COLUMN_LAMBDA ? value[k] > 0.0 && isfinite(value[k])
                                                   : fabs(value[k]) < 90.0;
        if (!good)
            return dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld: %s is %.9g, want %s", csv->source->name, csv->line,
                            dif_direction_columns[k].names[0], value[k],
                            is_phi                   ? "a finite angle"
                            : k == DIF_COLUMN_LAMBDA ? "a wavelength > 0"
                                                     : "-90 < angle < 90");
    }
    return DIF_OK;
}

/* A list of numbers that grows. */
typedef struct number_list {
    double *value; /* value[n_room], owned */
    size_t n, n_room;
} number_list;

static dif_status push(const dif_source *source, number_list *list, double value, dif_error *err)
{
    if (list->n == list->n_room) {
        const size_t n_room = list->n_room ? 2 * list->n_room : 1024;
        double *grown = dif_alloc(n_room, sizeof *grown);
        if (!grown)
            return dif_fail(err, DIF_ERR_NOMEM, "%s: %zu numbers", source->name, n_room);
        if (list->n)
            memcpy(grown, list->value, list->n * sizeof *grown);
        dif_release(list->value);
        list->value = grown;
        list->n_room = n_room;
    }
    list->value[list->n++] = value;
    return DIF_OK;
}

/* The first row of a matrix: a label, then the angles. */
static dif_status read_angles(dif_csv *csv, number_list *angle_deg, dif_error *err)
{
    const char *cell = NULL;
    size_t n = 0;
    (void)dif_csv_next_cell(csv, &cell, &n); /* a row has at least one cell */
    dif_status status = DIF_OK;
    while (!status && dif_csv_next_cell(csv, &cell, &n)) {
        double value = NAN;
        status = dif_csv_number(csv, cell, n, "angle", &value, err);
        if (!status && !(fabs(value) < 90.0))
            status = dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld: angle %zu is %.9g, want -90 < angle < 90",
                              csv->source->name, csv->line, angle_deg->n + 1, value);
        if (!status)
            status = push(csv->source, angle_deg, value, err);
    }
    if (!status && angle_deg->n == 0)
        status =
            dif_fail(err, DIF_ERR_FORMAT,
                     "%s: line %ld: neither columns theta_i_deg, theta_r_deg, lambda_nm, value nor angles of a matrix",
                     csv->source->name, csv->line);
    return status;
}

/* The further rows: a wavelength, then a value for each angle. */
static dif_status read_matrix_rows(dif_csv *csv, size_t n_angle, number_list *lambda_nm, number_list *value,
                                   dif_error *err)
{
    while (dif_csv_next_row(csv)) {
        const char *cell = NULL;
        size_t n = 0, n_cell = 0;
        for (; dif_csv_next_cell(csv, &cell, &n); n_cell++) {
            double number = NAN;
            dif_status status = dif_csv_number(csv, cell, n, n_cell == 0 ? "lambda_nm" : "value", &number, err);
            if (!status && n_cell == 0 && !(number > 0.0 && isfinite(number)))
                status = dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld: lambda_nm is %.9g, want a wavelength > 0",
                                  csv->source->name, csv->line, number);
            if (!status)
                status = push(csv->source, n_cell == 0 ? lambda_nm : value, number, err);
            if (status)
                return status;
        }
        if (n_cell != n_angle + 1)
            return dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld has %zu cells, want %zu as in the first row",
                            csv->source->name, csv->line, n_cell, n_angle + 1);
    }
    if (lambda_nm->n == 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: no rows below the angles", csv->source->name);
    return DIF_OK;
}

static dif_status make_table(const dif_source *source, const dif_table_geometry *said, const number_list *angle_deg,
                             const number_list *lambda_nm, const number_list *value, dif_table *table, dif_error *err)
{
    dif_plan plan;
    dif_status status = dif_plan_create((int)angle_deg->n, (int)lambda_nm->n, &plan, err);
    if (status)
        return dif_fail_named(err, source->name, status);
    plan.fixed_is_wo = said->fixed_is_wo;
    plan.fixed_rad = dif_rad_from_deg(said->fixed_deg);
    plan.azimuth_rad = dif_rad_from_deg(said->azimuth_deg);
    for (int i = 0; i < plan.n_angle; i++)
        plan.angle_rad[i] = dif_rad_from_deg(angle_deg->value[i]);
    for (int i = 0; i < plan.n_lambda; i++)
        plan.lambda_um[i] = dif_um_from_nm(lambda_nm->value[i]);
    status = dif_table_create(&plan, said->quantity, table, err);
    dif_plan_free(&plan);
    if (status)
        return dif_fail_named(err, source->name, status);
    memcpy(table->value, value->value, value->n * sizeof *table->value);
    return DIF_OK;
}

static dif_status read_matrix(dif_csv *csv, const dif_table_geometry *said, dif_table *table, dif_error *err)
{
    const dif_source *source = csv->source;
    number_list angle_deg = {0}, lambda_nm = {0}, value = {0};
    dif_status status = read_angles(csv, &angle_deg, err);
    if (!status)
        status = read_matrix_rows(csv, angle_deg.n, &lambda_nm, &value, err);
    if (!status && !(said->fixed_is_known && !isnan(said->fixed_deg)))
        status =
            dif_fail(err, DIF_ERR_FORMAT,
                     "%s: a matrix without its geometry, want # fixed_angle: theta_i (or theta_r) and # fixed_deg: in "
                     "its header",
                     source->name);
    if (!status && !(fabs(said->fixed_deg) < 90.0))
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: fixed_deg is %.9g, want -90 < angle < 90", source->name,
                          said->fixed_deg);
    if (!status)
        status = make_table(source, said, &angle_deg, &lambda_nm, &value, table, err);
    dif_release(angle_deg.value);
    dif_release(lambda_nm.value);
    dif_release(value.value);
    return status;
}

/* True if the current row names a column of a tidy table. */
static bool is_tidy_header(const dif_csv *csv)
{
    dif_csv row = *csv;
    const char *cell = NULL;
    size_t n = 0;
    row.cell = row.row;
    while (dif_csv_next_cell(&row, &cell, &n)) {
        static const char *const NAMES[] = {"theta_i_deg", "theta_r_deg"};
        for (int k = 0; k < 2; k++) {
            if (dif_csv_name_is(cell, n, NAMES[k]))
                return true;
        }
    }
    return false;
}

static const char *look_up(void *self, const char *key)
{
    return dif_manifest_get(self, key);
}

dif_status dif_table_csv_read(const dif_source *source, dif_table *table, dif_manifest *keys, dif_error *err)
{
    dif_csv csv;
    dif_table_geometry said;
    dif_status status = dif_csv_open(source, &csv, keys, err);
    if (!status)
        status = dif_table_geometry_read(source, look_up, keys, &said, err);
    if (!status)
        status =
            is_tidy_header(&csv) ? dif_table_tidy_read(&csv, &said, table, err) : read_matrix(&csv, &said, table, err);
    dif_csv_close(&csv);
    return status;
}

/* Reads the rows of queries into list, DIF_N_DIRECTION numbers each. */
static dif_status read_queries(dif_csv *csv, number_list *list, dif_error *err)
{
    signed char *role = NULL;
    long n_cell = 0;
    dif_status status = dif_csv_find_columns(csv, dif_direction_columns, DIF_N_DIRECTION, &role, &n_cell, err);
    while (!status && dif_csv_next_row(csv)) {
        double value[DIF_N_DIRECTION];
        status = dif_csv_read_row(csv, dif_direction_columns, DIF_N_DIRECTION, role, n_cell, value, err);
        if (!status)
            status = dif_csv_check_direction(csv, value, err);
        for (int k = 0; k < DIF_N_DIRECTION && !status; k++)
            status = push(csv->source, list, value[k], err);
    }
    dif_release(role);
    if (!status && list->n == 0)
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: no rows below the header", csv->source->name);
    return status;
}

static dif_query query_from(const double degrees[DIF_N_DIRECTION])
{
    const dif_query query = {
        .wi = dif_vec3_from_angles_rad(dif_rad_from_deg(degrees[DIF_COLUMN_THETA_I]),
                                       dif_rad_from_deg(degrees[DIF_COLUMN_PHI_I])),
        .wo = dif_vec3_from_angles_rad(dif_rad_from_deg(degrees[DIF_COLUMN_THETA_R]),
                                       dif_rad_from_deg(degrees[DIF_COLUMN_PHI_R])),
        .lambda_um = dif_um_from_nm(degrees[DIF_COLUMN_LAMBDA]),
    };
    return query;
}

dif_status dif_queries_parse(const unsigned char *data, size_t n, const char *name, size_t *n_query, dif_query **query,
                             double (**degrees)[5], dif_error *err)
{
    const dif_source source = dif_source_of(data, n, name);
    dif_manifest keys = {0};
    number_list list = {0};
    dif_csv csv;
    *n_query = 0;
    *query = NULL;
    *degrees = NULL;
    if (n == 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: empty file", source.name);
    dif_status status = dif_csv_open(&source, &csv, &keys, err);
    if (!status)
        status = read_queries(&csv, &list, err);
    if (status)
        goto cleanup;
    const size_t n_row = list.n / DIF_N_DIRECTION;
    *query = dif_alloc(n_row, sizeof **query);
    *degrees = dif_alloc(n_row, sizeof **degrees);
    if (!*query || !*degrees) {
        dif_release(*query);
        dif_release(*degrees);
        *query = NULL;
        *degrees = NULL;
        status = dif_fail(err, DIF_ERR_NOMEM, "%s: %zu queries", source.name, n_row);
        goto cleanup;
    }
    memcpy(*degrees, list.value, list.n * sizeof *list.value);
    for (size_t i = 0; i < n_row; i++)
        (*query)[i] = query_from((*degrees)[i]);
    *n_query = n_row;
cleanup:
    dif_release(list.value);
    dif_csv_close(&csv);
    dif_manifest_free(&keys);
    return status;
}
