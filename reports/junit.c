/* A comparison as JUnit XML, which build servers show: elements and attributes as the Ant task writes them. */
#include <math.h>
#include <string.h>

#include "reports/compare.h"
#include "reports/html.h"
#include "reports/result.h"

/* An attribute; what must be escaped in HTML text must be so here. */
static void attribute(FILE *xml, const char *name, const char *value)
{
    fprintf(xml, " %s=\"", name);
    dif_html_text(xml, value);
    fputc('"', xml);
}

/* "2024-05-01T12:00:00" of a time with a zone; the schema knows none. */
static void timestamp(FILE *xml, const json_t *doc)
{
    char text[20] = "1970-01-01T00:00:00";
    const char *created = dif_result_text(doc, "provenance.created");
    if (strlen(created) >= 19)
        memcpy(text, created, 19);
    attribute(xml, "timestamp", text);
}

static double seconds_of(const json_t *one)
{
    const double s = dif_result_number(one, "timings.first_s") + dif_result_number(one, "timings.reference_s");
    return isfinite(s) ? s : 0.0;
}

static void property(FILE *xml, const char *name, const char *value)
{
    fputs("    <property", xml);
    attribute(xml, "name", name);
    attribute(xml, "value", value);
    fputs("/>\n", xml);
}

static void suite_begin(FILE *xml, const json_t *doc, const char *name, size_t n_test, size_t n_failure, size_t n_error,
                        size_t n_skipped, double seconds)
{
    fputs("  <testsuite", xml);
    attribute(xml, "name", name);
    fprintf(xml, " tests=\"%zu\" failures=\"%zu\" errors=\"%zu\" skipped=\"%zu\" time=\"%.3f\"", n_test, n_failure,
            n_error, n_skipped, seconds);
    timestamp(xml, doc);
    attribute(xml, "hostname", "localhost");
    fputs(">\n   <properties>\n", xml);
    property(xml, "version", dif_result_text(doc, "provenance.version"));
    property(xml, "renderer", dif_result_text(doc, "device.renderer"));
    property(xml, "driver", dif_result_text(doc, "device.version"));
    property(xml, "software", dif_result_true(doc, "device.software") ? "true" : "false");
    fputs("   </properties>\n", xml);
}

static void place(FILE *xml, const json_t *at)
{
    const double angle = dif_result_number(at, "angle_deg"), theta = dif_result_number(at, "theta_r_deg");
    const double lambda = dif_result_number(at, "lambda_nm");
    if (isfinite(angle))
        fprintf(xml, "angle %.6g deg, ", angle);
    if (isfinite(theta))
        fprintf(xml, "theta_r %.6g deg, phi_r %.6g deg, ", theta, dif_result_number(at, "phi_r_deg"));
    if (isfinite(lambda))
        fprintf(xml, "%.6g nm, ", lambda);
    if (*dif_result_text(at, "channel"))
        fprintf(xml, "%s, ", dif_result_text(at, "channel"));
}

/* Where the worst of each statistic lies, and both values. */
static void worst_places(FILE *xml, const json_t *one)
{
    static const char *const names[] = {"abs", "rel", "de"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const json_t *stat = dif_result_at(dif_result_at(one, "stats"), names[i]);
        if (!stat)
            continue;
        fprintf(xml, "worst %s %.6g at ", names[i], dif_result_number(stat, "worst"));
        place(xml, dif_result_at(stat, "at"));
        fprintf(xml, "device %.9g, reference %.9g\n", dif_result_number(stat, "device"),
                dif_result_number(stat, "reference"));
    }
}

static void failure(FILE *xml, const json_t *one)
{
    size_t i;
    json_t *check;
    char message[400] = "";
    json_array_foreach(dif_result_at(one, "checks"), i, check)
    {
        const size_t used = strlen(message);
        if (!dif_result_true(check, "pass") && used < sizeof message)
            snprintf(message + used, sizeof message - used, "%s%s = %.4g, limit %.4g", used ? "; " : "",
                     dif_result_text(check, "metric"), dif_result_number(check, "value"),
                     dif_result_number(check, "limit"));
    }
    fputs("    <failure", xml);
    attribute(xml, "message", *message ? message : "nothing to compare");
    attribute(xml, "type", "outside tolerance");
    fputs(">", xml);
    worst_places(xml, one);
    fputs("</failure>\n", xml);
}

static void test_case(FILE *xml, const char *slug, const json_t *one)
{
    char name[160], class_name[200];
    snprintf(name, sizeof name, "%s %s (%s)", dif_result_text(one, "method"), dif_result_text(one, "question"),
             dif_result_text(one, "path"));
    snprintf(class_name, sizeof class_name, "diffbench.compare.%s", slug);
    fputs("   <testcase", xml);
    attribute(xml, "name", name);
    attribute(xml, "classname", class_name);
    fprintf(xml, " time=\"%.3f\">\n", seconds_of(one));
    if (!dif_result_true(one, "answered")) {
        fputs("    <error", xml);
        attribute(xml, "message", dif_result_text(one, "text"));
        attribute(xml, "type", "no answer");
        fputs("/>\n", xml);
    } else if (!dif_result_true(one, "pass")) {
        failure(xml, one);
    }
    fputs("   </testcase>\n", xml);
}

static void skipped_test(FILE *xml, const char *slug, const json_t *skipped)
{
    char class_name[200];
    snprintf(class_name, sizeof class_name, "diffbench.compare.%s", slug);
    fputs("   <testcase", xml);
    attribute(xml, "name", dif_result_text(skipped, "method"));
    attribute(xml, "classname", class_name);
    fputs(" time=\"0.000\"><skipped", xml);
    attribute(xml, "message", dif_result_text(skipped, "text"));
    fputs("/></testcase>\n", xml);
}

/* What a suite counts. */
typedef struct tally {
    size_t n, n_failure, n_error, n_skipped;
    double seconds;
} tally;

static tally count(const json_t *surface)
{
    const json_t *cases = dif_result_at(surface, "cases");
    tally t = {.n_skipped = json_array_size(dif_result_at(surface, "skipped"))};
    size_t i;
    json_t *one;
    json_array_foreach(cases, i, one)
    {
        const bool answered = dif_result_true(one, "answered");
        t.n_error += !answered;
        t.n_failure += answered && !dif_result_true(one, "pass");
        t.seconds += seconds_of(one);
    }
    t.n = json_array_size(cases) + t.n_skipped;
    return t;
}

static void surface_suite(FILE *xml, const json_t *doc, const json_t *surface)
{
    const tally t = count(surface);
    const char *slug = dif_result_text(surface, "slug");
    size_t i;
    json_t *one;
    suite_begin(xml, doc, dif_result_text(surface, "title"), t.n, t.n_failure, t.n_error, t.n_skipped, t.seconds);
    json_array_foreach(dif_result_at(surface, "cases"), i, one) test_case(xml, slug, one);
    json_array_foreach(dif_result_at(surface, "skipped"), i, one) skipped_test(xml, slug, one);
    fputs("  </testsuite>\n", xml);
}

static bool is_worse(const json_t *row)
{
    return strcmp(dif_result_text(row, "state"), "worse") == 0 || strcmp(dif_result_text(row, "state"), "missing") == 0;
}

/* A number, or a verdict's word. */
static void moved_value(const json_t *row, const char *key, char out[24])
{
    if (*dif_result_text(row, key))
        snprintf(out, 24, "%s", dif_result_text(row, key));
    else
        snprintf(out, 24, "%.4g", dif_result_number(row, key));
}

/* One test for all that stayed, one for each that got worse. */
static void baseline_suite(FILE *xml, const json_t *doc, const json_t *baseline, size_t n_worse)
{
    size_t i;
    json_t *row;
    suite_begin(xml, doc, "against the baseline", n_worse + 1, n_worse, 0, 0, 0.0);
    fputs("   <testcase name=\"all others\" classname=\"diffbench.compare.baseline\" time=\"0.000\"/>\n", xml);
    json_array_foreach(dif_result_at(baseline, "rows"), i, row)
    {
        char name[320], message[120], before[24], now[24];
        if (!is_worse(row))
            continue;
        snprintf(name, sizeof name, "%s %s %s (%s) %s", dif_result_text(row, "surface"), dif_result_text(row, "method"),
                 dif_result_text(row, "question"), dif_result_text(row, "path"), dif_result_text(row, "metric"));
        moved_value(row, "before", before);
        moved_value(row, "now", now);
        snprintf(message, sizeof message, "%s: before %s, now %s", dif_result_text(row, "state"), before, now);
        fputs("   <testcase", xml);
        attribute(xml, "name", name);
        fputs(" classname=\"diffbench.compare.baseline\" time=\"0.000\">\n    <failure", xml);
        attribute(xml, "message", message);
        attribute(xml, "type", "worse than the baseline");
        fputs("/>\n   </testcase>\n", xml);
    }
    fputs("  </testsuite>\n", xml);
}

void dif_compare_junit(FILE *xml, const json_t *doc)
{
    const json_t *baseline = dif_result_at(doc, "baseline");
    tally all = {0};
    size_t i, n_worse = 0;
    json_t *one;
    json_array_foreach(dif_result_at(doc, "surfaces"), i, one)
    {
        const tally t = count(one);
        all = (tally){all.n + t.n, all.n_failure + t.n_failure, all.n_error + t.n_error, all.n_skipped + t.n_skipped,
                      all.seconds + t.seconds};
    }
    json_array_foreach(dif_result_at(baseline, "rows"), i, one) n_worse += is_worse(one);
    all.n += json_is_object(baseline) ? n_worse + 1 : 0;
    fprintf(xml,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"diffbench compare\" tests=\"%zu\" "
            "failures=\"%zu\" errors=\"%zu\" skipped=\"%zu\" time=\"%.3f\">\n",
            all.n, all.n_failure + n_worse, all.n_error, all.n_skipped, all.seconds);
    json_array_foreach(dif_result_at(doc, "surfaces"), i, one) surface_suite(xml, doc, one);
    if (json_is_object(baseline))
        baseline_suite(xml, doc, baseline, n_worse);
    fputs("</testsuites>\n", xml);
}
