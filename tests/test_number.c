#include "tests/near.h"

#include <locale.h>
#include <string.h>

#include "core/io/number.h"

static double parse_all(const char *text, char decimal)
{
    double value = NAN;
    assert_true(dif_number_all(text, strlen(text), decimal, &value));
    return value;
}

static void test_parse__reads_what_strtod_reads(void **state)
{
    (void)state;
    static const char *const TEXTS[] = {"0",
                                        "-0",
                                        "1",
                                        "+1.5",
                                        ".5",
                                        "5.",
                                        "1e3",
                                        "1.0e-007",
                                        "1E+22",
                                        "1e23",
                                        "1e-23",
                                        "9007199254740993",
                                        "0.1",
                                        "123456789012345678901234567890",
                                        "4.9e-324",
                                        "1.7976931348623157e308",
                                        "2.2250738585072011e-308",
                                        "0.000000000000000000000000000001",
                                        "1e400",
                                        "-1e-400",
                                        "8.5e-22",
                                        "999999999999999999999e-21"};
    for (size_t i = 0; i < sizeof TEXTS / sizeof *TEXTS; i++) {
        const double got = parse_all(TEXTS[i], '.'), want = strtod(TEXTS[i], NULL);
        assert_memory_equal(&got, &want, sizeof got); /* also the sign of zero */
    }
}

static void test_parse__random_doubles_come_back(void **state)
{
    (void)state;
    uint64_t seed = 7;
    for (int i = 0; i < 200000; i++) {
        const uint64_t bits = test_random_next(&seed);
        double value, back = 0.0;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        char text[DIF_NUMBER_SIZE];
        const size_t n = i % 2 ? dif_number_print(value, 17, text) : dif_number_print_short(value, text);
        assert_int_equal(n, strlen(text));
        assert_true(dif_number_all(text, n, '.', &back));
        assert_memory_equal(&back, &value, sizeof value);
    }
}

static void test_parse__short_decimals_match_strtod(void **state)
{
    (void)state;
    uint64_t seed = 11;
    for (int i = 0; i < 200000; i++) {
        char text[64];
        const int n_digit = (int)(test_random_next(&seed) % 18);
        snprintf(text, sizeof text, "%.*f", n_digit, test_random(&seed, -1000.0, 1000.0));
        const double got = parse_all(text, '.'), want = strtod(text, NULL);
        assert_memory_equal(&got, &want, sizeof got);
    }
}

static void test_parse__refuses_other_text(void **state)
{
    (void)state;
    static const char *const TEXTS[] = {"",    " ",   "-",    ".",     "+.",  "e5", "1e", "1e+",  "1.2.3", "0x10",
                                        "1,5", "1 2", "nanx", "infin", "--1", "1-", "x",  ".nan", "1_0"};
    for (size_t i = 0; i < sizeof TEXTS / sizeof *TEXTS; i++) {
        double value;
        if (dif_number_all(TEXTS[i], strlen(TEXTS[i]), '.', &value))
            fail_msg("'%s' was read as a number", TEXTS[i]);
    }
    char digits[1000];
    memset(digits, '1', sizeof digits);
    double value;
    assert_false(dif_number_all(digits, sizeof digits, '.', &value)); /* longer than any number */
}

static void test_parse__stops_at_the_end_it_is_given(void **state)
{
    (void)state;
    const char text[] = "12345";
    double value = 0.0;
    assert_ptr_equal(dif_number_parse(text, text + 3, '.', &value), text + 3);
    assert_true(value == 123.0);
    assert_null(dif_number_parse(text, text, '.', &value));
}

static void test_parse__knows_words_and_commas(void **state)
{
    (void)state;
    assert_true(isnan(parse_all("NaN", '.')));
    assert_true(parse_all("-Infinity", '.') == -(double)INFINITY);
    assert_true(parse_all("inf", '.') == (double)INFINITY);
    assert_true(parse_all("-12,25", ',') == -12.25);
    assert_true(parse_all("0,1234567890123456789012", ',') == 0.1234567890123456789012);
}

static void test_print__does_not_depend_on_the_locale(void **state)
{
    (void)state;
    static const char *const LOCALES[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "C"};
    for (size_t i = 0; i < sizeof LOCALES / sizeof *LOCALES; i++) {
        if (!setlocale(LC_ALL, LOCALES[i]))
            continue;
        print_message("with the locale %s\n", LOCALES[i]);
        char text[DIF_NUMBER_SIZE];
        dif_number_print(0.5, 9, text);
        assert_string_equal(text, "0.5");
        assert_true(parse_all("0.12345678901234567", '.') == 0.12345678901234567);
    }
    setlocale(LC_ALL, "C");
}

static void test_print__prints_few_digits_where_they_do(void **state)
{
    (void)state;
    char text[DIF_NUMBER_SIZE];
    assert_int_equal(dif_number_print_short(-54.99, text), 6);
    assert_string_equal(text, "-54.99");
    dif_number_print(NAN, 17, text);
    assert_string_equal(text, "nan");
    dif_number_print(-0.1, 17, text);
    assert_string_equal(text, "-0.10000000000000001");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parse__reads_what_strtod_reads),
        cmocka_unit_test(test_parse__random_doubles_come_back),
        cmocka_unit_test(test_parse__short_decimals_match_strtod),
        cmocka_unit_test(test_parse__refuses_other_text),
        cmocka_unit_test(test_parse__stops_at_the_end_it_is_given),
        cmocka_unit_test(test_parse__knows_words_and_commas),
        cmocka_unit_test(test_print__does_not_depend_on_the_locale),
        cmocka_unit_test(test_print__prints_few_digits_where_they_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
