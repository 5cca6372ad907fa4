#include "core/io/directions.h"

#include "tests/near.h"

#include <string.h>

#include "core/alloc.h"
#include "tests/alloc_count.h"

static dif_status parse(const char *text, size_t *n, double (**degrees)[4], dif_error *err)
{
    return dif_directions_parse((const unsigned char *)text, strlen(text), "d.csv", n, degrees, err);
}

static void test_parse__columns_by_name_and_queries_too(void **state)
{
    (void)state;
    static const char *const TEXTS[] = {
        "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n30,10,-20,190\n0,0,5,0\n",
        "# a comment\nlambda_nm,phi_r_deg,theta_r_deg,phi_i_deg,theta_i_deg\n550,190,-20,10,30\n550,0,5,0,0\n"};
    static const double WANT[2][4] = {{30.0, 10.0, -20.0, 190.0}, {0.0, 0.0, 5.0, 0.0}};
    for (int i = 0; i < 2; i++) {
        double(*degrees)[4];
        size_t n;
        dif_error err;
        assert_int_equal(parse(TEXTS[i], &n, &degrees, &err), DIF_OK);
        assert_int_equal(n, 2);
        assert_memory_equal(degrees, WANT, sizeof WANT);
        dif_release(degrees);
    }
}

static void test_parse__long_lists_and_missing_azimuths(void **state)
{
    (void)state;
    enum { N = 1000 };
    static char text[N * 16 + 64];
    double(*degrees)[4];
    size_t n, at = (size_t)snprintf(text, sizeof text, "theta_i_deg,theta_r_deg\n");
    dif_error err;
    for (int i = 0; i < N; i++)
        at += (size_t)snprintf(text + at, sizeof text - at, "%g,%d\n", 0.0625 * i, -i / 20);
    assert_int_equal(parse(text, &n, &degrees, &err), DIF_OK);
    assert_int_equal(n, N);
    for (int i = 0; i < N; i++) {
        assert_near(degrees[i][0], 0.0625 * i, 0.0, 0.0);
        assert_near(degrees[i][1], 0.0, 0.0, 0.0);
        assert_near(degrees[i][2], -i / 20, 0.0, 0.0);
    }
    dif_release(degrees);
}

static void test_parse__bad_files_have_their_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } CASES[] = {{"", "d.csv: empty file"},
                 {"theta_i_deg,theta_r_deg\n", "d.csv: no rows below the header"},
                 {"theta_i_deg\n1\n", "theta_r_deg"},
                 {"theta_i_deg,theta_r_deg\n1,2\n90,2\n", "d.csv: line 3: theta_i_deg is 90, want -90 < angle < 90"},
                 {"theta_i_deg,theta_r_deg\n1,nan\n", "d.csv: line 2: theta_r_deg is nan"},
                 {"theta_i_deg,theta_r_deg\n1,x\n", "line 2"},
                 {"theta_i_deg,theta_r_deg\n1\n", "line 2"}};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        double(*degrees)[4];
        size_t n;
        dif_error err;
        assert_int_equal(parse(CASES[i].text, &n, &degrees, &err), DIF_ERR_FORMAT);
        assert_null(degrees);
        assert_int_equal(n, 0);
        if (!strstr(err.text, CASES[i].message))
            fail_msg("'%s' does not hold '%s'", err.text, CASES[i].message);
    }
}

static void test_parse__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    const int live = test_alloc_live();
    int n_failed = 0;
    for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; n_failed++) {
        double(*degrees)[4];
        size_t n;
        dif_error err;
        test_alloc_fail_from(n_failed + 1);
        status = parse("theta_i_deg,theta_r_deg\n1,2\n", &n, &degrees, &err);
        test_alloc_fail_from(0);
        assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
        dif_release(degrees);
        assert_int_equal(test_alloc_live(), live);
    }
    assert_true(n_failed > 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parse__columns_by_name_and_queries_too),
        cmocka_unit_test(test_parse__long_lists_and_missing_azimuths),
        cmocka_unit_test(test_parse__bad_files_have_their_line),
        cmocka_unit_test(test_parse__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
