#include "core/stam.h"

#include "core/grating.h"
#include "core/units.h"
#include "near.h"

static const dif_stam BUMPS = {2.5, (double)NAN, 0.5, 16.25};

static void kappa_of(dif_vec3 wi, dif_vec3 wo, double lambda_um, double *kx, double *ky)
{
    *kx = -DIF_TWO_PI / lambda_um * (wi.x + wo.x);
    *ky = -DIF_TWO_PI / lambda_um * (wi.y + wo.y);
}

static void test_power__every_order_of_the_grating_equation_is_bright(void **state)
{
    (void)state;
    const dif_vec3 wi = dif_vec3_from_angles_rad(0.6, 0.9);
    int n = 0;
    for (double lambda_um = 0.38; lambda_um < 0.79; lambda_um += 0.05)
        for (int m = -6; m <= 6; m++) {
            dif_vec3 wo;
            double kx, ky;
            if (!dif_grating_direction(wi, BUMPS.period_um, BUMPS.psi_rad, lambda_um, m, &wo))
                continue;
            kappa_of(wi, wo, lambda_um, &kx, &ky);
            /* sigma dkappa with dkappa ~ 1e-14 of rounding */
            assert_near(dif_stam_power(&BUMPS, kx, ky), 1.0, 1e-12, 0.0);
            n++;
        }
    assert_true(n > 50);
}

static void test_power__line_is_that_of_the_gaussian_window(void **state)
{
    (void)state;
    const double c = cos(BUMPS.psi_rad), s = sin(BUMPS.psi_rad), step = DIF_TWO_PI / BUMPS.period_um;
    for (double off = -0.2; off <= 0.2; off += 0.01) {
        const double want = exp(-pow(BUMPS.sigma_um * off, 2.0));
        const double along = 3.0 * step + off;
        assert_near(dif_stam_power(&BUMPS, c * along, s * along), want, 1e-12, 1e-15);
        /* across the grooves there is only order 0 */
        assert_near(dif_stam_power(&BUMPS, c * step - s * off, s * step + c * off), want, 1e-12, 1e-15);
    }
}

static void test_power__two_periods_make_a_lattice(void **state)
{
    (void)state;
    const dif_stam lattice = {2.0, 3.0, 0.0, 5.0};
    for (int m = -3; m <= 3; m++)
        for (int n = -3; n <= 3; n++) {
            assert_near(dif_stam_power(&lattice, m * DIF_PI, n * DIF_TWO_PI / 3.0), 1.0, 1e-12, 0.0);
            assert_at_most(dif_stam_power(&lattice, (m + 0.5) * DIF_PI, n * DIF_TWO_PI / 3.0), 1e-20);
        }
}

static void test_check__bad_bumps_have_their_codes(void **state)
{
    (void)state;
    dif_stam bad = BUMPS;
    dif_error err;
    bad.period_um = 0.0;
    assert_int_equal(dif_stam_check(&bad, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "a period of 0 um, want > 0");
    bad = BUMPS;
    bad.period_across_um = -1.0;
    assert_int_equal(dif_stam_check(&bad, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "a period of -1 um across, want > 0");
    bad = BUMPS;
    bad.sigma_um = (double)NAN;
    assert_int_equal(dif_stam_check(&bad, &err), DIF_ERR_ARG);
    assert_int_equal(dif_stam_check(&BUMPS, &err), DIF_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_power__every_order_of_the_grating_equation_is_bright),
        cmocka_unit_test(test_power__line_is_that_of_the_gaussian_window),
        cmocka_unit_test(test_power__two_periods_make_a_lattice),
        cmocka_unit_test(test_check__bad_bumps_have_their_codes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
