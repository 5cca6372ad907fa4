/* Tables and queries from CSV as others write it. */
#include "tests/near.h"

#include <string.h>

#include "core/alloc.h"
#include "core/io/table_io.h"
#include "core/units.h"
#include "tests/alloc_count.h"

static dif_status parse(const char *text, dif_table *table, dif_error *err)
{
    return dif_table_parse((const unsigned char *)text, strlen(text), "f.csv", table, NULL, err);
}

static void test_read__bare_columns_of_an_instrument(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        dif_quantity quantity;
    } TEXTS[] = {
        {"theta_i_deg,theta_r_deg,lambda_nm,value\n75,-20,500,1\n75,-10,500,2\n75,-20,600,3\n75,-10,600,4\n",
         DIF_QUANTITY_RHO},
        {"wavelength_nm;power;theta_r_deg;theta_i_deg\n600;4;-10;75\n500;1;-20;75\n600;3;-20;75\n500;2;-10;75\n",
         DIF_QUANTITY_POWER},
        {"Theta_I_deg\tNote\tTHETA_R_deg\tLambda_nm\tbrdf\r\n75\ta\t-20\t500,0\t1,0\r\n75\tb\t-10\t500\t2\r\n"
         "75\t\t-20\t600\t3\r\n75\t\t-10\t600\t4\r\n",
         DIF_QUANTITY_BRDF},
        {"# quantity: "
         "power\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value\n75,0,20,180,500,1\n75,0,10,-180,500,2\n"
         "75,0,20,540,600,3\n75,360,10,180,600,4\n",
         DIF_QUANTITY_POWER},
    };
    for (size_t i = 0; i < sizeof TEXTS / sizeof *TEXTS; i++) {
        dif_table table;
        dif_error err;
        if (parse(TEXTS[i].text, &table, &err))
            fail_msg("%s", err.text);
        assert_int_equal(table.plan.n_angle, 2);
        assert_int_equal(table.plan.n_lambda, 2);
        assert_false(table.plan.fixed_is_wo);
        assert_int_equal(table.quantity, TEXTS[i].quantity);
        assert_true(table.plan.azimuth_rad == 0.0 && table.plan.fixed_rad == dif_rad_from_deg(75.0));
        assert_true(table.plan.angle_rad[0] == dif_rad_from_deg(-20.0) && table.plan.lambda_um[1] == 0.6);
        for (int k = 0; k < 4; k++)
            assert_true(table.value[k] == k + 1.0);
        dif_table_free(&table);
    }
}

static void test_read__missing_cells_become_nan(void **state)
{
    (void)state;
    dif_table table;
    dif_error err;
    assert_int_equal(parse("theta_i_deg,theta_r_deg,lambda_nm,value\n-20,75,500,\n-10,75,600,4\n", &table, &err),
                     DIF_OK);
    assert_true(table.plan.fixed_is_wo);
    assert_true(isnan(table.value[0]) && isnan(table.value[1]) && isnan(table.value[2]) && table.value[3] == 4.0);
    dif_table_free(&table);
}

static void test_read__normal_incidence_takes_the_plane_of_the_other_side(void **state)
{
    (void)state;
    dif_table table;
    dif_error err;
    assert_int_equal(
        parse("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value\n0,0,10,90,500,1\n0,0,10,270,500,2\n"
              "0,0,0,0,500,3\n",
              &table, &err),
        DIF_OK);
    assert_true(table.plan.azimuth_rad == dif_rad_from_deg(90.0));
    assert_int_equal(table.plan.n_angle, 3);
    assert_true(table.value[0] == 2.0 && table.value[1] == 3.0 && table.value[2] == 1.0);
    dif_table_free(&table);
}

static void test_read__matrices_in_any_order_are_sorted(void **state)
{
    (void)state;
    dif_table table;
    dif_error err;
    assert_int_equal(
        parse("# fixed_angle: theta_i\n# fixed_deg: 30\n# quantity: power\nnm,10,-10,0\n600,1,2,3\n500,4,nan,6\n",
              &table, &err),
        DIF_OK);
    static const double WANT[] = {-1.0, 6.0, 4.0, 2.0, 3.0, 1.0};
    for (int k = 0; k < 6; k++)
        assert_true(k == 0 ? isnan(table.value[k]) : table.value[k] == WANT[k]);
    assert_true(table.plan.lambda_um[0] == 0.5 && table.plan.angle_rad[2] == dif_rad_from_deg(10.0));
    dif_table_free(&table);
}

static void test_read__refuses_bad_tables_with_the_line(void **state)
{
    (void)state;
#define HEAD  "theta_i_deg,theta_r_deg,lambda_nm,value\n"
#define FIXED "# fixed_angle: theta_i\n# fixed_deg: 75\n"
    static const struct {
        const char *text;
        dif_status status;
        const char *message;
    } CASES[] = {
        {"", DIF_ERR_FORMAT, "f.csv: empty file"},
        {"# only: comments\n", DIF_ERR_FORMAT, "f.csv: no row of data, want CSV"},
        {HEAD, DIF_ERR_FORMAT, "f.csv: no rows below the header"},
        {"theta_i_deg,theta_r_deg,value\n1,2,3\n", DIF_ERR_FORMAT, "f.csv: line 1: no column lambda_nm"},
        {"theta_i_deg,theta_r_deg,lambda_nm\n1,2,3\n", DIF_ERR_FORMAT,
         "f.csv: line 1: no column value, power, rho or brdf"},
        {HEAD "75,10,500,1\n75,10\n", DIF_ERR_FORMAT, "f.csv: line 3 has 2 cells, want 4 as in the header"},
        {HEAD "75,10,500,1,9\n", DIF_ERR_FORMAT, "f.csv: line 2 has 5 cells, want 4 as in the header"},
        {HEAD "75,ten,500,1\n", DIF_ERR_FORMAT, "f.csv: line 2: theta_r_deg is 'ten', want a number"},
        {HEAD "75,90,500,1\n", DIF_ERR_FORMAT, "f.csv: line 2: theta_r_deg is 90, want -90 < angle < 90"},
        {HEAD "-91,9,500,1\n", DIF_ERR_FORMAT, "f.csv: line 2: theta_i_deg is -91, want -90 < angle < 90"},
        {HEAD "75,,500,1\n", DIF_ERR_FORMAT, "f.csv: line 2: theta_r_deg is nan, want -90 < angle < 90"},
        {HEAD "75,10,0,1\n", DIF_ERR_FORMAT, "f.csv: line 2: lambda_nm is 0, want a wavelength > 0"},
        {HEAD "75,10,-5,1\n", DIF_ERR_FORMAT, "f.csv: line 2: lambda_nm is -5, want a wavelength > 0"},
        {HEAD "75,10,inf,1\n", DIF_ERR_FORMAT, "f.csv: line 2: lambda_nm is inf, want a wavelength > 0"},
        {HEAD "75,10,500,1\n75,10,500,2\n", DIF_ERR_FORMAT, "f.csv: line 3: 10 deg, 500 nm was measured before"},
        {HEAD "75,10,500,1\n74,11,500,2\n", DIF_ERR_FORMAT,
         "f.csv: theta_i_deg and theta_r_deg both change, want one fixed within 1e-06 deg"},
        {HEAD "75,10,500,inf\n", DIF_ERR_NONFINITE, "f.csv: infinite value at 10 deg, 500 nm"},
        {"theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value\n75,0,10,0,500,1\n75,0,10,30,500,1\n",
         DIF_ERR_FORMAT, "f.csv: line 3: azimuths 0 and 30, want all directions in the plane of azimuth 0 deg"},
        {"# quantity: colour\n" HEAD "75,10,500,1\n", DIF_ERR_FORMAT,
         "f.csv: quantity is 'colour', want power, rho or brdf"},
        {"lambda,10,20\n500,1,2\n", DIF_ERR_FORMAT,
         "f.csv: a matrix without its geometry, want # fixed_angle: theta_i (or theta_r) and # fixed_deg: in its "
         "header"},
        {"# fixed_angle: up\nlambda,10,20\n500,1,2\n", DIF_ERR_FORMAT,
         "f.csv: fixed_angle is 'up', want theta_i or theta_r"},
        {"# fixed_angle: theta_i\n# fixed_deg: much\nx,1\n5,1\n", DIF_ERR_FORMAT,
         "f.csv: fixed_deg is 'much', want a finite number"},
        {"# fixed_angle: theta_i\n# fixed_deg: 90\nx,1\n5,1\n", DIF_ERR_FORMAT,
         "f.csv: fixed_deg is 90, want -90 < angle < 90"},
        {FIXED "x,10,90\n500,1,2\n", DIF_ERR_FORMAT, "f.csv: line 3: angle 2 is 90, want -90 < angle < 90"},
        {FIXED "x,10,20\n500,1\n", DIF_ERR_FORMAT, "f.csv: line 4 has 2 cells, want 3 as in the first row"},
        {FIXED "x,10,20\n0,1,2\n", DIF_ERR_FORMAT, "f.csv: line 4: lambda_nm is 0, want a wavelength > 0"},
        {FIXED "x,10,20\n500,1,b\n", DIF_ERR_FORMAT, "f.csv: line 4: value is 'b', want a number"},
        {FIXED "x,10,10\n500,1,2\n", DIF_ERR_FORMAT, "f.csv: two angles are the same"},
        {FIXED "x,10,20\n500,1,2\n500,1,2\n", DIF_ERR_FORMAT, "f.csv: two wavelengths are the same"},
        {FIXED "x,10,20\n", DIF_ERR_FORMAT, "f.csv: no rows below the angles"},
        {"just some words\n", DIF_ERR_FORMAT, "f.csv: line 1: angle is 'some', want a number"},
        {"word\n", DIF_ERR_FORMAT,
         "f.csv: line 1: neither columns theta_i_deg, theta_r_deg, lambda_nm, value nor angles of a matrix"},
    };
    const int n_live = test_alloc_live();
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        dif_table table;
        dif_error err = {0};
        assert_int_equal(parse(CASES[i].text, &table, &err), CASES[i].status);
        assert_string_equal(err.text, CASES[i].message);
        assert_null(table.value);
        assert_null(table.plan.angle_rad);
    }
    assert_int_equal(test_alloc_live(), n_live);
}

static void test_read__scattered_rows_are_no_table(void **state)
{
    (void)state;
    static char text[200000];
    size_t n = (size_t)snprintf(text, sizeof text, HEAD);
    for (int i = 0; i < 2000; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "75,%g,%g,1\n", 0.01 * i, 400.0 + 0.1 * i);
    dif_table table;
    dif_error err;
    assert_int_equal(parse(text, &table, &err), DIF_ERR_FORMAT);
    assert_string_equal(err.text, "f.csv: 2000 rows with 2000 angles and 2000 wavelengths, want a grid of them");
}

static void test_parse__failing_heap_leaves_nothing(void **state)
{
    (void)state;
    static const char *const TEXTS[] = {"# a: b\n" HEAD "75,10,500,1\n75,20,500,2\n",
                                        "# a: b\n" FIXED "x,20,10\n500,1,2\n"};
    const int n_live = test_alloc_live();
    for (int i = 0; i < 2; i++) {
        dif_status status = DIF_ERR_NOMEM;
        int k = 0;
        while (status) {
            dif_table table;
            dif_manifest manifest;
            dif_error err;
            test_alloc_fail_from(++k);
            status = dif_table_parse((const unsigned char *)TEXTS[i], strlen(TEXTS[i]), "f", &table, &manifest, &err);
            test_alloc_fail_from(0);
            assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
            dif_table_free(&table);
            dif_manifest_free(&manifest);
            assert_int_equal(test_alloc_live(), n_live);
            assert_true(k < 200);
        }
        assert_true(k > 10);
    }
}

static dif_status parse_queries(const char *text, size_t *n, dif_query **query, double (**degrees)[5], dif_error *err)
{
    return dif_queries_parse((const unsigned char *)text, strlen(text), "q.csv", n, query, degrees, err);
}

static void test_queries__columns_in_any_order(void **state)
{
    (void)state;
    size_t n = 0;
    dif_query *query = NULL;
    double(*degrees)[5] = NULL;
    dif_error err;
    assert_int_equal(parse_queries("# my queries\nlambda_nm,phi_r_deg,theta_r_deg,phi_i_deg,theta_i_deg\n"
                                   "550,180,30,0,60\n400,10,-20,45,0\n",
                                   &n, &query, &degrees, &err),
                     DIF_OK);
    assert_int_equal(n, 2);
    static const double WANT[2][5] = {{60, 0, 30, 180, 550}, {0, 45, -20, 10, 400}};
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 5; k++)
            assert_true(degrees[i][k] == WANT[i][k]);
    }
    assert_near(query[0].lambda_um, 0.55, 1e-15, 0.0);
    assert_near(query[0].wi.x, sqrt(0.75), 1e-15, 0.0);
    assert_near(query[0].wi.z, 0.5, 1e-15, 0.0);
    assert_near(query[0].wo.x, -0.5, 1e-15, 0.0);
    assert_near(query[0].wo.y, 0.0, 0.0, 1e-16); /* the sine of pi as a double */
    dif_release(query);
    dif_release(degrees);
}

static void test_queries__bad_ones_are_refused_with_the_line(void **state)
{
    (void)state;
#define QUERY_HEAD "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm\n"
    static const struct {
        const char *text, *message;
    } CASES[] = {
        {"", "q.csv: empty file"},
        {QUERY_HEAD, "q.csv: no rows below the header"},
        {"theta_i_deg,phi_i_deg\n1,2\n", "q.csv: line 1: no column theta_r_deg"},
        {QUERY_HEAD "1,2,3,4\n", "q.csv: line 2 has 4 cells, want 5 as in the header"},
        {QUERY_HEAD "1,2,3,4,500\n90,2,3,4,500\n", "q.csv: line 3: theta_i_deg is 90, want -90 < angle < 90"},
        {QUERY_HEAD "1,2,nan,4,500\n", "q.csv: line 2: theta_r_deg is nan, want -90 < angle < 90"},
        {QUERY_HEAD "1,inf,3,4,500\n", "q.csv: line 2: phi_i_deg is inf, want a finite angle"},
        {QUERY_HEAD "1,2,3,4,0\n", "q.csv: line 2: lambda_nm is 0, want a wavelength > 0"},
        {QUERY_HEAD "1,2,3,x,500\n", "q.csv: line 2: phi_r_deg is 'x', want a number"},
    };
    const int n_live = test_alloc_live();
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        size_t n = 7;
        dif_query *query = NULL;
        double(*degrees)[5] = NULL;
        dif_error err = {0};
        assert_int_equal(parse_queries(CASES[i].text, &n, &query, &degrees, &err), DIF_ERR_FORMAT);
        assert_string_equal(err.text, CASES[i].message);
        assert_true(n == 0 && !query && !degrees);
    }
    assert_int_equal(test_alloc_live(), n_live);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__bare_columns_of_an_instrument),
        cmocka_unit_test(test_read__missing_cells_become_nan),
        cmocka_unit_test(test_read__normal_incidence_takes_the_plane_of_the_other_side),
        cmocka_unit_test(test_read__matrices_in_any_order_are_sorted),
        cmocka_unit_test(test_read__refuses_bad_tables_with_the_line),
        cmocka_unit_test(test_read__scattered_rows_are_no_table),
        cmocka_unit_test(test_parse__failing_heap_leaves_nothing),
        cmocka_unit_test(test_queries__columns_in_any_order),
        cmocka_unit_test(test_queries__bad_ones_are_refused_with_the_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
