#include "tests/near.h"

#include <string.h>

#include "bench/energy.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "tests/alloc_count.h"

static dif_field make(dif_surface_kind kind, int n, double pitch_um)
{
    dif_surface surface = dif_surface_default(kind);
    surface.nx = surface.ny = n;
    surface.pitch_um = pitch_um;
    dif_field field;
    dif_error err;
    assert_int_equal(dif_surface_make(&surface, &field, &err), DIF_OK);
    return field;
}

static double albedo_of(const dif_field *field, double theta_deg, double phi_deg, double lambda_um,
                        const dif_measure_opts *opts)
{
    double albedo;
    dif_error err = {0};
    const dif_vec3 wi = dif_vec3_from_angles_rad(dif_rad_from_deg(theta_deg), dif_rad_from_deg(phi_deg));
    const dif_status status = dif_energy_albedo(field, wi, lambda_um, 1e-6, opts, &albedo, &err);
    if (status)
        print_error("%s\n", err.text);
    assert_int_equal(status, DIF_OK);
    return albedo;
}

/* A flat mirror returns R of the angle of incidence. The window dies inside the patch (4 sigma to each side), so that the
 * lobe has no tails, but it has a width, and f varies over it: by its second derivative times the lobe's variance
 * (lambda/(2 pi sigma))^2/2 = 1.5e-5. This is 4e-4 of R at 60 degrees. */
static void test_albedo__flat_mirror_returns_r(void **state)
{
    (void)state;
    dif_field field = make(DIF_SURFACE_FLAT, 512, 0.25);
    dif_measure_opts opts = dif_measure_opts_default();
    opts.sigma_um = 16.0;
    static const double angles[][2] = {{0.0, 0.0}, {45.0, 37.0}, {60.0, 90.0}};
    for (int i = 0; i < 3; i++) {
        const double want = dif_fresnel_schlick(opts.index, cos(dif_rad_from_deg(angles[i][0])));
        const double got = albedo_of(&field, angles[i][0], angles[i][1], 0.55, &opts);
        print_message("theta %g deg, R = %.6f: integral / R - 1 = %.2g\n", angles[i][0], want, got / want - 1.0);
        assert_near(got, want, 1e-3, 0.0);
    }
    dif_field_free(&field);
}

/* At 75 degrees f varies ten times faster, so the integral goes to R as 1/sigma^2: two widths give the limit. */
static void test_albedo__flat_mirror_near_grazing_tends_to_r(void **state)
{
    (void)state;
    dif_field field = make(DIF_SURFACE_FLAT, 512, 0.25);
    static const dif_index indices[] = {{1.5, 0.0}, {0.05, 4.0}};
    for (int k = 0; k < 2; k++) {
        dif_measure_opts opts = dif_measure_opts_default();
        opts.index = indices[k];
        opts.sigma_um = 12.0;
        const double narrow = albedo_of(&field, 75.0, 200.0, 0.55, &opts);
        opts.sigma_um = 16.0;
        const double wide = albedo_of(&field, 75.0, 200.0, 0.55, &opts);
        const double want = dif_fresnel_schlick(indices[k], cos(dif_rad_from_deg(75.0)));
        const double limit = (256.0 * wide - 144.0 * narrow) / (256.0 - 144.0);
        print_message("theta 75 deg, R = %.6f: integral / R - 1 = %.2g, %.2g, limit %.2g\n", want, narrow / want - 1.0,
                      wide / want - 1.0, limit / want - 1.0);
        assert_near(limit, want, 1e-3, 0.0);
    }
    dif_field_free(&field);
}

/* The integral of a grating's BRDF is the sum of its orders' efficiencies: two ways that share only the gain. */
static void test_albedo__sine_grating_returns_its_order_sum(void **state)
{
    (void)state;
    dif_field field = make(DIF_SURFACE_SINE, 400, 0.2);
    dif_measure_opts opts = dif_measure_opts_default();
    opts.sigma_um = 10.0;
    opts.index = (dif_index){1.0, 1e5}; /* reflects all but 4e-10 at any angle */
    const dif_grating grating = {DIF_PROFILE_SINE, 2.5, 0.25, 0.5, 0.0};
    static const double theta_deg[] = {0.0, 30.0, -40.0};
    for (int i = 0; i < 3; i++) {
        const dif_vec3 wi = dif_vec3_from_angles_rad(dif_rad_from_deg(theta_deg[i]), 0.0);
        const double want = dif_energy_order_sum(&grating, wi, 0.55);
        const double got = albedo_of(&field, theta_deg[i], 0.0, 0.55, &opts);
        print_message("theta %g deg: integral %.5f, orders %.5f\n", theta_deg[i], got, want);
        assert_near(got, want, 1e-3,
                    0.0); /* the orders stay 30 degrees off the rim; what is left is the width of their lobes */
    }
    dif_field_free(&field);
}

static void test_order_sum__one_for_a_mirror_and_reported_as_it_is(void **state)
{
    (void)state;
    dif_grating grating = {DIF_PROFILE_SINE, 2.5, 0.0, 0.5, 0.3};
    for (double theta = -1.3; theta < 1.4; theta += 0.2)
        assert_near(dif_energy_order_sum(&grating, dif_vec3_from_angles_rad(theta, 1.0), 0.5), 1.0, 1e-12, 0.0);
    /* a deep one at grazing incidence is far from 1, and is not rescaled */
    grating.height_um = 0.25;
    grating.psi_rad = 0.0;
    const double sum = dif_energy_order_sum(&grating, dif_vec3_from_angles_rad(dif_rad_from_deg(75.0), 0.0), 0.4);
    assert_near(sum, 1.259, 0.0, 1e-3); /* sum of eff_stam of the tabulated orders */
    assert_near(dif_energy_order_sum(&grating, (dif_vec3){0.6, 0.0, -0.8}, 0.4), 0.0, 0.0, 0.0);
}

static void test_albedo__refuses_with_reasons(void **state)
{
    (void)state;
    dif_field field = make(DIF_SURFACE_FLAT, 16, 0.1);
    const dif_vec3 up = {0.0, 0.0, 1.0}, down = {0.0, 0.0, -1.0};
    double albedo = 7.0;
    dif_error err;
    assert_int_equal(dif_energy_albedo(&field, down, 0.5, 1e-6, NULL, &albedo, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "incident direction with cosine -1, want a cosine > 0");
    assert_near(albedo, 0.0, 0.0, 0.0);
    assert_int_equal(dif_energy_albedo(&field, up, 0.0, 1e-6, NULL, &albedo, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "wavelength 0 nm, want a finite number > 0");
    assert_int_equal(dif_energy_albedo(&field, up, 0.5, 0.0, NULL, &albedo, &err), DIF_ERR_TOL);
    field.pitch_x_um = field.pitch_y_um = 100.0; /* 1.6 mm wide */
    dif_measure_opts opts = dif_measure_opts_default();
    opts.window = DIF_WINDOW_FLAT;
    assert_int_equal(dif_energy_albedo(&field, up, 0.5, 1e-6, &opts, &albedo, &err), DIF_ERR_SIZE);
    assert_non_null(strstr(err.text, "energy integral needs 4.1e+08 directions, want at most 4e+06: a smaller patch"));
    dif_field_free(&field);
}

static void test_albedo__alloc_failing_leaves_nothing_behind(void **state)
{
    (void)state;
    dif_field field = make(DIF_SURFACE_FLAT, 16, 0.1);
    const dif_vec3 up = {0.0, 0.0, 1.0};
    double albedo;
    dif_error err;
    test_alloc_fail_from(0);
    assert_int_equal(dif_energy_albedo(&field, up, 0.5, 1e-6, NULL, &albedo, &err), DIF_OK);
    const int n_call = test_alloc_calls();
    for (int k = 1; k <= n_call; k++) {
        test_alloc_fail_from(k);
        assert_int_equal(dif_energy_albedo(&field, up, 0.5, 1e-6, NULL, &albedo, &err), DIF_ERR_NOMEM);
        assert_near(albedo, 0.0, 0.0, 0.0);
        assert_int_equal(test_alloc_live(), 1);
    }
    test_alloc_fail_from(0);
    dif_field_free(&field);
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_albedo__flat_mirror_returns_r),
        cmocka_unit_test(test_albedo__flat_mirror_near_grazing_tends_to_r),
        cmocka_unit_test(test_albedo__sine_grating_returns_its_order_sum),
        cmocka_unit_test(test_order_sum__one_for_a_mirror_and_reported_as_it_is),
        cmocka_unit_test(test_albedo__refuses_with_reasons),
        cmocka_unit_test(test_albedo__alloc_failing_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
