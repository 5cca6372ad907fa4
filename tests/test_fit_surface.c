#include "bench/fit.h"

#include "core/io/field_io.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "rough.h"

static dif_field make(dif_surface_kind kind, double period_um, double height_um, double psi_deg, int nx, int ny,
                      double pitch_um)
{
    dif_surface surface = dif_surface_default(kind);
    dif_field field;
    surface.period_um = period_um;
    surface.height_um = height_um;
    surface.psi_rad = dif_rad_from_deg(psi_deg);
    surface.nx = nx;
    surface.ny = ny;
    surface.pitch_um = pitch_um;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    return field;
}

static dif_fit_surface_result fit(const dif_field *field, const dif_fit_surface_opts *opts)
{
    dif_fit_surface_result result;
    dif_error err = {DIF_OK, ""};
    if (dif_fit_surface(field, opts, &result, &err) != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(err.status, DIF_OK);
    return result;
}

static void add_noise(dif_field *field, double sd_um)
{
    uint64_t random = 17;
    for (size_t i = 0; i < dif_field_n(field); i++) {
        double sum = -6.0;
        for (int k = 0; k < 12; k++)
            sum += test_random(&random, 0.0, 1.0);
        field->z_um[i] += sd_um * sum;
    }
}

static void test_surface__pure_sine_is_met_exactly(void **state)
{
    (void)state;
    dif_field field = make(DIF_SURFACE_SINE, 0.7321, 0.1, 25.0, 200, 180, 0.05);
    dif_fit_surface_opts opts = dif_fit_surface_opts_default();
    opts.n_harmonic = 1;
    const dif_fit_surface_result r = fit(&field, &opts);
    assert_near(r.period_um, 0.7321, 1e-8, 0.0);
    assert_near(r.psi_rad, dif_rad_from_deg(25.0), 0.0, 1e-8);
    assert_near(r.amplitude_um[0], 0.05, 1e-6, 0.0);
    assert_at_most(r.residual_rms_um, 1e-9);
    dif_field_free(&field);
}

static void test_surface__noisy_gratings_lie_inside_their_uncertainty(void **state)
{
    (void)state;
    const dif_surface_kind kinds[] = {DIF_SURFACE_SINE, DIF_SURFACE_BLAZED, DIF_SURFACE_LAMELLAR, DIF_SURFACE_TRIANGLE};
    const double psi_deg[] = {0.0, 90.0, 30.0, 150.0};
    for (int k = 0; k < 4; k++) {
        dif_field field = make(kinds[k], 0.9137, 0.1, psi_deg[k], 256, 200, 0.04);
        add_noise(&field, 0.01);
        const dif_fit_surface_result r = fit(&field, NULL);
        print_message("%s: %.3f +- %.3f pm off by %.3f pm, %d harmonics\n", dif_surface_kind_name(kinds[k]),
                      1e6 * r.period_um, 1e6 * r.period_uncertainty_um, 1e6 * fabs(r.period_um - 0.9137), r.n_harmonic);
        /* three stated uncertainties, and no uncertainty that says nothing */
        assert_near(r.period_um, 0.9137, 0.0, 3.0 * r.period_uncertainty_um);
        assert_at_most(r.period_uncertainty_um, 1e-3);
        assert_near(sin(r.psi_rad - dif_rad_from_deg(psi_deg[k])), 0.0, 0.0, 1e-3);
        dif_field_free(&field);
    }
}

static void test_surface__drifting_scan_is_given_away_by_its_bands(void **state)
{
    (void)state;
    dif_field field;
    /* the period grows by 1 % from the first row to the last, as a scanner that creeps would make it */
    assert_int_equal(dif_field_create(300, 300, 0.03, 0.03, &field, NULL), DIF_OK);
    for (int iy = 0; iy < 300; iy++)
        for (int ix = 0; ix < 300; ix++)
            field.z_um[iy * 300 + ix] =
                0.05 * sin(DIF_TWO_PI * dif_field_x_um(&field, ix) / (0.5 * (1.0 + 0.01 * iy / 299)));
    const dif_fit_surface_result r = fit(&field, NULL);
    assert_near(r.period_um, 0.5025, 0.0, 0.001);
    /* eight bands, evenly from 0.50 to 0.505: standard deviation 1.53 nm */
    assert_near(r.band_sd_um, 0.00153, 0.1, 0.0);
    assert_true(r.period_scatter_um > 5.0 * r.period_sd_um);
    assert_near(r.period_uncertainty_um, r.period_scatter_um, 0.0, 0.0);
    /* rows go down while y goes up; 299 rows are 8.97 um */
    assert_int_equal(r.drift.n_band, 8);
    assert_near(r.drift.slope, -0.005 / 8.97, 0.02, 0.0);
    assert_near(r.drift.share, -0.01 * 9.0 / 8.97 / 1.005, 0.02, 0.0);
    assert_true(r.drift.is_significant);
    assert_near(r.drift.band[0].y_um, dif_field_y_um(&field, 18), 0.0, 1e-9); /* rows 0 ... 36 */
    assert_near(r.drift.band[0].period_um, 0.5 * (1.0 + 0.01 * 18 / 299), 2e-4, 0.0);
    dif_field_free(&field);
}

static void test_surface__drift_of_a_wave_along_the_slow_axis(void **state)
{
    (void)state;
    /* the wave runs along y and its period from 0.5 um at the bottom to 0.505 um at the top: phase = integral of dy/p */
    dif_field field;
    assert_int_equal(dif_field_create(60, 500, 0.03, 0.03, &field, NULL), DIF_OK);
    const double height_um = 500 * 0.03;
    for (int iy = 0; iy < 500; iy++)
        for (int ix = 0; ix < 60; ix++) {
            const double t = (dif_field_y_um(&field, iy) + 0.5 * height_um) / height_um;
            field.z_um[iy * 60 + ix] = 0.05 * sin(DIF_TWO_PI * height_um / 0.005 * log1p(0.01 * t));
        }
    const dif_fit_surface_result r = fit(&field, NULL);
    assert_int_equal(r.drift.n_band, 8);
    assert_true(r.drift.is_significant);
    /* a band of 4 periods whose period changes within it */
    assert_near(r.drift.slope, 0.005 / height_um, 0.1, 0.0);
    dif_field_free(&field);
}

static void test_surface__steady_scans_show_no_drift(void **state)
{
    (void)state;
    int n_significant = 0;
    for (int k = 0; k < 5; k++) {
        dif_field field = make(DIF_SURFACE_SINE, 0.7 + 0.01 * k, 0.1, 0.3, 200, 200, 0.05);
        add_noise(&field, 0.02);
        const dif_fit_surface_result r = fit(&field, NULL);
        assert_near(r.drift.slope, 0.0, 0.0, 5.0 * r.drift.slope_sd);
        n_significant += r.drift.is_significant;
        dif_field_free(&field);
    }
    assert_true(n_significant <= 1); /* one in a hundred is expected */
}

static void test_surface__direction_of_the_start_chooses_the_wave(void **state)
{
    (void)state;
    dif_field field = make(DIF_SURFACE_SINE, 0.7, 0.1, 6.0, 150, 150, 0.05);
    const dif_field other = make(DIF_SURFACE_SINE, 0.9, 0.08, 96.0, 150, 150, 0.05);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        field.z_um[i] += other.z_um[i];
    dif_fit_surface_opts opts = dif_fit_surface_opts_default();
    assert_near(fit(&field, &opts).period_um, 0.7, 1e-3, 0.0);
    opts.psi_start_rad = dif_rad_from_deg(-84.0);
    assert_near(fit(&field, &opts).period_um, 0.9, 1e-3, 0.0);
    opts.psi_start_rad = (double)INFINITY;
    dif_fit_surface_result r;
    dif_error err;
    assert_int_equal(dif_fit_surface(&field, &opts, &r, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "start direction inf rad, want a finite angle");
    dif_field_free(&field);
    dif_field_free(&(dif_field){.z_um = other.z_um});
}

static void test_surface__measured_gratings(void **state)
{
    (void)state;
    /* no certified period of the first (another harmonic fit gave 287.99 nm, bands scatter by 0.42 nm); the second is
     * synthetic, 315 nm */
    const struct {
        const char *file;
        double period_um, off_um, uncertainty_min_um, uncertainty_max_um;
    } scans[] = {{"afm/bipm_grating.gsf", 0.28799, 0.0003, 0.0001, 0.0005},
                 {"afm/text/gratinglab_synthetic_blazed_scan.txt", 0.315, 0.0001, 0.0, 0.0001}};
    const char *folder = test_data_folder();
    if (!folder)
        skip();
    for (int i = 0; i < 2; i++) {
        const dif_field_request request = dif_field_request_default();
        dif_field_file scan;
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, scans[i].file);
        assert_int_equal(dif_field_read(path, &request, &scan, NULL), DIF_OK);
        const dif_fit_surface_result r = fit(&scan.field, NULL);
        print_message("%s: %.4f nm, covariance %.4f, scatter %.4f\n", scans[i].file, 1e3 * r.period_um,
                      1e3 * r.period_sd_um, 1e3 * r.period_scatter_um);
        assert_near(r.period_um, scans[i].period_um, 0.0, scans[i].off_um);
        assert_near(r.period_um, scans[i].period_um, 0.0, 2.0 * r.period_uncertainty_um);
        assert_true(r.period_uncertainty_um >= scans[i].uncertainty_min_um);
        assert_at_most(r.period_uncertainty_um, scans[i].uncertainty_max_um);
        dif_field_file_free(&scan);
    }
}

static void test_surface__what_is_no_grating_is_refused(void **state)
{
    (void)state;
    dif_fit_surface_result r;
    dif_error err;
    dif_field field;
    assert_int_equal(dif_field_create(64, 64, 0.05, 0.05, &field, NULL), DIF_OK);
    assert_int_equal(dif_fit_surface(&field, NULL, &r, &err), DIF_ERR_FIT);
    dif_field_free(&field);
    field = test_rough_field(128, 128, 0.05, 0.05, 0.2, 4);
    assert_int_equal(dif_fit_surface(&field, NULL, &r, &err), DIF_ERR_FIT);
    assert_near(r.period_um, 0.0, 0.0, 0.0);
    dif_field_free(&field);
    field = make(DIF_SURFACE_SINE, 3.0, 0.1, 0.0, 100, 100, 0.05);
    assert_int_equal(dif_fit_surface(&field, NULL, &r, &err), DIF_ERR_FIT);
    dif_field_free(&field);
    field = make(DIF_SURFACE_SINE, 0.5, 0.1, 0.0, 100, 100, 0.05);
    dif_fit_surface_opts opts = dif_fit_surface_opts_default();
    opts.period_start_um = 2.0;
    assert_int_equal(dif_fit_surface(&field, &opts, &r, &err), DIF_ERR_FIT);
    opts.period_start_um = -1.0;
    assert_int_equal(dif_fit_surface(&field, &opts, &r, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "start period -1 um, want > 0");
    opts = dif_fit_surface_opts_default();
    opts.n_part = 1;
    assert_int_equal(dif_fit_surface(&field, &opts, &r, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "1 parts, want 2 ... 100");
    opts = dif_fit_surface_opts_default();
    opts.n_harmonic = 33;
    assert_int_equal(dif_fit_surface(&field, &opts, &r, &err), DIF_ERR_ARG);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_surface__pure_sine_is_met_exactly),
        cmocka_unit_test(test_surface__noisy_gratings_lie_inside_their_uncertainty),
        cmocka_unit_test(test_surface__drifting_scan_is_given_away_by_its_bands),
        cmocka_unit_test(test_surface__drift_of_a_wave_along_the_slow_axis),
        cmocka_unit_test(test_surface__steady_scans_show_no_drift),
        cmocka_unit_test(test_surface__direction_of_the_start_chooses_the_wave),
        cmocka_unit_test(test_surface__measured_gratings),
        cmocka_unit_test(test_surface__what_is_no_grating_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
