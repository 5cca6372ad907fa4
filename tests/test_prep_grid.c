/* Preparation that moves samples: filling, resampling, rotation, high-pass, whole periods. */
#include "bench/fit.h"
#include "core/fft.h"
#include "core/prep.h"
#include "core/units.h"
#include "prep_field.h"
#include "rough.h"

/* A wave of amplitude 1 um. */
typedef struct wave {
    double period_um, psi_rad, phase;
} wave;

static double wave_at(const wave *w, double x_um, double y_um)
{
    return cos(DIF_TWO_PI * (x_um * cos(w->psi_rad) + y_um * sin(w->psi_rad)) / w->period_um + w->phase);
}

static dif_field make(const wave *w, int nx, int ny, double pitch_x_um, double pitch_y_um)
{
    dif_field field = blank(nx, ny, pitch_x_um, pitch_y_um);
    for (int iy = 0; iy < ny; iy++)
        for (int ix = 0; ix < nx; ix++)
            *at(&field, ix, iy) = wave_at(w, dif_field_x_um(&field, ix), dif_field_y_um(&field, iy));
    return field;
}

/* Largest difference from a wave, `margin` samples from the edges. */
static double off_wave(const dif_field *field, const wave *w, int margin)
{
    double most = 0.0;
    for (int iy = margin; iy < field->ny - margin; iy++)
        for (int ix = margin; ix < field->nx - margin; ix++)
            most =
                fmax(most, fabs(*at(field, ix, iy) - wave_at(w, dif_field_x_um(field, ix), dif_field_y_um(field, iy))));
    return most;
}

static void make_hole(dif_field *field, double ix0, double iy0, double radius)
{
    for (int iy = 0; iy < field->ny; iy++)
        for (int ix = 0; ix < field->nx; ix++)
            if (hypot(ix - ix0, iy - iy0) <= radius)
                *at(field, ix, iy) = (double)NAN;
}

static void test_fill__smooth_surface_comes_back(void **state)
{
    (void)state;
    /* a wave of 40 samples; holes of 7, 13 and 21 samples across, one of them at an edge */
    const wave w = {40.0, 0.4, 0.2};
    const struct {
        double radius, allowed;
    } holes[] = {{3.0, 0.005}, {6.0, 0.06}, {10.0, 0.4}};
    for (int k = 0; k < 3; k++) {
        dif_field field = make(&w, 90, 80, 1.0, 1.0);
        dif_prep_filled filled;
        make_hole(&field, 40.0, 40.0, holes[k].radius);
        assert_int_equal(dif_prep_fill(&field, DIF_FILL_PLATE, &filled, NULL), DIF_OK);
        assert_int_equal(dif_prep_state_of(&field).n_missing, 0);
        const double off = off_wave(&field, &w, 0);
        print_message("hole of radius %g: off by %.3g, reach %d, residual %.2g\n", holes[k].radius, off, filled.reach,
                      filled.residual);
        /* least bending of a wave: (pi radius / period)^4, times a factor near 1/3 */
        assert_at_most(off, holes[k].allowed);
        assert_at_most(filled.residual, 1e-9);
        assert_int_equal(filled.reach, (int)holes[k].radius + 1);
        dif_field_free(&field);
    }
}

static void test_fill__plane_comes_back_exactly_whatever_is_missing(void **state)
{
    (void)state;
    uint64_t random = 11;
    for (int k = 0; k < 4; k++) {
        dif_field field = blank(130, 70, 0.03, 0.05), want = blank(130, 70, 0.03, 0.05);
        dif_prep_filled filled;
        for (int iy = 0; iy < 70; iy++)
            for (int ix = 0; ix < 130; ix++)
                *at(&want, ix, iy) = *at(&field, ix, iy) = 100.0 + 0.3 * ix - 0.2 * iy;
        if (k == 0)
            for (size_t i = 0; i < dif_field_n(&field); i++) /* two thirds, at random */
                field.z_um[i] = test_random(&random, 0.0, 3.0) < 2.0 ? (double)NAN : field.z_um[i];
        if (k == 1)
            make_hole(&field, 0.0, 0.0, 40.0); /* a corner */
        if (k == 2)
            for (int iy = 40; iy < 70; iy++) /* a scan that was broken off */
                for (int ix = 0; ix < 130; ix++)
                    *at(&field, ix, iy) = (double)NAN;
        if (k == 3)
            make_hole(&field, 60.0, 35.0, 30.0);
        const dif_field before = field;
        assert_int_equal(dif_prep_fill(&field, DIF_FILL_PLATE, &filled, NULL), DIF_OK);
        assert_true(before.z_um != field.z_um);
        double off = 0.0;
        for (size_t i = 0; i < dif_field_n(&field); i++)
            off = fmax(off, fabs(field.z_um[i] - want.z_um[i]));
        print_message("plane, case %d: off by %.3g, residual %.2g\n", k, off, filled.residual);
        assert_at_most(
            off, 1e-5); /* of heights that range over 50 um: the solver's residual, amplified by the hole's size */
        dif_field_free(&field);
        dif_field_free(&want);
    }
}

static void test_fill__laplace_keeps_between_the_rim(void **state)
{
    (void)state;
    dif_field field = test_rough_field(60, 50, 0.05, 0.02, 0.2, 9);
    make_hole(&field, 30.0, 20.0, 9.0);
    for (int ix = 0; ix < 60; ix++)
        *at(&field, ix, 49) = (double)NAN;
    assert_int_equal(dif_prep_fill(&field, DIF_FILL_LAPLACE, NULL, NULL), DIF_OK);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        assert_true(field.z_um[i] >= 0.1 - 1e-9 && field.z_um[i] <= 0.3 + 1e-9);
    /* under a row's end there is only the row before */
    dif_field row = blank(20, 12, 1.0, 1.0);
    for (int ix = 0; ix < 20; ix++)
        *at(&row, ix, 11) = (double)NAN;
    for (int iy = 0; iy < 11; iy++)
        for (int ix = 0; ix < 20; ix++)
            *at(&row, ix, iy) = 0.5;
    assert_int_equal(dif_prep_fill(&row, DIF_FILL_LAPLACE, NULL, NULL), DIF_OK);
    for (size_t i = 0; i < dif_field_n(&row); i++)
        assert_near(row.z_um[i], 0.5, 0.0, 1e-12);
    dif_field_free(&row);
    dif_field_free(&field);
}

static void test_fill__measured_points_keep_their_bits(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 40, 1.0, 1.0, 0.2, 2), want = test_rough_field(40, 40, 1.0, 1.0, 0.2, 2);
    make_hole(&field, 12.0, 12.0, 4.0);
    make_hole(&want, 12.0, 12.0, 4.0);
    assert_int_equal(dif_prep_fill(&field, DIF_FILL_PLATE, NULL, NULL), DIF_OK);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        if (isfinite(want.z_um[i]))
            assert_near(field.z_um[i], want.z_um[i], 0.0, 0.0);
    dif_field_free(&field);
    dif_field_free(&want);
}

static void test_resample__band_limited_sine_to_the_stated_error(void **state)
{
    (void)state;
    const double pitches_um[] = {0.31, 0.77, 1.0, 1.9, 3.3};
    for (int k = 0; k < 5; k++) {
        const double to_um = pitches_um[k];
        const wave w = {fmax(8.0, 4.0 * to_um), 0.0, 0.7}; /* 8 samples a period, or 4 new ones */
        dif_field field = make(&w, 200, 80, 1.0, 1.0);
        assert_int_equal(dif_prep_resample(&field, to_um, to_um, NULL), DIF_OK);
        assert_int_equal(field.nx, (int)(200 / to_um));
        assert_near(field.pitch_y_um, to_um, 0.0, 0.0);
        const double off = off_wave(&field, &w, to_um > 1.0 ? 9 : (int)(17.0 / to_um));
        print_message("to a pitch of %g: off by %.3g\n", to_um, off);
        assert_at_most(off, to_um > 1.0 ? 2e-4 : 2.5 * pow(1.0 / 7.0, 6.0));
        dif_field_free(&field);
    }
}

static void test_resample__coarser_pitch_does_not_alias(void **state)
{
    (void)state;
    const wave w = {2.5, 0.3, 0.7}; /* cannot be seen at a pitch of 4 */
    dif_field field = make(&w, 200, 120, 1.0, 1.0);
    assert_int_equal(dif_prep_resample(&field, 4.0, 4.0, NULL), DIF_OK);
    double most = 0.0;
    for (int iy = 9; iy < field.ny - 9; iy++)
        for (int ix = 9; ix < field.nx - 9; ix++)
            most = fmax(most, fabs(*at(&field, ix, iy)));
    assert_at_most(most, 2e-4); /* side lobes of -80 dB, two axes */
    dif_field_free(&field);
}

static void test_resample__plane_is_kept_to_its_edges(void **state)
{
    (void)state;
    const double pitches_um[] = {0.4, 2.5};
    for (int k = 0; k < 2; k++) {
        dif_field field = blank(50, 40, 1.0, 0.8);
        for (int iy = 0; iy < 40; iy++)
            for (int ix = 0; ix < 50; ix++)
                *at(&field, ix, iy) = 7.0 + 0.3 * dif_field_x_um(&field, ix) - 0.2 * dif_field_y_um(&field, iy);
        assert_int_equal(dif_prep_resample(&field, pitches_um[k], pitches_um[k], NULL), DIF_OK);
        for (int iy = 0; iy < field.ny; iy++)
            for (int ix = 0; ix < field.nx; ix++)
                assert_near(*at(&field, ix, iy),
                            7.0 + 0.3 * dif_field_x_um(&field, ix) - 0.2 * dif_field_y_um(&field, iy), 0.0, 1e-10);
        dif_field_free(&field);
    }
}

static void test_rotate__quarter_turns_permute_the_samples(void **state)
{
    (void)state;
    dif_field field = test_rough_field(7, 5, 0.3, 0.2, 0.2, 3), whole = test_rough_field(7, 5, 0.3, 0.2, 0.2, 3);
    *at(&field, 2, 1) = *at(&whole, 2, 1) = 9.0;
    assert_int_equal(dif_prep_rotate(&field, dif_rad_from_deg(90.0), NULL), DIF_OK);
    assert_int_equal(field.nx, 5);
    assert_int_equal(field.ny, 7);
    assert_near(field.pitch_x_um, 0.2, 0.0, 0.0);
    assert_near(field.pitch_y_um, 0.3, 0.0, 0.0);
    for (int iy = 0; iy < 5; iy++)
        for (int ix = 0; ix < 7; ix++) /* what lay at (x, y) lies at (-y, x): column iy, row nx - 1 - ix */
            assert_near(*at(&field, iy, 6 - ix), *at(&whole, ix, iy), 0.0, 0.0);
    assert_int_equal(dif_prep_rotate(&field, dif_rad_from_deg(180.0), NULL), DIF_OK);
    assert_int_equal(dif_prep_rotate(&field, dif_rad_from_deg(-270.0), NULL), DIF_OK);
    assert_int_equal(memcmp(field.z_um, whole.z_um, dif_field_n(&whole) * sizeof *field.z_um), 0);
    assert_int_equal(field.nx, 7);
    dif_field_free(&field);
    dif_field_free(&whole);
}

static void test_rotate__azimuth_turns_with_the_sample(void **state)
{
    (void)state;
    const double turns_deg[] = {3.0, -20.0, 45.0, 90.0, 117.0, 300.0};
    for (int k = 0; k < 6; k++) {
        const wave w = {9.0, dif_rad_from_deg(10.0), 0.3};
        const wave turned = {9.0, w.psi_rad + dif_rad_from_deg(turns_deg[k]), 0.3};
        dif_field field = make(&w, 150, 110, 1.0, 1.0);
        dif_fit_surface_result fit;
        assert_int_equal(dif_prep_rotate(&field, dif_rad_from_deg(turns_deg[k]), NULL), DIF_OK);
        assert_true(field.nx > 30 && field.ny > 30);
        const bool is_exact = fmod(turns_deg[k], 90.0) == 0.0;
        assert_at_most(off_wave(&field, &turned, 20), is_exact ? 1e-12 : 1.2e-5); /* 2.5 / 8^6 */
        assert_at_most(off_wave(&field, &turned, 0), 0.03);                       /* corners reach the patch's edge */
        assert_int_equal(dif_fit_surface(&field, NULL, &fit, NULL), DIF_OK);
        assert_near(fit.period_um, 9.0, 1e-5, 0.0);
        assert_near(sin(fit.psi_rad - turned.psi_rad), 0.0, 0.0, 1e-5);
        dif_field_free(&field);
    }
}

static void test_highpass__plane_goes_and_a_grating_stays(void **state)
{
    (void)state;
    const wave w = {5.0, 0.2, 0.3};
    dif_field field = make(&w, 180, 90, 0.5, 0.5);
    for (int iy = 0; iy < 90; iy++)
        for (int ix = 0; ix < 180; ix++)
            *at(&field, ix, iy) += 40.0 + 0.5 * dif_field_x_um(&field, ix) + 0.1 * dif_field_y_um(&field, iy);
    assert_int_equal(dif_prep_highpass(&field, 20.0, NULL), DIF_OK);
    /* inside, a wave of a quarter of the cut-off keeps 1 - 2^-16; near an edge the line's end follows the wave */
    assert_at_most(off_wave(&field, &w, 40), 1e-4);
    assert_at_most(off_wave(&field, &w, 20), 0.05);
    assert_at_most(off_wave(&field, &w, 0), 0.6);
    dif_field_free(&field);
    field = blank(64, 48, 0.5, 0.5);
    for (int iy = 0; iy < 48; iy++)
        for (int ix = 0; ix < 64; ix++)
            *at(&field, ix, iy) = 40.0 + 0.5 * dif_field_x_um(&field, ix) + 0.1 * dif_field_y_um(&field, iy);
    assert_int_equal(dif_prep_highpass(&field, 4.0, NULL), DIF_OK);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        assert_near(field.z_um[i], 0.0, 0.0, 1e-12);
    dif_field_free(&field);
}

static void test_highpass__half_passes_at_the_cut_off(void **state)
{
    (void)state;
    const wave w = {16.0, 0.0, 0.0};
    dif_field field = make(&w, 321, 20, 0.25, 0.25);
    assert_int_equal(dif_prep_highpass(&field, 16.0, NULL), DIF_OK);
    for (int k = -1; k <= 1; k++) /* the middle is a crest */
        assert_near(*at(&field, 160 + k, 10), 0.5 * wave_at(&w, 0.25 * k, 0.0), 1e-4, 0.0);
    dif_field_free(&field);
}

/* Share of a field's variance outside one bin of its rows' (or columns') spectra. */
static double leakage(const dif_field *field, bool along_x, int bin)
{
    const int n = along_x ? field->nx : field->ny, n_line = along_x ? field->ny : field->nx;
    double inside = 0.0, all = 0.0, line[2048];
    assert_true(n <= 1024);
    for (int k = 0; k < n_line; k++) {
        for (int i = 0; i < n; i++) {
            line[2 * i] = along_x ? *at(field, i, k) : *at(field, k, i);
            line[2 * i + 1] = 0.0;
        }
        assert_int_equal(dif_fft_rows(line, 1, n, false, NULL), DIF_OK);
        for (int i = 0; i < n; i++) {
            const double power = line[2 * i] * line[2 * i] + line[2 * i + 1] * line[2 * i + 1];
            all += power;
            inside += i == bin || i == n - bin ? power : 0.0;
        }
    }
    return 1.0 - inside / all;
}

static void test_whole_periods__one_bin_holds_everything(void **state)
{
    (void)state;
    const double psi_deg[] = {0.0, 3.0, -8.0, 87.0, 90.0};
    for (int k = 0; k < 5; k++) {
        const wave w = {11.37, dif_rad_from_deg(psi_deg[k]), 0.8};
        const dif_prep_lattice lattice = {w.period_um, w.psi_rad, (double)NAN};
        dif_field field = make(&w, 200, 165, 1.0, 1.0);
        const bool along_x = psi_deg[k] < 45.0;
        int n_period[2];
        const double before = leakage(&field, along_x, (int)floor((along_x ? 200 : 165) / 11.37 + 0.5));
        assert_int_equal(dif_prep_whole_periods(&field, &lattice, n_period, NULL), DIF_OK);
        assert_true(n_period[0] >= 12 && n_period[1] == 0);
        assert_near(along_x ? field.nx * field.pitch_x_um : field.ny * field.pitch_y_um, n_period[0] * 11.37, 1e-12,
                    0.0);
        assert_true(field.pitch_x_um <= 1.0 + 1e-12 && field.pitch_y_um <= 1.0 + 1e-12);
        const double after = leakage(&field, along_x, n_period[0]);
        print_message("normal at %g deg: leakage %.2g, before %.2g\n", psi_deg[k], after, before);
        assert_true(before > 0.01);
        assert_at_most(after, 1e-6); /* the spline at the edges */
        dif_field_free(&field);
    }
}

static void test_whole_periods__both_axes_of_a_crossed_grating(void **state)
{
    (void)state;
    const wave a = {11.37, 0.05, 0.8}, b = {9.1, 0.05 + 0.5 * DIF_PI, 0.1};
    dif_field field = make(&a, 200, 170, 1.0, 1.0), other = make(&b, 200, 170, 1.0, 1.0);
    int n_period[2];
    for (size_t i = 0; i < dif_field_n(&field); i++)
        field.z_um[i] += other.z_um[i];
    assert_int_equal(dif_prep_whole_periods(&field, &(dif_prep_lattice){11.37, 0.05, 9.1}, n_period, NULL), DIF_OK);
    assert_near(field.nx * field.pitch_x_um, n_period[0] * 11.37, 1e-12, 0.0);
    assert_near(field.ny * field.pitch_y_um, n_period[1] * 9.1, 1e-12, 0.0);
    for (int iy = 0; iy < field.ny; iy++) { /* without its mean a row is the first wave alone */
        double mean = 0.0;
        for (int ix = 0; ix < field.nx; ix++)
            mean += *at(&field, ix, iy) / field.nx;
        for (int ix = 0; ix < field.nx; ix++)
            *at(&field, ix, iy) -= mean;
    }
    assert_at_most(leakage(&field, true, n_period[0]), 1e-6);
    dif_field_free(&field);
    dif_field_free(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fill__smooth_surface_comes_back),
        cmocka_unit_test(test_fill__plane_comes_back_exactly_whatever_is_missing),
        cmocka_unit_test(test_fill__laplace_keeps_between_the_rim),
        cmocka_unit_test(test_fill__measured_points_keep_their_bits),
        cmocka_unit_test(test_resample__band_limited_sine_to_the_stated_error),
        cmocka_unit_test(test_resample__coarser_pitch_does_not_alias),
        cmocka_unit_test(test_resample__plane_is_kept_to_its_edges),
        cmocka_unit_test(test_rotate__quarter_turns_permute_the_samples),
        cmocka_unit_test(test_rotate__azimuth_turns_with_the_sample),
        cmocka_unit_test(test_highpass__plane_goes_and_a_grating_stays),
        cmocka_unit_test(test_highpass__half_passes_at_the_cut_off),
        cmocka_unit_test(test_whole_periods__one_bin_holds_everything),
        cmocka_unit_test(test_whole_periods__both_axes_of_a_crossed_grating),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
