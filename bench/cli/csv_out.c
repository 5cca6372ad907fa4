#include "bench/cli/csv_out.h"

#include "bench/cli/cli.h"

#include <string.h>

dif_status dif_csv_out_open(const char *path, dif_csv_out *out, dif_error *err)
{
    *out = (dif_csv_out){.stream = stdout};
    if (!path || strcmp(path, "-") == 0)
        return DIF_OK;
    const dif_status status = dif_outfile_open(path, &out->file, err);
    out->stream = out->file.stream;
    return status;
}

dif_status dif_csv_out_close(dif_csv_out *out, dif_error *err)
{
    return out->stream == stdout ? DIF_OK : dif_outfile_commit(&out->file, err);
}

void dif_csv_out_provenance(FILE *stream, const dif_manifest *manifest)
{
    for (int i = 0; i < manifest->n; i++)
        fprintf(stream, "# %s: %s\n", manifest->item[i].key, manifest->item[i].value);
}

dif_status dif_cli_check_out(const char *path, dif_error *err)
{
    dif_outfile out;
    if (!path || strcmp(path, "-") == 0)
        return DIF_OK;
    dif_status status = dif_outfile_reserve(path, &out, err);
    if (status)
        return status;
    const bool is_device = strcmp(out.path, out.path_tmp) == 0; /* opening a pipe would end it */
    dif_outfile_abort(&out);
    if (is_device)
        return DIF_OK;
    status = dif_outfile_open(path, &out, err);
    dif_outfile_abort(&out);
    return status;
}
