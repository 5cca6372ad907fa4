/* Operands: surfaces, and files that may be a table or a surface. */
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/table_io.h"
#include "fixtures/surfaces.h"

static const size_t INPUT_BYTES_MAX = (size_t)1 << 33;
static const size_t SNIFF_BYTES = (size_t)16 << 20; /* the axes of a wide table come before its names */

static const unsigned char *find(const unsigned char *data, size_t n, const char *word)
{
    const size_t n_word = strlen(word);
    for (size_t i = 0; i + n_word <= n; i++)
        if (data[i] == (unsigned char)word[0] && memcmp(data + i, word, n_word) == 0)
            return data + i;
    return NULL;
}

static bool looks_like_table(const unsigned char *data, size_t n)
{
    const size_t n_sniff = n < SNIFF_BYTES ? n : SNIFF_BYTES;
    return find(data, n_sniff, "lambda_nm") || find(data, n_sniff, "wavelength_nm");
}

/* The value behind a key of our provenance at text[n]: ` = VALUE` and a line end in GSF; in EXR NUL, "string", NUL, the
 * length as little-endian 32 bits and the value. Returns its length, 0 if this is neither. */
static size_t value_behind(const unsigned char *text, size_t n, const unsigned char **value)
{
    static const char in_gsf[] = " = ", in_exr[] = "\0string";
    const size_t n_gsf = sizeof in_gsf - 1, n_exr = sizeof in_exr + 4;
    size_t n_value = 0;
    if (n > n_gsf && memcmp(text, in_gsf, n_gsf) == 0) {
        *value = text + n_gsf;
        while (n_gsf + n_value < n && (*value)[n_value] != '\n')
            n_value++;
    } else if (n > n_exr && memcmp(text, in_exr, sizeof in_exr) == 0 && !text[n_exr - 3] && !text[n_exr - 2]) {
        *value = text + n_exr;
        n_value = text[n_exr - 4];
        n_value = n_value <= n - n_exr ? n_value : 0;
    }
    return n_value;
}

/* The kind that `fixture` wrote into the provenance of a GSF or EXR file. */
static bool fixture_kind(const unsigned char *data, size_t n, dif_surface_kind *kind)
{
    static const char key[] = "diffbench.fixture";
    const unsigned char *end = data + (n < SNIFF_BYTES ? n : SNIFF_BYTES);
    const unsigned char *at = data, *value = NULL;
    while ((at = find(at, (size_t)(end - at), key))) {
        char name[32] = "";
        at += sizeof key - 1;
        const size_t n_value = value_behind(at, (size_t)(end - at), &value);
        if (n_value > 0 && n_value < sizeof name) {
            memcpy(name, value, n_value);
            if (dif_surface_kind_from_name(name, kind))
                return true;
        }
    }
    return false;
}

/* Parses a surface, refuses what has no extent, passes the warning on. */
static dif_status parse_surface(const dif_cli *cli, const char *path, const unsigned char *data, size_t n,
                                const dif_cli_surface *surface, dif_field_file *out, dif_error *err)
{
    const dif_field_request request = dif_cli_surface_request(surface);
    dif_surface_kind kind;
    dif_status status = dif_field_parse(data, n, path, &request, out, err);
    if (status)
        return status;
    const int nx = out->field.nx, ny = out->field.ny;
    if (nx < 2 || ny < 2) {
        dif_field_file_free(out);
        return dif_fail(err, DIF_ERR_SIZE, "%s: %d x %d samples, expected at least 2 x 2", path, nx, ny);
    }
    if (fixture_kind(data, n, &kind))
        snprintf(out->title, sizeof out->title, "diffbench fixture %s", dif_surface_kind_name(kind));
    if (out->warning[0])
        dif_cli_say(cli, "%s%s%s", cli->n_operand > 1 ? path : "", cli->n_operand > 1 ? ": " : "", out->warning);
    status = dif_cli_prep_apply(cli, path, surface, out, err);
    if (status)
        dif_field_file_free(out);
    return status;
}

dif_status dif_cli_surface_read(const dif_cli *cli, const char *path, const dif_cli_surface *surface,
                                dif_field_file *out, dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    *out = (dif_field_file){0};
    dif_status status = dif_file_read(path, INPUT_BYTES_MAX, &data, &n, err);
    if (!status)
        status = parse_surface(cli, path, data, n, surface, out, err);
    dif_release(data);
    return status;
}

static dif_status input_read(const dif_cli *cli, const char *path, const dif_cli_surface *surface, bool wants_channels,
                             dif_cli_input *out, dif_error *err)
{
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
        status = parse_surface(cli, path, data, n, surface, &out->file, err);
    if (wants_channels && !out->is_table && dif_field_channels_parse(data, n, path, &out->channels, NULL) != DIF_OK)
        dif_channels_free(&out->channels); /* then reading fails, too, and says why */
    dif_release(data);
    return status;
}

dif_status dif_cli_input_read(const dif_cli *cli, const char *path, const dif_cli_surface *surface, dif_cli_input *out,
                              dif_error *err)
{
    return input_read(cli, path, surface, false, out, err);
}

dif_status dif_cli_input_read_listed(const dif_cli *cli, const char *path, const dif_cli_surface *surface,
                                     dif_cli_input *out, dif_error *err)
{
    return input_read(cli, path, surface, true, out, err);
}

void dif_cli_input_free(dif_cli_input *input)
{
    dif_table_free(&input->table);
    dif_manifest_free(&input->manifest);
    dif_field_file_free(&input->file);
    dif_channels_free(&input->channels);
    *input = (dif_cli_input){0};
}
