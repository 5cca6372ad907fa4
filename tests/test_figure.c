#define _DEFAULT_SOURCE /* mkdtemp */

#include "report_files.h"

#include "reports/figures.h"

/* A result in memory; files are not needed. */
static void make_result(dif_result *result)
{
    *result = (dif_result){.doc = report_doc()};
    report_make_field(&result->field);
    report_make_table(&result->table);
    result->maxima = (dif_columns){.n_column = DIF_MAXIMA_N, .value = dif_alloc(3 * DIF_MAXIMA_N, sizeof(double))};
    result->lines = (dif_columns){.n_column = DIF_LINES_N, .value = dif_alloc(2 * DIF_LINES_N, sizeof(double))};
    assert_non_null(result->maxima.value);
    assert_non_null(result->lines.value);
}

static void add_maximum(dif_result *result, double lambda_nm, double angle_deg, double residual_deg, bool edge)
{
    double *row = result->maxima.value + (size_t)result->maxima.n_row++ * DIF_MAXIMA_N;
    row[DIF_MAXIMA_LAMBDA_NM] = lambda_nm;
    row[DIF_MAXIMA_ANGLE_DEG] = angle_deg;
    row[DIF_MAXIMA_ORDER] = 1.0;
    row[DIF_MAXIMA_RESIDUAL_DEG] = residual_deg;
    row[DIF_MAXIMA_AT_EDGE] = edge;
    row[DIF_MAXIMA_ON_LINE] = !edge;
}

static char *text_of(FILE *file)
{
    const long n = ftell(file);
    assert_in_range(n, 1, 1 << 26);
    char *text = dif_alloc((size_t)n + 1, 1);
    assert_non_null(text);
    rewind(file);
    assert_int_equal(fread(text, 1, (size_t)n, file), n);
    fclose(file);
    return text;
}

/* All five figures draw; each is one SVG element. */
static void assert_all_draw(const dif_result *result, dif_figure_notes *notes)
{
    dif_error err = {0};
    FILE *html = tmpfile();
    assert_non_null(html);
    dif_status status = dif_figure_height(result, "h", html, notes, &err);
    if (!status)
        status = dif_figure_profile(result, "p", html, notes, &err);
    if (!status)
        status = dif_figure_table(result, "t", html, notes, &err);
    if (!status)
        status = dif_figure_residuals(result, "r", html, notes, &err);
    if (!status)
        status = dif_figure_lines(result, "l", html, &err);
    if (status)
        fail_msg("%s", err.text);
    char *text = text_of(html);
    int n = 0;
    for (const char *at = text; (at = strstr(at, "</svg>")); at++)
        n++;
    assert_int_equal(n, 5);
    dif_release(text);
}

static void test_all__of_a_fitted_grating(void **state)
{
    (void)state;
    dif_result result;
    dif_figure_notes notes = {0};
    make_result(&result);
    add_maximum(&result, 400.0, -53.6, 0.001, false);
    add_maximum(&result, 440.0, -52.1, -0.002, false);
    add_maximum(&result, 480.0, -70.0, 0.5, true);
    assert_all_draw(&result, &notes);
    assert_int_equal(notes.n_cell_x, 1);
    assert_int_equal(notes.n_cell_y, 1);
    assert_int_equal(notes.n_maximum, 2);
    assert_int_equal(notes.n_skipped, 1);
    assert_int_equal(notes.n_residual, 2);
    assert_int_equal(notes.n_far, 0);
    /* orders 1 to 5 of 2500 nm cross the table between -70 and -10 degrees at 400 to 720 nm */
    int n_curve = 0;
    for (int m = -13; m <= 13; m++) {
        int n_inside = 0;
        for (int i = 0; i <= 40; i++) {
            const double s = m * (0.4 + 0.008 * i) / 2.500003 - sin(dif_rad_from_deg(75.0));
            n_inside += s >= sin(dif_rad_from_deg(-70.0)) && s <= sin(dif_rad_from_deg(-10.0));
        }
        n_curve += n_inside > 1;
    }
    assert_int_equal(notes.n_curve, n_curve);
    assert_near(notes.low, notes.high * 1e-6, 1e-12, 0.0);
    assert_near(notes.profile_um, 3.2, 1e-12, 0.0); /* eight periods do not fit: the shorter side */
    dif_result_free(&result);
}

static void test_all__without_a_period(void **state)
{
    (void)state;
    dif_result result;
    dif_figure_notes notes = {0};
    make_result(&result);
    json_object_set_new(result.doc, "fit_table", json_pack("{s:b, s:s}", "ok", 0, "text", "none"));
    assert_all_draw(&result, &notes);
    assert_int_equal(notes.n_curve, 0);
    assert_int_equal(notes.n_residual, 0);
    dif_result_free(&result);
}

static void test_all__of_separate_ridges(void **state)
{
    (void)state;
    dif_result result;
    dif_figure_notes notes = {0};
    make_result(&result);
    json_object_set_new((json_t *)dif_result_at(result.doc, "fit_table"), "common_period", json_false());
    assert_all_draw(&result, &notes);
    assert_int_equal(notes.n_curve, 1);
    dif_result_free(&result);
}

static void test_all__of_flat_dark_and_missing_data(void **state)
{
    (void)state;
    dif_result result;
    dif_figure_notes notes = {0};
    make_result(&result);
    for (size_t i = 0; i < dif_field_n(&result.field); i++)
        result.field.z_um[i] = 0.125;
    for (int i = 0; i < 61 * 9; i++)
        result.table.value[i] = i % 7 ? 0.0 : (double)NAN;
    assert_all_draw(&result, &notes);
    assert_near(notes.high, 1.0, 0.0, 0.0);
    assert_near(notes.height_outside, 0.0, 0.0, 0.0);
    dif_result_free(&result);
}

static void test_all__of_one_wavelength_and_one_angle(void **state)
{
    (void)state;
    dif_result result;
    dif_figure_notes notes = {0};
    make_result(&result);
    result.table.plan.n_angle = 1;
    result.table.plan.n_lambda = 1;
    result.field.nx = 2;
    result.field.ny = 2;
    assert_all_draw(&result, &notes);
    assert_near(notes.profile_um, 0.2, 1e-12, 0.0);
    result.table.plan.n_angle = 61;
    dif_result_free(&result);
}

static void test_height__a_speck_does_not_take_the_colours(void **state)
{
    (void)state;
    dif_result result;
    dif_figure_notes notes = {0};
    dif_error err = {0};
    make_result(&result);
    result.field.z_um[100] = 50.0;
    FILE *html = tmpfile();
    assert_non_null(html);
    assert_int_equal(dif_figure_height(&result, "h", html, &notes, &err), DIF_OK);
    fclose(html);
    assert_at_most(notes.height_high_nm, 200.0);
    assert_at_most(notes.height_outside, 0.011); /* the middle 99 % */
    assert_at_most(0.5 / (48 * 32), notes.height_outside);
    dif_result_free(&result);
}

static void test_residuals__far_ones_are_counted(void **state)
{
    (void)state;
    dif_result result;
    dif_figure_notes notes = {0};
    make_result(&result);
    dif_release(result.maxima.value);
    result.maxima.value = dif_alloc(100 * DIF_MAXIMA_N, sizeof(double));
    assert_non_null(result.maxima.value);
    for (int i = 0; i < 99; i++)
        add_maximum(&result, 400.0 + i, -50.0, 0.001, false);
    add_maximum(&result, 500.0, -50.0, 1.0, false);
    FILE *html = tmpfile();
    assert_non_null(html);
    assert_int_equal(dif_figure_residuals(&result, "r", html, &notes, NULL), DIF_OK);
    fclose(html);
    assert_int_equal(notes.n_residual, 100);
    assert_int_equal(notes.n_far, 1);
    dif_result_free(&result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all__of_a_fitted_grating),
        cmocka_unit_test(test_all__without_a_period),
        cmocka_unit_test(test_all__of_separate_ridges),
        cmocka_unit_test(test_all__of_flat_dark_and_missing_data),
        cmocka_unit_test(test_all__of_one_wavelength_and_one_angle),
        cmocka_unit_test(test_height__a_speck_does_not_take_the_colours),
        cmocka_unit_test(test_residuals__far_ones_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
