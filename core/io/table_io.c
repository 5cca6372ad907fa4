#include "core/io/table_io.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/file.h"
#include "core/io/table_impl.h"
#include "core/units.h"

static const size_t FILE_MAX = (size_t)1 << 32;

const char *const dif_table_keys[] = {"layout",      "quantity",  "quantity_unit", "fixed_angle", "fixed_deg",
                                      "azimuth_deg", "angle_deg", "lambda_nm",     NULL};

bool dif_table_key_is(const char *key)
{
    for (const char *const *known = dif_table_keys; *known; known++) {
        if (strcmp(key, *known) == 0)
            return true;
    }
    return false;
}

static dif_status fail_key(const dif_source *source, const char *key, const char *text, const char *want,
                           dif_error *err)
{
    char quote[DIF_QUOTE_SIZE];
    dif_quote(text, strlen(text), quote);
    return dif_fail(err, DIF_ERR_FORMAT, "%s: %s is '%s', want %s", source->name, key, quote, want);
}

/* A finite number of a key; *value stays if there is no such key. */
static dif_status read_key_number(const dif_source *source, const char *key, const char *text, double *value,
                                  dif_error *err)
{
    if (!text)
        return DIF_OK;
    if (!dif_number_all(text, strlen(text), '.', value) || !isfinite(*value))
        return fail_key(source, key, text, "a finite number", err);
    return DIF_OK;
}

dif_status dif_table_geometry_read(const dif_source *source, const char *(*look_up)(void *, const char *), void *self,
                                   dif_table_geometry *out, dif_error *err)
{
    *out = (dif_table_geometry){.fixed_deg = NAN, .quantity = DIF_QUANTITY_RHO};
    const char *quantity = look_up(self, "quantity"), *fixed = look_up(self, "fixed_angle");
    if (quantity) {
        out->quantity_is_known = dif_quantity_from_name(quantity, &out->quantity);
        if (!out->quantity_is_known)
            return fail_key(source, "quantity", quantity, "power, rho or brdf", err);
    }
    if (fixed) {
        out->fixed_is_known = true;
        out->fixed_is_wo = strcmp(fixed, "theta_r") == 0;
        if (!out->fixed_is_wo && strcmp(fixed, "theta_i") != 0)
            return fail_key(source, "fixed_angle", fixed, "theta_i or theta_r", err);
    }
    const dif_status status = read_key_number(source, "fixed_deg", look_up(self, "fixed_deg"), &out->fixed_deg, err);
    if (status)
        return status;
    return read_key_number(source, "azimuth_deg", look_up(self, "azimuth_deg"), &out->azimuth_deg, err);
}

/* Conversions round, so the text that leads back may stand for a neighbour of the number shown. */
static size_t print_axis(double shown, double stored, double (*back)(double), char out[DIF_NUMBER_SIZE])
{
    double below[3] = {shown}, above[3] = {shown};
    for (int k = 1; k < 3; k++) {
        below[k] = nextafter(below[k - 1], -INFINITY);
        above[k] = nextafter(above[k - 1], INFINITY);
    }
    for (int n_digit = 15; n_digit <= 17; n_digit++) {
        for (int k = 0; k < 6; k++) {
            double read = 0.0;
            const size_t n = dif_number_print(k % 2 ? below[k / 2] : above[k / 2], n_digit, out);
            if (dif_number_all(out, n, '.', &read) && back(read) == stored)
                return n;
        }
    }
    return dif_number_print(shown, 17, out);
}

size_t dif_table_print_deg(double angle_rad, char out[DIF_NUMBER_SIZE])
{
    return print_axis(dif_deg_from_rad(angle_rad), angle_rad, dif_rad_from_deg, out);
}

size_t dif_table_print_nm(double lambda_um, char out[DIF_NUMBER_SIZE])
{
    return print_axis(dif_nm_from_um(lambda_um), lambda_um, dif_um_from_nm, out);
}

/* An axis value with its place before sorting. */
typedef struct axis_item {
    double value;
    int from;
} axis_item;

static int compare_items(const void *a, const void *b)
{
    const axis_item *x = a, *y = b;
    return (x->value > y->value) - (x->value < y->value);
}

/* Sorts an axis and says where each value came from; *moved tells whether anything changed. */
static dif_status sort_axis(const dif_source *source, double *axis, int n, const char *what, int **from, bool *moved,
                            dif_error *err)
{
    axis_item *item = dif_alloc((size_t)n, sizeof *item);
    *from = dif_alloc((size_t)n, sizeof **from);
    dif_status status = DIF_OK;
    *moved = false;
    if (!item || !*from) {
        status = dif_fail(err, DIF_ERR_NOMEM, "%s: axis of %d values", source->name, n);
        goto cleanup;
    }
    for (int i = 0; i < n; i++)
        item[i] = (axis_item){axis[i], i};
    qsort(item, (size_t)n, sizeof *item, compare_items);
    for (int i = 0; i < n && !status; i++) {
        axis[i] = item[i].value;
        (*from)[i] = item[i].from;
        *moved |= item[i].from != i;
        if (i > 0 && item[i].value == item[i - 1].value)
            status = dif_fail(err, DIF_ERR_FORMAT, "%s: two %s are the same", source->name, what);
    }
cleanup:
    dif_release(item);
    return status;
}

dif_status dif_table_sort(const dif_source *source, dif_table *table, dif_error *err)
{
    const int nx = table->plan.n_angle, ny = table->plan.n_lambda;
    int *from_x = NULL, *from_y = NULL;
    double *value = NULL;
    bool moved_x = false, moved_y = false;
    dif_status status = sort_axis(source, table->plan.angle_rad, nx, "angles", &from_x, &moved_x, err);
    if (!status)
        status = sort_axis(source, table->plan.lambda_um, ny, "wavelengths", &from_y, &moved_y, err);
    if (status || (!moved_x && !moved_y))
        goto cleanup;
    value = dif_alloc((size_t)nx * (size_t)ny, sizeof *value);
    if (!value) {
        status = dif_fail(err, DIF_ERR_NOMEM, "%s: table of %d x %d", source->name, nx, ny);
        goto cleanup;
    }
    for (int iy = 0; iy < ny; iy++) {
        for (int ix = 0; ix < nx; ix++)
            value[(size_t)iy * (size_t)nx + (size_t)ix] =
                table->value[(size_t)from_y[iy] * (size_t)nx + (size_t)from_x[ix]];
    }
    dif_release(table->value);
    table->value = value;
cleanup:
    dif_release(from_x);
    dif_release(from_y);
    return status;
}

dif_status dif_table_check(const dif_source *source, const dif_table *table, dif_error *err)
{
    const dif_status status = dif_plan_check(&table->plan, err);
    if (status)
        return dif_fail_named(err, source->name, DIF_ERR_FORMAT);
    const size_t n = (size_t)table->plan.n_angle * (size_t)table->plan.n_lambda;
    for (size_t i = 0; i < n; i++) {
        if (isinf(table->value[i])) {
            const size_t n_angle = (size_t)table->plan.n_angle;
            return dif_fail(err, DIF_ERR_NONFINITE, "%s: infinite value at %.9g deg, %.9g nm", source->name,
                            dif_deg_from_rad(table->plan.angle_rad[i % n_angle]),
                            dif_nm_from_um(table->plan.lambda_um[i / n_angle]));
        }
    }
    return DIF_OK;
}

/* Hands the keys that are no geometry to the caller. */
static dif_status give_manifest(const dif_manifest *keys, dif_manifest *manifest, dif_error *err)
{
    for (int i = 0; i < keys->n; i++) {
        if (dif_table_key_is(keys->item[i].key))
            continue;
        const dif_status status = dif_manifest_set(manifest, keys->item[i].key, keys->item[i].value, err);
        if (status) {
            dif_manifest_free(manifest);
            return status;
        }
    }
    return DIF_OK;
}

dif_status dif_table_parse(const unsigned char *data, size_t n, const char *name, dif_table *table,
                           dif_manifest *manifest, dif_error *err)
{
    const dif_source source = dif_source_of(data, n, name);
    dif_manifest keys = {0};
    dif_status status = DIF_OK;
    *table = (dif_table){0};
    if (manifest)
        *manifest = (dif_manifest){0};
    if (n == 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: empty file", source.name);
    if (dif_exr_is(&source))
        status = dif_table_exr_read(&source, table, &keys, err);
    else
        status = dif_table_csv_read(&source, table, &keys, err);
    if (!status)
        status = dif_table_sort(&source, table, err);
    if (!status)
        status = dif_table_check(&source, table, err);
    if (!status && manifest)
        status = give_manifest(&keys, manifest, err);
    if (status)
        dif_table_free(table);
    dif_manifest_free(&keys);
    return status;
}

dif_status dif_table_read(const char *path, dif_table *table, dif_manifest *manifest, dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    *table = (dif_table){0};
    if (manifest)
        *manifest = (dif_manifest){0};
    dif_status status = dif_file_read(path, FILE_MAX, &data, &n, err);
    if (!status)
        status = dif_table_parse(data, n, path, table, manifest, err);
    dif_release(data);
    return status;
}

dif_status dif_table_write(const char *path, const dif_table *table, dif_layout layout, const dif_manifest *manifest,
                           dif_error *err)
{
    const bool to_stdout = !path || strcmp(path, "-") == 0;
    const size_t n_path = to_stdout ? 0 : strlen(path);
    if (n_path <= 4 || strcmp(path + n_path - 4, ".exr") != 0)
        return dif_table_csv_write(to_stdout ? NULL : path, table, layout, manifest, err);
    unsigned char *data = NULL;
    size_t n = 0;
    dif_status status = dif_table_exr_encode(table, manifest, &data, &n, err);
    if (status)
        return dif_fail_named(err, path, status);
    status = dif_file_write(path, data, n, err);
    dif_release(data);
    return status;
}
