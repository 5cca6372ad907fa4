/* Text matrices. */
#include "tests/io_cases.h"

static const char EXPORT[] = "# Channel: My Channel\n# Width: 6 \xc2\xb5m\n# Height: 500 nm\n# Value units: nm\n";

/* Reads a text of 3 x 2 numbers 1 2 3 / 4 5 6 (times unit), and its pitch. */
static void expect_numbers(const char *text, size_t n, const dif_field_request *request, const double want[6])
{
    dif_field_file file;
    dif_error err;
    if (parse_bytes(text, n, request, &file, &err))
        fail_msg("%s in:\n%s", err.text, text);
    assert_string_equal(file.format, "text");
    assert_int_equal(file.field.nx, 3);
    assert_int_equal(file.field.ny, 2);
    for (int i = 0; i < 6; i++)
        assert_near(file.field.z_um[i], want[i], 4e-16, 0.0); /* product with the unit */
    dif_field_file_free(&file);
}

static dif_field_request request_nm(void)
{
    dif_field_request request = dif_field_request_default();
    request.pixel_um = 0.05;
    request.z_unit = "um";
    return request;
}

static void test_read__export_headers_give_scale_and_title(void **state)
{
    (void)state;
    static const char *const HEADERS[] = {
        "# Channel: T\n# Width: 6 \xc2\xb5m\n# Height: 500 nm\n# Value units: nm\n",
        "# Kanal: T\n# Breite: 6,0 \xc2\xb5m\n# H\xc3\xb6he: 500 nm\n# Value units: nm\n",
        "# Canal: T\n# Ancho: 6 \xb5m\n# Alto: 500 nm\n# Unidades: nm\n",
        "% T: T\n% Height: 500 nm\n% Width: 6000000 pm\n\n% Value units: nm\n",
        "; T: T\n; Width: 6 \xce\xbcm\n; Height: 5000 A\n; Value units: nm\n",
    };
    for (size_t i = 0; i < sizeof HEADERS / sizeof *HEADERS; i++) {
        char text[400];
        snprintf(text, sizeof text, "%s1 2 3\n4 5 6\n", HEADERS[i]);
        dif_field_file file;
        dif_error err;
        assert_int_equal(parse_bytes(text, strlen(text), NULL, &file, &err), DIF_OK);
        assert_near(file.field.pitch_x_um, 2.0, 4e-16, 0.0);
        assert_near(file.field.pitch_y_um, 0.25, 4e-16, 0.0);
        assert_near(file.field.z_um[0], 1e-3, 4e-16, 0.0);
        assert_string_equal(file.title, "T");
        dif_field_file_free(&file);
    }
}

static void test_read__separators_and_decimal_signs(void **state)
{
    (void)state;
    const dif_field_request request = request_nm();
    static const double WANT[6] = {1.5, -2.5, 3e-7, 4.0, 0.25, 6e3};
    static const char *const TEXTS[] = {
        "1.5 -2.5 3.0e-007\n4 .25 6e3\n",
        "1.5\t-2.5\t3e-7\r\n4\t0.25\t6000\r\n",
        "1.5\t-2.5\t3e-7\t\n4\t0.25\t6000\t",
        "  1.5   -2.5  3e-7  \n\n  4  0.25   6000\n\n",
        "1.5,-2.5,3e-7\n4,0.25,6000\n",
        "1.5, -2.5, 3e-7,\n4, 0.25, 6000,\n",
        "1.5;-2.5;3e-7\n4;0.25;6000\n",
        "1,5;-2,5;3e-7\n4;0,25;6000\n",
        "1,5; -2,5; 3e-7;\n4; 0,25; 6000;\n",
        "1,5 -2,5 3,0e-7\n4 0,25 6000\n",
        "1,5\t-2,5\t3e-7\n4\t0,25\t6000\n",
        "1.5 \t-2.5 \t3e-7\n4 \t0.25 \t6000\n",
        "+1.5 -2.5\t3e-7\n4 0.25\t6000\n",
        "# a comment\n1.5 -2.5 3e-7\n# another, with commas\n4 0.25 6000\n",
        "\xef\xbb\xbf"
        "1.5 -2.5 3e-7\n4 0.25 6000",
    };
    for (size_t i = 0; i < sizeof TEXTS / sizeof *TEXTS; i++)
        expect_numbers(TEXTS[i], strlen(TEXTS[i]), &request, WANT);
    static const double WHOLE[6] = {1, 2, 3, 4, 5, 6};
    expect_numbers("1,2,3\n4,5,6\n", 12, &request, WHOLE); /* commas and nothing else separate */
}

static void test_read__utf16_in_both_orders(void **state)
{
    (void)state;
    const dif_field_request request = request_nm();
    static const double WANT[6] = {1, 2, 3, 4, 5, 6};
    static const char TEXT[] = "1\t2\t3\r\n4\t5\t6\r\n";
    for (int big = 0; big < 2; big++) {
        char wide[2 * sizeof TEXT];
        size_t n = 0;
        wide[n++] = big ? '\xfe' : '\xff';
        wide[n++] = big ? '\xff' : '\xfe';
        for (size_t i = 0; i < sizeof TEXT - 1; i++) {
            wide[n++] = big ? '\0' : TEXT[i];
            wide[n++] = big ? TEXT[i] : '\0';
        }
        expect_numbers(wide, n, &request, WANT);
    }
}

/* A text as UTF-16 with its byte order mark; returns its length in bytes. */
static size_t widen(const char *text, bool big, char *out)
{
    size_t n = 0;
    out[n++] = big ? '\xfe' : '\xff';
    out[n++] = big ? '\xff' : '\xfe';
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        /* two bytes of UTF-8 are all that is needed here */
        const unsigned code = *c < 0x80 ? *c : (c[0] & 31u) << 6 | (c[1] & 63u);
        c += *c >= 0x80;
        out[n++] = (char)(big ? code >> 8 : code & 255u);
        out[n++] = (char)(big ? code & 255u : code >> 8);
    }
    return n;
}

static void test_read__utf16_with_header_and_decimal_comma(void **state)
{
    (void)state;
    static const char TEXT[] = "# Kanal: H\xc3\xb6hen\r\n# Breite: 6,0 \xc2\xb5m\r\n# H\xc3\xb6he: 500 nm\r\n"
                               "# Value units: nm\r\n1,5\t-2,5\tNaN\r\n4\t0,25\t6,0e+003\r\n";
    static const double WANT[6] = {1.5, -2.5, NAN, 4.0, 0.25, 6e3};
    for (int big = 0; big < 2; big++) {
        char wide[2 * sizeof TEXT];
        dif_field_file file;
        dif_error err;
        dif_field_request request = dif_field_request_default();
        request.allow_missing = true;
        if (parse_bytes(wide, widen(TEXT, big, wide), &request, &file, &err))
            fail_msg("%s", err.text);
        assert_string_equal(file.title, "H\xc3\xb6hen");
        assert_near(file.field.pitch_x_um, 2.0, 4e-16, 0.0);
        assert_near(file.field.pitch_y_um, 0.25, 4e-16, 0.0);
        for (int i = 0; i < 6; i++) {
            if (isnan(WANT[i]))
                assert_true(isnan(file.field.z_um[i]));
            else
                assert_near(file.field.z_um[i], 1e-3 * WANT[i], 4e-16, 0.0);
        }
        dif_field_file_free(&file);
    }
}

static void test_read__size_and_factor_header(void **state)
{
    (void)state;
    static const char TEXT[] = "h=2 w=3\npixel size=3.69862e-007 m\ndata unit=rad\n"
                               "height conversion factor (-> m)=2.5e-008\n1 2 3\n4 5 6\n";
    dif_field_file file;
    dif_error err;
    assert_int_equal(parse_bytes(TEXT, strlen(TEXT), NULL, &file, &err), DIF_OK);
    assert_near(file.field.pitch_x_um, 0.369862, 4e-16, 0.0);
    assert_near(file.field.pitch_y_um, 0.369862, 4e-16, 0.0);
    assert_near(file.field.z_um[5], 6 * 0.025, 4e-16, 0.0);
    dif_field_file_free(&file);
    static const char WRONG[] = "h=3 w=3\npixel size=3e-007 m\n1 2 3\n4 5 6\n";
    assert_parse_fails(WRONG, strlen(WRONG), NULL, DIF_ERR_FORMAT,
                       "2 rows of 3 values, want 3 of 3 as the header says");
}

static void expect(const char *text, dif_status want, const char *part)
{
    char with_header[600];
    snprintf(with_header, sizeof with_header, "%s%s", EXPORT, text);
    assert_parse_fails(with_header, strlen(with_header), NULL, want, part);
}

static void test_read__refuses_ragged_rows_with_line_and_counts(void **state)
{
    (void)state;
    expect("1 2 3\n4 5\n", DIF_ERR_FORMAT, "line 6 has 2 values, want 3 as in line 5");
    expect("1 2 3\n\n# x\n4 5 6 7\n", DIF_ERR_FORMAT, "line 8 has 4 values, want 3 as in line 5");
    expect("1;2;3\n4;5\n", DIF_ERR_FORMAT, "line 6 has 2 values, want 3");
}

/* Reads a text under the header that says everything; NaN stands for missing points. */
static void expect_with_missing(const char *text, const double want_nm[6])
{
    char with_header[600];
    dif_field_file file;
    dif_error err;
    dif_field_request request = dif_field_request_default();
    request.allow_missing = true;
    snprintf(with_header, sizeof with_header, "%s%s", EXPORT, text);
    if (parse_bytes(with_header, strlen(with_header), &request, &file, &err))
        fail_msg("%s in:\n%s", err.text, text);
    assert_int_equal(file.field.nx, 3);
    assert_int_equal(file.field.ny, 2);
    for (int i = 0; i < 6; i++) {
        if (isnan(want_nm[i]))
            assert_true(isnan(file.field.z_um[i]));
        else
            assert_near(file.field.z_um[i], want_nm[i] * 1e-3, 4e-16, 0.0);
    }
    dif_field_file_free(&file);
}

static void test_read__missing_points_are_nan_on_request(void **state)
{
    (void)state;
    static const char *const MARKS[] = {"NaN", "nan",       "-nan",    "BAD",    "bad", "***",  "--",
                                        "N/A", "-nan(ind)", "1.#QNAN", "1.#IND", "inf", "1e999"};
    static const double WANT[6] = {1, 2, 3, 4, NAN, 6};
    for (size_t i = 0; i < sizeof MARKS / sizeof *MARKS; i++) {
        char text[100];
        snprintf(text, sizeof text, "1 2 3\n4 %s 6\n", MARKS[i]);
        expect_with_missing(text, WANT);
    }
    expect_with_missing("1;2;3\n4;;6\n", WANT);
    expect_with_missing("1,2,3\n4,,6\n", WANT);
    expect_with_missing("1\t2\t3\n4\t\t6\n", WANT);
    static const double FIRST[6] = {NAN, 2, 3, NAN, 5, 6}, LAST[6] = {1, 2, 3, 4, 5, NAN};
    expect_with_missing("BAD 2 3\nBAD 5 6\n", FIRST);
    expect_with_missing(";2;3\n;5;6\n", FIRST);
    expect_with_missing("\t2\t3\n\t5\t6\n", FIRST);
    expect_with_missing("1;2;3\n4;5;\n", LAST); /* an empty last cell is not the end of a row */
    expect_with_missing("1;2;3;\n4;5;;\n", LAST);
    expect_with_missing("1\t2\t3\n4\t5\t\n", LAST);
}

static void test_read__missing_points_are_refused_with_the_place_and_the_flag(void **state)
{
    (void)state;
    expect("1 2 3\n4 NaN 6\n", DIF_ERR_NONFINITE, "height at column 1, row 1 is nan");
    expect("1 2 3\n4 5 BAD\n", DIF_ERR_NONFINITE, "height at column 2, row 1 is nan");
    expect("1 *** 3\n4 5 6\n", DIF_ERR_NONFINITE, "height at column 1, row 0 is nan");
    expect("1;;3\n4;5;6\n", DIF_ERR_NONFINITE, "--fill");
    expect("1 2 3\n4 inf 6\n", DIF_ERR_NONFINITE, "height at column 1, row 1 is inf");
    expect("1 2 3\n4 1e999 6\n", DIF_ERR_NONFINITE, "height at column 1, row 1 is inf");
}

/* Our own lines above and below may hold words of a header. */
static void test_read__provenance_is_no_scale(void **state)
{
    (void)state;
    static const char TEXT[] =
        "# diffbench.note: Height: 5 mm\n# Channel: T\n# Width: 6 um\n# Height: 4 um\n"
        "# Value units: nm\n# diffbench.command: diffbench convert --Width: 5 nm\n1 2 3\n4 5 6\n";
    dif_field_file file;
    dif_error err;
    assert_int_equal(parse_bytes(TEXT, sizeof TEXT - 1, NULL, &file, &err), DIF_OK);
    assert_string_equal(file.title, "T");
    assert_near(file.field.pitch_x_um, 2.0, 4e-16, 0.0);
    assert_near(file.field.pitch_y_um, 2.0, 4e-16, 0.0);
    dif_field_file_free(&file);
}

static void test_read__refuses_what_is_no_number(void **state)
{
    (void)state;
    expect("1 2 3\n4 x5 6\n", DIF_ERR_FORMAT, "line 6, value 2 is 'x5', want a number");
    expect("1 2 3\n4 5.0.0 6\n", DIF_ERR_FORMAT, "line 6, value 2 is '5.0.0'");
    expect("1 2 3\n4 0x10 6\n", DIF_ERR_FORMAT, "line 6, value 2 is '0x10'");
    expect("hello world\n1 2 3\n", DIF_ERR_FORMAT, "line 5 is 'hello world', want numbers");
    expect("", DIF_ERR_FORMAT, "no numbers");
    assert_parse_fails("\n \n\n", 4, NULL, DIF_ERR_FORMAT, "no numbers");
    assert_parse_fails("1 2\0 3\n", 7, NULL, DIF_ERR_FORMAT, "unknown format, and no text (NUL at byte 3)");
    const char *far = "# T: T\n# Width: -6 um\n# Height: 1 um\n# Value units: m\n1 2\n";
    assert_parse_fails(far, strlen(far), NULL, DIF_ERR_FORMAT, "the header's width is -6 um, want > 0");
}

static void test_read__missing_scale_names_the_flags(void **state)
{
    (void)state;
    assert_parse_fails("1 2\n3 4\n", 8, NULL, DIF_ERR_SCALE,
                       "text has no scale in it, give --pixel-nm or --size-um, and --z-unit (nm, um, m)");
    dif_field_request request = dif_field_request_default();
    request.size_um = 10.0;
    assert_parse_fails("1 2\n3 4\n", 8, &request, DIF_ERR_SCALE, "no height scale in it, give --z-unit (nm, um, m)");
    request.height_um = 1.0; /* the range of an image says nothing of numbers that are heights */
    assert_parse_fails("1 2\n3 4\n", 8, &request, DIF_ERR_SCALE, "give --z-unit");
}

static void test_read__refuses_sizes_over_the_limit(void **state)
{
    (void)state;
    enum { N_ROW = 32769, LINE = 4 };
    static char text[N_ROW * LINE + 100];
    size_t n = 0;
    for (int i = 0; i < N_ROW; i++) {
        memcpy(text + n, "1 2\n", LINE);
        n += LINE;
    }
    const dif_field_request request = request_nm();
    assert_parse_fails(text, n, &request, DIF_ERR_SIZE, "2 x 32769 samples, want at most 32768 a side");
    for (size_t i = 0; i < n; i++)
        text[i] = i % 2 ? ' ' : '7';
    assert_parse_fails(text, n, &request, DIF_ERR_SIZE, "65538 x 1 samples, want at most 32768 a side");
}

static void test_read__beginnings_never_read_past_their_end(void **state)
{
    (void)state;
    static const char TEXT[] = "\xef\xbb\xbf# T: T\n# Width: 6,5 \xc2\xb5m\n# Height: 500 nm\n# Value units: nm\n"
                               "1,25;-2e-3;3\n4;5;6\n";
    /* Whole rows, and rows cut within their last number, are matrices too: no more than that. */
    const int n_accepted = count_accepted_beginnings((const unsigned char *)TEXT, sizeof TEXT - 1, NULL);
    assert_in_range(n_accepted, 1, 25);
    static const char UTF16[] = "\xff\xfe"
                                "1\0 \0"
                                "2\0\n\0";
    const dif_field_request request = request_nm();
    assert_in_range(count_accepted_beginnings((const unsigned char *)UTF16, 10, &request), 1, 4);
}

static void test_read__failing_heap_is_said(void **state)
{
    (void)state;
    const dif_field_request request = request_nm();
    char text[12000];
    size_t n = 0;
    for (int i = 0; i < 2000; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "%d%c", i % 7, i % 50 == 49 ? '\n' : ' ');
    assert_true(parse_with_failing_heap((const unsigned char *)text, n, &request) >= 2);
    assert_true(parse_with_failing_heap((const unsigned char *)"0 0 1\n1 0 1\n0 1 1\n1 1 1\n", 24, &request) >= 3);
    assert_true(parse_with_failing_heap((const unsigned char *)"\xff\xfe"
                                                               "1\0 \0"
                                                               "2\0\n\0",
                                        10, &request) >= 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__export_headers_give_scale_and_title),
        cmocka_unit_test(test_read__separators_and_decimal_signs),
        cmocka_unit_test(test_read__utf16_in_both_orders),
        cmocka_unit_test(test_read__utf16_with_header_and_decimal_comma),
        cmocka_unit_test(test_read__size_and_factor_header),
        cmocka_unit_test(test_read__refuses_ragged_rows_with_line_and_counts),
        cmocka_unit_test(test_read__missing_points_are_nan_on_request),
        cmocka_unit_test(test_read__missing_points_are_refused_with_the_place_and_the_flag),
        cmocka_unit_test(test_read__provenance_is_no_scale),
        cmocka_unit_test(test_read__refuses_what_is_no_number),
        cmocka_unit_test(test_read__missing_scale_names_the_flags),
        cmocka_unit_test(test_read__refuses_sizes_over_the_limit),
        cmocka_unit_test(test_read__beginnings_never_read_past_their_end),
        cmocka_unit_test(test_read__failing_heap_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
