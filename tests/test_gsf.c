#include "tests/io_cases.h"

#include <stdint.h>

#include "core/io/field_raw.h"

static const char MAGIC[] = "Gwyddion Simple Field 1.0\n";

typedef struct bytes {
    unsigned char data[1024];
    size_t n;
} bytes;

static void put_float(bytes *file, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int k = 0; k < 4; k++)
        file->data[file->n++] = (unsigned char)(bits >> (8 * k));
}

/* A file of n_sample samples 0.5, 1.5, ... under the header lines. */
static bytes make(const char *header, int n_sample)
{
    bytes file = {.n = 0};
    file.n = (size_t)snprintf((char *)file.data, 512, "%s%s", MAGIC, header);
    do
        file.data[file.n++] = '\0';
    while (file.n % 4);
    for (int i = 0; i < n_sample; i++)
        put_float(&file, 0.5f + (float)i);
    return file;
}

static const char FULL[] =
    "XRes = 3\nYRes = 2\nXReal = 6e-6\nYReal = 2e-6\nXYUnits = m\nZUnits = nm\nTitle = A title\n";

static void test_read__takes_size_units_and_samples(void **state)
{
    (void)state;
    dif_field_file file;
    dif_error err;
    const bytes gsf = make(FULL, 6);
    assert_int_equal(parse_bytes(gsf.data, gsf.n, NULL, &file, &err), DIF_OK);
    assert_string_equal(file.format, "gsf");
    assert_string_equal(file.title, "A title");
    assert_string_equal(file.warning, "");
    assert_int_equal(file.field.nx, 3);
    assert_int_equal(file.field.ny, 2);
    assert_near(file.field.pitch_x_um, 2.0, 4e-16, 0.0); /* a product and a division round */
    assert_near(file.field.pitch_y_um, 1.0, 4e-16, 0.0);
    for (int i = 0; i < 6; i++)
        assert_near(file.field.z_um[i], (0.5 + i) * 1e-3, 2e-16, 0.0);
    dif_field_file_free(&file);
}

static void test_read__accepts_any_padding_order_and_unknown_keys(void **state)
{
    (void)state;
    static const char *const HEADERS[] = {
        "YRes=2\nXRes  =  3\nZUnits = m\nXYUnits=m\nXReal= 3\nYReal =2\n",
        "Own key = x\nXRes = 3\nYRes = 2\nXYUnits = m\nZUnits = m\nXReal = 3\nYReal = 2\n",
        "Own key = xy\nXRes = 3\nYRes = 2\nXYUnits = m\nZUnits = m\nXReal = 3\nYReal = 2\n",
        "Own key = xyz\nXRes = 3\nYRes = 2\nXYUnits = m\nZUnits = m\nXReal = 3\nYReal = 2\n",
        "Own key = wxyz\nXRes = 3\nYRes = 2\nXYUnits = m\nZUnits = m\nXReal = 3\nYReal = 2\n",
    };
    for (size_t i = 0; i < sizeof HEADERS / sizeof *HEADERS; i++) {
        dif_field_file file;
        dif_error err;
        const bytes gsf = make(HEADERS[i], 6);
        assert_int_equal(parse_bytes(gsf.data, gsf.n, NULL, &file, &err), DIF_OK);
        assert_true(file.field.pitch_x_um == 1e6 && file.field.z_um[5] == 5.5e6);
        dif_field_file_free(&file);
    }
}

static void expect(const char *header, int n_sample, dif_status want, const char *part)
{
    const bytes gsf = make(header, n_sample);
    assert_parse_fails(gsf.data, gsf.n, NULL, want, part);
}

static void test_read__refuses_bad_headers(void **state)
{
    (void)state;
    expect("YRes = 2\n", 6, DIF_ERR_FORMAT, "no XRes in the header");
    expect("XRes = 3\n", 6, DIF_ERR_FORMAT, "no YRes in the header");
    expect("XRes = three\nYRes = 2\n", 6, DIF_ERR_FORMAT, "XRes is 'three', want a finite number");
    expect("XRes = nan\nYRes = 2\n", 6, DIF_ERR_FORMAT, "XRes is 'nan'");
    expect("XRes = 1.5\nYRes = 2\n", 6, DIF_ERR_FORMAT, "XRes is 1.5, want a whole number");
    expect("XRes = 0\nYRes = 2\n", 6, DIF_ERR_FORMAT, "0 x 2 samples, want at least 1 x 1");
    expect("XRes = -3\nYRes = 2\n", 6, DIF_ERR_FORMAT, "-3 x 2 samples");
    expect("XRes = 32769\nYRes = 2\n", 6, DIF_ERR_SIZE, "32769 x 2 samples, want at most 32768 a side");
    expect("XRes = 3\nYRes = 100000\n", 6, DIF_ERR_SIZE, "3 x 100000 samples");
    expect("XRes = 4294967299\nYRes = 4294967298\n", 6, DIF_ERR_SIZE, "want at most 32768 a side");
    expect("XRes = 1e300\nYRes = 2\n", 6, DIF_ERR_SIZE, "XRes is 1e+300");
    expect("XRes = 32768\nYRes = 32768\n", 6, DIF_ERR_SIZE, "want at most 268435456 together");
    expect("XRes = 3\nYRes = 2\nXYUnits = V\n", 6, DIF_ERR_FORMAT, "XYUnits is 'V', want a length");
    expect("XRes = 3\nYRes = 2\nXYUnits = m\nZUnits = deg\n", 6, DIF_ERR_SCALE, "is in deg, which is no length");
    expect("XRes = 3\nYRes = 2\nXYUnits = m\nZUnits = m\nXReal = 0\n", 6, DIF_ERR_FORMAT,
           "XReal, YReal are 0, 1, want > 0");
    expect("XRes = 3\nYRes = 2\nXYUnits = m\nZUnits = m\nXReal = -1\n", 6, DIF_ERR_FORMAT, "want > 0");
    expect("XRes = 3\nYRes = 2\nXYUnits = m\nZUnits = m\nXReal = inf\n", 6, DIF_ERR_FORMAT, "XReal is 'inf'");
}

static void test_read__refuses_a_wrong_amount_of_samples(void **state)
{
    (void)state;
    expect(FULL, 5, DIF_ERR_FORMAT, "20 bytes of samples, want 24 for 3 x 2 (truncated?)");
    expect(FULL, 7, DIF_ERR_FORMAT, "28 bytes of samples, want 24 for 3 x 2");
    bytes gsf = make(FULL, 6);
    gsf.data[sizeof MAGIC - 1 + strlen(FULL) + 1] = 'x'; /* inside the padding */
    assert_parse_fails(gsf.data, gsf.n, NULL, DIF_ERR_FORMAT, "not padded with NUL");
}

static void test_read__missing_scale_names_the_flag(void **state)
{
    (void)state;
    expect("XRes = 3\nYRes = 2\n", 6, DIF_ERR_SCALE,
           "no scale in it, give --pixel-nm or --size-um, and --z-unit (nm, um, m)");
    expect("XRes = 3\nYRes = 2\nZUnits = m\n", 6, DIF_ERR_SCALE,
           "no lateral scale in it, give --pixel-nm or --size-um");
    expect("XRes = 3\nYRes = 2\nXYUnits = m\n", 6, DIF_ERR_SCALE, "no height scale in it, give --z-unit (nm, um, m)");
}

static void test_read__what_the_user_says_wins_with_a_warning(void **state)
{
    (void)state;
    dif_field_file file;
    dif_error err;
    const bytes gsf = make(FULL, 6);
    dif_field_request request = dif_field_request_default();
    request.pixel_um = 0.05;
    request.z_unit = "um";
    assert_int_equal(parse_bytes(gsf.data, gsf.n, &request, &file, &err), DIF_OK);
    assert_true(file.field.pitch_x_um == 0.05 && file.field.pitch_y_um == 0.05 && file.field.z_um[0] == 0.5);
    assert_string_equal(file.warning, "the file's own height scale is replaced by the one given; "
                                      "the file's own pitch of 2000 nm is replaced by 50 nm");
    dif_field_file_free(&file);
    request = dif_field_request_default();
    request.size_um = 6.0; /* what the file says too */
    request.z_unit = "nm";
    assert_int_equal(parse_bytes(gsf.data, gsf.n, &request, &file, &err), DIF_OK);
    assert_string_equal(file.warning, "");
    dif_field_file_free(&file);
}

static void test_read__non_finite_samples_are_refused_with_the_place(void **state)
{
    (void)state;
    bytes gsf = make(FULL, 5);
    put_float(&gsf, NAN);
    assert_parse_fails(gsf.data, gsf.n, NULL, DIF_ERR_NONFINITE,
                       "height at column 2, row 1 is nan, want a finite number");
    dif_field_request request = dif_field_request_default();
    dif_field_file file;
    dif_error err;
    request.allow_missing = true;
    assert_int_equal(parse_bytes(gsf.data, gsf.n, &request, &file, &err), DIF_OK);
    assert_true(isnan(file.field.z_um[5]) && isfinite(file.field.z_um[4]));
    dif_field_file_free(&file);
    gsf = make(FULL, 3);
    put_float(&gsf, INFINITY);
    put_float(&gsf, 1.0f);
    put_float(&gsf, 1.0f);
    assert_parse_fails(gsf.data, gsf.n, NULL, DIF_ERR_NONFINITE, "height at column 0, row 1 is inf");
}

static void test_read__every_beginning_is_refused(void **state)
{
    (void)state;
    const bytes gsf = make(FULL, 6);
    assert_int_equal(count_accepted_beginnings(gsf.data, gsf.n, NULL), 0);
}

static void test_encode__comes_back_to_the_last_bit_of_a_float(void **state)
{
    (void)state;
    dif_field field;
    dif_field_file file;
    dif_error err;
    dif_manifest manifest = {0};
    unsigned char *data = NULL;
    size_t n = 0;
    uint64_t seed = 5;
    assert_int_equal(dif_field_create(7, 5, 0.0488, 0.061, &field, &err), DIF_OK);
    for (int i = 0; i < 35; i++)
        field.z_um[i] = test_random(&seed, -2.0, 2.0);
    assert_int_equal(dif_manifest_set(&manifest, "command", "diffbench fixture sine", &err), DIF_OK);
    assert_int_equal(dif_gsf_encode(&field, &manifest, &data, &n, &err), DIF_OK);
    assert_int_equal(n % 4, 0);
    assert_non_null(strstr((const char *)data, "\ndiffbench.command = diffbench fixture sine\n"));
    assert_int_equal(parse_bytes(data, n, NULL, &file, &err), DIF_OK);
    assert_near(file.field.pitch_x_um, field.pitch_x_um, 1e-15, 0.0); /* extent and back: a few roundings */
    assert_near(file.field.pitch_y_um, field.pitch_y_um, 1e-15, 0.0);
    for (int i = 0; i < 35; i++)
        assert_near(file.field.z_um[i], field.z_um[i], 6.1e-8, 0.0); /* 2^-24: half a step of a float */
    dif_release(data);
    dif_field_file_free(&file);
    dif_manifest_free(&manifest);
    dif_field_free(&field);
}

static void test_read__failing_heap_is_said(void **state)
{
    (void)state;
    const bytes gsf = make(FULL, 6);
    assert_true(parse_with_failing_heap(gsf.data, gsf.n, NULL) >= 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__takes_size_units_and_samples),
        cmocka_unit_test(test_read__accepts_any_padding_order_and_unknown_keys),
        cmocka_unit_test(test_read__refuses_bad_headers),
        cmocka_unit_test(test_read__refuses_a_wrong_amount_of_samples),
        cmocka_unit_test(test_read__missing_scale_names_the_flag),
        cmocka_unit_test(test_read__what_the_user_says_wins_with_a_warning),
        cmocka_unit_test(test_read__non_finite_samples_are_refused_with_the_place),
        cmocka_unit_test(test_read__every_beginning_is_refused),
        cmocka_unit_test(test_encode__comes_back_to_the_last_bit_of_a_float),
        cmocka_unit_test(test_read__failing_heap_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
