#include "tests/near.h"

#include "core/window.h"

static const dif_field SCAN = {.nx = 1332, .ny = 1332, .pitch_x_um = 65.0 / 1332, .pitch_y_um = 65.0 / 1332};

static void test_fill__gaussian_around_its_centre(void **state)
{
    (void)state;
    const dif_field field = {.nx = 40, .ny = 30, .pitch_x_um = 0.5, .pitch_y_um = 0.25};
    const dif_window window = {.kind = DIF_WINDOW_GAUSS, .sigma_um = 3.0, .x_um = 1.25, .y_um = -2.0};
    double wx[40], wy[30], sum = 0.0, sum2 = 0.0;
    const dif_window_sums sums = dif_window_fill(&window, &field, wx, wy);
    for (int iy = 0; iy < 30; iy++) {
        for (int ix = 0; ix < 40; ix++) {
            const double dx = dif_field_x_um(&field, ix) - 1.25, dy = dif_field_y_um(&field, iy) + 2.0;
            const double want = exp(-(dx * dx + dy * dy) / (2.0 * 9.0));
            assert_near(wx[ix] * wy[iy], want, 1e-14, 0.0); /* a few roundings of the exponent */
            sum += want;
            sum2 += want * want;
        }
    }
    assert_near(sums.w, sum, 1e-13, 0.0);
    assert_near(sums.w2, sum2, 1e-13, 0.0);
}

static void test_fill__flat_is_one_everywhere(void **state)
{
    (void)state;
    const dif_field field = {.nx = 7, .ny = 5, .pitch_x_um = 0.5, .pitch_y_um = 0.25};
    const dif_window window = {.kind = DIF_WINDOW_FLAT, .sigma_um = NAN, .x_um = NAN, .y_um = NAN}; /* ignored */
    double wx[7], wy[5];
    const dif_window_sums sums = dif_window_fill(&window, &field, wx, wy);
    for (int i = 0; i < 7; i++)
        assert_near(wx[i], 1.0, 0.0, 0.0);
    for (int i = 0; i < 5; i++)
        assert_near(wy[i], 1.0, 0.0, 0.0);
    assert_near(sums.w, 35.0, 0.0, 0.0);
    assert_near(sums.w2, 35.0, 0.0, 0.0);
}

/* Far from its edges the sums are those of the whole Gaussian: 2 pi sigma^2 and pi sigma^2 over the sample's area. */
static void test_fill__wide_patch_has_the_sums_of_a_whole_gaussian(void **state)
{
    (void)state;
    static double wx[1332], wy[1332];
    const dif_window window = {.kind = DIF_WINDOW_GAUSS, .sigma_um = 4.0};
    const dif_window_sums sums = dif_window_fill(&window, &SCAN, wx, wy);
    const double area = SCAN.pitch_x_um * SCAN.pitch_y_um;
    /* cut at 8.1 sigma; the trapezoid of a Gaussian converges beyond double precision at this pitch */
    assert_near(sums.w * area, 2.0 * 3.14159265358979323846 * 16.0, 1e-13, 0.0);
    assert_near(sums.w2 * area, 3.14159265358979323846 * 16.0, 1e-13, 0.0);
}

static void test_tile__modes_without_tiles_have_one_centred_window(void **state)
{
    (void)state;
    dif_window window;
    assert_int_equal(dif_window_tile_count(DIF_WINDOW_GAUSS, 16.25, DIF_AVERAGE_NONE, &SCAN), 1);
    assert_int_equal(dif_window_tile_count(DIF_WINDOW_FLAT, 16.25, DIF_AVERAGE_WELCH, &SCAN), 1);
    dif_window_tile(DIF_WINDOW_GAUSS, 16.25, DIF_AVERAGE_NONE, &SCAN, &window);
    assert_int_equal(window.kind, DIF_WINDOW_GAUSS);
    assert_near(window.x_um, 0.0, 0.0, 0.0);
    assert_near(window.y_um, 0.0, 0.0, 0.0);
    assert_near(window.sigma_um, 16.25, 0.0, 0.0);
    dif_window_tile(DIF_WINDOW_FLAT, 16.25, DIF_AVERAGE_WELCH, &SCAN, &window);
    assert_int_equal(window.kind, DIF_WINDOW_FLAT);
}

static void test_tile__the_scan_has_nine_windows(void **state)
{
    (void)state;
    dif_window windows[9];
    assert_int_equal(dif_window_tile_count(DIF_WINDOW_GAUSS, 16.25, DIF_AVERAGE_WELCH, &SCAN), 9);
    dif_window_tile(DIF_WINDOW_GAUSS, 16.25, DIF_AVERAGE_WELCH, &SCAN, windows);
    static const double at[3] = {-16.25, 0.0, 16.25}; /* 65 um wide: from one sigma inside to one sigma inside */
    for (int i = 0; i < 9; i++) {
        assert_near(windows[i].x_um, at[i % 3], 0.0, 1e-12);
        assert_near(windows[i].y_um, at[i / 3], 0.0, 1e-12);
    }
}

static void test_tile__spacing_symmetry_and_margins_hold_for_any_size(void **state)
{
    (void)state;
    static dif_window windows[40000];
    uint64_t random = 7;
    for (int trial = 0; trial < 200; trial++) {
        const dif_field field = {.nx = 1 + (int)test_random(&random, 0.0, 400.0),
                                 .ny = 1 + (int)test_random(&random, 0.0, 400.0),
                                 .pitch_x_um = test_random(&random, 0.05, 0.5),
                                 .pitch_y_um = test_random(&random, 0.05, 0.5)};
        const double sigma = test_random(&random, 1.0, 30.0);
        const int n = dif_window_tile_count(DIF_WINDOW_GAUSS, sigma, DIF_AVERAGE_WELCH, &field);
        assert_in_range(n, 1, 40000);
        dif_window_tile(DIF_WINDOW_GAUSS, sigma, DIF_AVERAGE_WELCH, &field, windows);
        const double half = 0.5 * field.nx * field.pitch_x_um;
        assert_near(windows[0].x_um, half > sigma ? -(half - sigma) : 0.0, 0.0, 1e-9);
        for (int i = 0; i < n; i++) { /* the centre of the set is the centre of the patch */
            assert_near(windows[i].x_um, -windows[n - 1 - i].x_um, 0.0, 1e-9);
            assert_near(windows[i].y_um, -windows[n - 1 - i].y_um, 0.0, 1e-9);
            if (i > 0 && windows[i].y_um == windows[i - 1].y_um)
                assert_at_most(windows[i].x_um - windows[i - 1].x_um, sigma * (1.0 + 1e-9));
        }
    }
}

static void test_tile__a_tiny_width_stays_countable(void **state)
{
    (void)state;
    const dif_field field = {.nx = 32768, .ny = 32768, .pitch_x_um = 1.0, .pitch_y_um = 1.0};
    const int n = dif_window_tile_count(DIF_WINDOW_GAUSS, 1e-9, DIF_AVERAGE_WELCH, &field);
    assert_int_equal(n, 32769 * 32769); /* never finer than the samples, never over an int */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fill__gaussian_around_its_centre),
        cmocka_unit_test(test_fill__flat_is_one_everywhere),
        cmocka_unit_test(test_fill__wide_patch_has_the_sums_of_a_whole_gaussian),
        cmocka_unit_test(test_tile__modes_without_tiles_have_one_centred_window),
        cmocka_unit_test(test_tile__the_scan_has_nine_windows),
        cmocka_unit_test(test_tile__spacing_symmetry_and_margins_hold_for_any_size),
        cmocka_unit_test(test_tile__a_tiny_width_stays_countable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
