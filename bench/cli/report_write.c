#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/report_job.h"
#include "core/io/field_io.h"
#include "core/io/file.h"
#include "core/io/table_io.h"
#include "core/units.h"
#include "reports/result.h"

enum { PATH_SIZE = 4096 };

static dif_status join(const char *folder, const char *slug, const char *ending, char path[PATH_SIZE], dif_error *err)
{
    const int n = snprintf(path, PATH_SIZE, "%s/%s%s", folder, slug, ending);
    if (n < 0 || n >= PATH_SIZE)
        return dif_fail(err, DIF_ERR_SIZE, "%.100s...: path too long", folder);
    return DIF_OK;
}

dif_status dif_report_write_json(const char *folder, const char *name, const json_t *doc, dif_error *err)
{
    char path[PATH_SIZE];
    dif_outfile out = {0};
    dif_status status = join(folder, name, "", path, err);
    if (status == DIF_OK)
        status = dif_outfile_open(path, &out, err);
    if (status != DIF_OK)
        return status;
    if (json_dumpf(doc, out.stream, JSON_INDENT(1) | JSON_REAL_PRECISION(12)) != 0 || fputc('\n', out.stream) == EOF)
        status = dif_fail(err, DIF_ERR_IO, "%s: %s", path, strerror(errno));
    if (status == DIF_OK)
        return dif_outfile_commit(&out, err);
    dif_outfile_abort(&out);
    return status;
}

static void write_comments(FILE *out, const dif_manifest *manifest)
{
    for (int i = 0; i < manifest->n; i++)
        fprintf(out, "# %s: %s\n", manifest->item[i].key, manifest->item[i].value);
}

static dif_status write_maxima(const char *path, const dif_report_job *job, const dif_report_data *data, dif_error *err)
{
    const dif_maxima *maxima = &data->maxima;
    dif_outfile out = {0};
    const dif_status status = dif_outfile_open(path, &out, err);
    if (status != DIF_OK)
        return status;
    write_comments(out.stream, &job->provenance);
    fputs(DIF_RESULT_MAXIMA_HEADER "\n", out.stream);
    for (int i = 0; i < maxima->n; i++) {
        const dif_maximum *m = &maxima->item[i];
        fprintf(out.stream, "%.9g,%.9g,%.9g,%d,%.6g,%.9g,%d,%d,%d\n", dif_nm_from_um(m->lambda_um),
                dif_deg_from_rad(m->angle_rad), m->value, m->order, dif_deg_from_rad(m->residual_rad),
                dif_nm_from_um(m->period_um), (int)m->is_global, (int)m->at_edge, (int)dif_report_on_line(data, m));
    }
    return dif_outfile_commit(&out, err);
}

static dif_status write_lines(const char *path, const dif_report_job *job, const dif_report_data *data, dif_error *err)
{
    dif_outfile out = {0};
    const dif_status status = dif_outfile_open(path, &out, err);
    if (status != DIF_OK)
        return status;
    write_comments(out.stream, &job->provenance);
    fputs(DIF_RESULT_LINES_HEADER "\n", out.stream);
    for (int i = 0; i < data->n_line; i++)
        fprintf(out.stream, "%.9g,%.9g,%.0f\n", data->line[i][0], data->line[i][1], data->line[i][2]);
    return dif_outfile_commit(&out, err);
}

static dif_status write_map(const char *folder, const dif_report_job *job, const dif_report_data *data, dif_error *err)
{
    char path[PATH_SIZE];
    const dif_report_map_data *map = &data->map;
    dif_status status = join(folder, job->slug, ".map.exr", path, err);
    if (status == DIF_OK)
        status = dif_report_map_write_exr(path, map, &job->provenance, err);
    if (status == DIF_OK)
        status = join(folder, job->slug, ".map.png", path, err);
    if (status == DIF_OK)
        status = dif_report_map_write(path, &map->map, map->exposure, map->gamut, err);
    if (status == DIF_OK)
        status = join(folder, job->slug, ".map-level.png", path, err);
    return status == DIF_OK ? dif_report_map_write(path, &map->map, (double)NAN, map->gamut, err) : status;
}

static dif_status write_doc(const char *folder, const dif_report_job *job, const dif_report_data *data, bool *outside,
                            dif_error *err)
{
    char name[128];
    snprintf(name, sizeof name, "%s.json", job->slug);
    json_t *doc = dif_report_json(job, data, outside);
    if (!doc)
        return dif_fail(err, DIF_ERR_NOMEM, "results of %s", job->slug);
    const dif_status status = dif_report_write_json(folder, name, doc, err);
    json_decref(doc);
    return status;
}

dif_status dif_report_write(const char *folder, const dif_report_job *job, dif_report_data *data, bool *outside,
                            dif_error *err)
{
    char path[PATH_SIZE];
    dif_status status = join(folder, job->slug, ".height.exr", path, err);
    if (status == DIF_OK)
        status = dif_field_write(path, &job->field, &job->provenance, err);
    if (status == DIF_OK)
        status = join(folder, job->slug, ".table.exr", path, err);
    if (status == DIF_OK)
        status = dif_table_write(path, &data->table, DIF_LAYOUT_TIDY, &job->provenance, err);
    if (status == DIF_OK)
        status = join(folder, job->slug, ".table.csv", path, err);
    if (status == DIF_OK) /* the tidy layout would take five times the room */
        status = dif_table_write(path, &data->table, DIF_LAYOUT_MATRIX, &job->provenance, err);
    if (status == DIF_OK)
        status = join(folder, job->slug, ".maxima.csv", path, err);
    if (status == DIF_OK)
        status = write_maxima(path, job, data, err);
    if (status == DIF_OK)
        status = join(folder, job->slug, ".lines.csv", path, err);
    if (status == DIF_OK)
        status = write_lines(path, job, data, err);
    if (status == DIF_OK && data->map.map.n_pixel > 0)
        status = write_map(folder, job, data, err);
    if (status == DIF_OK && data->render.frame.nx > 0)
        status = dif_report_render_write(folder, job, &data->render, err);
    if (status == DIF_OK && data->slopes.slopes.square.n > 0)
        status = dif_report_slopes_write(folder, job, &data->slopes, err);
    if (status == DIF_OK)
        status = dif_report_study_write(folder, job, &data->study, err);
    return status == DIF_OK ? write_doc(folder, job, data, outside, err) : status;
}
