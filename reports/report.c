#include "reports/report.h"

#include <errno.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/file.h"
#include "reports/page.h"
#include "reports/result.h"

enum { PATH_SIZE = 4096 };

/* Opens FOLDER/NAME for writing. */
static dif_status open_in(const char *folder, const char *name, dif_outfile *out, dif_error *err)
{
    char path[PATH_SIZE];
    const int n = snprintf(path, sizeof path, "%s/%s", folder, name);
    if (n < 0 || n >= PATH_SIZE)
        return dif_fail(err, DIF_ERR_SIZE, "%.100s...: path too long", folder);
    return dif_outfile_open(path, out, err);
}

static dif_status load_docs(const char *folder, const json_t *list, json_t *docs, dif_error *err)
{
    size_t i;
    json_t *name;
    json_array_foreach(dif_result_at(list, "surfaces"), i, name)
    {
        json_t *doc = NULL;
        const dif_status status = dif_result_doc_load(folder, json_string_value(name), &doc, err);
        if (status != DIF_OK)
            return status;
        if (json_array_append_new(docs, doc) != 0)
            return dif_fail(err, DIF_ERR_NOMEM, "list of surfaces");
    }
    return DIF_OK;
}

static dif_status write_page(const char *folder, const json_t *list, const json_t *docs, dif_error *err)
{
    dif_outfile out = {0};
    dif_status status = open_in(folder, "index.html", &out, err);
    if (status != DIF_OK)
        return status;
    dif_page_head(out.stream, list, docs);
    size_t i;
    json_t *name;
    json_array_foreach(dif_result_at(list, "surfaces"), i, name)
    {
        dif_result result;
        status = dif_result_load(folder, json_string_value(name), &result, err);
        if (status != DIF_OK)
            break;
        status = dif_page_surface(out.stream, (int)i + 1, &result, err);
        dif_result_free(&result);
        if (status != DIF_OK)
            break;
    }
    if (status == DIF_OK) {
        dif_page_published(out.stream, list, docs);
        dif_page_tail(out.stream, list);
        return dif_outfile_commit(&out, err);
    }
    dif_outfile_abort(&out);
    return status;
}

static dif_status write_json(const char *folder, const json_t *list, json_t *docs, dif_error *err)
{
    dif_outfile out = {0};
    dif_status status = open_in(folder, "report.json", &out, err);
    if (status != DIF_OK)
        return status;
    json_t *report =
        json_pack("{s:s, s:s, s:O, s:O}", "schema", "diffbench report 1", "title", dif_result_text(list, "title"),
                  "provenance", dif_result_at(list, "provenance"), "surfaces", docs);
    if (!report)
        status = dif_fail(err, DIF_ERR_NOMEM, "%s/report.json", folder);
    else if (json_dumpf(report, out.stream, JSON_INDENT(1) | JSON_REAL_PRECISION(12)) != 0 ||
             fputc('\n', out.stream) == EOF)
        status = dif_fail(err, DIF_ERR_IO, "%s/report.json: %s", folder, strerror(errno));
    json_decref(report);
    if (status == DIF_OK)
        return dif_outfile_commit(&out, err);
    dif_outfile_abort(&out);
    return status;
}

dif_status dif_report_build(const char *folder, dif_error *err)
{
    json_t *list = NULL;
    dif_status status = dif_result_list_load(folder, &list, err);
    if (status != DIF_OK)
        return status;
    json_t *docs = json_array();
    if (!docs)
        status = dif_fail(err, DIF_ERR_NOMEM, "list of surfaces");
    if (status == DIF_OK)
        status = load_docs(folder, list, docs, err);
    if (status == DIF_OK)
        status = write_page(folder, list, docs, err);
    if (status == DIF_OK)
        status = write_json(folder, list, docs, err);
    json_decref(docs);
    json_decref(list);
    return status;
}
