/* Tables to CSV. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/table_impl.h"

enum { BUFFER_SIZE = 1 << 16, AXIS_SIZE = DIF_NUMBER_SIZE };

/* Text on its way into a file or standard output. */
typedef struct text_sink {
    FILE *stream;
    const char *name;
    char *buffer; /* buffer[BUFFER_SIZE] */
    size_t n;
    int number; /* errno of the first failure */
} text_sink;

static void flush(text_sink *sink)
{
    errno = 0;
    if (sink->number == 0 && sink->n > 0 && fwrite(sink->buffer, 1, sink->n, sink->stream) != sink->n)
        sink->number = errno ? errno : EIO;
    sink->n = 0;
}

static void put(text_sink *sink, const char *text, size_t n)
{
    while (n > 0) {
        if (sink->n == BUFFER_SIZE)
            flush(sink);
        const size_t n_free = BUFFER_SIZE - sink->n;
        const size_t n_copy = n < n_free ? n : n_free;
        memcpy(sink->buffer + sink->n, text, n_copy);
        sink->n += n_copy;
        text += n_copy;
        n -= n_copy;
    }
}

static void put_text(text_sink *sink, const char *text)
{
    put(sink, text, strlen(text));
}

static void put_key(text_sink *sink, const char *key, const char *value)
{
    put_text(sink, "# ");
    put_text(sink, key);
    put_text(sink, ": ");
    put_text(sink, value);
    put_text(sink, "\n");
}

static void put_header(text_sink *sink, const dif_table *table, dif_layout layout, const dif_manifest *manifest)
{
    char number[DIF_NUMBER_SIZE];
    for (int i = 0; manifest && i < manifest->n; i++) {
        if (!dif_table_key_is(manifest->item[i].key))
            put_key(sink, manifest->item[i].key, manifest->item[i].value);
    }
    put_key(sink, "layout", layout == DIF_LAYOUT_MATRIX ? "matrix" : "tidy");
    put_key(sink, "quantity", dif_quantity_name(table->quantity));
    put_key(sink, "quantity_unit", dif_quantity_unit(table->quantity));
    put_key(sink, "fixed_angle", table->plan.fixed_is_wo ? "theta_r" : "theta_i");
    dif_table_print_deg(table->plan.fixed_rad, number);
    put_key(sink, "fixed_deg", number);
    dif_table_print_deg(table->plan.azimuth_rad, number);
    put_key(sink, "azimuth_deg", number);
}

/* 17 digits: reading gives the same double back. */
static void put_value(text_sink *sink, double value)
{
    char text[DIF_NUMBER_SIZE];
    put(sink, text, dif_number_print(value, 17, text));
}

/* Texts of the axes, printed once: row i of text is axis value i. */
typedef struct axis_texts {
    char (*angle)[AXIS_SIZE], (*lambda)[AXIS_SIZE]; /* owned */
} axis_texts;

static void put_matrix(text_sink *sink, const dif_table *table, const axis_texts *axes)
{
    const int nx = table->plan.n_angle, ny = table->plan.n_lambda;
    put_text(sink, table->plan.fixed_is_wo ? "lambda_nm\\theta_i_deg" : "lambda_nm\\theta_r_deg");
    for (int ix = 0; ix < nx; ix++) {
        put_text(sink, ",");
        put_text(sink, axes->angle[ix]);
    }
    put_text(sink, "\n");
    for (int iy = 0; iy < ny && sink->number == 0; iy++) {
        put_text(sink, axes->lambda[iy]);
        for (int ix = 0; ix < nx; ix++) {
            put_text(sink, ",");
            put_value(sink, table->value[(size_t)iy * (size_t)nx + (size_t)ix]);
        }
        put_text(sink, "\n");
    }
}

static void put_tidy(text_sink *sink, const dif_table *table, const axis_texts *axes)
{
    const int nx = table->plan.n_angle, ny = table->plan.n_lambda;
    char fixed[DIF_NUMBER_SIZE], azimuth[DIF_NUMBER_SIZE];
    dif_table_print_deg(table->plan.fixed_rad, fixed);
    dif_table_print_deg(table->plan.azimuth_rad, azimuth);
    put_text(sink, "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value\n");
    for (int iy = 0; iy < ny && sink->number == 0; iy++) {
        for (int ix = 0; ix < nx; ix++) {
            const char *cells[] = {table->plan.fixed_is_wo ? axes->angle[ix] : fixed, azimuth,
                                   table->plan.fixed_is_wo ? fixed : axes->angle[ix], azimuth, axes->lambda[iy]};
            for (size_t k = 0; k < sizeof cells / sizeof *cells; k++) {
                put_text(sink, cells[k]);
                put(sink, ",", 1);
            }
            put_value(sink, table->value[(size_t)iy * (size_t)nx + (size_t)ix]);
            put(sink, "\n", 1);
        }
    }
}

static dif_status write_all(text_sink *sink, const dif_table *table, dif_layout layout, const dif_manifest *manifest,
                            dif_error *err)
{
    const int nx = table->plan.n_angle, ny = table->plan.n_lambda;
    axis_texts axes = {dif_alloc((size_t)nx, sizeof *axes.angle), dif_alloc((size_t)ny, sizeof *axes.lambda)};
    sink->buffer = dif_alloc(BUFFER_SIZE, 1);
    dif_status status = DIF_OK;
    if (!axes.angle || !axes.lambda || !sink->buffer) {
        status = dif_fail(err, DIF_ERR_NOMEM, "CSV of %d x %d values", nx, ny);
        dif_fail_named(err, sink->name, status);
        goto cleanup;
    }
    for (int i = 0; i < nx; i++)
        dif_table_print_deg(table->plan.angle_rad[i], axes.angle[i]);
    for (int i = 0; i < ny; i++)
        dif_table_print_nm(table->plan.lambda_um[i], axes.lambda[i]);
    put_header(sink, table, layout, manifest);
    if (layout == DIF_LAYOUT_MATRIX)
        put_matrix(sink, table, &axes);
    else
        put_tidy(sink, table, &axes);
    flush(sink);
    if (sink->number)
        status = dif_fail_errno(err, sink->name, "cannot write", sink->number);
cleanup:
    dif_release(axes.angle);
    dif_release(axes.lambda);
    dif_release(sink->buffer);
    return status;
}

static dif_status write_stdout(const dif_table *table, dif_layout layout, const dif_manifest *manifest, dif_error *err)
{
    text_sink sink = {.stream = stdout, .name = "standard output"};
    const dif_status status = write_all(&sink, table, layout, manifest, err);
    if (!status && fflush(stdout) != 0)
        return dif_fail_errno(err, sink.name, "cannot write", errno);
    return status;
}

dif_status dif_table_csv_write(const char *path, const dif_table *table, dif_layout layout,
                               const dif_manifest *manifest, dif_error *err)
{
    if (!path)
        return write_stdout(table, layout, manifest, err);
    dif_outfile out;
    dif_status status = dif_outfile_open(path, &out, err);
    if (status)
        return status;
    text_sink sink = {.stream = out.stream, .name = path};
    status = write_all(&sink, table, layout, manifest, err);
    if (status) {
        dif_outfile_abort(&out);
        return status;
    }
    return dif_outfile_commit(&out, err);
}
