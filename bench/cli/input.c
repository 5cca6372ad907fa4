/* Operands: surfaces, and files that may be a table or a surface. */
#include <string.h>

#include "bench/cli/cli.h"
#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/table_io.h"

static const size_t INPUT_BYTES_MAX = (size_t)1 << 33;
static const size_t SNIFF_BYTES = 65536;

/* A surface that was read: refuses what has no extent, passes the warning on. */
static dif_status accept(const dif_cli *cli, const char *path, dif_field_file *file, dif_error *err)
{
    const int nx = file->field.nx, ny = file->field.ny;
    if (nx < 2 || ny < 2) {
        dif_field_file_free(file);
        return dif_fail(err, DIF_ERR_SIZE, "%s: %d x %d samples, expected at least 2 x 2", path, nx, ny);
    }
    if (file->warning[0])
        dif_cli_say(cli, "%s", file->warning);
    return DIF_OK;
}

dif_status dif_cli_surface_read(const dif_cli *cli, const char *path, const dif_cli_surface *surface,
                                dif_field_file *out, dif_error *err)
{
    const dif_field_request request = dif_cli_surface_request(surface);
    const dif_status status = dif_field_read(path, &request, out, err);
    return status ? status : accept(cli, path, out, err);
}

static bool holds(const unsigned char *data, size_t n, const char *word)
{
    const size_t n_word = strlen(word);
    for (size_t i = 0; i + n_word <= n; i++)
        if (data[i] == (unsigned char)word[0] && memcmp(data + i, word, n_word) == 0)
            return true;
    return false;
}

static bool looks_like_table(const unsigned char *data, size_t n)
{
    const size_t n_sniff = n < SNIFF_BYTES ? n : SNIFF_BYTES;
    return holds(data, n_sniff, "lambda_nm") || holds(data, n_sniff, "wavelength_nm");
}

dif_status dif_cli_input_read(const dif_cli *cli, const char *path, const dif_cli_surface *surface, dif_cli_input *out,
                              dif_error *err)
{
    const dif_field_request request = dif_cli_surface_request(surface);
    unsigned char *data = NULL;
    size_t n = 0;
    *out = (dif_cli_input){0};
    dif_status status = dif_file_read(path, INPUT_BYTES_MAX, &data, &n, err);
    if (status)
        return status;
    out->is_table = looks_like_table(data, n);
    if (out->is_table)
        status = dif_table_parse(data, n, path, &out->table, &out->manifest, err);
    else
        status = dif_field_parse(data, n, path, &request, &out->file, err);
    dif_release(data);
    if (!status && !out->is_table)
        status = accept(cli, path, &out->file, err);
    return status;
}

void dif_cli_input_free(dif_cli_input *input)
{
    dif_table_free(&input->table);
    dif_manifest_free(&input->manifest);
    dif_field_file_free(&input->file);
    *input = (dif_cli_input){0};
}
