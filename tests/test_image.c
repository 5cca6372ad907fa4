#include "tests/io_cases.h"

#include "core/io/image_cv.h"
#include "core/io/image_head.h"
#include "tests/image_sample.h"

static const image_tiff_kind TIFF = {5, 3, 16, 0, 1, 1, 1, 1};

static void expect_picture(const image_sample *file, int nx, int ny, int bits)
{
    dif_image image;
    dif_error err;
    if (dif_image_decode(file->data, file->n, &image, &err))
        fail_msg("%s", err.text);
    assert_int_equal(image.nx, nx);
    assert_int_equal(image.ny, ny);
    assert_int_equal(image.bits, bits);
    for (int iy = 0; iy < ny; iy++) {
        for (int ix = 0; ix < nx; ix++)
            assert_int_equal(image.value[iy * nx + ix], image_value(ix, iy, bits));
    }
    dif_release(image.value);
}

static void test_decode__png_tiff_bmp_grey_and_colour_that_is_grey(void **state)
{
    (void)state;
    static const int COLOURS[] = {0, 2, 4, 6};
    for (int i = 0; i < 8; i++) {
        const image_sample png = image_png(5, 3, i < 4 ? 8 : 16, COLOURS[i % 4], 0, NULL);
        expect_picture(&png, 5, 3, i < 4 ? 8 : 16);
    }
    for (int i = 0; i < 4; i++) {
        image_tiff_kind kind = TIFF;
        kind.bits = i % 2 ? 8 : 16;
        kind.big = i / 2;
        const image_sample tiff = image_tiff(&kind);
        expect_picture(&tiff, 5, 3, kind.bits);
    }
    const image_sample bmp = image_bmp(5, 3);
    expect_picture(&bmp, 5, 3, 8);
}

static void expect(const image_sample *file, dif_status want, const char *part)
{
    dif_image image;
    dif_error err = {0};
    assert_int_equal(dif_image_decode(file->data, file->n, &image, &err), want);
    if (!strstr(err.text, part))
        fail_msg("'%s' does not hold '%s'", err.text, part);
    assert_null(image.value);
}

static void test_decode__refuses_colour_with_the_place(void **state)
{
    (void)state;
    const image_sample png = image_png(5, 3, 8, 2, 1, NULL);
    expect(&png, DIF_ERR_FORMAT, "a colour picture (first at column 0, row 0), want grey heights");
}

static void test_decode__refuses_kinds_of_tiff_with_other_values(void **state)
{
    (void)state;
    static const struct {
        image_tiff_kind kind;
        const char *part;
    } CASES[] = {
        {{5, 3, 16, 0, 0, 1, 1, 1}, "TIFF has 0 as photometric kind"},
        {{5, 3, 16, 0, 1, 3, 1, 1}, "TIFF has 3 as orientation"},
        {{5, 3, 16, 0, 1, 1, 2, 1}, "TIFF has 2 as sample format"},
        {{5, 3, 32, 0, 1, 1, 3, 1}, "TIFF has 32 bits a sample"},
        {{5, 3, 16, 0, 1, 1, 1, 2}, "TIFF has 2 samples a pixel"},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        const image_sample tiff = image_tiff(&CASES[i].kind);
        expect(&tiff, DIF_ERR_UNSUPPORTED, CASES[i].part);
    }
    image_sample big = image_tiff(&TIFF);
    big.data[2] = '+';
    expect(&big, DIF_ERR_UNSUPPORTED, "BigTIFF");
}

/* The size in the header is looked at before anything is allocated. */
static void test_decode__refuses_sizes_that_lie(void **state)
{
    (void)state;
    static const struct {
        uint32_t nx, ny;
        dif_status status;
        const char *part;
    } SIZES[] = {
        {0, 3, DIF_ERR_FORMAT, "0 x 3 pixels"},
        {32769, 1, DIF_ERR_SIZE, "32769 x 1 pixels, want at most 32768 a side"},
        {3, 100000, DIF_ERR_SIZE, "3 x 100000 pixels"},
        {32768, 32768, DIF_ERR_SIZE, "want at most 268435456 together"},
        {0x7fffffff, 0x7fffffff, DIF_ERR_SIZE, "want at most 32768 a side"},
        {0xffffffff, 0xffffffff, DIF_ERR_SIZE, "want at most 32768 a side"},
    };
    for (size_t i = 0; i < sizeof SIZES / sizeof *SIZES; i++) {
        image_sample png = image_png(5, 3, 8, 0, 0, NULL);
        for (int k = 0; k < 4; k++) {
            png.data[16 + k] = (unsigned char)(SIZES[i].nx >> (24 - 8 * k));
            png.data[20 + k] = (unsigned char)(SIZES[i].ny >> (24 - 8 * k));
        }
        const uint32_t crc = image_crc(png.data + 12, 17);
        for (int k = 0; k < 4; k++)
            png.data[29 + k] = (unsigned char)(crc >> (24 - 8 * k));
        expect(&png, SIZES[i].status, SIZES[i].part);
    }
    image_sample bmp = image_bmp(5, 3);
    memset(bmp.data + 18, 0xff, 4);
    expect(&bmp, DIF_ERR_FORMAT, "-1 x 3 pixels");
    bmp = image_bmp(5, 3);
    bmp.data[19] = 100;
    expect(&bmp, DIF_ERR_FORMAT, "is shorter than its 25605 x 3 pixels");
}

static void test_decode__refuses_damaged_files(void **state)
{
    (void)state;
    image_sample png = image_png(5, 3, 8, 0, 0, NULL);
    png.data[60] ^= 1;
    expect(&png, DIF_ERR_FORMAT, "PNG is damaged: wrong check sum of the chunk at byte 33");
    image_sample tiff = image_tiff(&TIFF);
    tiff.data[8 + 30] = 0xff; /* the first strip begins far beyond the end */
    tiff.data[8 + 31] = 0xff;
    expect(&tiff, DIF_ERR_FORMAT, "does not hold all its pixels (truncated?)");
    image_sample bmp = image_bmp(5, 3);
    bmp.data[30] = 1;
    expect(&bmp, DIF_ERR_UNSUPPORTED, "BMP of 24 bits with compression 1");
    image_sample none = {.data = "hello", .n = 5};
    expect(&none, DIF_ERR_FORMAT, "not a PNG, TIFF or BMP image");
}

static dif_field_request request_all(void)
{
    dif_field_request request = dif_field_request_default();
    request.pixel_um = 0.05;
    request.height_um = 0.255;
    return request;
}

static void test_read__every_beginning_is_refused(void **state)
{
    (void)state;
    const dif_field_request request = request_all();
    const image_sample files[] = {image_png(5, 3, 8, 0, 0, NULL), image_png(4, 3, 16, 6, 0, NULL), image_tiff(&TIFF),
                                  image_bmp(5, 3)};
    for (int i = 0; i < 4; i++) {
        /* a TIFF without the pointer to a second directory, its last four bytes, is whole; so is a BMP without padding */
        const int allowed = i == 2 ? 4 : 0;
        assert_in_range(count_accepted_beginnings(files[i].data, files[i].n, &request), 0, allowed);
    }
}

static void test_read__full_range_maps_to_the_height_given(void **state)
{
    (void)state;
    dif_field_request request = request_all();
    dif_field_file file;
    dif_error err;
    const image_sample png8 = image_png(5, 3, 8, 0, 0, NULL);
    assert_int_equal(parse_bytes(png8.data, png8.n, &request, &file, &err), DIF_OK);
    assert_string_equal(file.format, "png");
    assert_int_equal(file.bits, 8);
    assert_near(file.step_um, 1e-3, 4e-16, 0.0); /* 255 steps of 1 nm */
    assert_near(file.field.z_um[1], 10e-3, 4e-16, 0.0);
    assert_true(file.field.pitch_x_um == 0.05);
    assert_string_equal(file.warning, "8-bit heights: one step is 1 nm");
    dif_field_file_free(&file);
    request.height_um = 65.535;
    const image_sample png16 = image_png(5, 3, 16, 0, 0, NULL);
    assert_int_equal(parse_bytes(png16.data, png16.n, &request, &file, &err), DIF_OK);
    assert_int_equal(file.bits, 16);
    assert_near(file.field.z_um[0], 7e-3, 4e-16, 0.0);
    assert_string_equal(file.warning, "");
    dif_field_file_free(&file);
    request.pixel_um = NAN;
    request.size_um = 10.0; /* along x, square pixels */
    assert_int_equal(parse_bytes(png16.data, png16.n, &request, &file, &err), DIF_OK);
    assert_true(file.field.pitch_x_um == 2.0 && file.field.pitch_y_um == 2.0);
    dif_field_file_free(&file);
}

static void test_read__missing_scale_names_the_flags(void **state)
{
    (void)state;
    const image_sample png = image_png(5, 3, 8, 0, 0, NULL);
    dif_field_request request = dif_field_request_default();
    assert_parse_fails(png.data, png.n, NULL, DIF_ERR_SCALE,
                       "png has no scale in it, give --pixel-nm or --size-um, and --height-um (black to white)");
    request.pixel_um = 0.1;
    assert_parse_fails(png.data, png.n, &request, DIF_ERR_SCALE, "png has no height scale in it, give --height-um");
    request.z_unit = "nm"; /* says nothing of an image */
    assert_parse_fails(png.data, png.n, &request, DIF_ERR_SCALE, "give --height-um");
    request = dif_field_request_default();
    request.height_um = 0.1;
    assert_parse_fails(png.data, png.n, &request, DIF_ERR_SCALE,
                       "no lateral scale in it, give --pixel-nm or --size-um");
}

static void test_read__keys_of_gwyddion_give_the_scale(void **state)
{
    (void)state;
    static const char *const TEXTS[] = {"Gwy::XReal", "2e-6", "Gwy::YReal",  "9e-7",    "Gwy::XYUnit", "m",
                                        "Gwy::ZMin",  "-100", "Gwy::ZMax",   "65435",   "Gwy::ZUnit",  "nm",
                                        "Gwy::Title", "scan", "Other::Text", "ignored", NULL};
    const image_sample png = image_png(5, 3, 16, 0, 0, TEXTS);
    dif_field_request request = dif_field_request_default();
    dif_field_file file;
    dif_error err;
    assert_int_equal(parse_bytes(png.data, png.n, NULL, &file, &err), DIF_OK);
    assert_string_equal(file.title, "scan");
    assert_near(file.field.pitch_x_um, 0.4, 4e-16, 0.0);
    assert_near(file.field.pitch_y_um, 0.3, 4e-16, 0.0);
    assert_near(file.step_um, 1e-3, 1e-15, 0.0);
    assert_near(file.field.z_um[0], -0.1 + 7e-3, 0.0, 1e-16); /* offset and one product */
    dif_field_file_free(&file);
    request.height_um = 65.535;
    assert_int_equal(parse_bytes(png.data, png.n, &request, &file, &err), DIF_OK);
    assert_near(file.field.z_um[0], 7e-3, 4e-16, 0.0); /* the offset goes with the scale it belongs to */
    dif_field_file_free(&file);
}

static void test_read__failing_heap_is_said(void **state)
{
    (void)state;
    const dif_field_request request = request_all();
    const image_sample png = image_png(5, 3, 8, 0, 0, NULL);
    assert_true(parse_with_failing_heap(png.data, png.n, &request) >= 2);
}

static void test_colormap__ends_and_names(void **state)
{
    (void)state;
    uint8_t rgb[256][3];
    dif_error err;
    assert_int_equal(dif_image_colormap("gray", rgb, &err), DIF_OK);
    for (int i = 0; i < 256; i++)
        assert_true(rgb[i][0] == i && rgb[i][1] == i && rgb[i][2] == i);
    assert_int_equal(dif_image_colormap("viridis", rgb, &err), DIF_OK);
    assert_in_range(rgb[0][2], 75, 95); /* dark violet to yellow */
    assert_in_range(rgb[0][0], 60, 75);
    assert_in_range(rgb[255][0], 245, 255);
    assert_in_range(rgb[255][2], 25, 45);
    assert_int_equal(dif_image_colormap("inferno", rgb, &err), DIF_OK);
    assert_int_equal(dif_image_colormap("turbo", rgb, &err), DIF_OK);
    assert_int_equal(dif_image_colormap("jet", rgb, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "colour map 'jet', want viridis, inferno, turbo or gray");
}

static void test_encode_png__is_a_whole_png_of_its_size(void **state)
{
    (void)state;
    uint8_t rgb[4 * 2 * 3];
    unsigned char *png = NULL;
    size_t n = 0;
    dif_image_head head;
    dif_image image;
    dif_error err;
    for (int i = 0; i < 24; i++)
        rgb[i] = (uint8_t)(10 * (i / 3));
    assert_int_equal(dif_image_encode_png(rgb, 4, 2, &png, &n, &err), DIF_OK);
    assert_int_equal(dif_image_head_read(png, n, &head, &err), DIF_OK);
    assert_true(head.nx == 4 && head.ny == 2);
    assert_int_equal(dif_image_decode(png, n, &image, &err), DIF_OK);
    for (int i = 0; i < 8; i++)
        assert_int_equal(image.value[i], 10 * i);
    dif_release(image.value);
    dif_release(png);
    rgb[3] = 255; /* red at the second pixel, so that a swap of channels is seen */
    assert_int_equal(dif_image_encode_png(rgb, 4, 2, &png, &n, &err), DIF_OK);
    assert_int_equal(dif_image_decode(png, n, &image, &err), DIF_ERR_FORMAT);
    assert_non_null(strstr(err.text, "first at column 1, row 0"));
    dif_release(png);
    assert_int_equal(dif_image_encode_png(rgb, 0, 2, &png, &n, &err), DIF_ERR_ARG);
    assert_null(png);
}

static void test_resize__averages_areas(void **state)
{
    (void)state;
    float src[6 * 4], dst[3 * 2];
    dif_error err;
    for (int i = 0; i < 24; i++)
        src[i] = (float)(i % 6 + 10 * (i / 6));
    assert_int_equal(dif_image_resize(src, 6, 4, dst, 3, 2, &err), DIF_OK);
    for (int i = 0; i < 6; i++)
        assert_near((double)dst[i], 2.0 * (i % 3) + 0.5 + 10.0 * (2 * (i / 3)) + 5.0, 1e-6, 0.0); /* floats */
    float one = 3.0f, four[4];
    assert_int_equal(dif_image_resize(&one, 1, 1, four, 2, 2, &err), DIF_OK);
    for (int i = 0; i < 4; i++)
        assert_near((double)four[i], 3.0, 1e-6, 0.0);
    assert_int_equal(dif_image_resize(src, 6, 4, dst, 0, 2, &err), DIF_ERR_ARG);
}

enum { CANVAS = 60 };

/* Pixels of a drawn mark that are lit, and where they lie on average. */
static int draw_one(const dif_mark *mark, double *x, double *y)
{
    uint8_t rgb[CANVAS * CANVAS * 3] = {0};
    int n = 0;
    dif_error err;
    assert_int_equal(dif_image_draw(rgb, CANVAS, CANVAS, 1, mark, &err), DIF_OK);
    *x = *y = 0.0;
    for (int i = 0; i < CANVAS * CANVAS; i++)
        if (rgb[3 * i] > 100) {
            n++;
            *x += i % CANVAS;
            *y += i / CANVAS;
        }
    *x /= n;
    *y /= n;
    return n;
}

static void test_draw__marks_lie_where_they_should(void **state)
{
    (void)state;
    double x, y;
    const dif_mark circle = {.kind = DIF_MARK_CIRCLE, .x = 30, .y = 20, .size = 15, .stroke = 1, .rgb = {255, 0, 0}};
    const int n_circle = draw_one(&circle, &x, &y);
    /* about 2 pi r pixels, smoothed: one or two wide; its middle to a twentieth of a pixel */
    assert_in_range(n_circle, 70, 200);
    assert_near(x, 30.0, 0.0, 0.05);
    assert_near(y, 20.0, 0.0, 0.05);
    const dif_mark line = {
        .kind = DIF_MARK_LINE, .x = 10, .y = 10, .x1 = 50, .y1 = 30, .stroke = 1, .rgb = {255, 0, 0}};
    assert_true(draw_one(&line, &x, &y) >= 40);
    assert_near(x, 30.0, 0.0, 0.5);
    assert_near(y, 20.0, 0.0, 0.5);
    dif_mark text = {.kind = DIF_MARK_TEXT,
                     .x = 30,
                     .y = 30,
                     .size = 10,
                     .anchor_x = 0.5,
                     .anchor_y = 0.5,
                     .stroke = 1,
                     .rgb = {255, 255, 255},
                     .text = "H\xC2\xB0H"};
    const int n_text = draw_one(&text, &x, &y);
    assert_true(n_text > 30);
    assert_near(x, 30.0, 0.0, 2.0);
    assert_near(y, 30.0, 0.0, 2.0);
    text.width_max = 12.0;
    assert_true(draw_one(&text, &x, &y) < n_text);
}

static void test_draw__refuses_what_cannot_be_drawn(void **state)
{
    (void)state;
    uint8_t rgb[3] = {0};
    dif_error err;
    const dif_mark good = {.kind = DIF_MARK_CIRCLE, .size = 1, .stroke = 1};
    dif_mark bad[5] = {good, good, good, good, good};
    bad[0].x = NAN;
    bad[1].size = 0.0;
    bad[2].stroke = 0;
    bad[3].kind = DIF_MARK_TEXT; /* without text */
    bad[4].y = 1e9;
    assert_int_equal(dif_image_draw(rgb, 1, 1, 1, &good, &err), DIF_OK);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(dif_image_draw(rgb, 1, 1, 1, bad + i, &err), DIF_ERR_ARG);
        assert_string_equal(err.text, "mark 0 of a picture is not drawable");
    }
    assert_int_equal(dif_image_draw(NULL, 1, 1, 1, &good, &err), DIF_ERR_ARG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decode__png_tiff_bmp_grey_and_colour_that_is_grey),
        cmocka_unit_test(test_decode__refuses_colour_with_the_place),
        cmocka_unit_test(test_decode__refuses_kinds_of_tiff_with_other_values),
        cmocka_unit_test(test_decode__refuses_sizes_that_lie),
        cmocka_unit_test(test_decode__refuses_damaged_files),
        cmocka_unit_test(test_read__every_beginning_is_refused),
        cmocka_unit_test(test_read__full_range_maps_to_the_height_given),
        cmocka_unit_test(test_read__missing_scale_names_the_flags),
        cmocka_unit_test(test_read__keys_of_gwyddion_give_the_scale),
        cmocka_unit_test(test_read__failing_heap_is_said),
        cmocka_unit_test(test_colormap__ends_and_names),
        cmocka_unit_test(test_encode_png__is_a_whole_png_of_its_size),
        cmocka_unit_test(test_resize__averages_areas),
        cmocka_unit_test(test_draw__marks_lie_where_they_should),
        cmocka_unit_test(test_draw__refuses_what_cannot_be_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
