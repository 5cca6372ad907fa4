#include "near.h"

#include <string.h>

#include "alloc_count.h"
#include "bench/maxima.h"
#include "core/units.h"

/* A table over evenly spaced angles in degrees, values zero. */
static dif_table make_table(double fixed_deg, double low_deg, double step_deg, int n_angle, double lambda_nm,
                            double lambda_step_nm, int n_lambda)
{
    dif_plan plan;
    dif_table table;
    dif_error err;
    assert_int_equal(dif_plan_create(n_angle, n_lambda, &plan, &err), DIF_OK);
    plan.fixed_rad = dif_rad_from_deg(fixed_deg);
    for (int i = 0; i < n_angle; i++)
        plan.angle_rad[i] = dif_rad_from_deg(low_deg + i * step_deg);
    for (int i = 0; i < n_lambda; i++)
        plan.lambda_um[i] = dif_um_from_nm(lambda_nm + i * lambda_step_nm);
    assert_int_equal(dif_table_create(&plan, DIF_QUANTITY_POWER, &table, &err), DIF_OK);
    dif_plan_free(&plan);
    return table;
}

/* One wavelength with the given values. */
static dif_table make_row(int n, const double *value)
{
    dif_table table = make_table(0.0, -10.0, 1.0, n, 500.0, 1.0, 1);
    memcpy(table.value, value, (size_t)n * sizeof *value);
    return table;
}

static dif_maxima find(const dif_table *table, const dif_maxima_opts *opts)
{
    dif_maxima maxima;
    dif_error err;
    assert_int_equal(dif_maxima_find(table, opts, &maxima, &err), DIF_OK);
    return maxima;
}

static void test_find__parabola_is_exact(void **state)
{
    (void)state;
    /* the samples lie on one parabola, so its vertex is found to rounding */
    dif_table table = make_table(0.0, -10.0, 1.0, 21, 500.0, 1.0, 1);
    const double top = dif_rad_from_deg(2.3);
    for (int i = 0; i < 21; i++) {
        const double t = table.plan.angle_rad[i] - top;
        table.value[i] = 5.0 - 40.0 * t * t;
    }
    dif_maxima maxima = find(&table, NULL);
    assert_int_equal(maxima.n, 1);
    assert_near(maxima.item[0].angle_rad, top, 1e-12, 0.0);
    assert_near(maxima.item[0].value, 5.0, 1e-13, 0.0);
    assert_near(maxima.item[0].sin_sum, sin(top), 1e-12, 0.0);
    assert_true(maxima.item[0].is_global);
    assert_false(maxima.item[0].at_edge);
    dif_maxima_free(&maxima);
    dif_table_free(&table);
}

static void test_find__uneven_spacing(void **state)
{
    (void)state;
    dif_table table = make_table(0.0, -10.0, 1.0, 5, 500.0, 1.0, 1);
    const double angle[5] = {-0.2, -0.05, 0.01, 0.12, 0.3};
    for (int i = 0; i < 5; i++) {
        table.plan.angle_rad[i] = angle[i];
        table.value[i] = 1.0 - (angle[i] - 0.03) * (angle[i] - 0.03);
    }
    dif_maxima maxima = find(&table, NULL);
    assert_int_equal(maxima.n, 1);
    assert_near(maxima.item[0].angle_rad, 0.03, 1e-12, 0.0);
    dif_maxima_free(&maxima);
    dif_table_free(&table);
}

static void test_find__plateau_counts_once(void **state)
{
    (void)state;
    const double value[9] = {0, 1, 3, 3, 3, 1, 2, 1, 0};
    dif_table table = make_row(9, value);
    dif_maxima maxima = find(&table, NULL);
    assert_int_equal(maxima.n, 2);
    /* its middle: cell 3 */
    assert_near(maxima.item[0].angle_rad, table.plan.angle_rad[3], 1e-14, 0.0);
    assert_near(maxima.item[0].value, 3.0, 0.0, 0.0);
    assert_true(maxima.item[0].is_global);
    assert_false(maxima.item[1].is_global);
    dif_maxima_free(&maxima);
    dif_table_free(&table);
}

static void test_find__plateau_on_the_way_up_is_none(void **state)
{
    (void)state;
    const double value[7] = {0, 2, 2, 3, 1, 1, 0};
    dif_table table = make_row(7, value);
    dif_maxima maxima = find(&table, NULL);
    assert_int_equal(maxima.n, 1);
    assert_near(maxima.item[0].value, 3.0, 0.1, 0.0); /* parabola through 2, 3, 1 tops out a little above 3 */
    dif_maxima_free(&maxima);
    dif_table_free(&table);
}

static void test_find__edge_is_no_maximum(void **state)
{
    (void)state;
    const double value[6] = {9, 5, 1, 4, 1, 0};
    dif_table table = make_row(6, value);
    dif_maxima maxima = find(&table, NULL);
    assert_int_equal(maxima.n, 2); /* the largest value is told, but as an edge */
    assert_true(maxima.item[0].at_edge && maxima.item[0].is_global);
    assert_near(maxima.item[0].angle_rad, table.plan.angle_rad[0], 1e-15, 0.0);
    assert_false(maxima.item[1].at_edge || maxima.item[1].is_global);
    dif_maxima_free(&maxima);
    dif_table_free(&table);
}

static void test_find__nan_never_counts(void **state)
{
    (void)state;
    const double value[9] = {0, NAN, 5, NAN, 1, 2, 1, NAN, 0};
    dif_table table = make_row(9, value);
    dif_maxima maxima = find(&table, NULL);
    /* 5 stands between holes: the largest value, but no maximum; 2 is one */
    assert_int_equal(maxima.n, 2);
    assert_true(maxima.item[0].is_global && maxima.item[0].at_edge);
    assert_near(maxima.item[0].value, 5.0, 0.0, 0.0);
    assert_false(maxima.item[1].at_edge);
    dif_maxima_free(&maxima);
    for (int i = 0; i < 9; i++)
        table.value[i] = NAN;
    maxima = find(&table, NULL);
    assert_int_equal(maxima.n, 0);
    dif_maxima_free(&maxima);
    dif_table_free(&table);
}

static void test_find__floor_is_a_share_of_the_table(void **state)
{
    (void)state;
    const double value[9] = {0, 100, 0, 0.9, 0, 1.1, 0, 50, 0};
    dif_table table = make_row(9, value);
    dif_maxima maxima = find(&table, NULL); /* 1 % */
    assert_int_equal(maxima.n, 3);
    dif_maxima_free(&maxima);
    dif_maxima_opts opts = dif_maxima_opts_default();
    opts.floor_share = 0.0;
    maxima = find(&table, &opts);
    assert_int_equal(maxima.n, 4);
    dif_maxima_free(&maxima);
    dif_table_free(&table);
}

/* Narrow lines at the orders of a 2 um grating seen from 20 degrees. */
static dif_table make_orders(void)
{
    dif_table table = make_table(20.0, -60.0, 0.05, 2401, 400.0, 10.0, 11);
    for (int il = 0; il < table.plan.n_lambda; il++)
        for (int ia = 0; ia < table.plan.n_angle; ia++) {
            const double f = (sin(table.plan.fixed_rad) + sin(table.plan.angle_rad[ia])) / table.plan.lambda_um[il];
            const double t = (f * 2.0 - round(f * 2.0)) / 0.01;
            table.value[(size_t)il * 2401u + (size_t)ia] = exp(-0.5 * t * t);
        }
    return table;
}

static void test_find__orders_of_the_grating_equation(void **state)
{
    (void)state;
    dif_table table = make_orders();
    dif_maxima_opts opts = dif_maxima_opts_default();
    opts.period_um = 2.0;
    dif_maxima maxima = find(&table, &opts);
    assert_true(maxima.n > 11 * 5);
    for (int i = 0; i < maxima.n; i++) {
        const dif_maximum *m = &maxima.item[i];
        if (m->at_edge)
            continue;
        /* a parabola on 0.05 degree samples of these lines is good to a few 1e-6 rad */
        assert_near(m->residual_rad, 0.0, 0.0, 2e-5);
        assert_near(m->sin_sum, m->order * m->lambda_um / 2.0, 0.0, 2e-5);
        if (m->order != 0)
            assert_near(m->period_um, 2.0, 2e-4, 0.0);
        else
            assert_true(isnan(m->period_um));
    }
    dif_maxima_free(&maxima);
    dif_table_free(&table);
}

static void test_by_order__statistics(void **state)
{
    (void)state;
    dif_table table = make_orders();
    dif_maxima_opts opts = dif_maxima_opts_default();
    opts.period_um = 2.0;
    dif_maxima maxima = find(&table, &opts);
    dif_maxima_order order[16];
    const int n = dif_maxima_by_order(&maxima, 16, order);
    assert_true(n >= 6 && n <= 16);
    int n_all = 0;
    for (int i = 0; i < n; i++) {
        assert_true(i == 0 || order[i].order == order[i - 1].order + 1);
        assert_true(fabs(order[i].mean_rad) <= order[i].rms_rad + 1e-18);
        assert_true(order[i].rms_rad <= fabs(order[i].worst_rad) + 1e-18);
        n_all += order[i].n;
        if (order[i].order == 0)
            assert_true(isnan(order[i].period_mean_um));
        else
            assert_near(order[i].period_mean_um, 2.0, 1e-4, 0.0);
    }
    int n_want = 0;
    for (int i = 0; i < maxima.n; i++)
        n_want += !maxima.item[i].at_edge;
    assert_int_equal(n_all, n_want);
    assert_int_equal(dif_maxima_by_order(&maxima, 2, order), n); /* counts beyond the room it has */
    dif_maxima_free(&maxima);
    dif_table_free(&table);
}

static void test_find__order_beyond_the_horizon_has_no_residual(void **state)
{
    (void)state;
    /* from 75 degrees a maximum at sin = 0.99 with the nearest order at sin > 1 */
    dif_table table = make_table(75.0, 78.0, 1.0, 11, 500.0, 1.0, 1);
    for (int i = 0; i < 11; i++)
        table.value[i] = i == 3 ? 1.0 : 0.0; /* 81 degrees: sin sum 1.9536 */
    dif_maxima_opts opts = dif_maxima_opts_default();
    opts.period_um = 0.5 * 1.05; /* order 2 lies at sin = 0.9388 */
    dif_maxima maxima = find(&table, &opts);
    assert_int_equal(maxima.n, 1);
    assert_int_equal(maxima.item[0].order, 2);
    assert_near(maxima.item[0].residual_rad,
                maxima.item[0].angle_rad - asin(2.0 * 0.5 / 0.525 - sin(dif_rad_from_deg(75.0))), 1e-12, 0.0);
    dif_maxima_free(&maxima);
    opts.period_um = 0.5 * 1.01; /* order 2: sin = 1.0142 */
    maxima = find(&table, &opts);
    assert_int_equal(maxima.item[0].order, 2);
    assert_true(isnan(maxima.item[0].residual_rad));
    assert_near(maxima.item[0].period_um, 2.0 * 0.5 / maxima.item[0].sin_sum, 1e-14, 0.0);
    dif_maxima_free(&maxima);
    dif_table_free(&table);
}

static void test_first_order__mean_and_deviation(void **state)
{
    (void)state;
    /* one peak a wavelength, alternately at lambda/1.5 and lambda/1.6: mean and deviation follow by hand */
    dif_table table = make_table(75.0, -60.0, 0.01, 3001, 400.0, 20.0, 10);
    double sum = 0.0, square = 0.0;
    for (int il = 0; il < 10; il++) {
        const double period = il % 2 ? 1.5 : 1.6;
        const double at = asin(table.plan.lambda_um[il] / period - sin(table.plan.fixed_rad));
        for (int ia = 0; ia < 3001; ia++) {
            const double t = (table.plan.angle_rad[ia] - at) / 0.01;
            table.value[(size_t)il * 3001u + (size_t)ia] = exp(-0.5 * t * t);
        }
        sum += period;
        square += period * period;
    }
    dif_maxima maxima = find(&table, NULL);
    const dif_maxima_period p = dif_maxima_first_order(&maxima);
    assert_int_equal(p.n, 10);
    assert_near(p.mean_um, sum / 10.0, 1e-6, 0.0); /* parabola on a Gaussian: 1e-8 rad */
    assert_near(p.sd_um, sqrt((square - sum * sum / 10.0) / 9.0), 1e-4, 0.0);
    assert_near(p.min_um, 1.5, 1e-6, 0.0);
    assert_near(p.max_um, 1.6, 1e-6, 0.0);
    dif_maxima_free(&maxima);
    const dif_maxima_period none = dif_maxima_first_order(&(dif_maxima){0});
    assert_int_equal(none.n, 0);
    assert_true(isnan(none.mean_um) && isnan(none.sd_um));
    dif_table_free(&table);
}

static void test_find__bad_input(void **state)
{
    (void)state;
    const double value[3] = {0, 1, 0};
    dif_table table = make_row(3, value);
    dif_maxima maxima;
    dif_error err;
    dif_maxima_opts opts = dif_maxima_opts_default();
    opts.floor_share = 1.0;
    assert_int_equal(dif_maxima_find(&table, &opts, &maxima, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "floor_share = 1, want 0 <= floor_share < 1");
    opts.floor_share = NAN;
    assert_int_equal(dif_maxima_find(&table, &opts, &maxima, &err), DIF_ERR_ARG);
    opts = dif_maxima_opts_default();
    opts.period_um = -1.0;
    assert_int_equal(dif_maxima_find(&table, &opts, &maxima, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "period = -1 um, want a positive number");
    table.plan.angle_rad[2] = table.plan.angle_rad[1];
    assert_int_equal(dif_maxima_find(&table, NULL, &maxima, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "angles do not increase at cell 2");
    assert_null(maxima.item);
    assert_int_equal(dif_maxima_find(NULL, NULL, &maxima, &err), DIF_ERR_ARG);
    dif_maxima_free(NULL);
    dif_table_free(&table);
}

static void test_find__out_of_memory(void **state)
{
    (void)state;
    const double value[3] = {0, 1, 0};
    dif_table table = make_row(3, value);
    dif_maxima maxima;
    dif_error err;
    const int live = test_alloc_live();
    test_alloc_fail_from(1);
    assert_int_equal(dif_maxima_find(&table, NULL, &maxima, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    assert_null(maxima.item);
    assert_int_equal(test_alloc_live(), live);
    dif_table_free(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_find__parabola_is_exact),
        cmocka_unit_test(test_find__uneven_spacing),
        cmocka_unit_test(test_find__plateau_counts_once),
        cmocka_unit_test(test_find__plateau_on_the_way_up_is_none),
        cmocka_unit_test(test_find__edge_is_no_maximum),
        cmocka_unit_test(test_find__nan_never_counts),
        cmocka_unit_test(test_find__floor_is_a_share_of_the_table),
        cmocka_unit_test(test_find__orders_of_the_grating_equation),
        cmocka_unit_test(test_by_order__statistics),
        cmocka_unit_test(test_find__order_beyond_the_horizon_has_no_residual),
        cmocka_unit_test(test_first_order__mean_and_deviation),
        cmocka_unit_test(test_find__bad_input),
        cmocka_unit_test(test_find__out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
