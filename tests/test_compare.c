/* The page of a comparison and what it is built from. */
#define _DEFAULT_SOURCE /* mkdtemp */

#include "compare_files.h"
#include "well_formed.h"

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

static char *build(const json_t *doc)
{
    dif_error err = {DIF_OK, ""};
    compare_write(folder, doc);
    if (dif_compare_build(folder, &err) != DIF_OK)
        fail_msg("%s", err.text);
    return report_read(folder, "index.html");
}

static void assert_has(const char *page, const char *text)
{
    if (!strstr(page, text))
        fail_msg("\"%s\" is not on the page", text);
}

static void test_build__page_is_well_formed_and_says_all(void **state)
{
    (void)state;
    json_t *doc = compare_doc();
    char *page = build(doc);
    assert_well_formed(page);
    assert_has(page, "2 of 3 cases are outside their limits");
    assert_has(page, "llvmpipe &amp; &quot;x&quot;");
    assert_has(page, "(a software renderer)");
    assert_has(page, "abs.worst 0.00300, limit 2.00 × 10⁻⁶");
    assert_has(page, "0.1234567 / 0.1234569");
    assert_has(page, "−33.50°, 428.0 nm");
    assert_has(page, "no answer: shader &lt;a&gt; &amp; &quot;b&quot;: line 3");
    assert_has(page, "nmm-lines is left out: no period &amp; no patch");
    assert_has(page, "12 maxima beside the mirror beam, 1 without a counterpart");
    assert_has(page, "a difference of 0.0010 nm");
    assert_has(page, "because &lt;2&gt;");
    assert_has(page, "not judged");
    assert_null(strstr(page, "baseline"));
    int n_picture = 0;
    for (const char *at = page; (at = strstr(at, "data:image/png;base64,")); at++)
        n_picture++;
    assert_int_equal(n_picture, 6);
    dif_release(page);
    json_decref(doc);
}

static void test_build__ring_is_at_the_worst_place(void **state)
{
    (void)state;
    json_t *doc = compare_doc();
    char *page = build(doc);
    /* a quarter from the left of 44 ... 370 and three quarters down of 10 ... 204 */
    assert_has(page, "<circle cx=\"125.5\" cy=\"155.5\" r=\"9\"");
    dif_release(page);
    json_decref(doc);
}

static void test_build__a_pass_and_a_fault_are_said(void **state)
{
    (void)state;
    json_t *doc = compare_doc();
    json_object_set_new(json_object_get(doc, "verdict"), "pass", json_true());
    json_object_set_new(json_object_get(doc, "device"), "fault", json_string("plane"));
    char *page = build(doc);
    assert_has(page, "All 3 cases keep their limits.");
    assert_has(page, "deliberately wrong (plane): this run must fail");
    dif_release(page);
    json_decref(doc);
}

static void test_build__the_baseline_has_a_section(void **state)
{
    (void)state;
    json_t *doc = compare_doc();
    compare_add_baseline(doc);
    char *page = build(doc);
    assert_well_formed(page);
    assert_has(page,
               "old&lt;er&gt;.json (old &amp; slow). A number has moved if it changed by more than a factor of 2");
    assert_has(page, "7 numbers did not move");
    assert_has(page, "<b>worse</b>");
    assert_has(page, "<td class=\"n\">fail</td><td class=\"n\">pass</td>");
    dif_release(page);
    json_decref(doc);
}

/* Building from the document with one change fails with this text; the page that was there stays. */
static void expect_failure(json_t *doc, dif_status status, const char *text)
{
    dif_error err = {DIF_OK, ""};
    char want[256];
    report_write_doc(folder, "compare.json", doc);
    assert_int_equal(dif_compare_build(folder, &err), status);
    snprintf(want, sizeof want, "%s/%s", folder, text);
    assert_string_equal(err.text, want);
    json_decref(doc);
}

static void test_build__what_is_wrong_is_said(void **state)
{
    (void)state;
    dif_error err;
    assert_int_equal(dif_compare_build(folder, &err), DIF_ERR_IO);
    json_t *doc = compare_doc();
    json_object_set_new(doc, "schema", json_string("another"));
    expect_failure(doc, DIF_ERR_FORMAT, "compare.json: not a comparison: \"schema\" is not \"diffbench compare 1\"");
    doc = compare_doc();
    json_object_del(doc, "device");
    expect_failure(doc, DIF_ERR_FORMAT, "compare.json: no \"device\" in it");
    doc = compare_doc();
    json_object_set_new(doc, "surfaces", json_integer(3));
    expect_failure(doc, DIF_ERR_FORMAT, "compare.json: \"surfaces\" is not a list");
    doc = compare_doc();
    json_object_del(json_array_get(json_object_get(doc, "surfaces"), 0), "cases");
    expect_failure(doc, DIF_ERR_FORMAT, "compare.json: surface 1 has no \"cases\"");
    report_write_text(folder, "compare.json", "{\n\"a\": ]");
    assert_int_equal(dif_compare_build(folder, &err), DIF_ERR_FORMAT);
    assert_non_null(strstr(err.text, "compare.json: line 2: "));
}

static void test_build__a_missing_picture_leaves_the_old_page(void **state)
{
    (void)state;
    json_t *doc = compare_doc();
    char *page = build(doc), path[128];
    dif_error err;
    snprintf(path, sizeof path, "%s/a.r.png", folder);
    assert_int_equal(remove(path), 0);
    assert_int_equal(dif_compare_build(folder, &err), DIF_ERR_IO);
    char *after = report_read(folder, "index.html");
    assert_string_equal(page, after);
    dif_release(page);
    dif_release(after);
    json_decref(doc);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_build__page_is_well_formed_and_says_all, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_build__ring_is_at_the_worst_place, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_build__a_pass_and_a_fault_are_said, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_build__the_baseline_has_a_section, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_build__what_is_wrong_is_said, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_build__a_missing_picture_leaves_the_old_page, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
