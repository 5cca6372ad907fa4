#define _POSIX_C_SOURCE 200809L
#include "report_files.h"
#include "reports/report.h"
#include "well_formed.h"

static const char *const PICTURES[] = {"a.slopes.png", "a.normals.png", "a.view.png"};

/* The test's surface with slopes; its pictures but the last `missing`. */
static void write_slopes(const char *folder, int missing)
{
    static const char text[] =
        "{\"slopes\": {\"theta_deg\": 75, \"azimuth_deg\": 16.2127, \"overlap\": 0.468, \"seen_area\": 0.30212,"
        " \"gaussian_area\": 0.33101, \"masking_ndf\": 0.85533, \"masking_smith\": 0.78123, \"masking_worst\": 0.152,"
        " \"picture\": \"a.slopes.png\", \"picture_normals\": \"a.normals.png\", \"picture_view\": \"a.view.png\","
        " \"zoom\": 0.0625, \"samples\": 32, \"point\": {\"de_mean\": 4.473}, \"mean\": {\"de_mean\": 0.286},"
        " \"filtered\": {\"de_mean\": 0.056}}}";
    json_t *doc = report_doc(), *part = json_loads(text, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(part);
    json_object_update(doc, part);
    report_write_doc(folder, "a.json", doc);
    json_decref(part);
    json_decref(doc);
    for (int i = 0; i < 3 - missing; i++)
        report_write_png(folder, PICTURES[i], 12);
}

static void assert_on_page(const char *page, const char *text)
{
    if (!strstr(page, text))
        fail_msg("the page lacks: %s", text);
}

static void test_part_slopes__tells_what_the_file_says(void **state)
{
    (void)state;
    char folder[64];
    report_folder(folder);
    write_slopes(folder, 0);
    assert_int_equal(dif_report_build(folder, NULL), DIF_OK);
    char *page = report_read(folder, "index.html");
    assert_well_formed(page);
    static const char *const texts[] = {"<h3 id=\"s1-slopes\">",
                                        "href=\"#s1-slopes\">slopes and views<",
                                        "seen from 75° at azimuth 16.21°",
                                        "overlap by 46.8 %",
                                        "0.3021, by the Gaussian 0.3310",
                                        "they are 0.8553 and 0.7812",
                                        "at most 0.15",
                                        "16 × 16 samples a pixel",
                                        "32 × 32 jittered",
                                        "4.5, 0.29 and 0.056"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        assert_on_page(page, texts[i]);
    dif_release(page);
    report_folder_remove(folder);
}

static void test_part_slopes__absent_where_they_were_not_measured(void **state)
{
    (void)state;
    char folder[64];
    report_folder(folder);
    assert_int_equal(dif_report_build(folder, NULL), DIF_OK);
    char *page = report_read(folder, "index.html");
    assert_null(strstr(page, "s1-slopes"));
    dif_release(page);
    report_folder_remove(folder);
}

static void test_part_slopes__missing_picture_is_an_error(void **state)
{
    (void)state;
    for (int missing = 1; missing <= 3; missing++) {
        char folder[64];
        dif_error err;
        report_folder(folder);
        write_slopes(folder, missing);
        assert_int_equal(dif_report_build(folder, &err), DIF_ERR_IO);
        assert_non_null(strstr(err.text, PICTURES[3 - missing]));
        report_folder_remove(folder);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_part_slopes__tells_what_the_file_says),
        cmocka_unit_test(test_part_slopes__absent_where_they_were_not_measured),
        cmocka_unit_test(test_part_slopes__missing_picture_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
