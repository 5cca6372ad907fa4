/* The files of a small comparison for the tests of reports/: one surface, a case that passes, one that fails, one without an
 * answer, a skipped method, a baseline. */
#ifndef DIF_TEST_COMPARE_FILES_H
#define DIF_TEST_COMPARE_FILES_H

#include "report_files.h"
#include "reports/compare.h"

/* A case by its name; `checks` and `more` are members in JSON. */
static inline json_t *compare_case(const char *method, const char *question, bool answered, bool pass, const char *more)
{
    char text[8192];
    json_error_t why;
    snprintf(text, sizeof text,
             "{\"method\": \"%s\", \"question\": \"%s\", \"path\": \"compute\", \"answered\": %s, \"pass\": %s,"
             "\"text\": \"%s\", \"n_failed\": 0, \"n_asked\": 10%s}",
             method, question, answered ? "true" : "false", pass ? "true" : "false",
             answered ? "" : "shader <a> & \\\"b\\\": line 3", more);
    json_t *one = json_loads(text, JSON_REJECT_DUPLICATES, &why);
    if (!one)
        fail_msg("test case: line %d column %d: %s", why.line, why.column, why.text);
    return one;
}

#define COMPARE_STAT                                                                                                   \
    "{\"median\": 1e-9, \"p95\": 2e-9, \"p99\": 3e-9, \"worst\": %s, \"at\": {\"angle_deg\": -33.5, \"lambda_nm\": "   \
    "428,"                                                                                                             \
    " \"x\": 0.25, \"y\": 0.75}, \"device\": 0.1234567, \"reference\": 0.1234569}"

/* Members of an answered table. */
static inline const char *compare_answer(char text[4096], const char *worst, bool pass)
{
    char stat[600];
    snprintf(stat, sizeof stat, COMPARE_STAT, worst);
    snprintf(
        text, 4096,
        ", \"n\": 10, \"maximum\": 0.9, \"floor\": 9e-6, \"n_one_sided\": 0,"
        "\"stats\": {\"rel\": %s, \"abs\": %s, \"max\": %s},"
        "\"checks\": [{\"metric\": \"abs.worst\", \"unit\": \"\", \"value\": %s, \"limit\": 2e-6, \"pass\": %s},"
        " {\"metric\": \"period.off_nm\", \"unit\": \"nm\", \"value\": 0.001, \"limit\": 0.01, \"pass\": true}],"
        "\"peaks\": {\"n\": 12, \"n_lost\": 1, \"shift_deg\": 1e-6, \"lambda_nm\": 500, \"device_deg\": 3,"
        " \"reference_deg\": 3}, \"fit\": {\"device_nm\": 2500.001, \"device_u_nm\": 0.02, \"reference_nm\": 2500,"
        " \"reference_u_nm\": 0.02, \"text\": \"\"},"
        "\"timings\": {\"call_s\": 0.01, \"run_s\": 0.005, \"first_s\": 0.5, \"reference_s\": 0.25},"
        "\"pictures\": {\"device\": \"a.d.png\", \"reference\": \"a.r.png\", \"difference\": \"a.x.png\","
        " \"value_high\": 0.9, \"difference_low\": 1e-13, \"difference_high\": 1e-5, \"axes\": [-85, 85, 380, 780]}",
        stat, stat, stat, worst, pass ? "true" : "false");
    return text;
}

/* The document; the caller drops it. */
static inline json_t *compare_doc(void)
{
    char text[4096];
    json_t *cases = json_array();
    json_array_append_new(cases, compare_case("sheet", "table", true, true, compare_answer(text, "1e-7", true)));
    json_array_append_new(cases, compare_case("pq", "table", true, false, compare_answer(text, "3e-3", false)));
    json_array_append_new(cases, compare_case("lut", "colour", false, false, ""));
    json_t *doc = json_pack(
        "{s:s, s:s, s:{s:s, s:s, s:s}, s:{s:s, s:s, s:s, s:b, s:s}, s:{s:s}, "
        "s:{s:[{s:s, s:s, s:s, s:f, s:s}, {s:s, s:s, s:s, s:n, s:s}]}, s:{s:b, s:i, s:i}, "
        "s:[{s:s, s:s, s:s, s:[{s:s, s:s}], s:o}]}",
        "schema", DIF_COMPARE_SCHEMA, "title", "GPU <against> CPU", "provenance", "program", "diffbench", "version",
        "1.2.3", "created", "2024-05-01T12:00:00Z", "device", "renderer", "llvmpipe & \"x\"", "version", "ES 3.2",
        "platform", "surfaceless", "software", 1, "fault", "none", "conditions", "average", "none", "thresholds",
        "thresholds", "metric", "abs.worst", "method", "*", "question", "table", "limit", 2e-6, "reason", "because <2>",
        "metric", "rel.p99", "method", "pq", "question", "*", "limit", "reason", "not wanted", "verdict", "pass", 0,
        "n", 3, "n_failed", 2, "surfaces", "slug", "a", "title", REPORT_TITLE, "description", "<b>made</b>", "skipped",
        "method", "nmm-lines", "text", "no period & no patch", "cases", cases);
    assert_non_null(doc);
    return doc;
}

static inline void compare_add_baseline(json_t *doc)
{
    json_object_set_new(
        doc, "baseline",
        json_pack(
            "{s:s, s:s, s:f, s:f, s:i, s:i, s:[{s:s, s:s, s:s, s:s, s:s, s:f, s:f, s:s}, {s:s, s:s, s:s, s:s, s:s, "
            "s:s, s:s, s:s}]}",
            "file", "old<er>.json", "renderer", "old & slow", "factor", 2.0, "noise_share", 0.01, "n_same", 7,
            "n_worse", 1, "rows", "surface", "a", "method", "sheet", "question", "table", "path", "compute", "metric",
            "abs.worst", "before", 1e-8, "now", 1e-7, "state", "worse", "surface", "a", "method", "pq", "question",
            "map", "path", "compute", "metric", "verdict", "before", "fail", "now", "pass", "state", "better"));
}

/* Writes the document and its pictures. */
static inline void compare_write(const char *folder, const json_t *doc)
{
    report_write_doc(folder, "compare.json", doc);
    report_write_png(folder, "a.d.png", 16);
    report_write_png(folder, "a.r.png", 16);
    report_write_png(folder, "a.x.png", 16);
}

#endif
