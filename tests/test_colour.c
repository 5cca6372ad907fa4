#include "core/colour.h"

#include "core/spectrum.h"
#include "near.h"

static void test_difference_2000__published_pairs(void **state)
{
    (void)state;
    FILE *file = fopen("fixtures/expected/ciede2000.csv", "r");
    char line[200];
    int n = 0;
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        double a[3], b[3], want;
        if (sscanf(line, "%lf,%lf,%lf,%lf,%lf,%lf,%lf", a, a + 1, a + 2, b, b + 1, b + 2, &want) != 7)
            continue;
        /* published to four decimals */
        assert_near(dif_colour_difference_2000(a, b), want, 0.0, 5.001e-5);
        assert_near(dif_colour_difference_2000(b, a), want, 0.0, 5.001e-5);
        n++;
    }
    fclose(file);
    assert_int_equal(n, 34);
}

static void test_matrices__are_inverse_and_white_is_white(void **state)
{
    (void)state;
    double white[3], rgb[3], back[3];
    dif_spectrum_white(white);
    dif_colour_rgb_from_xyz(white, rgb);
    for (int c = 0; c < 3; c++)
        assert_near(rgb[c], 1.0, 0.0, 1e-6);
    dif_colour_xyz_from_rgb(rgb, back);
    for (int c = 0; c < 3; c++)
        assert_near(back[c], white[c], 1e-9, 0.0);
}

static void test_curve__inverts_and_has_its_landmarks(void **state)
{
    (void)state;
    for (int i = 0; i <= 255; i++)
        assert_near(dif_colour_encode(dif_colour_decode(i / 255.0)), i / 255.0, 0.0, 1e-7);
    assert_near(dif_colour_encode(0.18), 0.4613561, 0.0, 1e-6);
    assert_near(dif_colour_encode(1.0), 1.0, 0.0, 1e-15);
}

static void test_gamut__desaturating_keeps_the_luminance(void **state)
{
    (void)state;
    double rgb[3] = {-0.2, 0.5, 0.3}, clipped[3] = {-0.2, 0.5, 1.3}, before[3], after[3];
    dif_colour_xyz_from_rgb(rgb, before);
    dif_colour_fit_gamut(DIF_GAMUT_DESATURATE, rgb);
    dif_colour_xyz_from_rgb(rgb, after);
    /* the two matrices are inverse to ten digits */
    assert_near(after[1], before[1], 1e-9, 0.0);
    assert_near(rgb[0], 0.0, 0.0, 1e-15);
    dif_colour_fit_gamut(DIF_GAMUT_CLIP, clipped);
    assert_near(clipped[0], 0.0, 0.0, 0.0);
    assert_near(clipped[1], 0.5, 0.0, 0.0);
    assert_near(clipped[2], 1.0, 0.0, 0.0);
    double black[3] = {-0.1, -0.1, -0.1};
    dif_colour_fit_gamut(DIF_GAMUT_DESATURATE, black);
    for (int c = 0; c < 3; c++)
        assert_near(black[c], 0.0, 0.0, 1e-15);
}

static void test_pixel__white_grey_and_exposure(void **state)
{
    (void)state;
    double xyz[3];
    uint8_t rgb[3];
    dif_spectrum_white(xyz);
    dif_colour_pixel(xyz, 1.0, DIF_GAMUT_CLIP, rgb);
    for (int c = 0; c < 3; c++)
        assert_int_equal(rgb[c], 255);
    dif_colour_pixel(xyz, 0.18, DIF_GAMUT_CLIP, rgb);
    for (int c = 0; c < 3; c++)
        assert_in_range(rgb[c], 117, 118);
}

static void test_lab__of_white_and_grey(void **state)
{
    (void)state;
    double xyz[3], lab[3];
    dif_spectrum_white(xyz);
    dif_colour_lab_from_xyz(xyz, lab);
    assert_near(lab[0], 100.0, 0.0, 1e-12);
    assert_near(hypot(lab[1], lab[2]), 0.0, 0.0, 1e-12);
    for (int c = 0; c < 3; c++)
        xyz[c] *= 0.001;
    dif_colour_lab_from_xyz(xyz, lab);
    assert_near(lab[0], 0.9033, 0.0, 1e-4); /* the straight start: 903.3 Y */
}

static void test_gamut__names_go_both_ways(void **state)
{
    (void)state;
    dif_gamut gamut;
    assert_true(dif_gamut_from_name("desaturate", &gamut));
    assert_string_equal(dif_gamut_name(gamut), "desaturate");
    assert_false(dif_gamut_from_name("vivid", &gamut));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_difference_2000__published_pairs),
        cmocka_unit_test(test_matrices__are_inverse_and_white_is_white),
        cmocka_unit_test(test_curve__inverts_and_has_its_landmarks),
        cmocka_unit_test(test_gamut__desaturating_keeps_the_luminance),
        cmocka_unit_test(test_pixel__white_grey_and_exposure),
        cmocka_unit_test(test_lab__of_white_and_grey),
        cmocka_unit_test(test_gamut__names_go_both_ways),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
