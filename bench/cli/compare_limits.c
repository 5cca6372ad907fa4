/* Limits of a comparison as JSON: {"schema": "diffbench thresholds 1", "thresholds": [{"method", "question", "metric",
 * "limit" (a number, or null: not judged), "reason"}, ...]}; method and question may be absent or "*": all. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/compare_job.h"
#include "core/alloc.h"
#include "core/io/file.h"

#define SCHEMA "diffbench thresholds 1"
enum { BYTES_MAX = 1 << 20, ROWS_MAX = 10000 };

static bool is_question(const char *name)
{
    for (int i = DIF_REGRESS_TABLE; i <= DIF_REGRESS_FULL; i++)
        if (strcmp(name, dif_regress_question_name((dif_regress_question)i)) == 0)
            return true;
    return strcmp(name, "*") == 0;
}

static bool is_method(const char *name)
{
    for (int i = 0; i < DIF_REGRESS_METHODS; i++)
        if (strcmp(name, dif_regress_method_name(i)) == 0)
            return true;
    return strcmp(name, "*") == 0;
}

/* A text of a row, `absent` where there is none, NULL where it is no text. */
static const char *text_of(const json_t *row, const char *key, const char *absent)
{
    const json_t *value = json_object_get(row, key);
    return value ? json_string_value(value) : absent;
}

static dif_status parse_row(const char *path, int number, const json_t *row, dif_regress_limit *out, dif_error *err)
{
    const char *method = text_of(row, "method", "*"), *question = text_of(row, "question", "*");
    const char *metric = text_of(row, "metric", NULL), *reason = text_of(row, "reason", NULL);
    const json_t *limit = json_object_get(row, "limit");
    if (!method || !is_method(method))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: threshold %d: no method \"%s\"", path, number, method ? method : "?");
    if (!question || !is_question(question))
        return dif_fail(err, DIF_ERR_FORMAT,
                        "%s: threshold %d: no question \"%s\", expected table, map, colour, full or *", path, number,
                        question ? question : "?");
    if (!metric || !dif_regress_metric_from_name(metric, &out->metric))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: threshold %d: no metric \"%s\" (--print-thresholds names them)", path,
                        number, metric ? metric : "?");
    if (!json_is_null(limit) && !(json_is_number(limit) && json_number_value(limit) >= 0.0))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: threshold %d: \"limit\" is no number >= 0, nor null", path, number);
    if (!reason || strlen(reason) < 3)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: threshold %d: no \"reason\" given", path, number);
    snprintf(out->method, sizeof out->method, "%s", method);
    snprintf(out->question, sizeof out->question, "%s", question);
    snprintf(out->reason, sizeof out->reason, "%s", reason);
    out->limit = json_is_null(limit) ? (double)INFINITY : json_number_value(limit);
    return DIF_OK;
}

static dif_status take_rows(const char *path, const json_t *rows, dif_compare_limits *out, dif_error *err)
{
    int n_default;
    const dif_regress_limit *defaults = dif_regress_limits_default(&n_default);
    const size_t n_row = json_array_size(rows);
    if (n_row > ROWS_MAX)
        return dif_fail(err, DIF_ERR_SIZE, "%s: %zu thresholds, want at most %d", path, n_row, ROWS_MAX);
    out->limit = dif_alloc((size_t)n_default + n_row, sizeof *out->limit);
    if (!out->limit)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu thresholds", n_row);
    memcpy(out->limit, defaults, (size_t)n_default * sizeof *out->limit);
    out->n = n_default;
    for (size_t i = 0; i < n_row; i++) {
        const dif_status status = parse_row(path, (int)i + 1, json_array_get(rows, i), out->limit + out->n, err);
        if (status != DIF_OK)
            return status;
        out->n++;
    }
    return DIF_OK;
}

dif_status dif_compare_limits_load(const char *path, dif_compare_limits *out, dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    json_error_t why;
    *out = (dif_compare_limits){0};
    if (!path)
        return take_rows("", NULL, out, err);
    dif_status status = dif_file_read(path, BYTES_MAX, &data, &n, err);
    if (status != DIF_OK)
        return status;
    json_t *doc = json_loadb((const char *)data, n, JSON_REJECT_DUPLICATES, &why);
    const json_t *rows = json_object_get(doc, "thresholds");
    const char *schema = json_string_value(json_object_get(doc, "schema"));
    dif_release(data);
    if (!doc)
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: line %d: %s", path, why.line, why.text);
    else if (!schema || strcmp(schema, SCHEMA) != 0)
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: \"schema\" is not \"" SCHEMA "\"", path);
    else if (!json_is_array(rows))
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: \"thresholds\" is not a list", path);
    else
        status = take_rows(path, rows, out, err);
    json_decref(doc);
    if (status != DIF_OK)
        dif_compare_limits_free(out);
    return status;
}

void dif_compare_limits_free(dif_compare_limits *limits)
{
    dif_release(limits->limit);
    *limits = (dif_compare_limits){0};
}

json_t *dif_compare_limits_json(const dif_compare_limits *limits)
{
    json_t *rows = json_array(), *metrics = json_object();
    for (int i = 0; i < limits->n; i++) {
        const dif_regress_limit *limit = limits->limit + i;
        json_array_append_new(rows, json_pack("{s:s, s:s, s:s, s:o, s:s}", "method", limit->method, "question",
                                              limit->question, "metric", dif_regress_metric_name(limit->metric),
                                              "limit", dif_json_number(limit->limit), "reason", limit->reason));
    }
    for (int i = 0; i < DIF_REGRESS_METRICS; i++)
        json_object_set_new(metrics, dif_regress_metric_name((dif_regress_metric)i),
                            json_string(dif_regress_metric_text((dif_regress_metric)i)));
    return json_pack("{s:s, s:o, s:o}", "schema", SCHEMA, "metrics", metrics, "thresholds", rows);
}
