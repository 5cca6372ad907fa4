#include "tests/near.h"

#include <stdbool.h>
#include <string.h>

#include "core/units.h"
#include "fixtures/cd.h"
#include "tests/alloc_count.h"

enum { N = 1000 };
static const double PITCH_UM = 0.04;

static dif_field make(double psi_rad)
{
    dif_field field;
    dif_error err;
    assert_int_equal(dif_field_create(N, N, PITCH_UM, PITCH_UM, &field, &err), DIF_OK);
    assert_int_equal(dif_cd_fill(4, 1.6, 0.12, psi_rad, &field, &err), DIF_OK);
    return field;
}

static void test_fill__heights_are_land_and_pit(void **state)
{
    (void)state;
    dif_field field = make(0.0);
    int n_land = 0, n_pit = 0;
    for (int i = 0; i < N * N; i++) {
        assert_at_most(0.0, field.z_um[i]);
        assert_at_most(field.z_um[i], 0.12);
        n_land += field.z_um[i] == 0.12;
        n_pit += field.z_um[i] == 0.0;
    }
    /* half the length of each track is pit, pits fill 0.5 of 1.6 um: 16 % of the area, less the soft edges */
    assert_in_range(n_pit, N * N / 15, N * N / 6);
    assert_in_range(n_land, 2 * N * N / 3, 9 * N * N / 10);
    dif_field_free(&field);
}

/* Mean depth across the tracks repeats every 1.6 um: power at the track frequency stands out, and stays in its place
 * along the groove normal when the tracks are turned. */
static double power_at(const dif_field *field, double fx, double fy)
{
    double re = 0.0, im = 0.0;
    for (int iy = 0; iy < N; iy++) {
        for (int ix = 0; ix < N; ix++) {
            const double x = dif_field_x_um(field, ix), y = dif_field_y_um(field, iy);
            const double hann = cos(DIF_PI * x / (N * PITCH_UM)) * cos(DIF_PI * y / (N * PITCH_UM));
            const double phase = DIF_TWO_PI * (fx * x + fy * y);
            re += hann * hann * field->z_um[iy * N + ix] * cos(phase);
            im += hann * hann * field->z_um[iy * N + ix] * sin(phase);
        }
    }
    return re * re + im * im;
}

static void test_fill__tracks_repeat_along_the_groove_normal(void **state)
{
    (void)state;
    static const double psi_deg[] = {0.0, 45.0, 90.0};
    for (int p = 0; p < 3; p++) {
        const double c = cos(dif_rad_from_deg(psi_deg[p])), s = sin(dif_rad_from_deg(psi_deg[p]));
        dif_field field = make(dif_rad_from_deg(psi_deg[p]));
        const double peak = power_at(&field, c / 1.6, s / 1.6);
        for (int k = -1; k <= 1; k += 2) { /* three resolution cells (1/40 um) away */
            const double f = 1.0 / 1.6 + k * 3.0 / 40.0;
            assert_at_most(20.0 * power_at(&field, c * f, s * f), peak);
        }
        assert_at_most(20.0 * power_at(&field, -s / 1.6, c / 1.6), peak); /* nothing regular along the tracks */
        dif_field_free(&field);
    }
}

/* Runs of pit along the middle of a track are 3 to 11 clock lengths of 0.278 um, less their soft ends. */
static void test_fill__pits_have_lengths_within_the_limits(void **state)
{
    (void)state;
    dif_field field = make(0.0);
    int n_run = 0;
    double shortest = 1e9, longest = 0.0;
    for (int track = -10; track < 10; track++) {
        const int ix = (int)lround((track + 0.5) * 1.6 / PITCH_UM + 0.5 * (N - 1));
        int run = 0;
        for (int iy = 0; iy < N; iy++) {
            const bool pit = field.z_um[iy * N + ix] < 0.06;
            if (!pit && run > 0 && run < iy) { /* a run that touches an end of the patch does not count */
                shortest = fmin(shortest, run * PITCH_UM);
                longest = fmax(longest, run * PITCH_UM);
                n_run++;
            }
            run = pit ? run + 1 : 0;
        }
    }
    assert_in_range(n_run, 200, 400);
    assert_near(shortest, 3 * 0.278, 0.0, 0.05 + 2.0 * PITCH_UM); /* half a soft edge and a sample at each end */
    assert_near(longest, 11 * 0.278, 0.0, 0.05 + 2.0 * PITCH_UM);
    dif_field_free(&field);
}

static void test_fill__refuses_a_patch_of_too_many_tracks(void **state)
{
    (void)state;
    dif_field field;
    dif_error err;
    assert_int_equal(dif_field_create(100, 100, 1000.0, 1000.0, &field, &err), DIF_OK);
    assert_int_equal(dif_cd_fill(4, 1.6, 0.12, 0.0, &field, &err), DIF_ERR_SIZE);
    assert_non_null(strstr(err.text, "cd of 8.84e+04 tracks of "));
    assert_non_null(strstr(err.text, " clock lengths, want at most 32768 of each"));
    field.pitch_x_um = field.pitch_y_um = 0.1;
    test_alloc_fail_from(1);
    assert_int_equal(dif_cd_fill(4, 1.6, 0.12, 0.0, &field, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    assert_int_equal(test_alloc_live(), 1);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fill__heights_are_land_and_pit),
        cmocka_unit_test(test_fill__tracks_repeat_along_the_groove_normal),
        cmocka_unit_test(test_fill__pits_have_lengths_within_the_limits),
        cmocka_unit_test(test_fill__refuses_a_patch_of_too_many_tracks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
