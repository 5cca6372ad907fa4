#define _DEFAULT_SOURCE /* mkdtemp */

#include "report_files.h"
#include "well_formed.h"

#include "reports/report.h"

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    report_folder(folder);
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    report_folder_remove(folder);
    return 0;
}

static void build(void)
{
    dif_error err = {0};
    if (dif_report_build(folder, &err) != DIF_OK)
        fail_msg("%s", err.text);
}

static void test_build__page_is_well_formed(void **state)
{
    (void)state;
    build();
    char *page = report_read(folder, "index.html");
    assert_well_formed(page);
    dif_release(page);
}

static void test_build__page_with_all_parts_is_well_formed(void **state)
{
    (void)state;
    report_write_parts(folder);
    build();
    char *page = report_read(folder, "index.html");
    assert_well_formed(page);
    static const char *const ids[] = {"s1-map", "s1-methods", "s1-study", "published"};
    char text[64];
    for (size_t i = 0; i < sizeof ids / sizeof *ids; i++) {
        snprintf(text, sizeof text, "id=\"%s\"", ids[i]);
        assert_non_null(strstr(page, text));
        snprintf(text, sizeof text, "href=\"#%s\"", ids[i]);
        assert_non_null(strstr(page, text));
    }
    int n_svg = 0;
    for (const char *at = page; (at = strstr(at, "<svg ")); at++)
        n_svg++;
    assert_int_equal(n_svg, 9);
    static const char *const texts[] = {"Step &lt;x&gt;",
                                        "a &amp; b",
                                        "&lt;5&gt; nm",
                                        "ΔE 0.77, 95 %: 8.1",
                                        "worst 33",
                                        "1144.262 nm",
                                        "1143.820 nm<br><small>sd 0.32 nm</small>",
                                        "1126.810 nm",
                                        "1052.308 nm",
                                        "a synthetic stand-in"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (!strstr(page, texts[i]))
            fail_msg("\"%s\" is not on the page", texts[i]);
    }
    dif_release(page);
}

static void test_build__parts_left_out_leave_no_trace(void **state)
{
    (void)state;
    build();
    char *page = report_read(folder, "index.html");
    assert_null(strstr(page, "-map\""));
    assert_null(strstr(page, "-methods\""));
    assert_null(strstr(page, "Methods compared"));
    assert_null(strstr(page, "-study\""));
    assert_null(strstr(page, "\"published\""));
    dif_release(page);
}

/* Bytes of the picture whose text begins behind `start`. */
static size_t picture_behind(const char *page, const char *start, unsigned char *out, size_t room)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *picture = strstr(page, start);
    if (!picture)
        fail_msg("no picture after %s", start);
    unsigned bits = 0;
    int n_bit = 0;
    size_t n = 0;
    for (size_t i = picture ? (size_t)(picture - page) + strlen(start) : 0; page[i] != '"' && page[i] != '='; i++) {
        const char *digit = strchr(digits, page[i]);
        assert_non_null(digit);
        bits = (bits << 6 | (unsigned)(digit - digits)) & 0xffffffu;
        n_bit += 6;
        if (n_bit >= 8) {
            n_bit -= 8;
            assert_in_range(n, 0, room - 1);
            out[n++] = (unsigned char)(bits >> n_bit);
        }
    }
    return n;
}

static void test_build__pictures_are_embedded_whole(void **state)
{
    (void)state;
    report_write_parts(folder);
    build();
    unsigned char got[4096];
    const dif_result result = {.folder = folder};
    dif_picture picture;
    assert_int_equal(dif_picture_load(&result, "a.map.png", &picture, NULL), DIF_OK);
    unsigned char *page;
    size_t n;
    char path[128];
    snprintf(path, sizeof path, "%s/index.html", folder);
    assert_int_equal(dif_file_read(path, (size_t)1 << 26, &page, &n, NULL), DIF_OK);
    assert_int_equal(picture_behind((const char *)page, "\"none\" href=\"data:image/png;base64,", got, sizeof got),
                     picture.n);
    assert_memory_equal(got, picture.png, picture.n);
    dif_release(page);
    dif_picture_free(&picture);
}

static void test_build__page_needs_no_other_file(void **state)
{
    (void)state;
    report_write_parts(folder);
    build();
    char *page = report_read(folder, "index.html");
    static const char *const foreign[] = {"http:", "https:",  "//",      "<script", "<link",
                                          "<img",  "<iframe", "@import", " src="};
    for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++) {
        /* base64 may hold any letters, so only what stands outside the pictures counts */
        for (const char *at = page; (at = strstr(at, foreign[i])); at++) {
            const char *line = at;
            while (line > page && line[-1] != '\n')
                line--;
            if (!strstr(line, "base64,") || strstr(line, "base64,") > at)
                fail_msg("%s in: %.80s", foreign[i], line);
        }
    }
    for (const char *at = page; (at = strstr(at, "href=")); at += 5)
        assert_true(at[6] == '#' || strncmp(at + 6, "data:image/png;base64,", 22) == 0);
    for (const char *at = page; (at = strstr(at, "url(")); at += 4)
        assert_int_equal(at[4], '#');
    dif_release(page);
}

static void test_build__markup_in_texts_is_escaped(void **state)
{
    (void)state;
    build();
    char *page = report_read(folder, "index.html");
    assert_non_null(strstr(page, "&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &amp; &#39;grating&#39;"));
    assert_non_null(strstr(page, "<title>Report &lt;1&gt; &amp; more</title>"));
    assert_non_null(strstr(page, "&lt;b&gt;made&lt;/b&gt; &amp; measured"));
    assert_non_null(strstr(page, "nothing &lt;periodic&gt; in it"));
    assert_non_null(strstr(page, "d/lambda &lt; 2"));
    assert_null(strstr(page, "<script"));
    dif_release(page);
}

static void test_build__every_section_is_there_and_linked(void **state)
{
    (void)state;
    build();
    char *page = report_read(folder, "index.html");
    static const char *const ids[] = {"summary",       "contents",    "s1",          "s1-surface", "s1-table",
                                      "s1-period",     "s1-lines",    "s1-accuracy", "s1-energy",  "s1-trust",
                                      "s1-provenance", "conventions", "provenance"};
    char text[64];
    for (size_t i = 0; i < sizeof ids / sizeof *ids; i++) {
        snprintf(text, sizeof text, "id=\"%s\"", ids[i]);
        if (!strstr(page, text))
            fail_msg("no section %s", ids[i]);
    }
    int n_svg = 0, n_link = 0;
    for (const char *at = page; (at = strstr(at, "<svg ")); at++)
        n_svg++;
    assert_int_equal(n_svg, 5);
    for (const char *at = page; (at = strstr(at, "<a href=\"#")); at += 10) {
        snprintf(text, sizeof text, "id=\"%.*s\"", (int)strcspn(at + 10, "\""), at + 10);
        if (!strstr(page, text))
            fail_msg("a link to nowhere: %s", text);
        n_link++;
    }
    assert_int_equal(n_link, 12);
    dif_release(page);
}

static void test_build__ids_are_unique(void **state)
{
    (void)state;
    report_write_text(folder, "results.json",
                      "{\"schema\": \"" DIF_RESULT_LIST_SCHEMA "\", \"title\": \"two\", \"provenance\": {},"
                      " \"surfaces\": [\"a.json\", \"a.json\"]}");
    build();
    char *page = report_read(folder, "index.html");
    int n = 0;
    for (const char *at = page; (at = strstr(at, " id=")); at += 4, n++) {
        char id[80];
        snprintf(id, sizeof id, "%.*s", (int)(strcspn(at + 5, "'\"") + 6), at);
        const char *again = strstr(at + 4, id);
        if (again)
            fail_msg("twice:%s", id);
    }
    assert_in_range(n, 100, 400);
    dif_release(page);
}

static void test_build__numbers_are_those_of_the_files(void **state)
{
    (void)state;
    build();
    char *page = report_read(folder, "index.html");
    static const char *const numbers[] = {"2500.003 ± 0.012 nm",
                                          "2500 nm",
                                          "✓ pass",
                                          "✗ fail",
                                          "4.6 × 10⁻⁸",
                                          "6.1 × 10⁻⁷",
                                          "no reference",
                                          "500 ms",
                                          "nothing",
                                          "1.0010",
                                          "0.500 %",
                                          "75°",
                                          "0.0040 nm"};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (!strstr(page, numbers[i]))
            fail_msg("\"%s\" is not on the page", numbers[i]);
    }
    dif_release(page);
}

static void test_build__without_timings_no_time_section(void **state)
{
    (void)state;
    json_t *doc = report_doc();
    json_object_del(doc, "timings");
    report_write_doc(folder, "a.json", doc);
    json_decref(doc);
    build();
    char *page = report_read(folder, "index.html");
    assert_null(strstr(page, "<h3>Time</h3>"));
    assert_well_formed(page);
    dif_release(page);
}

static void test_build__json_holds_the_same(void **state)
{
    (void)state;
    build();
    char *text = report_read(folder, "report.json");
    json_error_t why;
    json_t *report = json_loads(text, JSON_REJECT_DUPLICATES, &why), *doc = report_doc();
    if (!report)
        fail_msg("line %d: %s", why.line, why.text);
    assert_string_equal(dif_result_text(report, "schema"), "diffbench report 1");
    assert_true(json_equal(json_array_get(dif_result_at(report, "surfaces"), 0), doc));
    json_decref(report);
    json_decref(doc);
    dif_release(text);
}

static void test_build__again_gives_the_same_bytes(void **state)
{
    (void)state;
    report_write_parts(folder);
    build();
    char *page = report_read(folder, "index.html"), *json = report_read(folder, "report.json");
    build();
    char *page_again = report_read(folder, "index.html"), *json_again = report_read(folder, "report.json");
    assert_string_equal(page, page_again);
    assert_string_equal(json, json_again);
    dif_release(page);
    dif_release(json);
    dif_release(page_again);
    dif_release(json_again);
}

/* Building fails so, and what stood there stays. */
static void assert_build_fails(dif_status want, const char *part)
{
    dif_error err = {0};
    report_write_text(folder, "index.html", "old page");
    report_write_text(folder, "report.json", "old json");
    assert_int_equal(dif_report_build(folder, &err), want);
    if (!strstr(err.text, part) || strchr(err.text, '\n'))
        fail_msg("got \"%s\", want \"...%s...\"", err.text, part);
    char *page = report_read(folder, "index.html"), *json = report_read(folder, "report.json");
    assert_string_equal(page, "old page");
    assert_string_equal(json, "old json");
    dif_release(page);
    dif_release(json);
}

static void test_build__broken_files_leave_the_old_page(void **state)
{
    (void)state;
    report_write_text(folder, "a.maxima.csv", "garbage\n");
    assert_build_fails(DIF_ERR_FORMAT, "a.maxima.csv: line 1: want the columns");
    char path[128];
    snprintf(path, sizeof path, "%s/a.maxima.csv", folder);
    assert_int_equal(unlink(path), 0);
    assert_build_fails(DIF_ERR_IO, "a.maxima.csv");
    report_write_parts(folder);
    report_write_text(folder, "a.maxima.csv", DIF_RESULT_MAXIMA_HEADER "\n");
    report_write_text(folder, "a.study-1-2.png", "");
    assert_build_fails(DIF_ERR_FORMAT, "a.study-1-2.png: not a PNG picture");
    report_write_text(folder, "a.map-level.png", "\x89PNG");
    assert_build_fails(DIF_ERR_FORMAT, "a.map-level.png: not a PNG picture");
    snprintf(path, sizeof path, "%s/a.map.png", folder);
    assert_int_equal(unlink(path), 0);
    assert_build_fails(DIF_ERR_IO, "a.map.png");
    report_write_text(folder, "a.json", "{");
    assert_build_fails(DIF_ERR_FORMAT, "a.json: line 1: ");
    report_write_text(folder, "results.json", "nothing");
    assert_build_fails(DIF_ERR_FORMAT, "results.json: line 1: ");
}

static void test_build__no_gnuplot_is_a_missing_resource(void **state)
{
    (void)state;
    char *path = strdup(getenv("PATH"));
    assert_int_equal(setenv("PATH", "/nonexistent", 1), 0);
    assert_build_fails(DIF_ERR_RESOURCE, "install the package gnuplot-nox");
    assert_int_equal(setenv("PATH", path, 1), 0);
    free(path);
}

static void test_build__no_folder(void **state)
{
    (void)state;
    dif_error err = {0};
    assert_int_equal(dif_report_build("/nonexistent/folder", &err), DIF_ERR_IO);
    assert_non_null(strstr(err.text, "/nonexistent/folder/results.json"));
}

#define FOLDER_TEST(function) cmocka_unit_test_setup_teardown(function, make_folder, remove_folder)

int main(void)
{
    const struct CMUnitTest tests[] = {
        FOLDER_TEST(test_build__page_is_well_formed),
        FOLDER_TEST(test_build__page_with_all_parts_is_well_formed),
        FOLDER_TEST(test_build__parts_left_out_leave_no_trace),
        FOLDER_TEST(test_build__pictures_are_embedded_whole),
        FOLDER_TEST(test_build__page_needs_no_other_file),
        FOLDER_TEST(test_build__markup_in_texts_is_escaped),
        FOLDER_TEST(test_build__every_section_is_there_and_linked),
        FOLDER_TEST(test_build__ids_are_unique),
        FOLDER_TEST(test_build__numbers_are_those_of_the_files),
        FOLDER_TEST(test_build__without_timings_no_time_section),
        FOLDER_TEST(test_build__json_holds_the_same),
        FOLDER_TEST(test_build__again_gives_the_same_bytes),
        FOLDER_TEST(test_build__broken_files_leave_the_old_page),
        FOLDER_TEST(test_build__no_gnuplot_is_a_missing_resource),
        cmocka_unit_test(test_build__no_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
