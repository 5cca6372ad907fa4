/* An earlier comparison beside this one. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/compare_job.h"
#include "core/alloc.h"
#include "core/io/file.h"
#include "reports/compare.h"

static const double NOISE_SHARE = 0.01; /* of a limit: what stays below it has not moved */
enum { BYTES_MAX = 1 << 28 };

/* What two runs have in common, and what moved. */
typedef struct ledger {
    double factor;
    int n_same, n_worse;
    json_t *rows;
} ledger;

static const char *text(const json_t *object, const char *key)
{
    const char *value = json_string_value(json_object_get(object, key));
    return value ? value : "";
}

static bool same_case(const json_t *a, const json_t *b)
{
    return strcmp(text(a, "method"), text(b, "method")) == 0 && strcmp(text(a, "question"), text(b, "question")) == 0 &&
           strcmp(text(a, "path"), text(b, "path")) == 0;
}

/* The row of a list that has the same text under a key. */
static const json_t *find_named(const json_t *list, const char *key, const char *name)
{
    for (size_t i = 0; i < json_array_size(list); i++)
        if (strcmp(text(json_array_get(list, i), key), name) == 0)
            return json_array_get(list, i);
    return NULL;
}

static const json_t *find_case(const json_t *surface, const json_t *like)
{
    const json_t *cases = json_object_get(surface, "cases");
    for (size_t i = 0; i < json_array_size(cases); i++)
        if (same_case(json_array_get(cases, i), like))
            return json_array_get(cases, i);
    return NULL;
}

static void note(ledger *to, const char *slug, const json_t *one, const char *metric, json_t *before, json_t *now,
                 const char *state)
{
    to->n_worse += strcmp(state, "worse") == 0 || strcmp(state, "missing") == 0;
    json_array_append_new(to->rows,
                          json_pack("{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:s}", "surface", slug, "method",
                                    text(one, "method"), "question", text(one, "question"), "path", text(one, "path"),
                                    "metric", metric, "before", before, "now", now, "state", state));
}

/* null is a number that was infinite. */
static double number(const json_t *check, const char *key)
{
    const json_t *value = json_object_get(check, key);
    return json_is_number(value) ? json_number_value(value) : (double)INFINITY;
}

static void compare_check(ledger *to, const char *slug, const json_t *one, const json_t *before, const json_t *now)
{
    const double was = number(before, "value"), is = number(now, "value");
    const double noise = NOISE_SHARE * fmin(number(now, "limit"), number(before, "limit"));
    const char *state = NULL;
    if (is > to->factor * was && is > noise)
        state = "worse";
    else if (was > to->factor * is && was > noise)
        state = "better";
    if (state)
        note(to, slug, one, text(now, "metric"), dif_json_number(was), dif_json_number(is), state);
    else
        to->n_same++;
}

static void compare_case(ledger *to, const char *slug, const json_t *before, const json_t *now)
{
    const json_t *old = json_object_get(before, "checks"), *checks = json_object_get(now, "checks");
    const bool passed = json_is_true(json_object_get(before, "pass")),
               passes = json_is_true(json_object_get(now, "pass"));
    if (passed != passes)
        note(to, slug, now, "verdict", json_string(passed ? "pass" : "fail"), json_string(passes ? "pass" : "fail"),
             passes ? "better" : "worse");
    for (size_t i = 0; i < json_array_size(checks); i++) {
        const json_t *check = json_array_get(checks, i), *was = find_named(old, "metric", text(check, "metric"));
        if (was)
            compare_check(to, slug, now, was, check);
        else
            note(to, slug, now, text(check, "metric"), json_null(), dif_json_number(number(check, "value")), "new");
    }
}

/* Cases of one list of surfaces that the other does not have. */
static void note_absent(ledger *to, const json_t *surfaces, const json_t *others, const char *state)
{
    for (size_t i = 0; i < json_array_size(surfaces); i++) {
        const json_t *surface = json_array_get(surfaces, i), *cases = json_object_get(surface, "cases");
        const json_t *other = find_named(others, "slug", text(surface, "slug"));
        for (size_t k = 0; k < json_array_size(cases); k++)
            if (!find_case(other, json_array_get(cases, k)))
                note(to, text(surface, "slug"), json_array_get(cases, k), "", json_null(), json_null(), state);
    }
}

static void compare_surfaces(ledger *to, const json_t *before, const json_t *now)
{
    for (size_t i = 0; i < json_array_size(now); i++) {
        const json_t *surface = json_array_get(now, i), *cases = json_object_get(surface, "cases");
        const json_t *old = find_named(before, "slug", text(surface, "slug"));
        for (size_t k = 0; k < json_array_size(cases); k++) {
            const json_t *one = json_array_get(cases, k), *was = find_case(old, one);
            if (was)
                compare_case(to, text(surface, "slug"), was, one);
        }
    }
    note_absent(to, now, before, "new");
    note_absent(to, before, now, "missing");
}

static dif_status load(const char *path, json_t **doc, char hex[65], dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    json_error_t why;
    *doc = NULL;
    dif_status status = dif_file_read(path, BYTES_MAX, &data, &n, err);
    if (status != DIF_OK)
        return status;
    dif_sha256_hex(data, n, hex);
    *doc = json_loadb((const char *)data, n, JSON_REJECT_DUPLICATES, &why);
    dif_release(data);
    if (!*doc)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: line %d: %s", path, why.line, why.text);
    if (strcmp(text(*doc, "schema"), DIF_COMPARE_SCHEMA) == 0 && json_is_array(json_object_get(*doc, "surfaces")))
        return DIF_OK;
    json_decref(*doc);
    *doc = NULL;
    return dif_fail(err, DIF_ERR_FORMAT, "%s: not a comparison: \"schema\" is not \"" DIF_COMPARE_SCHEMA "\"", path);
}

dif_status dif_compare_baseline(const char *path, const json_t *surfaces, double factor, json_t **out, int *n_worse,
                                dif_error *err)
{
    json_t *before;
    char hex[65];
    *out = NULL;
    *n_worse = 0;
    const dif_status status = load(path, &before, hex, err);
    if (status != DIF_OK)
        return status;
    ledger to = {.factor = factor, .rows = json_array()};
    compare_surfaces(&to, json_object_get(before, "surfaces"), surfaces);
    const json_t *device = json_object_get(before, "device");
    *n_worse = to.n_worse;
    *out = json_pack("{s:s, s:s, s:s, s:f, s:f, s:i, s:i, s:o}", "file", path, "sha256", hex, "renderer",
                     text(device, "renderer"), "factor", factor, "noise_share", NOISE_SHARE, "n_same", to.n_same,
                     "n_worse", to.n_worse, "rows", to.rows);
    json_decref(before);
    return *out ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "comparison with %s", path);
}
