#include "core/io/panel_picture.h"

#include <string.h>

#include "alloc_count.h"
#include "core/alloc.h"
#include "core/io/image_cv.h"
#include "near.h"

/* Counts pixels of a colour. */
static int count(const uint8_t *rgb, int nx, int ny, const uint8_t colour[3])
{
    int n = 0;
    for (int i = 0; i < nx * ny; i++)
        n += memcmp(rgb + 3 * i, colour, 3) == 0;
    return n;
}

static void test_draw__values_become_blocks_of_the_map(void **state)
{
    (void)state;
    static const float value[] = {0.0f, 1.0f, NAN, 0.25f};
    const dif_panel panel = {.nx = 2, .ny = 2, .value = value, .high = 1.0};
    const dif_panel_sheet sheet = {.n_panel = 1, .n_column = 1, .panel = &panel, .colour_map = "viridis", .side = 64};
    uint8_t *rgb, map[256][3];
    int nx, ny;
    assert_int_equal(dif_image_colormap("viridis", map, NULL), DIF_OK);
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx, &ny, NULL), DIF_OK);
    assert_int_equal(count(rgb, nx, ny, map[0]), 32 * 32);
    assert_int_equal(count(rgb, nx, ny, map[255]), 32 * 32);
    assert_int_equal(count(rgb, nx, ny, map[64]), 32 * 32);
    const uint8_t empty[3] = {232, 232, 232};
    assert_int_equal(count(rgb, nx, ny, empty), 32 * 32);
    dif_release(rgb);
}

static void test_draw__decades_and_ellipses(void **state)
{
    (void)state;
    static const float value[] = {1.0f, 0.1f, 0.01f, 1e-9f};
    dif_panel panel = {.nx = 2,
                       .ny = 2,
                       .value = value,
                       .low = 0.01,
                       .high = 1.0,
                       .is_log = true,
                       .x_max = 1.0,
                       .y_max = 1.0,
                       .title = "title"};
    snprintf(panel.note[0], DIF_PANEL_TEXT, "note");
    const dif_panel_sheet sheet = {
        .n_panel = 1, .n_column = 1, .panel = &panel, .heading = "heading", .colour_map = "viridis", .side = 128};
    uint8_t *rgb, map[256][3];
    int nx, ny;
    assert_int_equal(dif_image_colormap("viridis", map, NULL), DIF_OK);
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx, &ny, NULL), DIF_OK);
    assert_int_equal(count(rgb, nx, ny, map[255]), 64 * 64);
    assert_int_equal(count(rgb, nx, ny, map[128]), 64 * 64); /* one of two decades */
    assert_int_equal(count(rgb, nx, ny, map[0]), 2 * 64 * 64);
    dif_release(rgb);
    panel.n_ellipse = 1;
    const double ellipse[5] = {0.5, 0.5, 0.04, 0.04, 0.0};
    memcpy(panel.ellipse[0], ellipse, sizeof ellipse);
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx, &ny, NULL), DIF_OK);
    const int covered =
        4 * 64 * 64 - count(rgb, nx, ny, map[255]) - count(rgb, nx, ny, map[128]) - count(rgb, nx, ny, map[0]);
    assert_in_range(covered, 120, 480); /* a circle of 25 pixels: 160 long, up to three wide where it is smoothed */
    dif_release(rgb);
}

static void test_draw__large_pictures_shrink_and_columns_fill(void **state)
{
    (void)state;
    uint8_t *pixel = dif_alloc(300 * 100, 3), *rgb;
    int nx, ny, nx_one, ny_one;
    assert_non_null(pixel);
    const dif_panel panel[3] = {{.nx = 300, .ny = 100, .rgb = pixel},
                                {.nx = 300, .ny = 100, .rgb = pixel},
                                {.nx = 300, .ny = 100, .rgb = pixel}};
    dif_panel_sheet sheet = {.n_panel = 1, .n_column = 1, .panel = panel, .colour_map = "gray", .side = 150};
    const uint8_t black[3] = {0, 0, 0};
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx_one, &ny_one, NULL), DIF_OK);
    assert_int_equal(count(rgb, nx_one, ny_one, black), 150 * 50);
    dif_release(rgb);
    sheet.n_panel = 3;
    sheet.n_column = 2;
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx, &ny, NULL), DIF_OK);
    assert_int_equal(nx, 2 * nx_one);
    assert_int_equal(ny, 2 * ny_one);
    assert_int_equal(count(rgb, nx, ny, black), 3 * 150 * 50);
    dif_release(rgb);
    dif_release(pixel);
}

static void test_draw__bad_sheets_are_refused(void **state)
{
    (void)state;
    static const float value[] = {0.0f};
    dif_panel panel = {.nx = 1, .ny = 1, .value = value};
    dif_panel_sheet sheet = {.n_panel = 1, .n_column = 1, .panel = &panel, .colour_map = "viridis", .side = 128};
    dif_error err;
    uint8_t *rgb;
    int nx, ny;
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx, &ny, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "panel 1: colours from 0 to 0");
    panel.high = 1.0;
    panel.is_log = true;
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx, &ny, &err), DIF_ERR_ARG);
    panel.is_log = false;
    sheet.side = 10;
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx, &ny, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "panels of 10 pixels, want 64 ... 4096");
    sheet.side = 128;
    sheet.n_panel = 0;
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx, &ny, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "0 panels in 1 columns, want 1 ... 64");
    sheet.n_panel = 1;
    panel.value = NULL;
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx, &ny, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "panel 1 is empty");
    panel.value = value;
    test_alloc_fail_from(1);
    assert_int_equal(dif_panel_draw(&sheet, &rgb, &nx, &ny, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    assert_int_equal(dif_panel_write_png("/tmp/none/panels.png", &sheet, NULL, &err), DIF_ERR_IO);
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_draw__values_become_blocks_of_the_map),
        cmocka_unit_test(test_draw__decades_and_ellipses),
        cmocka_unit_test(test_draw__large_pictures_shrink_and_columns_fill),
        cmocka_unit_test(test_draw__bad_sheets_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
