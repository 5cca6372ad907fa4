#define _POSIX_C_SOURCE 200809L

#include "near.h"

#include <string.h>

#include "reports/html.h"

static void assert_escaped(const char *text, const char *want)
{
    char got[256] = "";
    FILE *file = tmpfile();
    assert_non_null(file);
    dif_html_text(file, text);
    rewind(file);
    got[fread(got, 1, sizeof got - 1, file)] = '\0';
    fclose(file);
    assert_string_equal(got, want);
}

static void test_text__markup_is_escaped(void **state)
{
    (void)state;
    assert_escaped("a < b & c > \"d\" 'e'", "a &lt; b &amp; c &gt; &quot;d&quot; &#39;e&#39;");
    assert_escaped("<script>", "&lt;script&gt;");
    assert_escaped("&amp;", "&amp;amp;");
    assert_escaped("", "");
}

static void test_text__utf8_stays_and_controls_go(void **state)
{
    (void)state;
    assert_escaped("θ = 75°, 2 µm\n\t", "θ = 75°, 2 µm\n\t");
    assert_escaped("a\x01"
                   "b\x7f",
                   "a\xef\xbf\xbd"
                   "b\xef\xbf\xbd");
}

static void assert_uncertain(double value, double u, const char *unit, const char *want)
{
    char got[DIF_HTML_NUMBER_SIZE];
    dif_html_uncertain(value, u, unit, got);
    assert_string_equal(got, want);
}

static void test_uncertain__two_digits_of_the_uncertainty(void **state)
{
    (void)state;
    assert_uncertain(2500.0031, 0.0123, "nm", "2500.003 ± 0.012 nm");
    assert_uncertain(-2500.0031, 0.5, "nm", "−2500.00 ± 0.50 nm");
    assert_uncertain(287.99, 0.42, "nm", "287.99 ± 0.42 nm");
    assert_uncertain(1436.6, 17.0, "nm", "1437 ± 17 nm");
    assert_uncertain(12.5, 1.0, "°", "12.5 ± 1.0°");
    assert_uncertain(1.0, 0.0996, "", "1.00 ± 0.10");
}

static void test_uncertain__without_an_uncertainty_the_value_alone(void **state)
{
    (void)state;
    assert_uncertain(2500.0, 0.0, "nm", "2500.000 nm");
    assert_uncertain(2500.0, NAN, "nm", "2500.000 nm");
    assert_uncertain(2500.0, INFINITY, "nm", "2500.000 nm");
    assert_uncertain(NAN, 0.1, "nm", "–");
}

static void assert_number(double value, int n_digit, const char *unit, const char *want)
{
    char got[DIF_HTML_NUMBER_SIZE];
    dif_html_number(value, n_digit, unit, got);
    assert_string_equal(got, want);
}

static void test_number__digits_and_powers_of_ten(void **state)
{
    (void)state;
    assert_number(1234.5678, 6, "nm", "1234.57 nm");
    assert_number(0.00123456, 3, "", "0.00123");
    assert_number(9.996, 3, "", "10.0");
    assert_number(1.23e-9, 2, "", "1.2 × 10⁻⁹");
    assert_number(-4.5e12, 2, "W", "−4.5 × 10¹² W");
    assert_number(0.0, 5, "nm", "0 nm");
    assert_number(75.0, 3, "°", "75.0°");
    assert_number(-INFINITY, 3, "nm", "–");
    assert_number(1e300, 3, "", "1.00 × 10³⁰⁰");
}

static void test_number__always_fits(void **state)
{
    (void)state;
    char got[DIF_HTML_NUMBER_SIZE];
    const double hard[] = {-1.0 / 3.0, 9999999.4, -1.7976931348623157e308, 5e-324, 1e-3};
    for (size_t i = 0; i < sizeof hard / sizeof *hard; i++) {
        for (int n = 1; n <= 17; n++) {
            dif_html_number(hard[i], n, "µm⁻¹ and a very long unit that nobody would use in earnest for anything", got);
            assert_in_range(strlen(got), 1, DIF_HTML_NUMBER_SIZE - 1);
        }
        dif_html_uncertain(hard[i], 1e-300, "nm", got);
        assert_in_range(strlen(got), 1, DIF_HTML_NUMBER_SIZE - 1);
        dif_html_uncertain(1.0, fabs(hard[i]), "nm", got);
        assert_in_range(strlen(got), 1, DIF_HTML_NUMBER_SIZE - 1);
    }
}

static void test_plain__no_trailing_zeros(void **state)
{
    (void)state;
    char got[DIF_HTML_NUMBER_SIZE];
    dif_html_plain(0.05, "°", got);
    assert_string_equal(got, "0.05°");
    dif_html_plain(2500.0, "nm", got);
    assert_string_equal(got, "2500 nm");
    dif_html_plain(-3.0, "", got);
    assert_string_equal(got, "−3");
    dif_html_plain(NAN, "nm", got);
    assert_string_equal(got, "–");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text__markup_is_escaped),
        cmocka_unit_test(test_text__utf8_stays_and_controls_go),
        cmocka_unit_test(test_uncertain__two_digits_of_the_uncertainty),
        cmocka_unit_test(test_uncertain__without_an_uncertainty_the_value_alone),
        cmocka_unit_test(test_number__digits_and_powers_of_ten),
        cmocka_unit_test(test_number__always_fits),
        cmocka_unit_test(test_plain__no_trailing_zeros),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
