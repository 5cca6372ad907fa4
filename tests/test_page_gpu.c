/* The page's section of a comparison of GPU and CPU. */
#define _DEFAULT_SOURCE /* mkdtemp */
#include "compare_files.h"
#include "reports/page_parts.h"

/* The section of a document; the caller releases. */
static char *section(const json_t *doc)
{
    FILE *html = tmpfile();
    char *text = dif_alloc(1 << 16, 1);
    assert_non_null(html);
    assert_non_null(text);
    dif_part_gpu(html, 3, doc);
    rewind(html);
    assert_true(fread(text, 1, (1 << 16) - 1, html) < (1 << 16) - 1);
    fclose(html);
    return text;
}

static void test_gpu__nothing_where_it_was_not_asked_for(void **state)
{
    (void)state;
    json_t *doc = json_object();
    char *text = section(doc);
    assert_string_equal(text, "");
    dif_release(text);
    json_decref(doc);
}

static void test_gpu__a_missing_one_is_a_line(void **state)
{
    (void)state;
    json_t *doc = json_pack("{s:{s:s}}", "gpu", "text", "no GPU: EGL <has> no driver");
    char *text = section(doc);
    assert_string_equal(text, "<h3 id=\"s3-gpu\">GPU against CPU</h3>\n<p>Not compared: no GPU: EGL &lt;has&gt; no "
                              "driver</p>\n");
    dif_release(text);
    json_decref(doc);
}

static void test_gpu__cases_have_their_table(void **state)
{
    (void)state;
    json_t *whole = compare_doc(), *surface = json_array_get(json_object_get(whole, "surfaces"), 0);
    json_t *doc = json_pack("{s:{s:O, s:{s:b, s:i, s:i}, s:O}}", "gpu", "device", json_object_get(whole, "device"),
                            "verdict", "pass", 0, "n", 3, "n_failed", 2, "cases", json_object_get(surface, "cases"));
    char *text = section(doc);
    assert_non_null(strstr(text,
                           "1 of 3 cases keep their limits: the shaders of llvmpipe &amp; &quot;x&quot; (a software "
                           "renderer)"));
    assert_non_null(strstr(text, "no answer: shader"));
    assert_non_null(strstr(text, "✗ fail"));
    dif_release(text);
    json_decref(doc);
    json_decref(whole);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gpu__nothing_where_it_was_not_asked_for),
        cmocka_unit_test(test_gpu__a_missing_one_is_a_line),
        cmocka_unit_test(test_gpu__cases_have_their_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
