#include "tests/io_cases.h"

static void test_parse__known_formats_that_are_not_read_say_so(void **state)
{
    (void)state;
    static const struct {
        const char *bytes, *what;
    } FORMATS[] = {
        {"\xff\xd8\xff\xe0", "a JPEG picture, which is lossy"},
        {"\x89HDF\r\n", "an HDF5 file"},
        {"CDF\x01", "a netCDF file"},
    };
    for (size_t i = 0; i < sizeof FORMATS / sizeof *FORMATS; i++)
        assert_parse_fails(FORMATS[i].bytes, strlen(FORMATS[i].bytes), NULL, DIF_ERR_UNSUPPORTED, FORMATS[i].what);
    assert_parse_fails("", 0, NULL, DIF_ERR_FORMAT, "empty file");
    assert_parse_fails(NULL, 0, NULL, DIF_ERR_FORMAT, "empty file");
    assert_parse_fails("\x7f"
                       "ELF\x02\x01\x01\0\0",
                       9, NULL, DIF_ERR_FORMAT, "unknown format");
}

static void test_parse__requests_out_of_range_are_refused(void **state)
{
    (void)state;
    static const double BAD[] = {0.0, -1.0, (double)INFINITY, -(double)INFINITY};
    for (int i = 0; i < 4; i++) {
        dif_field_request request = dif_field_request_default();
        request.pixel_um = BAD[i];
        assert_parse_fails("1 2\n", 4, &request, DIF_ERR_ARG, "--pixel-nm says ");
        request = dif_field_request_default();
        request.size_um = BAD[i];
        assert_parse_fails("1 2\n", 4, &request, DIF_ERR_ARG, "--size-um says ");
        request = dif_field_request_default();
        request.height_um = BAD[i];
        assert_parse_fails("1 2\n", 4, &request, DIF_ERR_ARG, "um, want a finite length > 0");
    }
    dif_field_request request = dif_field_request_default();
    request.pixel_um = request.size_um = 1.0;
    assert_parse_fails("1 2\n", 4, &request, DIF_ERR_ARG, "--pixel-nm and --size-um both given, want one of them");
    request = dif_field_request_default();
    request.z_unit = "volt";
    assert_parse_fails("1 2\n", 4, &request, DIF_ERR_ARG, "--z-unit is 'volt', want pm, nm, um, mm, m or A");
}

static void test_parse__message_keeps_the_end_of_a_long_name(void **state)
{
    (void)state;
    char name[1000];
    memset(name, 'd', sizeof name);
    memcpy(name + 980, "/the_scan.txt", 14);
    dif_field_file file;
    dif_error err;
    assert_int_equal(dif_field_parse((const unsigned char *)"1 2\n3\n", 6, name, NULL, &file, &err), DIF_ERR_FORMAT);
    assert_memory_equal(err.text, "...ddd", 6);
    assert_non_null(strstr(err.text, "/the_scan.txt: line 2 has 1 values, want 2 as in line 1"));
}

static void test_read__missing_file_and_directory(void **state)
{
    (void)state;
    dif_field_file file;
    dif_error err;
    assert_int_equal(dif_field_read("/no/such/file.gsf", NULL, &file, &err), DIF_ERR_IO);
    assert_string_equal(err.text, "/no/such/file.gsf: cannot open: No such file or directory");
    assert_int_equal(dif_field_read("/tmp", NULL, &file, &err), DIF_ERR_IO);
    assert_string_equal(err.text, "/tmp: is a directory, want a file");
}

/* Files with facts stated beside them: text exports, matrices, the pictures of the sheds. */
static void test_read__real_files_have_their_stated_size_and_scale(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int nx, ny;
        double size_x_um, size_y_um, first_um;
        double size_um, height_um; /* what the file does not say */
        const char *z_unit;
    } FILES[] = {
        {"afm/bipm_grating.gsf", 500, 500, 5.0, 5.0, NAN, NAN, NAN, NULL},
        {"afm/text/gratinglab_synthetic_blazed_scan.txt", 384, 64, 2.0, 0.333, 1.8099e-3, NAN, NAN, NULL},
        {"afm/text/gwyddion-export-english.txt", 3, 4, 12.34, 5.6789, 1e6, NAN, NAN, NULL},
        {"afm/text/gwyddion-export-german.txt", 3, 4, 12.34, 5.6789, 1e6, NAN, NAN, NULL},
        {"afm/text/matrix-3.txt", 256, 256, 10.0, 10.0, 1.8823e-2, NAN, NAN, NULL},
        {"afm/text/matrix-5.txt", 10, 10, 65.0, 65.0, 2.0, 65.0, NAN, "um"},
        {"afm/text/matrix-6.txt", 4, 3, 10.0, 10.0, 1e6, NAN, NAN, NULL},
        {"afm/text/txt_example.txt", 6, 3, 1.0, 0.5, 0.1, NAN, NAN, NULL},
        {"afm/text/xyz-1.txt", 4, 4, 4e-3, 4e-3, 1e-3, NAN, NAN, "nm"},
        {"afm/synthetic/t_matrix.txt", 40, 24, 2.0, 1.8, 0.1, NAN, NAN, NULL},
        {"afm/synthetic/t_gwykeys.png", 40, 24, 2.0, 1.8, 0.1, NAN, NAN, NULL},
        {"measured/xenopeltis_65um.png", 1332, 1332, 65.0, 65.0, NAN, 65.0, 0.81869, NULL},
        {"measured/elaphe_65um.png", 1332, 1332, 65.0, 65.0, NAN, 65.0, 0.375, NULL},
        {"measured/cd_1024.png", 1024, 1024, 30.0, 30.0, NAN, 30.0, 0.1, NULL},
    };
    const char *data = test_data_folder();
    if (!data)
        skip();
    for (size_t i = 0; i < sizeof FILES / sizeof *FILES; i++) {
        char path[1024];
        dif_field_file file;
        dif_error err;
        dif_field_request request = dif_field_request_default();
        request.size_um = FILES[i].size_um;
        request.height_um = FILES[i].height_um;
        request.z_unit = FILES[i].z_unit;
        snprintf(path, sizeof path, "%s/%s", data, FILES[i].name);
        if (dif_field_read(path, &request, &file, &err))
            fail_msg("%s", err.text);
        assert_int_equal(file.field.nx, FILES[i].nx);
        assert_int_equal(file.field.ny, FILES[i].ny);
        assert_near(file.field.pitch_x_um * file.field.nx, FILES[i].size_x_um, 1e-15, 0.0);
        assert_near(file.field.pitch_y_um * file.field.ny, FILES[i].size_y_um, 1e-15, 0.0);
        if (!isnan(FILES[i].first_um)) /* a 16-bit step of the PNG with scale keys is 3.4e-6 um */
            assert_near(file.field.z_um[0], FILES[i].first_um, 1e-15, file.bits ? 0.5 * file.step_um : 0.0);
        if (file.bits == 8)
            assert_near(file.step_um, FILES[i].height_um / 255.0, 1e-15, 0.0);
        dif_field_file_free(&file);
    }
}

/* The PNG with scale keys and the text matrix hold the same surface. */
static void test_read__picture_and_text_of_one_surface_agree(void **state)
{
    (void)state;
    const char *data = test_data_folder();
    if (!data)
        skip();
    char path[1024];
    dif_field_file png, text;
    dif_error err;
    snprintf(path, sizeof path, "%s/afm/synthetic/t_gwykeys.png", data);
    assert_int_equal(dif_field_read(path, NULL, &png, &err), DIF_OK);
    snprintf(path, sizeof path, "%s/afm/synthetic/t_matrix.txt", data);
    assert_int_equal(dif_field_read(path, NULL, &text, &err), DIF_OK);
    assert_near(png.field.pitch_x_um, text.field.pitch_x_um, 4e-16, 0.0);
    assert_near(png.field.pitch_y_um, text.field.pitch_y_um, 4e-16, 0.0);
    for (size_t i = 0; i < dif_field_n(&png.field); i++)
        assert_near(png.field.z_um[i], text.field.z_um[i], 0.0, 1.001 * png.step_um); /* at most one step */
    dif_field_file_free(&png);
    dif_field_file_free(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parse__known_formats_that_are_not_read_say_so),
        cmocka_unit_test(test_parse__requests_out_of_range_are_refused),
        cmocka_unit_test(test_parse__message_keeps_the_end_of_a_long_name),
        cmocka_unit_test(test_read__missing_file_and_directory),
        cmocka_unit_test(test_read__real_files_have_their_stated_size_and_scale),
        cmocka_unit_test(test_read__picture_and_text_of_one_surface_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
