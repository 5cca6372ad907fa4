/* A comparison as JUnit XML. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */

#include "compare_files.h"
#include "well_formed.h"

/* The XML of a document; the caller frees. */
static char *junit(const json_t *doc)
{
    char *text = NULL;
    size_t n = 0;
    FILE *stream = open_memstream(&text, &n);
    assert_non_null(stream);
    dif_compare_junit(stream, doc);
    assert_int_equal(fclose(stream), 0);
    return text;
}

static void assert_has(const char *xml, const char *text)
{
    if (!strstr(xml, text))
        fail_msg("\"%s\" is not in\n%s", text, xml);
}

/* The same elements under a declaration that the checker knows. */
static void assert_xml_well_formed(const char *xml)
{
    static const char declaration[] = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    char page[32768];
    assert_int_equal(strncmp(xml, declaration, sizeof declaration - 1), 0);
    assert_in_range(strlen(xml), 100, sizeof page - 64);
    snprintf(page, sizeof page, "<!DOCTYPE html>\n%s", xml + sizeof declaration - 1);
    assert_well_formed(page);
}

static void test_junit__counts_and_texts(void **state)
{
    (void)state;
    json_t *doc = compare_doc();
    char *xml = junit(doc);
    assert_xml_well_formed(xml);
    assert_has(
        xml,
        "<testsuites name=\"diffbench compare\" tests=\"4\" failures=\"1\" errors=\"1\" skipped=\"1\" time=\"1.500\">");
    assert_has(xml,
               "tests=\"4\" failures=\"1\" errors=\"1\" skipped=\"1\" time=\"1.500\" timestamp=\"2024-05-01T12:00:00\" "
               "hostname=\"localhost\"");
    assert_has(xml, "<property name=\"renderer\" value=\"llvmpipe &amp; &quot;x&quot;\"/>");
    assert_has(xml, "<testcase name=\"sheet table (compute)\" classname=\"diffbench.compare.a\" time=\"0.750\">\n   "
                    "</testcase>");
    assert_has(xml, "<failure message=\"abs.worst = 0.003, limit 2e-06\" type=\"outside tolerance\">");
    assert_has(xml, "worst abs 0.003 at angle -33.5 deg, 428 nm, device 0.1234567, reference 0.1234569\n");
    assert_has(xml, "<error message=\"shader &lt;a&gt; &amp; &quot;b&quot;: line 3\" type=\"no answer\"/>");
    assert_has(xml,
               "<testcase name=\"nmm-lines\" classname=\"diffbench.compare.a\" time=\"0.000\"><skipped message=\"no "
               "period &amp; no patch\"/></testcase>");
    assert_null(strstr(xml, "baseline"));
    free(xml);
    json_decref(doc);
}

static void test_junit__what_got_worse_is_a_failure(void **state)
{
    (void)state;
    json_t *doc = compare_doc();
    compare_add_baseline(doc);
    char *xml = junit(doc);
    assert_xml_well_formed(xml);
    assert_has(xml, "<testsuites name=\"diffbench compare\" tests=\"6\" failures=\"2\" errors=\"1\"");
    assert_has(xml, "<testsuite name=\"against the baseline\" tests=\"2\" failures=\"1\" errors=\"0\"");
    assert_has(xml, "<testcase name=\"a sheet table (compute) abs.worst\" classname=\"diffbench.compare.baseline\"");
    assert_has(xml, "<failure message=\"worse: before 1e-08, now 1e-07\" type=\"worse than the baseline\"/>");
    free(xml);
    /* a verdict that turned is said in words */
    json_t *row = json_array_get(json_object_get(json_object_get(doc, "baseline"), "rows"), 1);
    json_object_set_new(row, "state", json_string("worse"));
    xml = junit(doc);
    assert_has(xml, "<failure message=\"worse: before fail, now pass\" type=\"worse than the baseline\"/>");
    free(xml);
    json_decref(doc);
}

static void test_junit__without_timings_time_is_zero(void **state)
{
    (void)state;
    json_t *doc = compare_doc(), *surface = json_array_get(json_object_get(doc, "surfaces"), 0);
    json_object_del(json_array_get(json_object_get(surface, "cases"), 0), "timings");
    json_object_del(json_array_get(json_object_get(surface, "cases"), 1), "timings");
    char *xml = junit(doc);
    assert_has(xml, "skipped=\"1\" time=\"0.000\">");
    free(xml);
    json_decref(doc);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_junit__counts_and_texts),
        cmocka_unit_test(test_junit__what_got_worse_is_a_failure),
        cmocka_unit_test(test_junit__without_timings_time_is_zero),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
