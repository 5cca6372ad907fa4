#include "core/nmm.h"

#include "core/spectrum.h"
#include "near.h"

static dif_nmm make(double extent_um)
{
    return (dif_nmm){
        .extent_um = extent_um, .lambda_min_um = 0.38, .lambda_max_um = 0.78, .n_fixed = 8, .jacobian = true};
}

enum { ROOM = 1024 };

static void test_wavelengths__are_the_bins_that_a_direction_sees(void **state)
{
    (void)state;
    const dif_nmm nmm = make(65.0);
    double lambda[ROOM], weight[ROOM];
    assert_true(dif_nmm_count_max(&nmm) <= ROOM);
    for (double s = 0.15; s <= 2.0; s += 0.03713) {
        const int n = dif_nmm_wavelengths(&nmm, s, lambda, weight);
        const int first = (int)ceil(65.0 * s / 0.78), last = (int)floor(65.0 * s / 0.38);
        assert_int_equal(n, last - first + 1);
        assert_true(n <= dif_nmm_count_max(&nmm));
        for (int i = 0; i < n; i++) {
            assert_near(lambda[i], 65.0 * s / (first + i), 1e-15, 0.0);
            assert_near(weight[i], lambda[i] * lambda[i] / (65.0 * s), 1e-14, 0.0);
        }
    }
}

static void test_wavelengths__integrate_smooth_spectra(void **state)
{
    (void)state;
    const dif_nmm nmm = make(65.0);
    double lambda[ROOM], weight[ROOM];
    for (double s = 0.3; s <= 2.0; s += 0.1) {
        const int n = dif_nmm_wavelengths(&nmm, s, lambda, weight);
        double sum = 0.0;
        for (int i = 0; i < n; i++)
            sum += weight[i] * exp(-pow((lambda[i] - 0.55) / 0.05, 2.0));
        /* a Gaussian of 50 nm sampled every 15 nm or finer */
        assert_near(sum, 0.05 * sqrt(3.14159265358979), 2e-3, 0.0);
    }
}

static void test_wavelengths__fixed_ones_take_over_near_the_mirror_direction(void **state)
{
    (void)state;
    const dif_nmm nmm = make(65.0);
    double lambda[ROOM], weight[ROOM], total = 0.0;
    for (double s = 0.0; s < 0.08; s += 0.01) {
        assert_int_equal(dif_nmm_wavelengths(&nmm, s, lambda, weight), 8);
        assert_near(lambda[0], 0.405, 1e-14, 0.0);
        assert_near(lambda[7], 0.755, 1e-14, 0.0);
    }
    for (int i = 0; i < 8; i++)
        total += weight[i];
    assert_near(total, 0.4, 1e-14, 0.0);
}

static void test_wavelengths__lines_are_the_orders_of_a_period(void **state)
{
    (void)state;
    dif_nmm nmm = make(2.5);
    double lambda[ROOM], weight[ROOM];
    nmm.line_area_per_um = 0.01736;
    /* s = 0.6: 2.5 * 0.6 / m = 1500/m nm, of which m = 2 and 3 are visible */
    assert_int_equal(dif_nmm_wavelengths(&nmm, 0.6, lambda, weight), 2);
    assert_near(lambda[0], 0.75, 1e-14, 0.0);
    assert_near(lambda[1], 0.5, 1e-14, 0.0);
    assert_near(weight[1], 0.25 * 0.01736 / 0.6, 1e-14, 0.0);
    /* below lambda_min/d no order is seen */
    assert_int_equal(dif_nmm_wavelengths(&nmm, 0.15, lambda, weight), 8);
    assert_int_equal(dif_nmm_wavelengths(&nmm, 0.16, lambda, weight), 1);
}

static void test_wavelengths__without_the_jacobian_bins_count_alike(void **state)
{
    (void)state;
    dif_nmm nmm = make(65.0);
    double lambda[ROOM], weight[ROOM];
    nmm.jacobian = false;
    const int n = dif_nmm_wavelengths(&nmm, 1.0, lambda, weight);
    for (int i = 0; i < n; i++)
        assert_near(weight[i], 0.4 / n, 1e-14, 0.0);
}

static void test_nearest__is_one_of_the_wavelengths_and_the_closest(void **state)
{
    (void)state;
    const dif_nmm nmm = make(30.0);
    double lambda[ROOM], weight[ROOM];
    for (double s = 0.0; s <= 1.5; s += 0.05)
        for (double at = 0.38; at < 0.7801; at += 0.013) {
            const int n = dif_nmm_wavelengths(&nmm, s, lambda, weight);
            const double got = dif_nmm_nearest_um(&nmm, s, at);
            double best = 1.0, itself = 1.0;
            for (int i = 0; i < n; i++) {
                best = fmin(best, fabs(lambda[i] - at));
                itself = fmin(itself, fabs(lambda[i] - got));
            }
            assert_at_most(itself, 1e-14);
            /* nearest in n, not in lambda: they differ by less than a fifth of a step */
            assert_at_most(fabs(got - at), best + 0.2 * at * at / fmax(30.0 * s, 0.1));
        }
}

/* XYZ of a mirror by nmm. */
static void white_of(const dif_nmm *nmm, double s, double xyz[3])
{
    double scale[3], lambda[ROOM], weight[ROOM][3];
    assert_int_equal(dif_nmm_scale(scale, NULL), DIF_OK);
    const int n = dif_nmm_weights(nmm, scale, s, lambda, weight);
    xyz[0] = xyz[1] = xyz[2] = 0.0;
    for (int i = 0; i < n; i++)
        for (int c = 0; c < 3; c++)
            xyz[c] += weight[i][c];
}

static void test_weights__a_mirror_is_white(void **state)
{
    (void)state;
    const dif_nmm nmm = make(65.0);
    double white[3], xyz[3];
    dif_spectrum_white(white);
    for (double s = 0.0; s <= 2.0; s += 0.02) {
        white_of(&nmm, s, xyz);
        for (int c = 0; c < 3; c++) /* fixed wavelengths: exactly; bins: up to how finely they sample D65 */
            assert_near(xyz[c], white[c], s < 0.08 ? 1e-12 : s < 0.3 ? 0.08 : 0.01, 0.0);
    }
}

static void test_weights__without_the_jacobian_a_mirror_is_purple(void **state)
{
    (void)state;
    dif_nmm nmm = make(65.0);
    double right[3], wrong[3];
    white_of(&nmm, 1.0, right);
    nmm.jacobian = false;
    white_of(&nmm, 1.0, wrong);
    /* blue gains most, red next to nothing, green is what is missing: (x, y) moves from D65 towards violet */
    const double x = wrong[0] / (wrong[0] + wrong[1] + wrong[2]), y = wrong[1] / (wrong[0] + wrong[1] + wrong[2]);
    assert_true(x < 0.31 && x > 0.25 && y < 0.29);
    assert_true(wrong[2] / right[2] > 1.2 * wrong[1] / right[1]);
}

static void test_check__bad_values_have_their_codes(void **state)
{
    (void)state;
    dif_nmm nmm = make(0.0);
    dif_error err;
    assert_int_equal(dif_nmm_check(&nmm, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "an extent of 0 um, want > 0");
    nmm = make(65.0);
    nmm.n_fixed = 0;
    assert_int_equal(dif_nmm_check(&nmm, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "0 fixed wavelengths, want 1 ... 401");
    nmm = make(65.0);
    nmm.lambda_max_um = 0.38;
    assert_int_equal(dif_nmm_check(&nmm, &err), DIF_ERR_ARG);
    nmm = make(65.0);
    nmm.line_area_per_um = -1.0;
    assert_int_equal(dif_nmm_check(&nmm, &err), DIF_ERR_ARG);
    nmm = make(1e8);
    assert_int_equal(dif_nmm_check(&nmm, &err), DIF_ERR_SIZE);
    nmm = make(65.0);
    assert_int_equal(dif_nmm_check(&nmm, &err), DIF_OK);
}

static void test_bins__are_those_of_the_wavelengths(void **state)
{
    (void)state;
    const dif_nmm nmm = {
        .extent_um = 65.0, .lambda_min_um = 0.38, .lambda_max_um = 0.78, .n_fixed = 8, .jacobian = true};
    static double lambda_um[400], weight_um[400];
    for (double s = 0.0; s <= 2.0; s += 0.01) {
        int first = 0;
        const int bins = dif_nmm_bins(&nmm, s, &first), n = dif_nmm_wavelengths(&nmm, s, lambda_um, weight_um);
        assert_int_equal(n, bins > 0 ? bins : nmm.n_fixed);
        if (bins > 0)
            assert_near(lambda_um[0], nmm.extent_um * s / first, 1e-15, 0.0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_wavelengths__are_the_bins_that_a_direction_sees),
        cmocka_unit_test(test_wavelengths__integrate_smooth_spectra),
        cmocka_unit_test(test_wavelengths__fixed_ones_take_over_near_the_mirror_direction),
        cmocka_unit_test(test_wavelengths__lines_are_the_orders_of_a_period),
        cmocka_unit_test(test_wavelengths__without_the_jacobian_bins_count_alike),
        cmocka_unit_test(test_nearest__is_one_of_the_wavelengths_and_the_closest),
        cmocka_unit_test(test_weights__a_mirror_is_white),
        cmocka_unit_test(test_weights__without_the_jacobian_a_mirror_is_purple),
        cmocka_unit_test(test_check__bad_values_have_their_codes),
        cmocka_unit_test(test_bins__are_those_of_the_wavelengths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
