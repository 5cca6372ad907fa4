#include "bench/cli/csv_out.h"

#include <string.h>

dif_status dif_csv_open(const char *path, dif_csv_out *out, dif_error *err)
{
    *out = (dif_csv_out){.stream = stdout};
    if (!path || strcmp(path, "-") == 0)
        return DIF_OK;
    const dif_status status = dif_outfile_open(path, &out->file, err);
    out->stream = out->file.stream;
    return status;
}

dif_status dif_csv_close(dif_csv_out *out, dif_error *err)
{
    return out->stream == stdout ? DIF_OK : dif_outfile_commit(&out->file, err);
}

void dif_csv_provenance(FILE *stream, const dif_manifest *manifest)
{
    for (int i = 0; i < manifest->n; i++)
        fprintf(stream, "# %s: %s\n", manifest->item[i].key, manifest->item[i].value);
}
