#include "tests/near.h"

#include <string.h>

#include "core/status.h"

static void test_status_text__every_code_has_its_own(void **state)
{
    (void)state;
    const dif_status codes[] = {
#define CODE(name, number, text) name,
        DIF_STATUS_LIST(CODE)
#undef CODE
    };
    const int n = (int)(sizeof codes / sizeof codes[0]);
    for (int i = 0; i < n; i++) {
        assert_int_equal(codes[i], i); /* numbers are append-only: no gap, no reuse */
        assert_true(strlen(dif_status_text(codes[i])) >= 2);
        for (int j = 0; j < i; j++)
            assert_string_not_equal(dif_status_text(codes[i]), dif_status_text(codes[j]));
    }
    assert_string_equal(dif_status_text(DIF_OK), "ok");
}

static void test_status_text__unknown_code_is_answered(void **state)
{
    (void)state;
    int number = 1000;
    dif_status status;
    memcpy(&status, &number, sizeof status);
    assert_string_equal(dif_status_text(status), "unknown status");
}

static void test_fail__returns_the_code_and_keeps_the_text(void **state)
{
    (void)state;
    dif_error err = {DIF_OK, ""};
    assert_int_equal(dif_fail(&err, DIF_ERR_TOL, "tol = %g, want %s", 2.5, "less"), DIF_ERR_TOL);
    assert_int_equal(err.status, DIF_ERR_TOL);
    assert_string_equal(err.text, "tol = 2.5, want less");
    assert_int_equal(dif_fail(NULL, DIF_ERR_IO, "%d", 3), DIF_ERR_IO);
}

static void test_fail__long_text_is_cut_and_terminated(void **state)
{
    (void)state;
    dif_error err;
    memset(&err, 'x', sizeof err);
    assert_int_equal(dif_fail(&err, DIF_ERR_FORMAT, "%0400d", 7), DIF_ERR_FORMAT);
    assert_int_equal(strlen(err.text), sizeof err.text - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_status_text__every_code_has_its_own),
        cmocka_unit_test(test_status_text__unknown_code_is_answered),
        cmocka_unit_test(test_fail__returns_the_code_and_keeps_the_text),
        cmocka_unit_test(test_fail__long_text_is_cut_and_terminated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
