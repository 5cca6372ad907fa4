/* core/io/frame_io: frames as files. */
#define _POSIX_C_SOURCE 200809L /* unlink */

#include "core/io/frame_io.h"

#include <string.h>
#include <unistd.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/file.h"
#include "core/io/image_cv.h"
#include "tests/alloc_count.h"
#include "tests/near.h"

enum { NX = 24, NY = 16 };
static const char EXR[] = "frame_io.test.exr", PNG[] = "frame_io.test.png";

static void make_frame(dif_frame *frame)
{
    assert_int_equal(dif_frame_create(NX, NY, frame, NULL), DIF_OK);
    for (int i = 0; i < NX * NY; i++)
        for (int c = 0; c < 3; c++) {
            frame->coverage[i] = i % NX < NX / 2 ? 1.0F : 0.0F;
            frame->light[3 * i + c] = frame->coverage[i] * 0.001F * (float)(i % 7 + c);
            frame->base[3 * i + c] = frame->coverage[i] * 0.25F;
        }
}

static void test_write__exr_holds_the_exposed_numbers(void **state)
{
    (void)state;
    dif_frame frame;
    dif_manifest manifest = {0};
    unsigned char *data = NULL;
    size_t n = 0;
    float *red = NULL, *alpha = NULL;
    char found[DIF_EXR_CHANNEL_SIZE];
    dif_exr *exr = NULL;
    dif_frame_look look = dif_frame_look_default();
    look.exposure = 40.0;
    make_frame(&frame);
    assert_int_equal(dif_manifest_set(&manifest, "method", "lut", NULL), DIF_OK);
    assert_int_equal(dif_frame_write(EXR, &frame, &look, &manifest, NULL), DIF_OK);
    assert_int_equal(dif_file_read(EXR, 1 << 20, &data, &n, NULL), DIF_OK);
    const dif_source source = dif_source_of(data, n, EXR);
    assert_int_equal(dif_exr_open(&source, &exr, NULL), DIF_OK);
    assert_string_equal(dif_exr_text(exr, "diffbench.method"), "lut");
    assert_int_equal(dif_exr_read_channel(exr, "R", &red, found, NULL), DIF_OK);
    assert_int_equal(dif_exr_read_channel(exr, "A", &alpha, found, NULL), DIF_OK);
    for (int i = 0; i < NX * NY; i++) {
        assert_near((double)red[i], 40.0 * (double)frame.light[3 * i] + (double)frame.base[3 * i], 1e-6, 0.0);
        assert_near((double)alpha[i], (double)frame.coverage[i], 0.0, 0.0);
    }
    dif_exr_close(exr);
    dif_release(red);
    dif_release(alpha);
    dif_release(data);
    dif_manifest_free(&manifest);
    dif_frame_free(&frame);
    unlink(EXR);
}

static void test_texture__comes_back_from_a_picture(void **state)
{
    (void)state;
    dif_frame frame;
    dif_texture texture;
    uint8_t rgb[NX * NY * 3];
    const dif_frame_look look = {.exposure = 40.0, .gamut = DIF_GAMUT_CLIP, .ground = 0.5};
    make_frame(&frame);
    dif_frame_paint(&frame, &look, rgb);
    assert_int_equal(dif_frame_write_png(PNG, &frame, &look, NULL, NULL), DIF_OK);
    assert_int_equal(dif_texture_load(PNG, &texture, NULL), DIF_OK);
    assert_int_equal(texture.nx, NX);
    assert_int_equal(texture.ny, NY);
    for (int i = 0; i < NX * NY * 3; i++) {
        const double shown = frame.coverage[i / 3] > 0.0F ? 40.0 * (double)frame.light[i] + 0.25 : 0.5;
        /* half a step of 8 bits, encoded */
        assert_near((double)texture.rgb[i], shown, 0.01, 0.0);
        assert_near(rgb[i] / 255.0, dif_colour_encode((double)texture.rgb[i]), 0.0, 1e-6);
    }
    dif_texture_free(&texture);
    dif_frame_free(&frame);
    unlink(PNG);
}

static void test_sheet__shows_every_cell(void **state)
{
    (void)state;
    dif_frame frame;
    dif_texture sheet;
    const dif_frame_look look = dif_frame_look_default();
    make_frame(&frame);
    const dif_sheet_cell cells[3] = {
        {&frame, 1.0, "one", "first"}, {&frame, 40.0, "two", NULL}, {&frame, 80.0, NULL, NULL}};
    assert_int_equal(dif_frame_write_sheet(PNG, 3, cells, 2, &look, NULL, NULL), DIF_OK);
    assert_int_equal(dif_texture_load(PNG, &sheet, NULL), DIF_OK);
    assert_int_equal(sheet.nx, 2 * (NX + 8) + 8);
    assert_int_equal(sheet.ny, 2 * (NY + 40) + 8);
    /* the pixel with i % 7 = 3 of each cell, red */
    for (int k = 0; k < 3; k++) {
        const int x = 8 + k % 2 * (NX + 8) + 3, y = 8 + k / 2 * (NY + 40);
        const double want = cells[k].exposure * 0.003 + 0.25;
        assert_near((double)sheet.rgb[3 * (y * sheet.nx + x)], want, 0.02, 0.0);
    }
    dif_texture_free(&sheet);
    dif_frame_free(&frame);
    unlink(PNG);
}

static void test_load__refuses_what_is_no_picture(void **state)
{
    (void)state;
    dif_error err;
    dif_texture texture;
    assert_int_equal(dif_texture_load("none.png", &texture, &err), DIF_ERR_IO);
    assert_non_null(strstr(err.text, "none.png"));
    assert_int_equal(dif_texture_load("README.md", &texture, &err), DIF_ERR_FORMAT);
    assert_non_null(strstr(err.text, "README.md: "));
    assert_null(texture.rgb);
}

static void test_write__gives_everything_back(void **state)
{
    (void)state;
    dif_frame frame;
    const dif_frame_look look = dif_frame_look_default();
    make_frame(&frame);
    const dif_sheet_cell cell = {&frame, 1.0, "one", NULL};
    const int live = test_alloc_live();
    for (int k = 1; k <= 3; k++) {
        test_alloc_fail_from(k);
        const dif_status status = dif_frame_write_sheet(PNG, 1, &cell, 1, &look, NULL, NULL);
        const dif_status exr = dif_frame_write(EXR, &frame, &look, NULL, NULL);
        test_alloc_fail_from(0);
        assert_int_equal(status, DIF_ERR_NOMEM);
        assert_int_not_equal(exr, DIF_OK);
        assert_int_equal(test_alloc_live(), live);
    }
    dif_frame_free(&frame);
    assert_int_not_equal(access(PNG, F_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_write__exr_holds_the_exposed_numbers),
        cmocka_unit_test(test_texture__comes_back_from_a_picture),
        cmocka_unit_test(test_sheet__shows_every_cell),
        cmocka_unit_test(test_load__refuses_what_is_no_picture),
        cmocka_unit_test(test_write__gives_everything_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
