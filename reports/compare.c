#include "reports/compare.h"

#include <string.h>

#include "core/alloc.h"
#include "core/io/file.h"
#include "reports/page.h"
#include "reports/result.h"

enum { PATH_SIZE = 4096, BYTES_MAX = 1 << 28 };

static dif_status join(const char *folder, const char *name, char path[PATH_SIZE], dif_error *err)
{
    const int n = snprintf(path, PATH_SIZE, "%s/%s", folder, name);
    return n >= 0 && n < PATH_SIZE ? DIF_OK : dif_fail(err, DIF_ERR_SIZE, "%.100s...: path too long", folder);
}

static dif_status check(const char *path, const json_t *doc, dif_error *err)
{
    static const char *const objects[] = {"provenance", "device", "conditions", "thresholds", "verdict"};
    size_t i;
    json_t *surface;
    if (strcmp(dif_result_text(doc, "schema"), DIF_COMPARE_SCHEMA) != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: not a comparison: \"schema\" is not \"" DIF_COMPARE_SCHEMA "\"",
                        path);
    for (i = 0; i < sizeof objects / sizeof *objects; i++)
        if (!json_is_object(json_object_get(doc, objects[i])))
            return dif_fail(err, DIF_ERR_FORMAT, "%s: no \"%s\" in it", path, objects[i]);
    if (!json_is_array(json_object_get(doc, "surfaces")))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: \"surfaces\" is not a list", path);
    json_array_foreach(json_object_get(doc, "surfaces"), i, surface)
    {
        if (!json_is_array(json_object_get(surface, "cases")))
            return dif_fail(err, DIF_ERR_FORMAT, "%s: surface %zu has no \"cases\"", path, i + 1);
    }
    return DIF_OK;
}

static dif_status load(const char *folder, json_t **doc, dif_error *err)
{
    char path[PATH_SIZE];
    unsigned char *data = NULL;
    size_t n = 0;
    json_error_t why;
    *doc = NULL;
    dif_status status = join(folder, "compare.json", path, err);
    if (status == DIF_OK)
        status = dif_file_read(path, BYTES_MAX, &data, &n, err);
    if (status != DIF_OK)
        return status;
    *doc = json_loadb((const char *)data, n, JSON_REJECT_DUPLICATES, &why);
    dif_release(data);
    status = *doc ? check(path, *doc, err) : dif_fail(err, DIF_ERR_FORMAT, "%s: line %d: %s", path, why.line, why.text);
    if (status != DIF_OK) {
        json_decref(*doc);
        *doc = NULL;
    }
    return status;
}

static dif_status write_page(const char *folder, const json_t *doc, dif_error *err)
{
    char path[PATH_SIZE];
    dif_outfile out = {0};
    dif_status status = join(folder, "index.html", path, err);
    if (status == DIF_OK)
        status = dif_outfile_open(path, &out, err);
    if (status != DIF_OK)
        return status;
    status = dif_compare_page(out.stream, folder, doc, err);
    if (status == DIF_OK)
        return dif_outfile_commit(&out, err);
    dif_outfile_abort(&out);
    return status;
}

static dif_status write_junit(const char *folder, const json_t *doc, dif_error *err)
{
    char path[PATH_SIZE];
    dif_outfile out = {0};
    dif_status status = join(folder, "junit.xml", path, err);
    if (status == DIF_OK)
        status = dif_outfile_open(path, &out, err);
    if (status != DIF_OK)
        return status;
    dif_compare_junit(out.stream, doc);
    return dif_outfile_commit(&out, err);
}

dif_status dif_compare_build(const char *folder, dif_error *err)
{
    json_t *doc;
    dif_status status = load(folder, &doc, err);
    if (status == DIF_OK)
        status = write_page(folder, doc, err);
    if (status == DIF_OK)
        status = write_junit(folder, doc, err);
    json_decref(doc);
    return status;
}
