/* The methods that are compared with the sheet: the source's program, few wavelengths, bumps, series in float. */
#include "alloc_count.h"
#include "core/units.h"
#include "first_order.h"
#include "rough.h"

/* The source's bitmap: one period of 2500 nm in 200 pixels of 12.5 nm, 250 nm high in 8 bits. */
static dif_field blazed_bitmap(void)
{
    dif_field field;
    assert_int_equal(dif_field_create(200, 200, 0.0125, 0.0125, &field, NULL), DIF_OK);
    for (int i = 0; i < 200 * 200; i++)
        field.z_um[i] = 0.25 * rint(255.0 * (i % 200) / 200.0) / 255.0;
    return field;
}

static void test_method__names_lead_back(void **state)
{
    (void)state;
    const char *const names[] = {"sheet", "taylor", "direct", "thesis", "nmm", "pq", "stam"};
    for (int i = 0; i < 7; i++) {
        dif_method method;
        assert_true(dif_method_from_name(names[i], &method));
        assert_int_equal(method, i);
        assert_string_equal(dif_method_name(method), names[i]);
        assert_int_equal(*dif_method_leaves_out(method) != 0, i >= DIF_METHOD_THESIS);
    }
}

static void test_thesis__blazed_grating_as_published(void **state)
{
    (void)state;
    dif_field field = blazed_bitmap();
    dif_measure_opts opts = dif_measure_opts_default();
    double mean_nm, sd_nm;
    opts.method = DIF_METHOD_THESIS;
    for (int c = 0; c < 3; c++) { /* lit from either side, and in float: all the same */
        opts.single = c == 2;
        test_first_order(&field, &opts, c == 1 ? 180.0 : 0.0, "-55:-40:0.01", &mean_nm, &sd_nm);
        print_message("blazed by the source's program: %.4f nm, sd %.4f (published 2499.997 and 0.377)\n", mean_nm,
                      sd_nm);
        assert_near(mean_nm, 2499.997, 0.0, 0.001);
        assert_near(sd_nm, 0.377, 0.0, 0.001);
    }
    /* The deviation is that of the angular grid: twice the step, twice the deviation. */
    test_first_order(&field, &opts, 0.0, "-55:-40:0.02", &mean_nm, &sd_nm);
    assert_near(sd_nm, 2.0 * 0.377, 0.02, 0.0);
    dif_field_free(&field);
}

static void test_thesis__snake_sheds(void **state)
{
    (void)state;
    dif_field elaphe, xenopeltis;
    dif_measure_opts opts = dif_measure_opts_default();
    double mean_nm, sd_nm;
    opts.method = DIF_METHOD_THESIS;
    if (!test_read_scan("elaphe_65um.png", 0.375, &elaphe))
        skip();
    test_first_order(&elaphe, &opts, 180.0, "-40:-15:0.01", &mean_nm, &sd_nm);
    print_message("Elaphe by the source's program: %.3f nm, sd %.3f (published 1144.262)\n", mean_nm, sd_nm);
    assert_near(mean_nm, 1143.8, 0.0, 0.1); /* half a nanometre from what is published: 4e-4 */
    dif_field_free(&elaphe);
    assert_true(test_read_scan("xenopeltis_65um.png", 0.81869, &xenopeltis));
    test_first_order(&xenopeltis, &opts, 270.0, "-50:-25:0.01", &mean_nm, &sd_nm);
    print_message("Xenopeltis by the source's program: %.3f nm, sd %.3f (published 1552.27)\n", mean_nm, sd_nm);
    assert_near(mean_nm, 1515.0, 0.0, 0.5); /* not the published value */
    dif_field_free(&xenopeltis);
}

static void test_thesis__has_no_gain(void **state)
{
    (void)state;
    dif_field field = test_rough_field(30, 30, 0.1, 0.1, 0.2, 4);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_plan plan = test_plan(60.0, 0.0, "-40:40:10", "500");
    dif_table power, rho;
    dif_sample sample;
    dif_query query = {.lambda_um = 0.5};
    dif_error err;
    opts.method = DIF_METHOD_THESIS;
    opts.sigma_um = 1.0;
    rho = test_measure(&field, &plan, &opts, NULL);
    opts.quantity = DIF_QUANTITY_POWER;
    power = test_measure(&field, &plan, &opts, NULL);
    for (int i = 0; i < plan.n_angle; i++) {
        assert_near(rho.value[i], power.value[i], 0.0, 0.0);
        dif_plan_directions(&plan, i, &query.wi, &query.wo);
        assert_int_equal(dif_measure_queries(&field, 1, &query, 1e-6, &opts, &sample, NULL, NULL), DIF_OK);
        assert_near(sample.rho, power.value[i], 1e-9, 1e-15);
        assert_true(isnan(sample.brdf_per_sr));
    }
    opts.quantity = DIF_QUANTITY_BRDF;
    dif_table_free(&rho);
    assert_int_equal(dif_measure_table(&field, &plan, 1e-6, &opts, &rho, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "the source's program has no absolute BRDF: its gain is 1");
    opts.quantity = DIF_QUANTITY_RHO;
    opts.window = DIF_WINDOW_FLAT;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-6, &opts, &rho, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "the source's program knows no window but the Gaussian");
    dif_table_free(&power);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_stam__and_nmm_ask_for_their_period(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 30, 0.1, 0.1, 0.2, 1);
    dif_plan plan = test_plan(30.0, 0.0, "-40:40:20", "500");
    dif_measure_opts opts = dif_measure_opts_default();
    dif_table table;
    dif_error err;
    opts.method = DIF_METHOD_STAM;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-3, &opts, &table, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "stam needs the surface's period, and none was given");
    opts.method = DIF_METHOD_NMM;
    opts.nmm_lines = true;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-3, &opts, &table, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "nmm needs the surface's period, and none was given");
    opts.nmm_lines = false;
    opts.nmm_fixed = 0;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-3, &opts, &table, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "0 fixed wavelengths, want 1 ... 401");
    opts.method = DIF_METHOD_THESIS;
    opts.thesis_terms = 201;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-3, &opts, &table, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "201 terms, want 1 ... 200");
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_stam__orders_are_bright_whatever_the_heights(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 30, 0.1, 0.1, 0.2, 1);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_plan plan = test_plan(0.0, 0.0, "-80:80:0.5", "500");
    dif_measure_stats stats;
    opts.method = DIF_METHOD_STAM;
    opts.quantity = DIF_QUANTITY_POWER;
    opts.period_um = 2.0;
    dif_table table = test_measure(&field, &plan, &opts, &stats);
    assert_true(isnan(stats.bound));
    for (int i = 0; i < plan.n_angle; i++) {
        /* m lambda / d = m / 4 */
        const double m = 4.0 * sin(plan.angle_rad[i]), off = (m - rint(m)) / 2.0;
        assert_near(table.value[i], exp(-pow(DIF_TWO_PI * 16.25 * off, 2.0)), 1e-9, 1e-15);
    }
    dif_table_free(&table);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_methods__tables_and_queries_agree(void **state)
{
    (void)state;
    dif_field field = test_rough_field(60, 61, 0.05, 0.06, 0.3, 2);
    const dif_method methods[] = {DIF_METHOD_THESIS, DIF_METHOD_NMM, DIF_METHOD_PQ, DIF_METHOD_STAM};
    dif_plan plan = test_plan(30.0, 200.0, "-80:80:20", "400:700:100");
    for (int m = 0; m < 4; m++)
        for (int average = 0; average < 2; average++) {
            dif_measure_opts opts = dif_measure_opts_default();
            dif_measure_stats stats;
            opts.method = methods[m];
            opts.sigma_um = 0.7;
            opts.average = (dif_average)average;
            opts.period_um = 1.1;
            dif_table table = test_measure(&field, &plan, &opts, &stats);
            assert_true(methods[m] == DIF_METHOD_NMM || stats.n_window == 1);
            assert_true(isnan(stats.bound) == (methods[m] != DIF_METHOD_PQ));
            for (int i = 0; i < plan.n_angle * plan.n_lambda; i++) {
                dif_query query = {.lambda_um = plan.lambda_um[i / plan.n_angle]};
                dif_sample sample;
                dif_plan_directions(&plan, i % plan.n_angle, &query.wi, &query.wo);
                assert_int_equal(dif_measure_queries(&field, 1, &query, 1e-6, &opts, &sample, NULL, NULL), DIF_OK);
                /* two amplitudes, each good to 1e-6, times gains of up to 30 */
                assert_near(table.value[i], sample.rho, 0.0, 1e-4);
                assert_true(methods[m] != DIF_METHOD_STAM || isnan(sample.amp_re));
            }
            dif_table_free(&table);
        }
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_nmm__a_cell_is_read_at_its_bin(void **state)
{
    (void)state;
    dif_field field = test_rough_field(60, 50, 0.1, 0.1, 0.3, 2);
    dif_plan plan = test_plan(0.0, 0.0, "60", "400:700:10");
    dif_measure_opts opts = dif_measure_opts_default();
    opts.sigma_um = 1.5;
    opts.nmm_fixed = 2;
    opts.quantity = DIF_QUANTITY_POWER;
    opts.method = DIF_METHOD_NMM;
    dif_table table = test_measure(&field, &plan, &opts, NULL);
    for (int i = 0; i < plan.n_lambda; i++) {
        const double reach = 6.0 * sin(plan.angle_rad[0]); /* D s, D = 6 um */
        double n = rint(reach / plan.lambda_um[i]);
        n = fmin(fmax(n, ceil(reach / 0.78)), floor(reach / 0.38));
        dif_query query = {.lambda_um = reach / n};
        dif_sample sample;
        dif_plan_directions(&plan, 0, &query.wi, &query.wo);
        opts.method = DIF_METHOD_SHEET;
        assert_int_equal(dif_measure_queries(&field, 1, &query, 1e-6, &opts, &sample, NULL, NULL), DIF_OK);
        assert_near(table.value[i], sample.power, 0.0, 1e-6);
    }
    dif_table_free(&table);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_nmm__a_mirror_is_white_where_it_shines(void **state)
{
    (void)state;
    dif_field field;
    dif_plan plan = test_plan(30.0, 0.0, "-30", "380:780:5");
    dif_measure_opts opts = dif_measure_opts_default();
    double nmm[1][3], full[1][3];
    opts.quantity = DIF_QUANTITY_POWER;
    opts.sigma_um = 1.0;
    assert_int_equal(dif_field_create(64, 64, 0.1, 0.1, &field, NULL), DIF_OK);
    assert_int_equal(dif_measure_colours(&field, &plan, 1e-6, &opts, full, NULL, NULL), DIF_OK);
    opts.method = DIF_METHOD_NMM;
    assert_int_equal(dif_measure_colours(&field, &plan, 1e-6, &opts, nmm, NULL, NULL), DIF_OK);
    for (int c = 0; c < 3; c++) {
        assert_near(full[0][c], c == 0 ? 0.95047 : c == 1 ? 1.0 : 1.08883, 1e-5, 0.0);
        assert_near(nmm[0][c], full[0][c], 1e-5, 0.0);
    }
    dif_plan_free(&plan);
    dif_field_free(&field);
}

/* Largest amplitude error of the series against the direct sum near the mirror direction, where w is largest. */
static double series_error(double height_um, bool single, double *bound)
{
    dif_field field = test_rough_field(48, 48, 0.1, 0.1, height_um, 9);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_plan plan = test_plan(5.0, 0.0, "-45:35:2", "380");
    dif_measure_stats stats;
    dif_measure_check check;
    opts.method = DIF_METHOD_TAYLOR;
    opts.sigma_um = 1.0;
    opts.quantity = DIF_QUANTITY_POWER;
    opts.single = single;
    dif_table table = test_measure(&field, &plan, &opts, &stats);
    assert_int_equal(dif_measure_check_table(&field, &table, &opts, 200, 1, &check, NULL), DIF_OK);
    *bound = stats.bound;
    assert_int_equal(stats.single || !single, true);
    dif_table_free(&table);
    dif_plan_free(&plan);
    dif_field_free(&field);
    return check.worst_amplitude;
}

static void test_taylor__float_breaks_on_deep_surfaces(void **state)
{
    (void)state;
    const double heights_um[] = {0.25, 0.8187, 2.0};
    double error[3][2], bound[3][2];
    for (int h = 0; h < 3; h++)
        for (int single = 0; single < 2; single++)
            error[h][single] = series_error(heights_um[h], single, &bound[h][single]);
    for (int h = 0; h < 3; h++)
        print_message("series, heights of %.2f um: double %.1e (bound %.1e), float %.1e (bound %.1e)\n", heights_um[h],
                      error[h][0], bound[h][0], error[h][1], bound[h][1]);
    for (int h = 0; h < 3; h++)
        for (int single = 0; single < 2; single++)
            assert_at_most(error[h][single], bound[h][single]);
    assert_at_most(error[0][1], 1e-6);            /* shallow: float will do            */
    assert_true(error[1][1] > 100 * error[1][0]); /* as deep as Xenopeltis: no longer  */
    assert_true(error[2][1] > 1.0);               /* deep: not one digit is left        */
    assert_at_most(error[2][0], 1e-2);            /* and double has lost most of its own */
}

static void test_measure__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field = test_rough_field(16, 16, 0.05, 0.05, 0.1, 1);
    dif_plan plan = test_plan(75.0, 0.0, "-60:60:60", "400:500:100");
    const int live = test_alloc_live();
    for (int method = DIF_METHOD_THESIS; method <= DIF_METHOD_STAM; method++)
        for (int form = 0; form < 3; form++) {
            dif_measure_opts opts = dif_measure_opts_default();
            int n_failed = 0;
            opts.method = (dif_method)method;
            opts.period_um = 0.4;
            for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; n_failed++) {
                const dif_query query = {{0.0, 0.0, 1.0}, {0.0, 0.6, 0.8}, 0.5};
                dif_table table = {0};
                dif_sample sample;
                double xyz[3][3];
                test_alloc_fail_from(n_failed + 1);
                status = form == 0   ? dif_measure_queries(&field, 1, &query, 1e-3, &opts, &sample, NULL, NULL)
                         : form == 1 ? dif_measure_table(&field, &plan, 1e-3, &opts, &table, NULL, NULL)
                                     : dif_measure_colours(&field, &plan, 1e-3, &opts, xyz, NULL, NULL);
                test_alloc_fail_from(0);
                assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
                dif_table_free(&table);
                assert_int_equal(test_alloc_live(), live);
            }
            assert_true(n_failed > 5);
        }
    dif_plan_free(&plan);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_method__names_lead_back),
        cmocka_unit_test(test_thesis__blazed_grating_as_published),
        cmocka_unit_test(test_thesis__snake_sheds),
        cmocka_unit_test(test_thesis__has_no_gain),
        cmocka_unit_test(test_stam__and_nmm_ask_for_their_period),
        cmocka_unit_test(test_stam__orders_are_bright_whatever_the_heights),
        cmocka_unit_test(test_methods__tables_and_queries_agree),
        cmocka_unit_test(test_nmm__a_cell_is_read_at_its_bin),
        cmocka_unit_test(test_nmm__a_mirror_is_white_where_it_shines),
        cmocka_unit_test(test_taylor__float_breaks_on_deep_surfaces),
        cmocka_unit_test(test_measure__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
