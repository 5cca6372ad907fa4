#include "tests/near.h"

#include <errno.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/source.h"
#include "tests/alloc_count.h"

static void test_name_short__keeps_the_end(void **state)
{
    (void)state;
    char name[DIF_NAME_SIZE], path[300];
    dif_name_short("short/path.gsf", name);
    assert_string_equal(name, "short/path.gsf");
    memset(path, 'a', sizeof path);
    memcpy(path + 290, "/end.gsf", 9);
    dif_name_short(path, name);
    assert_int_equal(strlen(name), DIF_NAME_SIZE - 1);
    assert_memory_equal(name, "...aaa", 6);
    assert_string_equal(name + strlen(name) - 8, "/end.gsf");
    dif_name_short("a\nb\x7f", name);
    assert_string_equal(name, "a?b?");
}

static void test_name_short__never_cuts_a_character(void **state)
{
    (void)state;
    for (int shift = 0; shift < 4; shift++) {
        char path[400], name[DIF_NAME_SIZE];
        memset(path, 'x', sizeof path);
        for (int i = 0; i < 120; i++)
            memcpy(path + shift + 3 * i, "\xe2\x82\xac", 3);
        path[shift + 360] = '\0';
        dif_name_short(path, name);
        assert_memory_equal(name, "...\xe2", 4);
    }
}

static void test_fail__name_comes_first_and_the_text_is_cut(void **state)
{
    (void)state;
    dif_error err;
    dif_fail(&err, DIF_ERR_ARG, "something was %d", 7);
    assert_int_equal(dif_fail_named(&err, "file.gsf", DIF_ERR_FORMAT), DIF_ERR_FORMAT);
    assert_string_equal(err.text, "file.gsf: something was 7");
    assert_int_equal(err.status, DIF_ERR_FORMAT);
    memset(err.text, 'y', sizeof err.text);
    err.text[sizeof err.text - 1] = '\0';
    dif_fail_named(&err, "file.gsf", DIF_ERR_FORMAT);
    assert_int_equal(strlen(err.text), sizeof err.text - 1); /* nothing beyond the record */
    assert_memory_equal(err.text, "file.gsf: yyy", 13);
    assert_int_equal(dif_fail_named(NULL, "file.gsf", DIF_ERR_IO), DIF_ERR_IO);
    assert_int_equal(dif_fail_errno(&err, "out.csv", "cannot write", ENOSPC), DIF_ERR_IO);
    assert_string_equal(err.text, "out.csv: cannot write: No space left on device");
}

static void test_quote__shows_no_control_characters(void **state)
{
    (void)state;
    char quote[DIF_QUOTE_SIZE];
    dif_quote("a\tb\x1b[31m", 8, quote);
    assert_string_equal(quote, "a?b?[31m");
    dif_quote("0123456789012345678901234567890123456789", 40, quote);
    assert_int_equal(strlen(quote), DIF_QUOTE_SIZE - 1);
}

static void expect_text(const char *data, size_t n, const char *want)
{
    const dif_source source = dif_source_of((const unsigned char *)data, n, "t");
    const char *text = NULL;
    char *owned = NULL;
    size_t n_text = 0;
    dif_error err;
    assert_int_equal(dif_source_text(&source, &text, &n_text, &owned, &err), DIF_OK);
    assert_int_equal(n_text, strlen(want));
    assert_memory_equal(text, want, n_text);
    dif_release(owned);
}

static void test_text__byte_order_marks_choose_the_encoding(void **state)
{
    (void)state;
    expect_text("plain", 5, "plain");
    expect_text("\xef\xbb\xbf"
                "utf8",
                7, "utf8");
    expect_text("\xff\xfe"
                "1\0\xb5\0m\0",
                8, "1\xc2\xb5m");
    expect_text("\xfe\xff"
                "\0"
                "1\x20\xac",
                6, "1\xe2\x82\xac");
    expect_text("\xff\xfe\x3d\xd8\x00\xde", 6, "\xf0\x9f\x98\x80"); /* a surrogate pair */
    expect_text("\xff\xfe", 2, "");
}

static void expect_broken(const char *data, size_t n, const char *part)
{
    const dif_source source = dif_source_of((const unsigned char *)data, n, "t");
    const char *text = NULL;
    char *owned = NULL;
    size_t n_text = 0;
    dif_error err;
    assert_int_equal(dif_source_text(&source, &text, &n_text, &owned, &err), DIF_ERR_FORMAT);
    assert_non_null(strstr(err.text, part));
    assert_null(owned);
}

static void test_text__refuses_broken_utf16_and_binary_data(void **state)
{
    (void)state;
    const int n_live = test_alloc_live();
    expect_broken("\xff\xfe"
                  "1",
                  3, "odd number of bytes (3)");
    expect_broken("\xff\xfe\x3d\xd8"
                  "1\0",
                  6, "lone surrogate");
    expect_broken("\xff\xfe\x00\xde", 4, "lone surrogate");
    expect_broken("\xff\xfe\x3d\xd8", 4, "lone surrogate");
    expect_broken("12\0"
                  "34",
                  5, "NUL at byte 2");
    expect_broken("\xff\xfe"
                  "1\0\0\0",
                  6, "NUL at byte 1");
    assert_int_equal(test_alloc_live(), n_live);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_name_short__keeps_the_end),
        cmocka_unit_test(test_name_short__never_cuts_a_character),
        cmocka_unit_test(test_fail__name_comes_first_and_the_text_is_cut),
        cmocka_unit_test(test_quote__shows_no_control_characters),
        cmocka_unit_test(test_text__byte_order_marks_choose_the_encoding),
        cmocka_unit_test(test_text__refuses_broken_utf16_and_binary_data),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
