#include "tests/near.h"

#include <string.h>

#include "core/io/unit.h"

static void test_parse__knows_every_spelling(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double um;
    } UNITS[] = {{"m", 1e6},
                 {"mm", 1e3},
                 {"um", 1.0},
                 {"\xc2\xb5m", 1.0},
                 {"\xce\xbcm", 1.0},
                 {"\xb5m", 1.0},
                 {"~m", 1.0},
                 {"nm", 1e-3},
                 {"pm", 1e-6},
                 {"A", 1e-4},
                 {"\xc3\x85", 1e-4},
                 {"\xc5", 1e-4},
                 {"\xe2\x84\xab", 1e-4},
                 {" nm\t", 1e-3}};
    for (size_t i = 0; i < sizeof UNITS / sizeof *UNITS; i++) {
        double um = 0.0;
        assert_true(dif_unit_parse(UNITS[i].text, strlen(UNITS[i].text), &um));
        assert_true(um == UNITS[i].um);
    }
}

static void test_parse__refuses_what_is_no_length(void **state)
{
    (void)state;
    static const char *const TEXTS[] = {"", "V", "deg", "nmm", "n m", "NM", "rad", "1", "\xb5", "km/h"};
    double um;
    for (size_t i = 0; i < sizeof TEXTS / sizeof *TEXTS; i++)
        assert_false(dif_unit_parse(TEXTS[i], strlen(TEXTS[i]), &um));
}

static void test_parse_length__reads_point_and_comma(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double um;
    } LENGTHS[] = {{" 12.34 \xc2\xb5m", 12.34},
                   {"12,34 \xb5m", 12.34},
                   {"5678.9 nm", 5.6789},
                   {"3.69862e-007 m", 0.369862},
                   {"10nm", 0.01}};
    for (size_t i = 0; i < sizeof LENGTHS / sizeof *LENGTHS; i++) {
        double um = 0.0;
        assert_true(dif_unit_parse_length(LENGTHS[i].text, strlen(LENGTHS[i].text), &um));
        assert_near(um, LENGTHS[i].um, 4e-16, 0.0); /* one rounding of the unit, one of the product */
    }
    double um;
    assert_false(dif_unit_parse_length("12", 2, &um));
    assert_false(dif_unit_parse_length("nm", 2, &um));
    assert_false(dif_unit_parse_length("12 V", 4, &um));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parse__knows_every_spelling),
        cmocka_unit_test(test_parse__refuses_what_is_no_length),
        cmocka_unit_test(test_parse_length__reads_point_and_comma),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
