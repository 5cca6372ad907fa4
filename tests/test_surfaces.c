#include "tests/near.h"

#include <string.h>

#include "core/grating.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "tests/alloc_count.h"

static const dif_surface_kind PERIODIC[] = {DIF_SURFACE_SINE, DIF_SURFACE_BLAZED, DIF_SURFACE_LAMELLAR,
                                            DIF_SURFACE_TRIANGLE, DIF_SURFACE_CROSSED};
enum { N_PERIODIC = 5, N_KIND = 10 };

static dif_field make(const dif_surface *surface)
{
    dif_field field;
    dif_error err = {0};
    const dif_status status = dif_surface_make(surface, &field, &err);
    if (status)
        print_error("%s\n", err.text);
    assert_int_equal(status, DIF_OK);
    assert_int_equal(dif_field_check(&field, &err), DIF_OK);
    return field;
}

static dif_surface small(dif_surface_kind kind, int nx, int ny)
{
    dif_surface surface = dif_surface_default(kind);
    surface.nx = nx;
    surface.ny = ny;
    return surface;
}

static void test_kind__names_and_defaults(void **state)
{
    (void)state;
    static const char *const names[N_KIND] = {"flat",    "sine",   "blazed", "lamellar",   "triangle",
                                              "crossed", "random", "elaphe", "xenopeltis", "cd"};
    for (int i = 0; i < N_KIND; i++) {
        dif_surface_kind kind;
        assert_true(dif_surface_kind_from_name(names[i], &kind));
        assert_int_equal(kind, i);
        assert_string_equal(dif_surface_kind_name(kind), names[i]);
        const dif_surface surface = dif_surface_default(kind);
        assert_int_equal(surface.nx, 1332);
        assert_int_equal(surface.ny, 1332);
        assert_near(surface.nx * surface.pitch_um, 65.0, 1e-15, 0.0);
    }
    dif_surface_kind kind;
    assert_false(dif_surface_kind_from_name("snake", &kind));
    assert_near(dif_surface_default(DIF_SURFACE_ELAPHE).height_um, 0.375, 0.0, 0.0);
    assert_near(dif_surface_default(DIF_SURFACE_XENOPELTIS).height_um, 0.81869, 0.0, 0.0);
    assert_near(dif_surface_default(DIF_SURFACE_BLAZED).period_um, 2.5, 0.0, 0.0);
}

/* Height at phase s in periods, in the words of core/grating.h. */
static double profile_of(const dif_surface *surface, double s, double t)
{
    const double f = s - floor(s);
    switch (surface->kind) {
    case DIF_SURFACE_SINE:
        return 0.5 * sin(DIF_TWO_PI * s);
    case DIF_SURFACE_BLAZED:
        return f;
    case DIF_SURFACE_LAMELLAR:
        return f < surface->duty ? 1.0 : 0.0;
    case DIF_SURFACE_TRIANGLE:
        return f < 0.5 ? 2.0 * f : 2.0 - 2.0 * f;
    default:
        return 0.5 * sin(DIF_TWO_PI * s) * sin(DIF_TWO_PI * t);
    }
}

/* Mean of a profile over the pixel at (x, y), by brute force. */
static double pixel_mean(const dif_surface *surface, double x_um, double y_um)
{
    enum { SUB = 60 };
    double sum = 0.0;
    for (int i = 0; i < SUB; i++)
        for (int j = 0; j < SUB; j++) {
            const double x = x_um + ((i + 0.5) / SUB - 0.5) * surface->pitch_um;
            const double y = y_um + ((j + 0.5) / SUB - 0.5) * surface->pitch_um;
            sum += profile_of(surface, (x * cos(surface->psi_rad) + y * sin(surface->psi_rad)) / surface->period_um,
                              (y * cos(surface->psi_rad) - x * sin(surface->psi_rad)) / surface->period_um);
        }
    return sum / (SUB * SUB);
}

/* Phase 0 lies on the line through the patch centre, the pattern runs along (cos psi, sin psi) with y upwards. */
static void test_make__profiles_at_any_groove_azimuth(void **state)
{
    (void)state;
    static const double psi_deg[] = {0.0, 30.0, 137.0, -75.0};
    for (int k = 0; k < N_PERIODIC; k++) {
        for (int p = 0; p < 4; p++) {
            dif_surface surface = small(PERIODIC[k], 31, 27);
            const bool walls = PERIODIC[k] == DIF_SURFACE_BLAZED || PERIODIC[k] == DIF_SURFACE_LAMELLAR;
            surface.psi_rad = dif_rad_from_deg(psi_deg[p]);
            surface.duty = 0.3;
            surface.pitch_um = 0.1713;
            dif_field field = make(&surface);
            for (int iy = 0; iy < field.ny; iy++) {
                for (int ix = 0; ix < field.nx; ix++) {
                    const double x = dif_field_x_um(&field, ix), y = dif_field_y_um(&field, iy);
                    const double s = (x * cos(surface.psi_rad) + y * sin(surface.psi_rad)) / 2.5;
                    const double t = (y * cos(surface.psi_rad) - x * sin(surface.psi_rad)) / 2.5;
                    /* brute force places a wall to one of 60 lines of sub-samples */
                    if (walls)
                        assert_near(field.z_um[iy * 31 + ix], 0.25 * pixel_mean(&surface, x, y), 0.0, 0.25 / 60.0);
                    else
                        assert_near(field.z_um[iy * 31 + ix], 0.25 * profile_of(&surface, s, t), 0.0, 1e-13);
                }
            }
            dif_field_free(&field);
        }
    }
}

/* Where walls lie between samples nothing is averaged; a sample whose middle is a wall has the mean of both sides. */
static void test_make__walls_on_and_between_samples(void **state)
{
    (void)state;
    static const double psi_rad[] = {0.0, DIF_PI}; /* cos pi, sin pi are rounded */
    for (int p = 0; p < 2; p++) {
        dif_surface surface = small(DIF_SURFACE_BLAZED, 2000, 1);
        surface.period_um = 0.7;
        surface.pitch_um = 0.7 / 20.0; /* not exact in binary */
        surface.psi_rad = psi_rad[p];
        dif_field field = make(&surface);
        for (int i = 0; i < 2000; i++) {
            const int phase = (p == 0 ? i : 1999 - i) + 20000;
            assert_near(field.z_um[i], 0.25 * (phase % 20 + 0.5) / 20.0, 0.0, 1e-9);
        }
        dif_field_free(&field);
        surface.kind = DIF_SURFACE_LAMELLAR;
        surface.duty = 0.35;
        surface.nx = 2001;
        field = make(&surface);
        for (int i = 0; i < 2001; i++) {
            const int phase = ((p == 0 ? i - 1000 : 1000 - i) + 20000) % 20;
            assert_near(field.z_um[i], phase % 7 == 0 && phase < 8 ? 0.125 : (phase < 7 ? 0.25 : 0.0), 0.0, 1e-9);
        }
        dif_field_free(&field);
    }
}

/* |c_m|^2 summed over the n samples of one period. */
static double sampled_power(const dif_field *field, int n, int m, double kw)
{
    double re = 0.0, im = 0.0;
    for (int i = 0; i < n; i++) {
        const double phase = kw * field->z_um[i] - DIF_TWO_PI * m * i / n;
        re += cos(phase) / n;
        im += sin(phase) / n;
    }
    return re * re + im * im;
}

/* What a sampled period gives against the closed forms. A sine is exact once its orders stop short of the sampling rate.
 * Jumps and corners alias: order m receives orders m +- n. For a ramp and for walls on samples that makes a factor
 * (x / sin x)^2 with x = pi y / n, y the distance in orders from the ramp's peak or from 0, so a relative error of x^2/3:
 * 51 samples a period, as in the 65 um default, are good to about 1e-5 of the whole, 1024 to 1e-6. */
static void test_make__sampled_orders_approach_the_closed_forms(void **state)
{
    (void)state;
    static const struct {
        dif_surface_kind kind;
        dif_profile profile;
        int n;
        double within;
    } cases[] = {{DIF_SURFACE_SINE, DIF_PROFILE_SINE, 64, 1e-14},
                 {DIF_SURFACE_TRIANGLE, DIF_PROFILE_TRIANGLE, 4096, 1e-6},
                 {DIF_SURFACE_BLAZED, DIF_PROFILE_BLAZED, 1024, 1e-6},
                 {DIF_SURFACE_LAMELLAR, DIF_PROFILE_LAMELLAR, 2048, 1e-6}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const int n = cases[c].n;
        dif_surface surface = small(cases[c].kind, n, 1);
        surface.pitch_um = surface.period_um / n;
        dif_field field = make(&surface);
        const dif_grating grating = {cases[c].profile, 2.5, 0.25, 0.5, 0.0};
        double worst = 0.0;
        for (double lambda_um = 0.38; lambda_um < 0.79; lambda_um += 0.1) {
            const double kw = -DIF_TWO_PI / lambda_um * 1.7;
            for (int m = -8; m <= 8; m++)
                worst = fmax(worst, fabs(sampled_power(&field, n, m, kw) - dif_grating_power(&grating, m, kw)));
        }
        print_message("%s, %d samples a period: order powers off by at most %.2g\n",
                      dif_surface_kind_name(cases[c].kind), n, worst);
        assert_at_most(worst, cases[c].within);
        dif_field_free(&field);
    }
}

static void test_make__random_heights_have_their_deviation_and_correlation(void **state)
{
    (void)state;
    dif_surface surface = small(DIF_SURFACE_RANDOM, 700, 500);
    surface.correlation_um = 0.5;
    surface.pitch_um = 0.1;
    surface.height_um = 0.08;
    dif_field field = make(&surface);
    dif_field_stats stats;
    dif_error err;
    assert_int_equal(dif_field_stats_of(&field, &stats, &err), DIF_OK);
    assert_near(stats.mean_um, 0.0, 0.0, 1e-15);
    assert_near(stats.rms_um, 0.08, 1e-12, 0.0);
    for (int lag = 0; lag <= 15; lag += 3) {
        double along_x = 0.0, along_y = 0.0;
        int n = 0;
        for (int iy = 0; iy + lag < 500; iy++) {
            for (int ix = 0; ix + lag < 700; ix++, n++) {
                const double z = field.z_um[iy * 700 + ix];
                along_x += z * field.z_um[iy * 700 + ix + lag];
                along_y += z * field.z_um[(iy + lag) * 700 + ix];
            }
        }
        const double want = exp(-(0.1 * lag) * (0.1 * lag) / 0.25);
        /* 700 x 500 samples hold about 5000 independent patches of correlation: four deviations are 0.06 */
        assert_near(along_x / n / 0.0064, want, 0.0, 0.06);
        assert_near(along_y / n / 0.0064, want, 0.0, 0.06);
    }
    dif_field_free(&field);
}

static void test_make__a_seed_gives_the_same_bits_and_another_seed_others(void **state)
{
    (void)state;
    static const dif_surface_kind seeded[] = {DIF_SURFACE_RANDOM, DIF_SURFACE_ELAPHE, DIF_SURFACE_XENOPELTIS,
                                              DIF_SURFACE_CD};
    for (int k = 0; k < 4; k++) {
        dif_surface surface = small(seeded[k], 120, 90);
        dif_field a = make(&surface), b = make(&surface);
        surface.seed = 2;
        dif_field c = make(&surface);
        assert_memory_equal(a.z_um, b.z_um, 120 * 90 * sizeof(double));
        assert_memory_not_equal(a.z_um, c.z_um, 120 * 90 * sizeof(double));
        dif_field_free(&a);
        dif_field_free(&b);
        dif_field_free(&c);
    }
}

static void test_make__flat_and_zero_height_are_flat(void **state)
{
    (void)state;
    for (int k = 0; k < N_KIND; k++) {
        dif_surface surface = small((dif_surface_kind)k, 40, 30);
        surface.height_um = 0.0;
        dif_field field = make(&surface);
        for (int i = 0; i < 40 * 30; i++)
            assert_near(field.z_um[i], 0.0, 0.0, 0.0);
        dif_field_free(&field);
    }
}

static void test_make__refuses_bad_values_with_reasons(void **state)
{
    (void)state;
    const dif_surface good = small(DIF_SURFACE_LAMELLAR, 8, 8);
    dif_surface bad[13];
    for (int i = 0; i < 13; i++)
        bad[i] = good;
    static const struct {
        dif_status status;
        const char *text;
    } want[13] = {
        {DIF_ERR_ARG, "period = 0 um, want a finite number > 0"},
        {DIF_ERR_ARG, "period = inf um, want a finite number > 0"},
        {DIF_ERR_ARG, "height = -1 um, want a finite number >= 0"},
        {DIF_ERR_ARG, "height = nan um, want a finite number >= 0"},
        {DIF_ERR_ARG, "duty = 0, want 0 < duty < 1"},
        {DIF_ERR_ARG, "duty = 1, want 0 < duty < 1"},
        {DIF_ERR_ARG, "groove azimuth = nan rad, want a finite number"},
        {DIF_ERR_ARG, "correlation length = 0 um, want a finite number > 0"},
        {DIF_ERR_SIZE, "correlation length of 4.1e+03 samples, want at most 2048"},
        {DIF_ERR_ARG, "field of 0 x 8 samples, want at least 1 x 1"},
        {DIF_ERR_ARG, "pitch_x = 0 um, want a finite number > 0"},
        {DIF_ERR_SIZE, "patch is 1.13e+10 periods wide, want at most 2^31"},
        {DIF_ERR_ARG, "surface kind 77, want 0 to 9"},
    };
    bad[0].period_um = 0.0;
    bad[1].period_um = INFINITY;
    bad[2].height_um = -1.0;
    bad[3].height_um = NAN;
    bad[4].duty = 0.0;
    bad[5].duty = 1.0;
    bad[6].psi_rad = NAN;
    bad[7].kind = bad[8].kind = DIF_SURFACE_RANDOM;
    bad[7].correlation_um = 0.0;
    bad[8].correlation_um = 200.0;
    bad[9].nx = 0;
    bad[10].pitch_um = 0.0;
    bad[11].period_um = 1e-9;
    bad[11].pitch_um = 1.0;
    bad[12].kind = (dif_surface_kind)77;
    for (int i = 0; i < 13; i++) {
        dif_field field = {.nx = 1};
        dif_error err;
        assert_int_equal(dif_surface_make(&bad[i], &field, &err), want[i].status);
        assert_string_equal(err.text, want[i].text);
        assert_null(field.z_um);
        assert_int_equal(field.nx, 0);
    }
}

static void test_make__alloc_failing_leaves_nothing_behind(void **state)
{
    (void)state;
    for (int k = 0; k < N_KIND; k++) {
        const dif_surface surface = small((dif_surface_kind)k, 16, 16);
        test_alloc_fail_from(0);
        dif_field field = make(&surface);
        const int n_call = test_alloc_calls();
        dif_field_free(&field);
        assert_in_range(n_call, 1, 3);
        for (int fail = 1; fail <= n_call; fail++) {
            dif_error err;
            test_alloc_fail_from(fail);
            assert_int_equal(dif_surface_make(&surface, &field, &err), DIF_ERR_NOMEM);
            assert_null(field.z_um);
            assert_int_equal(test_alloc_live(), 0);
        }
    }
    test_alloc_fail_from(0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kind__names_and_defaults),
        cmocka_unit_test(test_make__profiles_at_any_groove_azimuth),
        cmocka_unit_test(test_make__walls_on_and_between_samples),
        cmocka_unit_test(test_make__sampled_orders_approach_the_closed_forms),
        cmocka_unit_test(test_make__random_heights_have_their_deviation_and_correlation),
        cmocka_unit_test(test_make__a_seed_gives_the_same_bits_and_another_seed_others),
        cmocka_unit_test(test_make__flat_and_zero_height_are_flat),
        cmocka_unit_test(test_make__refuses_bad_values_with_reasons),
        cmocka_unit_test(test_make__alloc_failing_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
