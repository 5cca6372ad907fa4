/* bench/filter_study: differences of frames. */
#include "bench/filter_study.h"

#include "tests/alloc_count.h"
#include "tests/near.h"

enum { NX = 12, NY = 10 };

static void make_frame(float level, dif_frame *frame)
{
    assert_int_equal(dif_frame_create(NX, NY, frame, NULL), DIF_OK);
    for (int i = 0; i < NX * NY; i++) {
        frame->coverage[i] = i % NX < 8 ? 1.0F : 0.5F;
        for (int c = 0; c < 3; c++)
            frame->light[3 * i + c] = level;
    }
}

static void test_differ__greys_are_their_lightness_apart(void **state)
{
    (void)state;
    dif_frame a, b;
    dif_frame_difference d;
    float map[NX * NY];
    make_frame(0.1842F, &a); /* L* = 50 */
    make_frame(0.1842F, &b);
    assert_int_equal(dif_frame_differ(&a, &b, 1.0, map, &d, NULL), DIF_OK);
    assert_int_equal(d.n, 8 * NY);
    assert_near(d.worst, 0.0, 0.0, 1e-9);
    assert_near(d.light_ratio, 1.0, 1e-12, 0.0);
    for (int i = 0; i < NX * NY * 3; i++)
        b.light[i] *= 2.0F;
    assert_int_equal(dif_frame_differ(&a, &b, 1.0, map, &d, NULL), DIF_OK);
    /* L* = 116 cbrt(0.3684) - 16 = 67.16; S_L at the mean of 58.58 is 1.116 */
    assert_near(d.median, 15.37, 0.01, 0.0);
    assert_near(d.mean, d.median, 1e-5, 0.0);
    assert_near(d.p95, d.median, 1e-5, 0.0);
    assert_near(d.blurred_mean, d.median, 1e-5, 0.0);
    assert_near(d.light_ratio, 0.5, 1e-6, 0.0);
    assert_near((double)map[0], d.median, 1e-5, 0.0);
    assert_near((double)map[NX - 1], 0.0, 0.0, 0.0);
    dif_frame_free(&a);
    dif_frame_free(&b);
}

static void test_differ__a_blur_forgives_noise(void **state)
{
    (void)state;
    dif_frame a, b;
    dif_frame_difference d;
    make_frame(0.2F, &a);
    make_frame(0.2F, &b);
    for (int i = 0; i < NX * NY; i++)
        for (int c = 0; c < 3; c++)
            b.light[3 * i + c] = (i % NX + i / NX) % 2 ? 0.1F : 0.3F;
    assert_int_equal(dif_frame_differ(&a, &b, 1.0, NULL, &d, NULL), DIF_OK);
    assert_at_most(8.0, d.mean);
    assert_at_most(d.blurred_mean, 0.3 * d.mean);
    dif_frame_free(&a);
    dif_frame_free(&b);
}

static void test_differ__refuses_other_sizes_and_no_memory(void **state)
{
    (void)state;
    dif_frame a, b;
    dif_frame_difference d;
    dif_error err;
    make_frame(0.2F, &a);
    assert_int_equal(dif_frame_create(NX, NY + 1, &b, NULL), DIF_OK);
    assert_int_equal(dif_frame_differ(&a, &b, 1.0, NULL, &d, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "frames of 12 x 10 and 12 x 11 pixels");
    test_alloc_fail_from(1);
    assert_int_equal(dif_frame_differ(&a, &a, 1.0, NULL, &d, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    dif_frame_free(&a);
    dif_frame_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_differ__greys_are_their_lightness_apart),
        cmocka_unit_test(test_differ__a_blur_forgives_noise),
        cmocka_unit_test(test_differ__refuses_other_sizes_and_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
