#include "core/spectrum.h"

#include "near.h"

static void test_white__is_the_sum_of_the_tables(void **state)
{
    (void)state;
    double white[3], sum[3] = {0.0};
    dif_spectrum_white(white);
    for (int nm = 380; nm <= 780; nm++) {
        double bar[3];
        dif_spectrum_observer(nm / 1e3, bar);
        for (int c = 0; c < 3; c++)
            sum[c] += bar[c] * dif_spectrum_d65(nm / 1e3);
    }
    for (int c = 0; c < 3; c++)
        /* what lies below 380 nm adds 2e-4 to Z and 5e-5 to X */
        assert_near(sum[c] / sum[1], white[c], 0.0, 2.5e-4);
}

static void test_weights__a_mirror_is_white_on_any_grid(void **state)
{
    (void)state;
    const double steps_nm[] = {1.0, 5.0, 7.0, 25.0, 100.0};
    double white[3];
    dif_spectrum_white(white);
    for (int s = 0; s < 5; s++) {
        double lambda_um[401], weight[401][3], sum[3] = {0.0};
        int n = 0;
        for (double nm = 380.0; nm <= 780.0; nm += steps_nm[s])
            lambda_um[n++] = nm / 1e3;
        assert_int_equal(dif_spectrum_weights(n, lambda_um, weight, NULL), DIF_OK);
        for (int i = 0; i < n; i++)
            for (int c = 0; c < 3; c++)
                sum[c] += weight[i][c];
        for (int c = 0; c < 3; c++)
            assert_near(sum[c], white[c], 1e-12, 0.0);
    }
}

static void test_weights__uneven_grid_is_the_trapezoid(void **state)
{
    (void)state;
    const double lambda_um[4] = {0.45, 0.5, 0.6, 0.61};
    double weight[4][3], bar[3];
    assert_int_equal(dif_spectrum_weights(4, lambda_um, weight, NULL), DIF_OK);
    const double step[4] = {0.025, 0.075, 0.055, 0.005};
    dif_spectrum_observer(lambda_um[0], bar);
    const double unit = weight[0][1] / (bar[1] * dif_spectrum_d65(lambda_um[0]) * step[0]);
    for (int i = 1; i < 4; i++) {
        dif_spectrum_observer(lambda_um[i], bar);
        assert_near(weight[i][1], unit * bar[1] * dif_spectrum_d65(lambda_um[i]) * step[i], 1e-12, 0.0);
    }
}

static void test_weights__one_line_has_its_own_chromaticity(void **state)
{
    (void)state;
    /* the 550 nm point of the spectrum locus, CIE 1931: x = 0.3016, y = 0.6923 */
    const double line_um[1] = {0.55};
    double weight[1][3];
    assert_int_equal(dif_spectrum_weights(1, line_um, weight, NULL), DIF_OK);
    const double sum = weight[0][0] + weight[0][1] + weight[0][2];
    assert_near(weight[0][0] / sum, 0.3016, 0.0, 1e-4);
    assert_near(weight[0][1] / sum, 0.6923, 0.0, 1e-4);
    assert_near(weight[0][1], 1.0, 1e-12, 0.0);
}

static void test_tables__equal_the_shared_ones(void **state)
{
    (void)state;
    const char *folder = test_data_folder();
    char path[4096], line[200];
    int n = 0;
    if (!folder)
        skip();
    snprintf(path, sizeof path, "%s/cie/cie1931_2deg_1nm.csv", folder);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        double nm, want[3], bar[3];
        if (sscanf(line, "%lf,%lf,%lf,%lf", &nm, want, want + 1, want + 2) != 4 || nm < 380.0 || nm > 780.0)
            continue;
        dif_spectrum_observer(nm / 1e3, bar);
        for (int c = 0; c < 3; c++)
            assert_near(bar[c], want[c], 1e-9, 1e-15);
        n++;
    }
    fclose(file);
    assert_int_equal(n, 401);
}

static void test_weights__bad_grids_are_refused(void **state)
{
    (void)state;
    const double falling[2] = {0.5, 0.4}, infrared[2] = {0.9, 1.0};
    double weight[2][3];
    dif_error err;
    assert_int_equal(dif_spectrum_weights(2, falling, weight, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "wavelengths must ascend: 0.4 um follows 0.5 um");
    assert_int_equal(dif_spectrum_weights(2, infrared, weight, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "no wavelength inside 380 ... 780 nm: nothing to see");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_white__is_the_sum_of_the_tables),
        cmocka_unit_test(test_weights__a_mirror_is_white_on_any_grid),
        cmocka_unit_test(test_weights__uneven_grid_is_the_trapezoid),
        cmocka_unit_test(test_weights__one_line_has_its_own_chromaticity),
        cmocka_unit_test(test_tables__equal_the_shared_ones),
        cmocka_unit_test(test_weights__bad_grids_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
