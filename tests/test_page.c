#define _DEFAULT_SOURCE /* mkdtemp */

#include "report_files.h"

#include "reports/page.h"
#include "reports/page_parts.h"

static char got[65536];

/* What a part writes of a document. */
static const char *part(void (*write)(FILE *, const json_t *), const json_t *doc)
{
    FILE *html = tmpfile();
    assert_non_null(html);
    write(html, doc);
    rewind(html);
    got[fread(got, 1, sizeof got - 1, html)] = '\0';
    fclose(html);
    return got;
}

static void assert_has(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("no \"%s\" in: %s", wanted, text);
}

static void test_verdict__mark_word_number_and_limit(void **state)
{
    (void)state;
    json_t *doc = report_doc();
    const json_t *list = dif_result_at(doc, "verdicts");
    part(dif_page_verdict, json_array_get(list, 0));
    assert_string_equal(got, "<div class=\"v pass\"><b>✓ pass</b> 0.0030 nm<small>limit 0.024 nm</small></div>");
    part(dif_page_verdict, json_array_get(list, 1));
    assert_string_equal(got, "<div class=\"v fail\"><b>✗ fail</b> 2.0 × 10⁻⁶<small>limit 1.0 × 10⁻⁶</small></div>");
    part(dif_page_verdict, json_array_get(list, 2));
    assert_string_equal(got, "<div class=\"v none\"><b>– no reference</b> </div>");
    part(dif_page_verdict, NULL);
    assert_has(got, "no reference");
    json_decref(doc);
}

static void test_provenance__keys_and_values_are_escaped(void **state)
{
    (void)state;
    json_t *list = json_pack("{s:s, s:i, s:n}", "a<b", "c&d", "n", 7, "none");
    part(dif_page_provenance, list);
    assert_has(got, "<tr><th>a&lt;b</th><td>c&amp;d</td></tr>");
    assert_has(got, "<tr><th>n</th><td>7</td></tr>");
    assert_has(got, "<tr><th>none</th><td>–</td></tr>");
    json_decref(list);
}

static void test_periods__both_uncertainties_and_the_reason_of_a_failure(void **state)
{
    (void)state;
    json_t *doc = report_doc();
    part(dif_part_periods, doc);
    assert_has(got, "2500.003 ± 0.012 nm");
    assert_has(got, ">0.0040 nm<");
    assert_has(got, ">0.012 nm<");
    assert_has(got, ">0.0070 nm<");
    assert_has(got, ">0.25<"); /* |2500.003 - 2500| / 0.012 */
    assert_has(got, "no period: nothing &lt;periodic&gt; in it");
    assert_has(got, "2500.04 nm");
    json_decref(doc);
}

static void test_periods__a_guide_is_called_one(void **state)
{
    (void)state;
    json_t *doc = report_doc();
    json_object_set_new(json_object_get(doc, "known"), "exact", json_false());
    assert_has(part(dif_part_periods, doc), "a guide and not a reference");
    json_object_set_new(doc, "known", json_null());
    assert_null(strstr(part(dif_part_periods, doc), "was made with"));
    json_decref(doc);
}

static void test_ridges__lettered_unless_they_share_a_period(void **state)
{
    (void)state;
    json_t *doc = report_doc();
    assert_null(strstr(part(dif_part_ridges, doc), "<td>A</td>"));
    assert_has(got, "100 %");
    json_object_set_new(json_object_get(doc, "fit_table"), "common_period", json_false());
    assert_has(part(dif_part_ridges, doc), "<td>A</td>");
    json_object_del(json_object_get(doc, "fit_table"), "ridges");
    assert_has(part(dif_part_ridges, doc), "No ridge was fitted");
    json_decref(doc);
}

static void test_accuracy__error_tol_bound_and_where(void **state)
{
    (void)state;
    json_t *doc = report_doc();
    part(dif_part_accuracy, doc);
    assert_has(got, "1.0 × 10⁻⁶");
    assert_has(got, "6.1 × 10⁻⁷");
    assert_has(got, "4.6 × 10⁻⁸");
    assert_has(got, "200 random cells");
    assert_has(got, "−33.500°");
    assert_has(got, "1.0 × 10⁻¹²"); /* tol^2 */
    json_decref(doc);
}

static void test_order_powers__nothing_without_a_closed_form(void **state)
{
    (void)state;
    json_t *doc = report_doc();
    assert_has(part(dif_part_order_powers, doc), ">−1<");
    json_object_set_new(json_object_get(doc, "orders"), "rows", json_array());
    assert_string_equal(part(dif_part_order_powers, doc), "");
    json_object_del(doc, "orders");
    assert_string_equal(part(dif_part_order_powers, doc), "");
    json_decref(doc);
}

static void test_methods__rows_reasons_and_findings(void **state)
{
    (void)state;
    json_t *doc = report_doc();
    report_add_parts(doc);
    part(dif_part_methods, doc);
    assert_has(got, "<b>sheet</b>");
    assert_has(got, "2500.04 nm<br><small>sd 0.37 nm</small>");
    assert_has(got, ">25 ms<");
    assert_has(got, ">2.5 s<");
    assert_has(got, "leaves out a &lt; b");
    assert_has(got, "not measured: no period &amp; no patch");
    assert_has(got, "is 0.87 with the Jacobian and 12 without");
    assert_has(got, "(−0.031, −0.052)");
    assert_has(got, "−55.50° to −40.00°");
    json_object_set_new(json_object_get(doc, "methods"), "first_order", json_false());
    assert_has(part(dif_part_methods, doc), "no period is known");
    json_decref(doc);
}

static void test_methods__without_times_no_column(void **state)
{
    (void)state;
    json_t *doc = report_doc(), *row;
    size_t i;
    report_add_parts(doc);
    json_array_foreach(dif_result_at(doc, "methods.rows"), i, row) json_object_del(row, "wall_s");
    assert_null(strstr(part(dif_part_methods, doc), ">Time<"));
    assert_has(got, "<td colspan=\"7\">");
    json_decref(doc);
}

static void test_trust__an_unknown_level_is_a_caution(void **state)
{
    (void)state;
    json_t *doc = report_doc();
    assert_has(part(dif_part_trust, doc), "<li class=\"beyond\"><b>beyond</b>d/lambda &lt; 2</li>");
    json_object_set_new(doc, "domain", json_pack("[{s:s, s:s}]", "level", "\"><x", "text", "t"));
    assert_has(part(dif_part_trust, doc), "<li class=\"caution\"><b>&quot;&gt;&lt;x</b>t</li>");
    json_decref(doc);
}

static void test_parts__survive_an_empty_document(void **state)
{
    (void)state;
    void (*const parts[])(FILE *, const json_t *) = {
        dif_part_conditions, dif_part_periods,      dif_part_orders, dif_part_ridges,  dif_part_accuracy,
        dif_part_energy,     dif_part_order_powers, dif_part_trust,  dif_part_timings, dif_part_methods};
    json_t *empty = json_object();
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        assert_null(strstr(part(parts[i], empty), "nan"));
    json_decref(empty);
}

static void test_style__asks_for_nothing_outside(void **state)
{
    (void)state;
    assert_null(strstr(dif_page_style(), "url("));
    assert_null(strstr(dif_page_style(), "@import"));
    assert_null(strchr(dif_page_style(), '<'));
    assert_has(dif_page_style(), "@media print");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_verdict__mark_word_number_and_limit),
        cmocka_unit_test(test_provenance__keys_and_values_are_escaped),
        cmocka_unit_test(test_periods__both_uncertainties_and_the_reason_of_a_failure),
        cmocka_unit_test(test_periods__a_guide_is_called_one),
        cmocka_unit_test(test_ridges__lettered_unless_they_share_a_period),
        cmocka_unit_test(test_accuracy__error_tol_bound_and_where),
        cmocka_unit_test(test_order_powers__nothing_without_a_closed_form),
        cmocka_unit_test(test_methods__rows_reasons_and_findings),
        cmocka_unit_test(test_methods__without_times_no_column),
        cmocka_unit_test(test_trust__an_unknown_level_is_a_caution),
        cmocka_unit_test(test_parts__survive_an_empty_document),
        cmocka_unit_test(test_style__asks_for_nothing_outside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
