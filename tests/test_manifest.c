/* setenv, mkstemp */
#define _POSIX_C_SOURCE 200809L

#include "tests/near.h"

#include <string.h>
#include <unistd.h>

#include "core/io/manifest.h"
#include "tests/alloc_count.h"

static void test_set__keeps_order_and_replaces(void **state)
{
    (void)state;
    dif_manifest manifest = {0};
    dif_error err;
    char key[16];
    for (int i = 0; i < 40; i++) {
        snprintf(key, sizeof key, "key%d", i);
        assert_int_equal(dif_manifest_setf(&manifest, &err, key, "%d of %s", i, "40"), DIF_OK);
    }
    assert_int_equal(dif_manifest_set(&manifest, "key7", "new", &err), DIF_OK);
    assert_int_equal(manifest.n, 40);
    assert_string_equal(manifest.item[7].key, "key7");
    assert_string_equal(manifest.item[7].value, "new");
    assert_string_equal(dif_manifest_get(&manifest, "key39"), "39 of 40");
    assert_null(dif_manifest_get(&manifest, "key40"));
    dif_manifest_free(&manifest);
    assert_int_equal(manifest.n, 0);
    dif_manifest_free(NULL);
}

static void test_set__text_stays_one_line_of_utf8(void **state)
{
    (void)state;
    dif_manifest manifest = {0};
    dif_error err;
    static const struct {
        const char *text, *want;
    } CASES[] = {
        {"a\nb\r\tc\x7f", "a b  c "},
        {"\xc2\xb5m \xe2\x82\xac \xf0\x9f\x98\x80", "\xc2\xb5m \xe2\x82\xac \xf0\x9f\x98\x80"},
        {"\xb5m", "?m"},
        {"cut \xe2\x82", "cut ??"},
        {"\xc0\xaf", "??"},
        {"\xed\xa0\x80", "???"},
        {"\xf4\x90\x80\x80", "????"},
        {"", ""},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        assert_int_equal(dif_manifest_set(&manifest, "k", CASES[i].text, &err), DIF_OK);
        assert_string_equal(dif_manifest_get(&manifest, "k"), CASES[i].want);
    }
    char text[3000];
    memset(text, 'z', sizeof text);
    text[sizeof text - 1] = '\0';
    assert_int_equal(dif_manifest_setf(&manifest, &err, "k", "%s", text), DIF_ERR_ARG);
    assert_string_equal(err.text, "manifest value of k is longer than 1023 bytes");
    assert_int_equal(dif_manifest_set(&manifest, "k", text, &err), DIF_OK);
    assert_int_equal(strlen(dif_manifest_get(&manifest, "k")), 2999);
    dif_manifest_free(&manifest);
}

static void test_begin__names_program_command_and_time(void **state)
{
    (void)state;
    char table[] = "table", name[] = "my scan's.gsf", flag[] = "--tol", value[] = "1e-6", program[] = "diffbench",
         empty[] = "";
    char *argv[] = {program, table, name, flag, value, empty, NULL};
    dif_manifest manifest = {0};
    dif_error err;
    setenv("SOURCE_DATE_EPOCH", "951782399", 1);
    assert_int_equal(dif_manifest_begin(&manifest, 6, argv, &err), DIF_OK);
    assert_string_equal(dif_manifest_get(&manifest, "program"), "diffbench");
    assert_string_equal(dif_manifest_get(&manifest, "command"), "diffbench table 'my scan'\\''s.gsf' --tol 1e-6 ''");
    assert_string_equal(dif_manifest_get(&manifest, "created"), "2000-02-28T23:59:59Z");
    int parts[3];
    assert_int_equal(sscanf(dif_manifest_get(&manifest, "version"), "%d.%d.%d", &parts[0], &parts[1], &parts[2]), 3);
    static const char *const KEYS[] = {"frame", "directions", "signs", "units"};
    for (int i = 0; i < 4; i++)
        assert_non_null(dif_manifest_get(&manifest, KEYS[i]));
    dif_manifest_free(&manifest);
}

static void test_begin__refuses_a_bad_epoch(void **state)
{
    (void)state;
    static const char *const EPOCHS[] = {"yesterday", "-1", "12x", "99999999999999999999", "253402300800"};
    for (int i = 0; i < 5; i++) {
        dif_manifest manifest = {0};
        dif_error err;
        setenv("SOURCE_DATE_EPOCH", EPOCHS[i], 1);
        assert_int_equal(dif_manifest_begin(&manifest, 0, NULL, &err), DIF_ERR_ARG);
        assert_non_null(strstr(err.text, "want seconds since 1970"));
        dif_manifest_free(&manifest);
    }
    unsetenv("SOURCE_DATE_EPOCH");
    dif_manifest manifest = {0};
    dif_error err;
    assert_int_equal(dif_manifest_begin(&manifest, 0, NULL, &err), DIF_OK);
    assert_true(strcmp(dif_manifest_get(&manifest, "created"), "2024") > 0); /* the clock, then */
    dif_manifest_free(&manifest);
}

static void test_add_input__sums_each_file(void **state)
{
    (void)state;
    char path[] = "/tmp/dif-manifest-XXXXXX";
    const int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, "abc", 3), 3);
    close(fd);
    dif_manifest manifest = {0};
    dif_error err;
    assert_int_equal(dif_manifest_add_input(&manifest, path, &err), DIF_OK);
    assert_int_equal(dif_manifest_add_input(&manifest, path, &err), DIF_OK);
    remove(path);
    assert_int_equal(manifest.n, 6);
    assert_string_equal(dif_manifest_get(&manifest, "input"), path);
    const char *sum = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_string_equal(dif_manifest_get(&manifest, "input_sha256"), sum);
    assert_string_equal(dif_manifest_get(&manifest, "input_bytes"), "3");
    assert_string_equal(dif_manifest_get(&manifest, "input_2_sha256"), sum);
    assert_int_equal(dif_manifest_add_input(&manifest, path, &err), DIF_ERR_IO);
    assert_non_null(strstr(err.text, "cannot open to take its sum"));
    assert_int_equal(dif_manifest_add_input(&manifest, "/tmp", &err), DIF_ERR_IO);
    assert_string_equal(err.text, "/tmp: is a directory, want a file");
    dif_manifest_free(&manifest);
}

static void test_begin__failing_heap_leaves_nothing(void **state)
{
    (void)state;
    const int n_live = test_alloc_live();
    dif_status status = DIF_ERR_NOMEM;
    int k = 0;
    while (status) {
        dif_manifest manifest = {0};
        dif_error err;
        test_alloc_fail_from(++k);
        status = dif_manifest_begin(&manifest, 0, NULL, &err);
        if (!status)
            status = dif_manifest_add_input(&manifest, "/dev/null", &err);
        assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
        dif_manifest_free(&manifest);
        assert_int_equal(test_alloc_live(), n_live);
        assert_true(k < 1000);
    }
    test_alloc_fail_from(0);
    assert_true(k > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_set__keeps_order_and_replaces),
        cmocka_unit_test(test_set__text_stays_one_line_of_utf8),
        cmocka_unit_test(test_begin__names_program_command_and_time),
        cmocka_unit_test(test_begin__refuses_a_bad_epoch),
        cmocka_unit_test(test_add_input__sums_each_file),
        cmocka_unit_test(test_begin__failing_heap_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
