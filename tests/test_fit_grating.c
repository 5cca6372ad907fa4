/* Table fits on measured tables of gratings: the whole chain from heights to period. */
#include "near.h"

#include "bench/fit.h"
#include "bench/measure.h"
#include "bench/scan.h"
#include "core/io/field_io.h"
#include "core/units.h"
#include "fixtures/surfaces.h"

static dif_fit_result fit(const dif_table *table, const dif_fit_table_opts *opts)
{
    dif_fit_result result;
    dif_error err = {.text = ""};
    const dif_status status = dif_fit_table(table, opts, &result, &err);
    if (status != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(status, DIF_OK);
    return result;
}

/* A measured table of a grating on the default patch, and the options that know how it was made. */
static dif_table measure(double azimuth_deg, double psi_deg, dif_average average, dif_fit_table_opts *opts)
{
    dif_surface surface = dif_surface_default(DIF_SURFACE_BLAZED);
    surface.psi_rad = dif_rad_from_deg(psi_deg);
    const dif_range angle = {-55.0, -40.0, 0.05, 301}, lambda = {380.0, 780.0, 10.0, 41};
    dif_plan plan;
    dif_field field;
    dif_table table;
    dif_measure_stats stats;
    dif_error err = {.text = ""};
    assert_int_equal(dif_scan_plan(false, 75.0, azimuth_deg, &angle, &lambda, &plan, &err), DIF_OK);
    dif_measure_opts how = dif_measure_opts_default();
    how.average = average;
    assert_int_equal(dif_surface_make(&surface, &field, &err), DIF_OK);
    assert_int_equal(dif_measure_table(&field, &plan, 1e-6, &how, &table, &stats, &err), DIF_OK);
    *opts = dif_fit_table_opts_default();
    opts->common_period = true;
    opts->line = (dif_fit_line){.known = true,
                                .window = {.kind = how.window, .sigma_um = how.sigma_um},
                                .size_x_um = field.nx * field.pitch_x_um,
                                .size_y_um = field.ny * field.pitch_y_um,
                                .average = average,
                                .pitch_um = field.pitch_x_um};
    dif_field_free(&field);
    dif_plan_free(&plan);
    return table;
}

static void test_grating__blazed_from_either_side(void **state)
{
    (void)state;
    /* plain maxima give 2500.4 and 2501.0 nm here; the line shape alone 2500.0 and 2500.7 */
    for (int side = 0; side < 2; side++) {
        dif_fit_table_opts opts;
        dif_table table = measure(180.0 * side, 0.0, DIF_AVERAGE_NONE, &opts);
        const dif_fit_result r = fit(&table, &opts);
        print_message("azimuth %3d: %.4f +- %.4f nm\n", 180 * side, 1e3 * r.period_um, 1e3 * r.period_uncertainty_um);
        assert_near(r.period_um, 2.5, 0.0, 5e-5);
        assert_near(r.period_um, 2.5, 0.0, r.period_uncertainty_um);
        assert_at_most(r.period_uncertainty_um, 1e-4);
        assert_at_most(r.residual_share, 1e-4);
        dif_table_free(&table);
    }
}

static void test_grating__blazed_turned(void **state)
{
    (void)state;
    for (int side = 0; side < 2; side++) {
        dif_fit_table_opts opts;
        dif_table table = measure(30.0 + 180.0 * side, 30.0, DIF_AVERAGE_NONE, &opts);
        const dif_fit_result r = fit(&table, &opts);
        assert_near(r.period_um, 2.5, 0.0, 5e-6);
        assert_near(r.period_um, 2.5, 0.0, r.period_uncertainty_um);
        dif_table_free(&table);
    }
}

static void test_grating__blazed_welch(void **state)
{
    (void)state;
    dif_fit_table_opts opts;
    dif_table table = measure(180.0, 0.0, DIF_AVERAGE_WELCH, &opts);
    const dif_fit_result r = fit(&table, &opts);
    assert_near(r.period_um, 2.5, 0.0, 2e-4);
    assert_near(r.period_um, 2.5, 0.0, r.period_uncertainty_um);
    /* windows at the patch's edge are cut, which makes the line wider than the single window's */
    assert_true(r.ridge[0].width_per_um > 0.0080);
    dif_table_free(&table);
}

static void test_grating__line_of_free_width(void **state)
{
    (void)state;
    dif_fit_table_opts opts;
    dif_table table = measure(0.0, 0.0, DIF_AVERAGE_NONE, &opts);
    opts.line.known = false;
    const dif_fit_result r = fit(&table, &opts);
    /* nothing is known of the window: the leak's few tenths of a nanometre stay */
    assert_near(r.period_um, 2.5, 0.0, 1e-3);
    dif_table_free(&table);
}

static void test_grating__separate_ridges_agree(void **state)
{
    (void)state;
    /* without a common period the samples' ghosts have no place in the model, which its uncertainty must tell */
    dif_fit_table_opts opts;
    dif_table table = measure(180.0, 0.0, DIF_AVERAGE_NONE, &opts);
    opts.common_period = false;
    const dif_fit_result r = fit(&table, &opts);
    assert_near(r.period_um, 2.5, 0.0, 1e-3);
    assert_near(r.period_um, 2.5, 0.0, r.period_uncertainty_um);
    dif_table_free(&table);
}

static void test_grating__no_order_between_orders(void **state)
{
    (void)state;
    /* f = 0.49 ... 0.65 holds nothing but what leaks from orders 1 and 2: neighbouring peaks, and no period in them */
    const dif_range angle = {-13.0, -10.0, 0.02, 151}, lambda = {500.0, 560.0, 2.0, 31};
    const dif_surface surface = dif_surface_default(DIF_SURFACE_BLAZED);
    const dif_measure_opts how = dif_measure_opts_default();
    dif_plan plan;
    dif_field field;
    dif_table table;
    dif_measure_stats stats;
    dif_fit_result result;
    dif_error err = {.text = ""};
    assert_int_equal(dif_scan_plan(false, 30.0, 0.0, &angle, &lambda, &plan, &err), DIF_OK);
    assert_int_equal(dif_surface_make(&surface, &field, &err), DIF_OK);
    assert_int_equal(dif_measure_table(&field, &plan, 1e-6, &how, &table, &stats, &err), DIF_OK);
    for (int i = 0; i < 4; i++) {
        dif_fit_table_opts opts = dif_fit_table_opts_default();
        opts.common_period = i % 2;
        opts.line.known = i / 2;
        opts.line.window.sigma_um = how.sigma_um;
        opts.line.size_x_um = opts.line.size_y_um = 65.0;
        assert_int_equal(dif_fit_table(&table, &opts, &result, &err), DIF_ERR_FIT);
        assert_int_equal(result.n_ridge, 0);
    }
    dif_table_free(&table);
    dif_field_free(&field);
    dif_plan_free(&plan);
}

/* The ridge nearest to a period, NULL if none is within 4 nm. */
static const dif_fit_ridge *ridge_near(const dif_fit_result *r, double period_um)
{
    for (int k = 0; k < r->n_ridge; k++)
        if (fabs(r->ridge[k].period_um - period_um) < 4e-3)
            return &r->ridge[k];
    return NULL;
}

static void test_grating__ridges_of_a_snake(void **state)
{
    (void)state;
    const char *folder = test_data_folder();
    if (!folder)
        skip();
    char path[512];
    snprintf(path, sizeof path, "%s/measured/elaphe_65um.png", folder);
    dif_field_request request = dif_field_request_default();
    request.size_um = 65.0;
    request.height_um = 0.375;
    const dif_range angle = {-40.0, -15.0, 0.05, 501}, lambda = {380.0, 780.0, 5.0, 81};
    const dif_measure_opts how = dif_measure_opts_default();
    dif_field_file file;
    dif_plan plan;
    dif_table table;
    dif_measure_stats stats;
    dif_error err = {.text = ""};
    assert_int_equal(dif_field_read(path, &request, &file, &err), DIF_OK);
    assert_int_equal(dif_scan_plan(false, 75.0, 0.0, &angle, &lambda, &plan, &err), DIF_OK);
    assert_int_equal(dif_measure_table(&file.field, &plan, 1e-6, &how, &table, &stats, &err), DIF_OK);
    dif_fit_table_opts opts = dif_fit_table_opts_default();
    opts.line =
        (dif_fit_line){.known = true, .window = {.sigma_um = how.sigma_um}, .size_x_um = 65.0, .size_y_um = 65.0};
    const dif_fit_result r = fit(&table, &opts);
    /* the surface's own spectrum has ridges near 1184, 1133, 1070 and 1030 nm; the maximum hops between them */
    const double want_um[] = {1.1838, 1.1335, 1.0713, 1.0281};
    double sum = 0.0;
    for (int i = 0; i < 4; i++) {
        const dif_fit_ridge *ridge = ridge_near(&r, want_um[i]);
        assert_non_null(ridge);
        assert_at_most(ridge->period_sd_um, 2e-3);
        assert_true(ridge->weight > 0.05 && ridge->weight < 0.5);
        sum += ridge->weight;
    }
    assert_true(sum > 0.7);
    assert_at_most(r.residual_share, 0.2);
    dif_table_free(&table);
    dif_plan_free(&plan);
    dif_field_file_free(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grating__blazed_from_either_side),
        cmocka_unit_test(test_grating__blazed_turned),
        cmocka_unit_test(test_grating__blazed_welch),
        cmocka_unit_test(test_grating__line_of_free_width),
        cmocka_unit_test(test_grating__separate_ridges_agree),
        cmocka_unit_test(test_grating__no_order_between_orders),
        cmocka_unit_test(test_grating__ridges_of_a_snake),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
