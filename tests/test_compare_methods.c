#include "bench/compare_methods.h"

#include <string.h>

#include "alloc_count.h"
#include "core/units.h"
#include "first_order.h"
#include "fixtures/surfaces.h"

/* A blazed grating of 2 um over 24 um, small enough for a test. */
static dif_field blazed(void)
{
    dif_surface surface = dif_surface_default(DIF_SURFACE_BLAZED);
    dif_field field;
    surface.period_um = 2.0;
    surface.nx = 480;
    surface.ny = 40;
    surface.pitch_um = 0.05;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    return field;
}

static const dif_compare_row *row_of(const dif_compare *compare, const char *name)
{
    for (int i = 0; i < compare->n; i++)
        if (strcmp(compare->row[i].name, name) == 0)
            return compare->row + i;
    fail_msg("no row %s", name);
    return NULL;
}

static dif_compare run(const dif_field *field, const dif_plan *plan, const dif_measure_opts *opts,
                       const dif_compare_opts *how)
{
    dif_compare out;
    dif_error err = {DIF_OK, ""};
    if (dif_compare_methods(field, plan, 1e-6, opts, how, &out, &err) != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(err.status, DIF_OK);
    return out;
}

static void print_rows(const char *title, const dif_compare *compare)
{
    print_message("%s: colours times %.4g\n", title, compare->exposure);
    for (int i = 0; i < compare->n; i++) {
        const dif_compare_row *r = compare->row + i;
        print_message("  %-25s %8.2f nm sd %7.2f  error rms %7.1e worst %7.1e  dE %6.3f %6.3f %6.3f  (x, y) %+.4f %+.4f"
                      "  cpu %.3g s %s\n",
                      r->name, dif_nm_from_um(r->argmax_mean_um), dif_nm_from_um(r->argmax_sd_um), r->error_rms,
                      r->error_worst, r->de_median, r->de_p95, r->de_worst, r->shift_x, r->shift_y, r->cpu_s, r->text);
    }
}

static void test_compare__every_method_has_its_row(void **state)
{
    (void)state;
    dif_field field = blazed();
    dif_plan plan = test_plan(75.0, 180.0, "-60:-30:0.05", "400:700:10");
    dif_measure_opts opts = dif_measure_opts_default();
    dif_compare_opts how = dif_compare_opts_default();
    how.fit = false;
    how.n_check = 30;
    how.colour_step_deg = 0.5;
    opts.sigma_um = 3.0; /* an eighth of the patch: the window's cut edges stay dark */
    opts.period_um = 2.0;
    const dif_compare c = run(&field, &plan, &opts, &how);
    print_rows("blazed 2 um", &c);
    assert_int_equal(c.n, DIF_COMPARE_MAX);
    assert_true(c.exposure > 0.0);
    for (int i = 0; i < c.n; i++) {
        assert_int_equal(c.row[i].status, DIF_OK);
        assert_true(c.row[i].cpu_s >= 0.0);
        if (c.row[i].method == DIF_METHOD_DIRECT)
            assert_true(isnan(c.row[i].argmax_mean_um) && c.row[i].error_worst == 0.0);
        else
            assert_true(isfinite(c.row[i].argmax_mean_um) && c.row[i].de_worst >= c.row[i].de_p95 &&
                        c.row[i].de_p95 >= c.row[i].de_median);
    }
    const dif_compare_row *sheet = row_of(&c, "sheet"), *taylor = row_of(&c, "taylor");
    assert_at_most(sheet->error_worst, 1e-6);
    assert_at_most(sheet->bound, 1e-6);
    assert_near(sheet->de_worst, 0.0, 0.0, 1e-9);
    assert_at_most(taylor->error_worst, 1e-6);
    /* Lab's cube root of dark colours makes 1e-6 of amplitude visible to a thousandth */
    assert_at_most(taylor->de_worst, 0.05);
    assert_true(isnan(row_of(&c, "thesis")->bound) && isnan(row_of(&c, "nmm")->bound));
    /* The right weights: hardly to be seen; without the Jacobian: purple. */
    const dif_compare_row *nmm = row_of(&c, "nmm"), *purple = row_of(&c, "nmm without its Jacobian");
    assert_at_most(nmm->de_median, 0.1);
    assert_true(purple->de_median > 10.0 * nmm->de_median);
    assert_true(purple->shift_x < -0.01 && purple->shift_y < -0.01);
    assert_at_most(hypot(nmm->shift_x, nmm->shift_y), 0.005);
    assert_near(row_of(&c, "pq")->argmax_mean_um, 2.0, 0.0, 1e-3);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_compare__without_a_period_rows_say_so(void **state)
{
    (void)state;
    dif_field field = blazed();
    dif_plan plan = test_plan(75.0, 180.0, "-60:-30:1", "400:700:100");
    dif_compare_opts how = dif_compare_opts_default();
    how.fit = false;
    how.n_check = 2;
    how.colour_step_deg = 5.0;
    how.colour_step_nm = 20.0;
    const dif_compare c = run(&field, &plan, NULL, &how);
    assert_int_equal(row_of(&c, "pq")->status, DIF_ERR_ARG);
    assert_string_equal(row_of(&c, "pq")->text, "pq needs the surface's period, and none was given");
    assert_true(isnan(row_of(&c, "pq")->argmax_mean_um) && isnan(row_of(&c, "pq")->de_median));
    assert_int_equal(row_of(&c, "stam")->status, DIF_ERR_ARG);
    assert_int_equal(row_of(&c, "nmm")->status, DIF_OK);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_compare__bad_options_have_their_codes(void **state)
{
    (void)state;
    dif_field field = blazed();
    dif_plan plan = test_plan(75.0, 0.0, "-60:-30:10", "400:700:100");
    const dif_compare_opts good = dif_compare_opts_default();
    dif_compare_opts bad = good;
    dif_compare out;
    dif_error err;
    bad.n_check = 0;
    assert_int_equal(dif_compare_methods(&field, &plan, 1e-3, NULL, &bad, &out, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "0 cells to check, want 1 ... 1000000");
    bad = good;
    bad.colour_max_deg = 90.0;
    assert_int_equal(dif_compare_methods(&field, &plan, 1e-3, NULL, &bad, &out, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "colours up to 90 deg, want 0 < deg < 90");
    bad = good;
    bad.colour_step_deg = 0.0;
    assert_int_equal(dif_compare_methods(&field, &plan, 1e-3, NULL, &bad, &out, &err), DIF_ERR_ARG);
    bad = good;
    bad.colour_step_nm = 101.0;
    assert_int_equal(dif_compare_methods(&field, &plan, 1e-3, NULL, &bad, &out, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "colours from a wavelength every 101 nm, want 0.01 ... 100");
    assert_int_equal(dif_compare_methods(&field, &plan, 0.0, NULL, &good, &out, &err), DIF_ERR_TOL);
    assert_int_equal(out.n, 0);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

/* nmm with its Jacobian against full sampling on a measured shed. */
static void compare_shed(const char *name, double height_um, double azimuth_deg, const char *angle_deg,
                         double period_um, double psi_rad, double sigma_um, double median, double p95)
{
    dif_field field;
    if (!test_read_scan(name, height_um, &field))
        skip();
    dif_plan plan = test_plan(75.0, azimuth_deg, angle_deg, "380:780:5");
    dif_measure_opts opts = dif_measure_opts_default();
    dif_compare_opts how = dif_compare_opts_default();
    how.fit = false;
    how.n_check = 10;
    how.colour_step_deg = 0.2;
    opts.period_um = period_um;
    opts.psi_rad = psi_rad;
    opts.sigma_um = sigma_um;
    const dif_compare c = run(&field, &plan, &opts, &how);
    print_rows(name, &c);
    const dif_compare_row *nmm = row_of(&c, "nmm"), *purple = row_of(&c, "nmm without its Jacobian");
    assert_at_most(nmm->de_median, median);
    assert_at_most(nmm->de_p95, p95);
    assert_at_most(fabs(nmm->shift_x) + fabs(nmm->shift_y), 0.015);
    assert_true(purple->shift_x < -0.02 && purple->shift_y < -0.015);
    /* replicating one period loses what a measured surface is made of */
    assert_true(row_of(&c, "pq")->de_p95 > 3.0 * nmm->de_p95);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

/* At sigma = 65 um / 4 the window still has 0.135 at the patch's edges: its cut scatters light into dark directions, which
 * the bins do not see. At half that width it has 3e-4 there, and nmm is right everywhere. */
static void test_compare__colours_of_elaphe(void **state)
{
    (void)state;
    compare_shed("elaphe_65um.png", 0.375, 180.0, "-40:-15:0.05", 1.1268, 0.0, 16.25, 0.5, 6.0);
    compare_shed("elaphe_65um.png", 0.375, 180.0, "-40:-15:0.05", 1.1268, 0.0, 8.125, 0.02, 0.3);
}

static void test_compare__colours_of_xenopeltis(void **state)
{
    (void)state;
    compare_shed("xenopeltis_65um.png", 0.81869, 270.0, "-50:-25:0.05", 1.5533, 0.5 * DIF_PI, 16.25, 2.0, 25.0);
    compare_shed("xenopeltis_65um.png", 0.81869, 270.0, "-50:-25:0.05", 1.5533, 0.5 * DIF_PI, 8.125, 0.02, 0.3);
}

static void test_compare__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field;
    dif_plan plan = test_plan(75.0, 0.0, "-60:-30:30", "400:700:100");
    dif_compare_opts how = dif_compare_opts_default();
    how.fit = false;
    how.n_check = 1;
    how.colour_max_deg = 20.0;
    how.colour_step_deg = 20.0;
    how.colour_step_nm = 100.0;
    assert_int_equal(dif_field_create(8, 8, 0.1, 0.1, &field, NULL), DIF_OK);
    const int live = test_alloc_live();
    int n_failed = 0, n_whole = 0;
    for (dif_status last = DIF_ERR_NOMEM; last != DIF_OK && n_failed < 2000; n_failed++) {
        dif_compare out;
        test_alloc_fail_from(n_failed + 1);
        const dif_status status = dif_compare_methods(&field, &plan, 1e-3, NULL, &how, &out, NULL);
        test_alloc_fail_from(0);
        assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
        n_whole += status == DIF_OK; /* a row alone may lack memory: it says so itself */
        last = status == DIF_OK ? row_of(&out, "nmm without its Jacobian")->status : status;
        assert_true(last == DIF_OK || last == DIF_ERR_NOMEM);
        assert_int_equal(test_alloc_live(), live);
    }
    assert_true(n_failed > 50 && n_failed < 2000 && n_whole > 10);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_compare__every_method_has_its_row),
        cmocka_unit_test(test_compare__without_a_period_rows_say_so),
        cmocka_unit_test(test_compare__bad_options_have_their_codes),
        cmocka_unit_test(test_compare__colours_of_elaphe),
        cmocka_unit_test(test_compare__colours_of_xenopeltis),
        cmocka_unit_test(test_compare__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
