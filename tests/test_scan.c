#include "tests/near.h"

#include <locale.h>
#include <string.h>

#include "bench/scan.h"
#include "core/units.h"
#include "tests/alloc_count.h"

static void test_parse__ranges_include_both_ends(void **state)
{
    (void)state;
    dif_range range;
    dif_error err;
    assert_int_equal(dif_range_parse("380:780:1", &range, &err), DIF_OK);
    assert_int_equal(range.n, 401);
    for (int i = 0; i < 401; i++)
        assert_near(dif_range_at(&range, i), 380.0 + i, 0.0, 0.0);
    assert_int_equal(dif_range_parse("-55:-40:0.01", &range, &err), DIF_OK);
    assert_int_equal(range.n, 1501);
    assert_near(dif_range_at(&range, 0), -55.0, 0.0, 0.0);
    assert_near(dif_range_at(&range, 1500), -40.0, 0.0, 0.0); /* exactly, although 0.01 is rounded */
    assert_near(dif_range_at(&range, 700), -48.0, 0.0, 1e-13);
    assert_int_equal(dif_range_parse("-90:90:0.1", &range, &err), DIF_OK);
    assert_int_equal(range.n, 1801);
}

static void test_parse__a_step_that_does_not_fit_stops_below(void **state)
{
    (void)state;
    dif_range range;
    dif_error err;
    assert_int_equal(dif_range_parse("0:1:0.3", &range, &err), DIF_OK);
    assert_int_equal(range.n, 4);
    assert_near(dif_range_at(&range, 3), 0.9, 0.0, 1e-15);
    assert_int_equal(dif_range_parse("5:5:1", &range, &err), DIF_OK);
    assert_int_equal(range.n, 1);
    assert_near(dif_range_at(&range, 0), 5.0, 0.0, 0.0);
    assert_int_equal(dif_range_parse("0:1:1e300", &range, &err), DIF_OK);
    assert_int_equal(range.n, 1);
}

static void test_parse__one_number(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value;
    } cases[] = {{"550", 550.0}, {"-75", -75.0}, {"+1.5e-3", 1.5e-3}, {"0", 0.0}, {".5", 0.5}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        dif_range range;
        dif_error err;
        assert_int_equal(dif_range_parse(cases[i].text, &range, &err), DIF_OK);
        assert_int_equal(range.n, 1);
        assert_near(dif_range_at(&range, 0), cases[i].value, 0.0, 0.0);
    }
}

static void test_parse__malformed_text_is_quoted(void **state)
{
    (void)state;
    static const char *const bad[] = {"",     " ",     "abc", "1:2", "1:2:",    "1:2:3:",  "1:2:3:4", ":1:2",
                                      "1::2", "1;2;3", "nan", "inf", "1:inf:1", "0x10",    "1:2:3 ",  " 1",
                                      "1,5",  "1-2",   "--1", "1e",  "1e999",   "1:2:1nm", "1 :2:3",  "e5"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        dif_range range = {.n = 3};
        dif_error err;
        char want[120];
        snprintf(want, sizeof want, "range '%s', want a number or MIN:MAX:STEP", bad[i]);
        assert_int_equal(dif_range_parse(bad[i], &range, &err), DIF_ERR_ARG);
        assert_string_equal(err.text, want);
        assert_int_equal(range.n, 0);
    }
}

static void test_parse__impossible_ranges_say_why(void **state)
{
    (void)state;
    static const struct {
        const char *text, *want;
    } cases[] = {
        {"780:380:1", "range '780:380:1': MIN 780 is above MAX 380, want MIN <= MAX"},
        {"380:780:0", "range '380:780:0': STEP is 0, want STEP > 0"},
        {"380:780:-1", "range '380:780:-1': STEP is -1, want STEP > 0"},
        {"0:1:1e-9", "range '0:1:1e-9' has 1e+09 points, want at most 1e7"},
        {"0:1:1e-300", "range '0:1:1e-300' has 1e+300 points, want at most 1e7"},
        {"-1e308:1e308:1", "range '-1e308:1e308:1' has inf points, want at most 1e7"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        dif_range range;
        dif_error err;
        assert_int_equal(dif_range_parse(cases[i].text, &range, &err), DIF_ERR_ARG);
        assert_string_equal(err.text, cases[i].want);
    }
    char endless[4000];
    memset(endless, '7', sizeof endless);
    endless[sizeof endless - 1] = '\0';
    dif_range range;
    dif_error err;
    assert_int_equal(dif_range_parse(endless, &range, &err), DIF_ERR_ARG);
    assert_non_null(strstr(err.text, ", want a number or MIN:MAX:STEP")); /* the quote is cut, the reason is not */
}

static void test_parse__a_decimal_comma_locale_changes_nothing(void **state)
{
    (void)state;
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE", "fr_FR"};
    const char *set = NULL;
    for (size_t i = 0; i < 5 && !set; i++)
        set = setlocale(LC_ALL, names[i]);
    if (!set) {
        print_message("no locale with a decimal comma is installed: skipping\n");
        skip();
    }
    dif_range range;
    dif_error err;
    const dif_status status = dif_range_parse("0.5:1.5:0.25", &range, &err);
    const char *kept = localeconv()->decimal_point;
    assert_string_equal(kept, ",");
    setlocale(LC_ALL, "C");
    assert_int_equal(status, DIF_OK);
    assert_int_equal(range.n, 5);
    assert_near(range.step, 0.25, 0.0, 0.0);
}

static dif_range range_of(const char *text)
{
    dif_range range;
    dif_error err;
    assert_int_equal(dif_range_parse(text, &range, &err), DIF_OK);
    return range;
}

static void test_plan__converts_units_once(void **state)
{
    (void)state;
    const dif_range angle = range_of("-55:-40:5"), lambda = range_of("380:780:200");
    dif_plan plan;
    dif_error err;
    assert_int_equal(dif_scan_plan(true, 75.0, 30.0, &angle, &lambda, &plan, &err), DIF_OK);
    assert_true(plan.fixed_is_wo);
    assert_near(plan.fixed_rad, 75.0 * DIF_PI / 180.0, 1e-15, 0.0);
    assert_near(plan.azimuth_rad, DIF_PI / 6.0, 1e-15, 0.0);
    assert_int_equal(plan.n_angle, 4);
    assert_int_equal(plan.n_lambda, 3);
    assert_near(plan.angle_rad[3], -40.0 * DIF_PI / 180.0, 1e-15, 0.0);
    assert_near(plan.lambda_um[0], 0.38, 0.0, 0.0);
    assert_near(plan.lambda_um[2], 0.78, 0.0, 0.0);
    dif_plan_free(&plan);
}

static void test_plan__refuses_what_cannot_be_measured(void **state)
{
    (void)state;
    static const struct {
        double fixed_deg;
        const char *angle, *lambda, *want;
    } cases[] = {
        {90.0, "0", "550", "fixed angle 90 deg, want -90 < angle < 90"},
        {75.0, "-90:90:1", "550", "angle 0 is -90 deg, want -90 < angle < 90"},
        {75.0, "80:100:10", "550", "angle 1 is 90 deg, want -90 < angle < 90"},
        {75.0, "0", "0", "wavelength 0 is 0 nm, want a finite number > 0"},
        {75.0, "0", "-550", "wavelength 0 is -550 nm, want a finite number > 0"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const dif_range angle = range_of(cases[i].angle), lambda = range_of(cases[i].lambda);
        dif_plan plan;
        dif_error err;
        assert_int_equal(dif_scan_plan(false, cases[i].fixed_deg, 0.0, &angle, &lambda, &plan, &err), DIF_ERR_ARG);
        assert_string_equal(err.text, cases[i].want);
        assert_null(plan.angle_rad);
        assert_int_equal(test_alloc_live(), 0);
    }
}

static void test_plan__alloc_failing_leaves_nothing(void **state)
{
    (void)state;
    const dif_range angle = range_of("0:10:1"), lambda = range_of("400:500:1");
    for (int k = 1; k <= 2; k++) {
        dif_plan plan;
        dif_error err;
        test_alloc_fail_from(k);
        assert_int_equal(dif_scan_plan(false, 75.0, 0.0, &angle, &lambda, &plan, &err), DIF_ERR_NOMEM);
        assert_string_equal(err.text, "plan of 11 angles and 101 wavelengths");
        assert_null(plan.angle_rad);
        assert_int_equal(test_alloc_live(), 0);
    }
    test_alloc_fail_from(0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parse__ranges_include_both_ends),
        cmocka_unit_test(test_parse__a_step_that_does_not_fit_stops_below),
        cmocka_unit_test(test_parse__one_number),
        cmocka_unit_test(test_parse__malformed_text_is_quoted),
        cmocka_unit_test(test_parse__impossible_ranges_say_why),
        cmocka_unit_test(test_parse__a_decimal_comma_locale_changes_nothing),
        cmocka_unit_test(test_plan__converts_units_once),
        cmocka_unit_test(test_plan__refuses_what_cannot_be_measured),
        cmocka_unit_test(test_plan__alloc_failing_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
