/* Lists of x y z. */
#include "tests/io_cases.h"

static dif_field_request request_nm(void)
{
    dif_field_request request = dif_field_request_default();
    request.pixel_um = 0.05;
    request.z_unit = "um";
    return request;
}

static void test_xyz__any_order_becomes_a_grid_with_y_up(void **state)
{
    (void)state;
    char text[1000] = "";
    size_t n = 0;
    for (int i = 0; i < 12; i++) {
        const int k = (5 * i + 3) % 12, ix = k % 4, iy = k / 4; /* a shuffle */
        n += (size_t)snprintf(text + n, sizeof text - n, "%.5f %g %d\n", 10.0 + 0.5 * ix + (k == 2 ? 2e-4 : 0.0),
                              -3.0 + 2.0 * iy, 100 + 10 * iy + ix);
    }
    dif_field_request request = dif_field_request_default();
    request.z_unit = "nm";
    dif_field_file file;
    dif_error err;
    assert_int_equal(parse_bytes(text, n, &request, &file, &err), DIF_OK);
    assert_int_equal(file.field.nx, 4);
    assert_int_equal(file.field.ny, 3);
    assert_near(file.field.pitch_x_um, 0.5e-3, 1e-12, 0.0); /* the mean of steps of decimals */
    assert_near(file.field.pitch_y_um, 2e-3, 1e-12, 0.0);
    for (int iy = 0; iy < 3; iy++) {
        for (int ix = 0; ix < 4; ix++)
            assert_near(file.field.z_um[iy * 4 + ix], 1e-3 * (100 + 10 * (2 - iy) + ix), 4e-16, 0.0);
    }
    dif_field_file_free(&file);
    request.pixel_um = 0.25; /* x and y in another unit than z */
    assert_int_equal(parse_bytes(text, n, &request, &file, &err), DIF_OK);
    assert_true(file.field.pitch_x_um == 0.25 && file.field.pitch_y_um == 0.25);
    dif_field_file_free(&file);
    assert_parse_fails(text, n, NULL, DIF_ERR_SCALE, "text has no scale in it, give --z-unit (nm, um, m)");
}

static void test_xyz__a_missing_height_is_one_point_of_the_grid(void **state)
{
    (void)state;
    static const char TEXT[] = "0 0 1\n1 0 NaN\n0 1 3\n1 1 inf\n";
    dif_field_request request = request_nm();
    dif_field_file file;
    dif_error err;
    assert_parse_fails(TEXT, sizeof TEXT - 1, &request, DIF_ERR_NONFINITE, "height at column 1, row 0 is nan");
    request.allow_missing = true;
    assert_int_equal(parse_bytes(TEXT, sizeof TEXT - 1, &request, &file, &err), DIF_OK);
    assert_int_equal(file.field.nx * 10 + file.field.ny, 22);
    assert_true(file.field.z_um[0] == 3.0 && isnan(file.field.z_um[1]));
    assert_true(file.field.z_um[2] == 1.0 && isnan(file.field.z_um[3]));
    dif_field_file_free(&file);
}

static void test_xyz__refuses_what_is_no_full_grid(void **state)
{
    (void)state;
    const dif_field_request request = request_nm();
    static const char *const TEXTS[] = {
        "0 0 1\n1 0 1\n0 1 1\n1 1.1 1\n",      "0 0 1\n1 0 1\n0 1 1\n0 1 1\n",
        "0 0 1\n1 0 1\n0 1 1\n1 1 1\n2 0 1\n", "1 2 3\n4 5 6\n7 8 9\n10 11 12\n",
        "0 0 1\n0 0 1\n0 0 1\n0 0 1\n",        "0 0 1\n1 0 1\n3 0 1\n0 1 1\n1 1 1\n3 1 1\n",
        "0 0 1\nNaN 0 1\n0 1 1\n1 1 1\n",      "0 0 1\n1 0 1\n0 inf 1\n1 1 1\n",
        "0 0 NaN\n1 0 1\n0 1 1\n0 1 1\n",
    };
    for (size_t i = 0; i < sizeof TEXTS / sizeof *TEXTS; i++)
        assert_parse_fails(TEXTS[i], strlen(TEXTS[i]), &request, DIF_ERR_FORMAT, "neither x y z on a regular grid nor");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_xyz__any_order_becomes_a_grid_with_y_up),
        cmocka_unit_test(test_xyz__a_missing_height_is_one_point_of_the_grid),
        cmocka_unit_test(test_xyz__refuses_what_is_no_full_grid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
