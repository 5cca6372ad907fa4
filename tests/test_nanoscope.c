#include "tests/nano_sample.h"

#include "core/io/nanoscope_header.h"
#include "core/io/nanoscope_scale.h"

static void test_read__bottom_line_comes_first_whatever_the_frame_direction(void **state)
{
    (void)state;
    static const char *const DIRECTIONS[] = {"\\Frame direction: Up", "\\Frame direction: Down"};
    for (int i = 0; i < 2; i++) {
        nano_file file;
        nano_begin(&file, NANO_MAGIC, "0x07200000");
        nano_channel(&file, 2, 2);
        nano_line(&file, "%s", DIRECTIONS[i]);
        nano_line(&file, "%s", NANO_HEIGHT);
        nano_line(&file, "%s", NANO_SCALE);
        nano_end(&file, 2, NANO_SIX, 6);
        assert_nano_six(&file, NULL, 10.0 * 20e-3 / 65536.0);
    }
}

/* The number per LSB is that of the acquisition and plays no part. */
static void test_read__scale_is_hard_value_times_sensitivity(void **state)
{
    (void)state;
    static const struct {
        const char *scale;
        double factor_um;
    } SCALES[] = {
        {"\\@2:Z scale: V [Sens. Zsens] (0.5000000 V/LSB) 10.00000 V", 10.0 * 20e-3 / 65536.0},
        {"\\@2:Z scale: V [Sens. Zsens] (0.0001 V/LSB) 10.00000 V", 10.0 * 20e-3 / 65536.0},
        {"\\@3:Z scale: V [Sens. Zsens] 10.00000 V", 10.0 * 20e-3 / 65536.0},
        {"\\@2:Z Scale: V [sens. zsens] (log(V)/(a(b)) LSB) 10.00000 V", 10.0 * 20e-3 / 65536.0},
        {"\\@2:Z scale: V [Sens. Zsens] (0.5 mV/LSB) 400.0 mV", 0.4 * 20e-3 / 65536.0},
        {"\\@2:Z scale: V [Sens. Zsens] (0.5 kV/LSB) 0.4 kV", 400.0 * 20e-3 / 65536.0},
        {"\\@2:Z scale: V [Sens. ZsensSens] (0.5 V/LSB) 10 V", 10.0 * 0.5 / 65536.0}, /* from the scan list, ~m */
        {"\\@2:Z scale: V (0.5 nm/LSB) 250.0 nm", 0.25 / 65536.0},
    };
    for (size_t i = 0; i < sizeof SCALES / sizeof *SCALES; i++) {
        const nano_file file = nano_make("0x05120000", SCALES[i].scale);
        assert_nano_six(&file, NULL, SCALES[i].factor_um);
    }
}

static void test_read__versions_before_4_3(void **state)
{
    (void)state;
    const nano_file old = nano_make("0x04220200", "\\Z scale: 250.0 nm (0.1 nm/LSB)");
    assert_nano_six(&old, NULL, 0.25 / 65536.0);
    nano_file oldest;
    nano_begin(&oldest, NANO_MAGIC, NULL);
    nano_line(&oldest, "\\*Controller list");
    nano_line(&oldest, "\\Z max: 4");
    nano_line(&oldest, "\\*Microscope list"); /* the scanner list came first: it is the one that counts */
    nano_line(&oldest, "\\Z sensitivity: 99");
    nano_line(&oldest, "\\*Image list");
    nano_line(&oldest, "\\Data offset: %d", NANO_HEADER);
    nano_line(&oldest, "\\Data length: 12");
    nano_line(&oldest, "\\Samps/line: 3");
    nano_line(&oldest, "\\Number of lines: 2");
    nano_line(&oldest, "\\Scan size: 300 nm");
    nano_line(&oldest, "\\Image data: Height");
    nano_line(&oldest, "\\Z scale height: 0.5");
    nano_file without = oldest;
    nano_end(&without, 2, NANO_SIX, 6);
    assert_parse_fails(without.data, without.n, NULL, DIF_ERR_FORMAT, "no channel is known to hold heights");
    dif_field_request request = dif_field_request_default();
    request.channel = "height";
    assert_parse_fails(without.data, without.n, &request, DIF_ERR_SCALE,
                       "nanoscope has no height scale in it, give --z-unit (nm, um, m)");
    memcpy(strstr((char *)oldest.data, "\\@Sens. Zsens: V 20.00000 nm/V"), "\\Z sensitivity: 7\r\n\\Remark: x ", 30);
    nano_end(&oldest, 2, NANO_SIX, 6);
    assert_nano_six(&oldest, NULL, 2.0 / 65536.0 * 0.5 * 4.0 * 7.0 * 1e-3);
}

/* From 9.2 on samples have 4 bytes, and "Bytes/pixel" is nothing but the power of 256 in the scale. */
static void test_read__four_byte_samples_with_two_written(void **state)
{
    (void)state;
    static const long BIG[] = {-2147483647L - 1, 2147483647L, 70000, -70000, 1, 0};
    for (int bytes_pixel = 2; bytes_pixel <= 4; bytes_pixel += 2) {
        nano_file nano;
        dif_field_file file;
        dif_error err;
        nano_begin(&nano, NANO_MAGIC, "0x09700105");
        nano_channel(&nano, 4, bytes_pixel);
        nano_line(&nano, "%s", NANO_HEIGHT);
        nano_line(&nano, "%s", NANO_SCALE);
        nano_end(&nano, 4, BIG, 6);
        if (parse_bytes(nano.data, nano.n, NULL, &file, &err))
            fail_msg("%s", err.text);
        for (int i = 0; i < 6; i++)
            assert_near(file.field.z_um[NANO_PLACE[i]], (double)BIG[i] * 0.2 * pow(256.0, -bytes_pixel), 1e-15, 0.0);
        dif_field_file_free(&file);
    }
}

/* The block's length decides, then the version. */
static void test_read__sample_size_follows_the_length(void **state)
{
    (void)state;
    nano_file file;
    nano_begin(&file, NANO_MAGIC, "0x09400202");
    nano_channel(&file, 2, 2);
    nano_line(&file, "%s", NANO_HEIGHT);
    nano_line(&file, "%s", NANO_SCALE);
    nano_end(&file, 2, NANO_SIX, 6);
    assert_nano_six(&file, NULL, 10.0 * 20e-3 / 65536.0);
    nano_begin(&file, "\\*EC File list", "0x05310001");
    nano_channel(&file, 4, 4);
    nano_line(&file, "%s", NANO_HEIGHT);
    nano_line(&file, "%s", NANO_SCALE);
    nano_end(&file, 4, NANO_SIX, 6);
    assert_nano_six(&file, NULL, 10.0 * 20e-3 / 65536.0 / 65536.0);
}

/* A header whose channel has these numbers and n_byte bytes of samples, each 0x0101 or 0x01010101. */
static nano_file make_sized(const char *version, int nx, int ny, int n_byte, const char *extra)
{
    nano_file file;
    nano_begin(&file, NANO_MAGIC, version);
    nano_line(&file, "\\*Ciao image list");
    nano_line(&file, "\\Data offset: %d", NANO_HEADER);
    nano_line(&file, "\\Data length: %d", n_byte);
    nano_line(&file, "\\Samps/line: %d", nx);
    nano_line(&file, "\\Number of lines: %d", ny);
    nano_line(&file, "%s", NANO_HEIGHT);
    nano_line(&file, "%s", NANO_SCALE);
    nano_line(&file, "%s", extra);
    nano_end(&file, 2, NULL, 0);
    memset(file.data + NANO_HEADER, 1, (size_t)n_byte);
    file.n += (size_t)n_byte;
    return file;
}

static void expect_shape(const nano_file *nano, const dif_field_request *request, int nx, int ny, double size_x_um,
                         double size_y_um, const char *warning)
{
    dif_field_file file;
    dif_error err;
    if (parse_bytes(nano->data, nano->n, request, &file, &err))
        fail_msg("%s", err.text);
    assert_int_equal(file.field.nx, nx);
    assert_int_equal(file.field.ny, ny);
    assert_near(file.field.pitch_x_um * nx, size_x_um, 1e-15, 0.0);
    assert_near(file.field.pitch_y_um * ny, size_y_um, 1e-15, 0.0);
    assert_string_equal(file.warning, warning);
    dif_field_file_free(&file);
}

static void test_read__interrupted_scans_have_the_lines_that_are_there(void **state)
{
    (void)state;
    nano_file file = make_sized("0x05150107", 8, 16, 8 * 5 * 2, "\\Scan size: 65 65 ~m");
    expect_shape(&file, NULL, 8, 5, 65.0, 65.0 * 5.0 / 16.0, "interrupted scan: 5 of 16 lines are in the file");
    /* half of the lines in 4 bytes are as long as all of them in 2 */
    file = make_sized("0x09700105", 8, 16, 8 * 8 * 4, "\\Valid data len Y: 8\r\n\\Scan size: 65 65 ~m");
    expect_shape(&file, NULL, 8, 8, 65.0, 32.5, "interrupted scan: 8 of 16 lines are in the file");
    file = make_sized("0x09700105", 8, 16, 8 * 16 * 4, "\\Valid data len Y: 8\r\n\\Scan size: 65 65 ~m");
    expect_shape(&file, NULL, 8, 16, 65.0, 65.0, "the file calls only 8 of its 16 lines valid");
    file = make_sized("0x05150107", 8, 16, 15, "\\Scan size: 65 65 ~m");
    assert_parse_fails(file.data, file.n, NULL, DIF_ERR_FORMAT, "15 bytes of samples, want 256 for 8 x 16");
}

/* Y of a channel that is no square is the part of the lines that were asked for. */
static void test_read__aspect_ratio_scales_y(void **state)
{
    (void)state;
    nano_file file =
        make_sized("0x09100000", 4, 358, 4 * 358 * 2, "\\Aspect Ratio: 0.516184\r\n\\Scan Size: 300 300 nm");
    char *lines = strstr((char *)file.data, "\\Lines: 2\r\n\\");
    assert_non_null(lines);
    memcpy(lines, "\\lines:512\r\n", 12);
    lines[12] = '\\'; /* what comes behind is no key any more */
    expect_shape(&file, NULL, 4, 358, 0.3, 0.3 * 358.0 / 512.0, "");
    file = make_sized("0x09100000", 4, 358, 4 * 358 * 2, "\\aspect ratio: 1:1\r\n\\Scan Size: 300 300 nm");
    expect_shape(&file, NULL, 4, 358, 0.3, 0.3, "");
    file = make_sized("0x05100000", 4, 8, 4 * 8 * 2, "\\Scan size: 2000 nm"); /* one number holds for both */
    expect_shape(&file, NULL, 4, 8, 2.0, 2.0, "");
    file = make_sized("0x05100000", 4, 8, 4 * 8 * 2, "\\Remark: the scan list says 3000 nm");
    expect_shape(&file, NULL, 4, 8, 3.0, 3.0, "");
}

static void test_read__no_scan_size_asks_for_the_pitch(void **state)
{
    (void)state;
    static const char *const SIZES[] = {"\\Scan Size: 0 0 nm", "\\Scan Size: 0 nm",       "\\Scan Size: 3 3",
                                        "\\Scan Size: -3 nm",  "\\Scan Size: nan nan nm", "\\Scan Size: 1e999 nm",
                                        "\\Scan Size: 3 3 V",  "\\Scan Size: 3 3 A"};
    dif_field_request request = dif_field_request_default();
    request.pixel_um = 0.5;
    for (size_t i = 0; i < sizeof SIZES / sizeof *SIZES; i++) {
        const nano_file file = make_sized("0x07200000", 4, 8, 4 * 8 * 2, SIZES[i]);
        assert_parse_fails(file.data, file.n, NULL, DIF_ERR_SCALE,
                           "nanoscope has no lateral scale in it, give --pixel-nm or --size-um");
        expect_shape(&file, &request, 4, 8, 2.0, 4.0, "");
    }
}

/* Values take their parts from anywhere in the text, and nothing but the text. */
static void test_value_parse__parts(void **state)
{
    (void)state;
    static const struct {
        const char *text, *soft, *rest;
        char type;
        double number;
    } VALUES[] = {
        {"V [Sens. Zsens] (0.006 V/LSB) 2.910461 V", "Sens. Zsens", "V", 'V', 2.910461},
        {"  V (log(Arb)/LSB) 32.00000 log(Arb) ", "", "log(Arb)", 'V', 32.0},
        {"V 1.000000 ", "", "", 'V', 1.0},
        {"S [Height] \"Height\"", "Height", "\"Height\"", 'S', NAN},
        {"S [] \"Disabled\"", "", "\"Disabled\"", 'S', NAN},
        {"V", "", "", 'V', NAN},
    };
    static const char *const BAD[] = {"", "  ", "12 V", "X [a] 1", "Vx", "V [a", "V (((a) 1", "V [a] (b 1 V"};
    dif_nanoscope_value value;
    for (size_t i = 0; i < sizeof VALUES / sizeof *VALUES; i++) {
        assert_true(dif_nanoscope_value_parse((dif_piece){VALUES[i].text, strlen(VALUES[i].text)}, &value));
        assert_int_equal(value.type, VALUES[i].type);
        assert_true(dif_piece_is(value.soft, VALUES[i].soft));
        assert_true(dif_piece_is(value.rest, VALUES[i].rest));
        if (isnan(VALUES[i].number))
            assert_true(isnan(value.number));
        else
            assert_true(value.number == VALUES[i].number);
    }
    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++)
        assert_false(dif_nanoscope_value_parse((dif_piece){BAD[i], strlen(BAD[i])}, &value));
}

static void test_text__latin_1_becomes_utf_8_and_fits(void **state)
{
    (void)state;
    char out[8];
    dif_nanoscope_text((dif_piece){"\xb5m\x01", 3}, out, sizeof out);
    assert_string_equal(out, "\xc2\xb5m ");
    dif_nanoscope_text((dif_piece){"\xb5\xb5\xb5\xb5\xb5", 5}, out, sizeof out);
    assert_string_equal(out, "\xc2\xb5\xc2\xb5\xc2\xb5"); /* no half of a character */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__bottom_line_comes_first_whatever_the_frame_direction),
        cmocka_unit_test(test_read__scale_is_hard_value_times_sensitivity),
        cmocka_unit_test(test_read__versions_before_4_3),
        cmocka_unit_test(test_read__four_byte_samples_with_two_written),
        cmocka_unit_test(test_read__sample_size_follows_the_length),
        cmocka_unit_test(test_read__interrupted_scans_have_the_lines_that_are_there),
        cmocka_unit_test(test_read__aspect_ratio_scales_y),
        cmocka_unit_test(test_read__no_scan_size_asks_for_the_pitch),
        cmocka_unit_test(test_value_parse__parts),
        cmocka_unit_test(test_text__latin_1_becomes_utf_8_and_fits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
