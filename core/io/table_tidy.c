/* Tables from tidy CSV: one sample a row, in any order. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/table_impl.h"
#include "core/units.h"

static const double FIXED_TOL_DEG = 1e-6;     /* how constant the fixed angle and the plane must be         */
static const double SAME_TOL = 1e-9;          /* values of an axis this near (degrees, nm) are one: rounding */
enum { SPARSE_MAX = 16, SPARSE_FREE = 4096 }; /* a grid may have this many cells a row */

enum { N_ROW_COLUMN = DIF_N_DIRECTION + 4, VALUE_FIRST = DIF_N_DIRECTION };
static const char *const VALUE_NAMES[] = {"value", "power", "rho", "brdf"};

typedef struct table_row {
    double direction[DIF_N_DIRECTION]; /* degrees, nm; angles signed once the plane is known */
    double value;
    long line;
} table_row;

typedef struct row_list {
    const dif_source *source;
    table_row *row; /* row[n_room], owned */
    size_t n, n_room;
} row_list;

static dif_status push_row(row_list *list, const table_row *row, dif_error *err)
{
    if (list->n == list->n_room) {
        const size_t n_room = list->n_room ? 2 * list->n_room : 1024;
        table_row *grown = dif_alloc(n_room, sizeof *grown);
        if (!grown)
            return dif_fail(err, DIF_ERR_NOMEM, "%s: %zu rows", list->source->name, n_room);
        if (list->n)
            memcpy(grown, list->row, list->n * sizeof *grown);
        dif_release(list->row);
        list->row = grown;
        list->n_room = n_room;
    }
    list->row[list->n++] = *row;
    return DIF_OK;
}

/* Which value column a tidy header has: index in VALUE_NAMES, or -1. */
static int find_value_column(const signed char *role, long n_cell)
{
    int found = -1;
    for (long i = 0; i < n_cell; i++) {
        const int k = role[i] - VALUE_FIRST;
        if (k >= 0 && (found < 0 || k < found))
            found = k;
    }
    return found;
}

static dif_status read_tidy_rows(dif_csv *csv, row_list *list, int *value_column, dif_error *err)
{
    dif_csv_column columns[N_ROW_COLUMN];
    memcpy(columns, dif_direction_columns, sizeof dif_direction_columns);
    for (int k = VALUE_FIRST; k < N_ROW_COLUMN; k++)
        columns[k] = (dif_csv_column){{VALUE_NAMES[k - VALUE_FIRST], NULL}, false};
    signed char *role = NULL;
    long n_cell = 0;
    dif_status status = dif_csv_find_columns(csv, columns, N_ROW_COLUMN, &role, &n_cell, err);
    if (status)
        return status;
    *value_column = find_value_column(role, n_cell);
    if (*value_column < 0)
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld: no column value, power, rho or brdf", csv->source->name,
                          csv->line);
    while (!status && dif_csv_next_row(csv)) {
        double value[N_ROW_COLUMN];
        table_row row = {.line = csv->line};
        status = dif_csv_read_row(csv, columns, N_ROW_COLUMN, role, n_cell, value, err);
        if (!status)
            status = dif_csv_check_direction(csv, value, err);
        if (status)
            break;
        memcpy(row.direction, value, sizeof row.direction);
        row.value = value[VALUE_FIRST + *value_column];
        status = push_row(list, &row, err);
    }
    dif_release(role);
    if (!status && list->n == 0)
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: no rows below the header", csv->source->name);
    return status;
}

/* The azimuth of the plane: that of the first direction which is not the normal. */
static double find_azimuth(const row_list *list)
{
    static const int PAIRS[2][2] = {{DIF_COLUMN_THETA_I, DIF_COLUMN_PHI_I}, {DIF_COLUMN_THETA_R, DIF_COLUMN_PHI_R}};
    for (int k = 0; k < 2; k++) {
        for (size_t i = 0; i < list->n; i++) {
            if (fabs(list->row[i].direction[PAIRS[k][0]]) > FIXED_TOL_DEG)
                return list->row[i].direction[PAIRS[k][1]];
        }
    }
    return list->row[0].direction[DIF_COLUMN_PHI_I];
}

/* Turns the angle to the plane's azimuth: opposite azimuths change its sign. False if it lies outside the plane. */
static bool fold(double azimuth_deg, double *theta_deg, double phi_deg)
{
    const double turn = fabs(remainder(phi_deg - azimuth_deg, 360.0));
    if (turn <= FIXED_TOL_DEG || fabs(*theta_deg) <= FIXED_TOL_DEG)
        return true;
    *theta_deg = -*theta_deg;
    return 180.0 - turn <= FIXED_TOL_DEG;
}

static dif_status fold_rows(row_list *list, double azimuth_deg, dif_error *err)
{
    for (size_t i = 0; i < list->n; i++) {
        table_row *row = &list->row[i];
        double *d = row->direction;
        if (!fold(azimuth_deg, &d[DIF_COLUMN_THETA_I], d[DIF_COLUMN_PHI_I]) ||
            !fold(azimuth_deg, &d[DIF_COLUMN_THETA_R], d[DIF_COLUMN_PHI_R]))
            return dif_fail(
                err, DIF_ERR_FORMAT,
                "%s: line %ld: azimuths %.9g and %.9g, want all directions in the plane of azimuth %.9g deg",
                list->source->name, row->line, d[DIF_COLUMN_PHI_I], d[DIF_COLUMN_PHI_R], azimuth_deg);
    }
    return DIF_OK;
}

static bool is_constant(const row_list *list, int column)
{
    const double first = list->row[0].direction[column];
    for (size_t i = 1; i < list->n; i++) {
        if (fabs(list->row[i].direction[column] - first) > FIXED_TOL_DEG)
            return false;
    }
    return true;
}

/* Finds the fixed side; if both angles are constant the header decides. */
static dif_status find_fixed(const row_list *list, const dif_table_geometry *said, bool *fixed_is_wo, dif_error *err)
{
    const bool wi_fixed = is_constant(list, DIF_COLUMN_THETA_I), wo_fixed = is_constant(list, DIF_COLUMN_THETA_R);
    if (!wi_fixed && !wo_fixed)
        return dif_fail(err, DIF_ERR_FORMAT,
                        "%s: theta_i_deg and theta_r_deg both change, want one fixed within %g deg", list->source->name,
                        FIXED_TOL_DEG);
    *fixed_is_wo = wi_fixed && wo_fixed ? said->fixed_is_known && said->fixed_is_wo : wo_fixed;
    return DIF_OK;
}

static int compare_double(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The distinct values of a column in rising order: axis[*n], freed by the caller. */
static dif_status collect_axis(const row_list *list, int column, double **axis, int *n, dif_error *err)
{
    double *value = dif_alloc(list->n, sizeof *value);
    if (!value)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: axis of %zu values", list->source->name, list->n);
    size_t n_run = 0; /* runs of one value, as tables have them, need no sorting */
    for (size_t i = 0; i < list->n; i++) {
        const double at = list->row[i].direction[column];
        if (n_run == 0 || at != value[n_run - 1])
            value[n_run++] = at;
    }
    qsort(value, n_run, sizeof *value, compare_double);
    size_t n_axis = 0;
    for (size_t i = 0; i < n_run; i++) {
        if (n_axis == 0 || value[i] - value[n_axis - 1] > SAME_TOL)
            value[n_axis++] = value[i];
    }
    *axis = value;
    *n = (int)n_axis;
    return DIF_OK;
}

/* Index of a value on a rising axis; `hint` is where it was last time. */
static int find_on_axis(const double *axis, int n, double value, int hint)
{
    for (int i = hint; i < n && i < hint + 2; i++) {
        if (fabs(axis[i] - value) <= SAME_TOL)
            return i;
    }
    int lo = 0, hi = n - 1;
    while (lo < hi) {
        const int middle = lo + (hi - lo + 1) / 2;
        if (axis[middle] <= value)
            lo = middle;
        else
            hi = middle - 1;
    }
    return lo + 1 < n && axis[lo + 1] - value < value - axis[lo] ? lo + 1 : lo;
}

static dif_status fill_cells(const row_list *list, int column, const double *angle_deg, const double *lambda_nm,
                             dif_table *table, dif_error *err)
{
    const size_t n_angle = (size_t)table->plan.n_angle, n_cell = n_angle * (size_t)table->plan.n_lambda;
    unsigned char *taken = dif_alloc(n_cell, 1);
    dif_status status = DIF_OK;
    if (!taken)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %zu cells", list->source->name, n_cell);
    for (size_t i = 0; i < n_cell; i++)
        table->value[i] = NAN;
    int ix = 0, iy = 0;
    for (size_t i = 0; i < list->n && !status; i++) {
        const table_row *row = &list->row[i];
        ix = find_on_axis(angle_deg, table->plan.n_angle, row->direction[column], ix);
        iy = find_on_axis(lambda_nm, table->plan.n_lambda, row->direction[DIF_COLUMN_LAMBDA], iy);
        const size_t at = (size_t)iy * n_angle + (size_t)ix;
        if (taken[at])
            status = dif_fail(err, DIF_ERR_FORMAT, "%s: line %ld: %.9g deg, %.9g nm was measured before",
                              list->source->name, row->line, row->direction[column], row->direction[DIF_COLUMN_LAMBDA]);
        taken[at] = 1;
        table->value[at] = row->value;
    }
    dif_release(taken);
    return status;
}

/* The table of folded rows. */
static dif_status build_table(const row_list *list, bool fixed_is_wo, double azimuth_deg, dif_quantity quantity,
                              dif_table *table, dif_error *err)
{
    const int column = fixed_is_wo ? DIF_COLUMN_THETA_I : DIF_COLUMN_THETA_R;
    const int fixed_column = fixed_is_wo ? DIF_COLUMN_THETA_R : DIF_COLUMN_THETA_I;
    double *angle_deg = NULL, *lambda_nm = NULL;
    dif_plan plan = {0};
    dif_status status = collect_axis(list, column, &angle_deg, &plan.n_angle, err);
    if (!status)
        status = collect_axis(list, DIF_COLUMN_LAMBDA, &lambda_nm, &plan.n_lambda, err);
    if (status)
        goto cleanup;
    const double n_cell = (double)plan.n_angle * (double)plan.n_lambda;
    if (n_cell > SPARSE_MAX * (double)list->n + SPARSE_FREE) {
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: %zu rows with %d angles and %d wavelengths, want a grid of them",
                          list->source->name, list->n, plan.n_angle, plan.n_lambda);
        goto cleanup;
    }
    status = dif_plan_create(plan.n_angle, plan.n_lambda, &plan, err);
    if (status) {
        dif_fail_named(err, list->source->name, status);
        goto cleanup;
    }
    plan.fixed_is_wo = fixed_is_wo;
    plan.fixed_rad = dif_rad_from_deg(list->row[0].direction[fixed_column]);
    plan.azimuth_rad = dif_rad_from_deg(azimuth_deg);
    for (int i = 0; i < plan.n_angle; i++)
        plan.angle_rad[i] = dif_rad_from_deg(angle_deg[i]);
    for (int i = 0; i < plan.n_lambda; i++)
        plan.lambda_um[i] = dif_um_from_nm(lambda_nm[i]);
    status = dif_table_create(&plan, quantity, table, err);
    dif_plan_free(&plan);
    if (!status)
        status = fill_cells(list, column, angle_deg, lambda_nm, table, err);
cleanup:
    dif_release(angle_deg);
    dif_release(lambda_nm);
    return status;
}

dif_status dif_table_tidy_read(dif_csv *csv, const dif_table_geometry *said, dif_table *table, dif_error *err)
{
    row_list list = {.source = csv->source};
    int value_column = 0;
    bool fixed_is_wo = false;
    double azimuth_deg = 0.0;
    dif_status status = read_tidy_rows(csv, &list, &value_column, err);
    if (!status) {
        azimuth_deg = find_azimuth(&list);
        status = fold_rows(&list, azimuth_deg, err);
    }
    if (!status)
        status = find_fixed(&list, said, &fixed_is_wo, err);
    if (!status) {
        dif_quantity quantity = said->quantity;
        if (value_column > 0)
            (void)dif_quantity_from_name(VALUE_NAMES[value_column], &quantity); /* the names are quantities */
        status = build_table(&list, fixed_is_wo, azimuth_deg, quantity, table, err);
    }
    dif_release(list.row);
    return status;
}
