#include "tests/near.h"

#include <string.h>

#include "core/alloc.h"
#include "core/io/csv.h"
#include "tests/alloc_count.h"

static dif_source source_of(const char *text)
{
    return dif_source_of((const unsigned char *)text, strlen(text), "f.csv");
}

/* Rows of cells, joined with '|' and '/'. */
static void expect_cells(const char *text, const char *want)
{
    const dif_source source = source_of(text);
    dif_manifest keys = {0};
    dif_error err;
    dif_csv csv;
    char got[400] = "";
    assert_int_equal(dif_csv_open(&source, &csv, &keys, &err), DIF_OK);
    do {
        const char *cell = NULL;
        size_t n = 0;
        long n_cell = 0;
        const long n_count = dif_csv_count_cells(&csv);
        for (; dif_csv_next_cell(&csv, &cell, &n); n_cell++)
            snprintf(got + strlen(got), sizeof got - strlen(got), "%s%.*s", n_cell ? "|" : "", (int)n, cell);
        assert_int_equal(n_cell, n_count);
        strcat(got, "/");
    } while (dif_csv_next_row(&csv));
    assert_string_equal(got, want);
    dif_csv_close(&csv);
    dif_manifest_free(&keys);
}

static void test_cells__separators_blanks_quotes_and_comments(void **state)
{
    (void)state;
    expect_cells("a,b,c\n1,2,3\n", "a|b|c/1|2|3/");
    expect_cells("# x\n\na, b ,c\r\n\r\n 1,\t2, 3 \r\n# y\n4,5,6", "a|b|c/1|2|3/4|5|6/");
    expect_cells("a;b\n1,5;2\n", "a|b/1,5|2/");
    expect_cells("a\tb\n1\t\n", "a|b/1|/");
    expect_cells("a b  c\n1   2 3\n", "a|b|c/1|2|3/");
    expect_cells("\"a\",\"b c\"\n1,\"2\"\n", "a|b c/1|2/");
    expect_cells("a,,c,\n,,,\n", "a||c|/|||/");
    expect_cells("alone\n", "alone/");
    expect_cells("\xef\xbb\xbf"
                 "a,b\n",
                 "a|b/");
}

static void test_open__keys_are_kept(void **state)
{
    (void)state;
    const dif_source source =
        source_of("# key: value: more \n#second-1.x:2\n# no key\n# bad key: 3\n#: 4\n# empty:\nrow\n# late: 5\n");
    dif_manifest keys = {0};
    dif_error err;
    dif_csv csv;
    assert_int_equal(dif_csv_open(&source, &csv, &keys, &err), DIF_OK);
    assert_int_equal(csv.line, 7);
    assert_int_equal(keys.n, 3);
    assert_string_equal(dif_manifest_get(&keys, "key"), "value: more");
    assert_string_equal(dif_manifest_get(&keys, "second-1.x"), "2");
    assert_string_equal(dif_manifest_get(&keys, "empty"), "");
    dif_csv_close(&csv);
    dif_manifest_free(&keys);
}

static void test_open__without_rows_is_refused(void **state)
{
    (void)state;
    static const char *const TEXTS[] = {"\n", "# a: b\n", "   \n\r\n"};
    for (int i = 0; i < 3; i++) {
        const dif_source source = source_of(TEXTS[i]);
        dif_manifest keys = {0};
        dif_error err;
        dif_csv csv;
        assert_int_equal(dif_csv_open(&source, &csv, &keys, &err), DIF_ERR_FORMAT);
        assert_string_equal(err.text, "f.csv: no row of data, want CSV");
        dif_csv_close(&csv);
        dif_manifest_free(&keys);
    }
}

static const dif_csv_column COLUMNS[] = {{{"alpha", NULL}, true}, {{"beta", "b", NULL}, false}};

/* Reads the first row below the header by the columns alpha and beta. */
static dif_status read_first(const char *text, double value[2], dif_error *err)
{
    const dif_source source = source_of(text);
    dif_manifest keys = {0};
    dif_csv csv;
    signed char *role = NULL;
    long n_cell = 0;
    dif_status status = dif_csv_open(&source, &csv, &keys, err);
    if (!status)
        status = dif_csv_find_columns(&csv, COLUMNS, 2, &role, &n_cell, err);
    if (!status && dif_csv_next_row(&csv))
        status = dif_csv_read_row(&csv, COLUMNS, 2, role, n_cell, value, err);
    dif_release(role);
    dif_csv_close(&csv);
    dif_manifest_free(&keys);
    return status;
}

static void test_columns__by_name_in_any_order_and_case(void **state)
{
    (void)state;
    double value[2];
    dif_error err;
    assert_int_equal(read_first("x,B,ALPHA,alpha\ny,2,1,9\n", value, &err), DIF_OK);
    assert_true(value[0] == 1.0 && value[1] == 2.0); /* the first of two alphas; text in other columns is left alone */
    assert_int_equal(read_first("alpha\n7\n", value, &err), DIF_OK);
    assert_true(value[0] == 7.0 && isnan(value[1]));
    assert_int_equal(read_first("alpha;beta\n0,5;nan\n", value, &err), DIF_OK);
    assert_true(value[0] == 0.5 && isnan(value[1]));
}

static void test_columns__errors_name_line_column_and_counts(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } CASES[] = {
        {"# c\nbeta,gamma\n1,2\n", "f.csv: line 2: no column alpha"},
        {"alpha,beta\n\n1,2,3\n", "f.csv: line 3 has 3 cells, want 2 as in the header"},
        {"alpha,beta\n1\n", "f.csv: line 2 has 1 cells, want 2 as in the header"},
        {"alpha,beta\n1,two\n", "f.csv: line 2: beta is 'two', want a number"},
        {"alpha,beta\n1.5.2,2\n", "f.csv: line 2: alpha is '1.5.2', want a number"},
        {"alpha;beta\n1.000,5;2\n", "f.csv: line 2: alpha is '1.000,5', want a number"},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        double value[2];
        dif_error err;
        assert_int_equal(read_first(CASES[i].text, value, &err), DIF_ERR_FORMAT);
        assert_string_equal(err.text, CASES[i].message);
    }
}

static void test_open__failing_heap_leaves_nothing(void **state)
{
    (void)state;
    const int n_live = test_alloc_live();
    dif_status status = DIF_ERR_NOMEM;
    for (int k = 1; status; k++) {
        double value[2];
        dif_error err;
        test_alloc_fail_from(k);
        status = read_first("# a: 1\n# b: 2\nalpha,beta\n1,2\n", value, &err);
        test_alloc_fail_from(0);
        assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
        assert_int_equal(test_alloc_live(), n_live);
        assert_true(k < 100);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cells__separators_blanks_quotes_and_comments),
        cmocka_unit_test(test_open__keys_are_kept),
        cmocka_unit_test(test_open__without_rows_is_refused),
        cmocka_unit_test(test_columns__by_name_in_any_order_and_case),
        cmocka_unit_test(test_columns__errors_name_line_column_and_counts),
        cmocka_unit_test(test_open__failing_heap_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
