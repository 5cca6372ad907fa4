#define _DEFAULT_SOURCE /* mkdtemp */

#include "alloc_count.h"
#include "report_files.h"

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

/* Loading a.json fails with this code and this text after "FOLDER/". */
static void assert_load_fails(dif_status want, const char *text)
{
    dif_error err = {0};
    dif_result result;
    char full[300];
    snprintf(full, sizeof full, "%s/%s", folder, text);
    assert_int_equal(dif_result_load(folder, "a.json", &result, &err), want);
    if (strncmp(err.text, full, strlen(full)) != 0)
        fail_msg("got \"%s\", want \"%s...\"", err.text, full);
    assert_null(strchr(err.text, '\n'));
    assert_null(result.doc);
    assert_null(result.field.z_um);
}

static void test_load__gives_all_parts(void **state)
{
    (void)state;
    dif_result result;
    dif_error err = {0};
    if (dif_result_load(folder, "a.json", &result, &err) != DIF_OK)
        fail_msg("%s", err.text);
    assert_int_equal(result.field.nx, 48);
    assert_int_equal(result.field.ny, 32);
    assert_int_equal(result.table.plan.n_angle, 61);
    assert_int_equal(result.table.plan.n_lambda, 9);
    assert_int_equal(result.maxima.n_row, 3);
    assert_near(result.maxima.value[DIF_MAXIMA_N + DIF_MAXIMA_RESIDUAL_DEG], -0.002, 0.0, 0.0); /* as written */
    assert_true(isnan(result.maxima.value[2 * DIF_MAXIMA_N + DIF_MAXIMA_PERIOD_NM]));
    assert_int_equal(result.lines.n_row, 4);
    dif_result_free(&result);
    dif_result_free(NULL);
}

static void test_at__paths_and_types(void **state)
{
    (void)state;
    json_t *doc = report_doc();
    assert_near(dif_result_number(doc, "fit_table.period_nm"), 2500.003, 0.0, 0.0);
    assert_near(dif_result_number(doc, "check.n_sample"), 200.0, 0.0, 0.0);
    assert_true(isnan(dif_result_number(doc, "fit_table.none")));
    assert_true(isnan(dif_result_number(doc, "title")));
    assert_true(isnan(dif_result_number(doc, "title.further")));
    assert_string_equal(dif_result_text(doc, "files.height"), "a.height.exr");
    assert_string_equal(dif_result_text(doc, "check.n_sample"), "");
    assert_true(dif_result_true(doc, "fit_table.ok"));
    assert_false(dif_result_true(doc, "fit_surface.ok"));
    assert_false(dif_result_true(NULL, "x"));
    char longer[200];
    memset(longer, 'k', sizeof longer);
    longer[199] = '\0';
    assert_null(dif_result_at(doc, longer));
    json_decref(doc);
}

static void test_load__missing_and_broken_json(void **state)
{
    (void)state;
    dif_error err = {0};
    dif_result result;
    assert_int_equal(dif_result_load(folder, "none.json", &result, &err), DIF_ERR_IO);
    assert_non_null(strstr(err.text, "none.json"));
    report_write_text(folder, "a.json", "{\"schema\": \n\n \"x\" oops}");
    assert_load_fails(DIF_ERR_FORMAT, "a.json: line 3: ");
    report_write_text(folder, "a.json", "");
    assert_load_fails(DIF_ERR_FORMAT, "a.json: line 1: ");
    report_write_text(folder, "a.json", "[1, 2]");
    assert_load_fails(DIF_ERR_FORMAT, "a.json: not a result file: \"schema\" is not \"" DIF_RESULT_SCHEMA "\"");
    report_write_text(folder, "a.json", "{\"schema\": \"" DIF_RESULT_SCHEMA "\"}");
    assert_load_fails(DIF_ERR_FORMAT, "a.json: no \"files\" in it");
}

static void test_load__names_may_not_leave_the_folder(void **state)
{
    (void)state;
    dif_error err = {0};
    dif_result result;
    static const char *const bad[] = {"../a.json", "", ".", "..", "/etc/passwd", "x/y"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char want[200];
        snprintf(want, sizeof want, "%s: \"%s\" is not the name of a result file", folder, bad[i]);
        assert_int_equal(dif_result_load(folder, bad[i], &result, &err), DIF_ERR_FORMAT);
        assert_string_equal(err.text, want);
    }
    json_t *doc = report_doc();
    json_object_set_new(json_object_get(doc, "files"), "height", json_string("../x.exr"));
    report_write_doc(folder, "a.json", doc);
    json_decref(doc);
    assert_int_equal(dif_result_load(folder, "a.json", &result, &err), DIF_ERR_FORMAT);
}

static void test_load__damaged_files(void **state)
{
    (void)state;
    report_write_text(folder, "a.lines.csv", DIF_RESULT_LINES_HEADER "\n0.1,2\n");
    assert_load_fails(DIF_ERR_FORMAT, "a.lines.csv: line 2: want 3 numbers");
    report_write_text(folder, "a.lines.csv", "");
    assert_load_fails(DIF_ERR_FORMAT, "a.lines.csv: want the columns " DIF_RESULT_LINES_HEADER);
    report_write_text(folder, "a.maxima.csv", "# x\nlambda_nm,angle\n");
    assert_load_fails(DIF_ERR_FORMAT, "a.maxima.csv: line 2: want the columns " DIF_RESULT_MAXIMA_HEADER);
    report_write_text(folder, "a.table.exr", "no table");
    dif_result result;
    dif_error err = {0};
    assert_int_not_equal(dif_result_load(folder, "a.json", &result, &err), DIF_OK);
    assert_non_null(strstr(err.text, "a.table.exr"));
    report_write_text(folder, "a.height.exr", "no picture");
    assert_int_not_equal(dif_result_load(folder, "a.json", &result, &err), DIF_OK);
    assert_non_null(strstr(err.text, "a.height.exr"));
}

static void test_picture__is_a_whole_png_of_the_folder(void **state)
{
    (void)state;
    const dif_result result = {.folder = folder};
    dif_picture picture;
    dif_error err = {0};
    report_write_png(folder, "p.png", 5);
    assert_int_equal(dif_picture_load(&result, "p.png", &picture, &err), DIF_OK);
    assert_int_equal(picture.nx, 5);
    assert_int_equal(picture.ny, 5);
    unsigned char bytes[4096];
    const size_t n = picture.n;
    assert_in_range(n, 40, sizeof bytes);
    memcpy(bytes, picture.png, n);
    dif_picture_free(&picture);
    dif_picture_free(NULL);
    char path[128];
    snprintf(path, sizeof path, "%s/p.png", folder);
    for (size_t cut = 0; cut < n; cut += 3) { /* cut short anywhere */
        assert_int_equal(dif_file_write(path, bytes, cut, NULL), DIF_OK);
        assert_int_equal(dif_picture_load(&result, "p.png", &picture, &err), DIF_ERR_FORMAT);
        assert_non_null(strstr(err.text, cut < 24 ? "p.png: not a PNG picture" : "p.png: the picture ends early"));
        assert_null(picture.png);
    }
    memset(bytes + 16, 0, 4); /* width 0 */
    assert_int_equal(dif_file_write(path, bytes, n, NULL), DIF_OK);
    assert_int_equal(dif_picture_load(&result, "p.png", &picture, &err), DIF_ERR_SIZE);
    assert_non_null(strstr(err.text, "a picture of 0 x 5 pixels, want 1 ... 65536"));
    assert_int_equal(dif_picture_load(&result, "../p.png", &picture, &err), DIF_ERR_FORMAT);
    assert_int_equal(dif_picture_load(&result, "", &picture, &err), DIF_ERR_FORMAT);
    assert_int_equal(dif_picture_load(&result, "none.png", &picture, &err), DIF_ERR_IO);
}

static void test_columns__rows_and_their_faults(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int n_row; /* -1 = refused */
    } cases[] = {{"a,b\n1,2\n3,4\n", 2},
                 {"# c\r\na,b\r\n1,-2e3\r\n", 1},
                 {"a,b\n", 0},
                 {"a,b\n1,2,3\n", -1},
                 {"a,b\n1\n", -1},
                 {"a,b\n1,\n", -1},
                 {"a,b\n1,x\n", -1},
                 {"a,b,c\n1,2\n", -1},
                 {"a,b\n1,2\n# end\n3,4", 2},
                 {"1,2\n", -1},
                 {"a,b\nnan,inf\n", 1}};
    char path[128];
    snprintf(path, sizeof path, "%s/c.csv", folder);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        dif_columns columns;
        report_write_text(folder, "c.csv", cases[i].text);
        const dif_status status = dif_columns_read(path, "a,b", 2, &columns, NULL);
        assert_int_equal(status, cases[i].n_row < 0 ? DIF_ERR_FORMAT : DIF_OK);
        assert_int_equal(columns.n_row, cases[i].n_row < 0 ? 0 : cases[i].n_row);
        dif_columns_free(&columns);
    }
}

static void test_list__shape_is_checked(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "{\"schema\": \"x\"}",
        "{\"schema\": \"" DIF_RESULT_LIST_SCHEMA "\", \"surfaces\": [\"a.json\"]}",
        "{\"schema\": \"" DIF_RESULT_LIST_SCHEMA "\", \"provenance\": {}}",
        "{\"schema\": \"" DIF_RESULT_LIST_SCHEMA "\", \"provenance\": {}, \"surfaces\": []}",
        "{\"schema\": \"" DIF_RESULT_LIST_SCHEMA "\", \"provenance\": {}, \"surfaces\": [1]}",
        "{\"schema\": \"" DIF_RESULT_LIST_SCHEMA "\", \"provenance\": {}, \"surfaces\": {}}",
    };
    json_t *list = NULL;
    dif_error err = {0};
    assert_int_equal(dif_result_list_load(folder, &list, &err), DIF_OK);
    json_decref(list);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        report_write_text(folder, "results.json", bad[i]);
        assert_int_equal(dif_result_list_load(folder, &list, &err), DIF_ERR_FORMAT);
        assert_non_null(strstr(err.text, "results.json: "));
        assert_null(list);
    }
    assert_int_equal(dif_result_list_load("/nonexistent", &list, &err), DIF_ERR_IO);
}

static void test_load__each_failing_allocation(void **state)
{
    (void)state;
    dif_result result;
    dif_error err;
    const int live = test_alloc_live();
    test_alloc_fail_from(0);
    assert_int_equal(dif_result_load(folder, "a.json", &result, &err), DIF_OK);
    const int n = test_alloc_calls();
    dif_result_free(&result);
    for (int k = 1; k <= n; k++) {
        test_alloc_fail_from(k);
        /* the code is the reader's of the file that was being read */
        assert_int_not_equal(dif_result_load(folder, "a.json", &result, &err), DIF_OK);
        assert_int_equal(test_alloc_live(), live);
    }
    test_alloc_fail_from(0);
    assert_int_equal(test_alloc_live(), live);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_load__gives_all_parts, make_folder, remove_folder),
        cmocka_unit_test(test_at__paths_and_types),
        cmocka_unit_test_setup_teardown(test_load__missing_and_broken_json, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_load__names_may_not_leave_the_folder, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_load__damaged_files, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_picture__is_a_whole_png_of_the_folder, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_columns__rows_and_their_faults, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_list__shape_is_checked, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_load__each_failing_allocation, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
