#include "core/response.h"
#include "core/sheet.h"

#include "alloc_count.h"
#include "core/direct.h"
#include "core/units.h"
#include "rough.h"

enum { N_POINT = 60 };

/* Visible light, any pair of directions. */
static const dif_band BAND = {2.0 * DIF_TWO_PI / 0.38, 0.0, 2.0 * DIF_TWO_PI / 0.38};

/* Random points of the band; lateral direction `azimuth`, or any if it is NaN. */
static void random_points(uint64_t *random, double azimuth_rad, dif_vec3 *kappa, double *ks, double *kz)
{
    for (int i = 0; i < N_POINT; i++) {
        const double k = test_random(random, DIF_TWO_PI / 0.78, DIF_TWO_PI / 0.38);
        const double a = test_random(random, -1.5, 1.5), b = test_random(random, -1.5, 1.5);
        const double turn = isnan(azimuth_rad) ? test_random(random, 0.0, DIF_TWO_PI) : azimuth_rad;
        ks[i] = -k * (sin(a) + sin(b));
        kz[i] = k * (cos(a) + cos(b));
        kappa[i] = (dif_vec3){ks[i] * cos(turn), ks[i] * sin(turn), -kz[i]};
    }
    /* the corners of the band */
    ks[0] = BAND.k_lateral_max_rad_per_um;
    kz[0] = 0.0;
    ks[1] = -BAND.k_lateral_max_rad_per_um;
    kz[1] = BAND.kz_max_rad_per_um;
    for (int i = 0; i < 2; i++) {
        const double turn = isnan(azimuth_rad) ? 0.0 : azimuth_rad;
        kappa[i] = (dif_vec3){ks[i] * cos(turn), ks[i] * sin(turn), -kz[i]};
    }
}

static double worst_difference(const double (*a)[2], const double (*b)[2])
{
    double worst = 0.0;
    for (int i = 0; i < N_POINT; i++)
        worst = fmax(worst, hypot(a[i][0] - b[i][0], a[i][1] - b[i][1]));
    return worst;
}

/* Largest amplitude error of a sheet of either form; asserts its own bound against the tolerance. */
static double sheet_error(const dif_field *field, const dif_window *window, bool is_line, double azimuth_rad,
                          double tol)
{
    uint64_t random = 11;
    dif_vec3 kappa[N_POINT];
    double ks[N_POINT], kz[N_POINT], got[N_POINT][2], want[N_POINT][2];
    dif_sheet *sheet = NULL;
    random_points(&random, is_line ? azimuth_rad : (double)NAN, kappa, ks, kz);
    assert_int_equal(is_line ? dif_sheet_create_line(field, window, azimuth_rad, &BAND, tol, NULL, &sheet, NULL)
                             : dif_sheet_create_volume(field, window, &BAND, tol, NULL, &sheet, NULL),
                     DIF_OK);
    assert_at_most(dif_sheet_info_of(sheet).bound, tol);
    if (is_line)
        dif_response_line(sheet, N_POINT, ks, kz, got);
    else
        dif_response_volume(sheet, N_POINT, kappa, got);
    dif_sheet_free(sheet);
    assert_int_equal(dif_direct_amplitudes(field, window, N_POINT, kappa, want, NULL), DIF_OK);
    return worst_difference((const double(*)[2])got, (const double(*)[2])want);
}

static void sweep(int nx, int ny, double pitch_x_um, double pitch_y_um, bool is_line, double azimuth_rad)
{
    dif_field field = test_rough_field(nx, ny, pitch_x_um, pitch_y_um, 0.8, 7);
    const dif_window gauss = {DIF_WINDOW_GAUSS, 0.2 * nx * pitch_x_um, 0.3, -0.2}, flat = {.kind = DIF_WINDOW_FLAT};
    double worst_share = 0.0;
    for (double tol = 1e-1; tol > 5e-13; tol *= 0.1) {
        worst_share = fmax(worst_share, sheet_error(&field, &gauss, is_line, azimuth_rad, tol) / tol);
        worst_share = fmax(worst_share, sheet_error(&field, &flat, is_line, azimuth_rad, tol) / tol);
    }
    print_message("%d x %d, %s, azimuth %.0f: worst error / tol = %.3f\n", nx, ny, is_line ? "line" : "volume",
                  dif_deg_from_rad(azimuth_rad), worst_share);
    assert_at_most(worst_share, 1.0);
    dif_field_free(&field);
}

static void test_line__tolerance_sweep_along_the_axes(void **state)
{
    (void)state;
    for (int quarter = -1; quarter < 4; quarter++) {
        sweep(130, 97, 0.05, 0.06, true, 0.5 * DIF_PI * quarter);
        sweep(97, 130, 0.06, 0.05, true, 0.5 * DIF_PI * quarter);
    }
}

static void test_line__tolerance_sweep_at_other_azimuths(void **state)
{
    (void)state;
    sweep(90, 71, 0.05, 0.06, true, dif_rad_from_deg(37.0));
    sweep(90, 71, 0.05, 0.06, true, dif_rad_from_deg(-141.0));
    sweep(71, 90, 0.05, 0.06, true, dif_rad_from_deg(90.001));
}

static void test_volume__tolerance_sweep(void **state)
{
    (void)state;
    sweep(70, 51, 0.05, 0.06, false, 0.0);
    sweep(51, 70, 0.06, 0.05, false, 0.0);
}

static void test_sheet__coarse_pitch_folds_the_band(void **state)
{
    (void)state;
    /* 2/lambda lies beyond the sampled spectrum 1/(2 T): points fold, and the sum of the samples is still met */
    sweep(40, 31, 0.4, 0.3, true, 0.0);
    sweep(31, 40, 0.4, 0.3, true, 0.5 * DIF_PI);
    sweep(40, 31, 0.4, 0.3, true, 0.6);
    sweep(40, 31, 0.4, 0.3, false, 0.0);
}

static void test_sheet__smallest_fields(void **state)
{
    (void)state;
    const int sizes[][2] = {{1, 1}, {2, 1}, {1, 3}, {3, 300}};
    for (int i = 0; i < 4; i++) {
        sweep(sizes[i][0], sizes[i][1], 0.05, 0.05, true, 0.0);
        sweep(sizes[i][0], sizes[i][1], 0.05, 0.05, true, 0.5);
        sweep(sizes[i][0], sizes[i][1], 0.05, 0.05, false, 0.0);
    }
}

static void test_sheet__flat_mirror_is_one_at_the_mirror_direction(void **state)
{
    (void)state;
    dif_field field;
    dif_sheet *sheet = NULL;
    const dif_window window = {DIF_WINDOW_GAUSS, 1.0, 0.0, 0.0};
    const double ks = 0.0, kz = 17.0;
    double amp[1][2];
    assert_int_equal(dif_field_create(64, 64, 0.05, 0.05, &field, NULL), DIF_OK);
    assert_int_equal(dif_sheet_create_line(&field, &window, 0.0, &BAND, 1e-9, NULL, &sheet, NULL), DIF_OK);
    dif_response_line(sheet, 1, &ks, &kz, amp);
    assert_near(amp[0][0], 1.0, 0.0, 1e-9);
    assert_near(amp[0][1], 0.0, 0.0, 1e-9);
    dif_sheet_free(sheet);
    dif_field_free(&field);
}

static void test_powers__taylor_meets_its_bound_and_float_breaks_on_a_deep_surface(void **state)
{
    (void)state;
    dif_field field = test_rough_field(80, 40, 0.05, 0.05, 0.8, 2);
    const dif_window window = {.kind = DIF_WINDOW_FLAT};
    dif_sheet_opts opts = dif_sheet_opts_default();
    opts.basis = DIF_BASIS_POWERS;
    double error[2], bound[2];
    for (int single = 0; single < 2; single++) {
        uint64_t random = 4;
        dif_vec3 kappa[N_POINT];
        double ks[N_POINT], kz[N_POINT], got[N_POINT][2], want[N_POINT][2];
        dif_sheet *sheet = NULL;
        opts.force_single = single == 1;
        random_points(&random, 0.0, kappa, ks, kz);
        assert_int_equal(dif_sheet_create_line(&field, &window, 0.0, &BAND, 1e-7, &opts, &sheet, NULL), DIF_OK);
        dif_response_line(sheet, N_POINT, ks, kz, got);
        bound[single] = dif_sheet_info_of(sheet).bound;
        dif_sheet_free(sheet);
        assert_int_equal(dif_direct_amplitudes(&field, &window, N_POINT, kappa, want, NULL), DIF_OK);
        error[single] = worst_difference((const double(*)[2])got, (const double(*)[2])want);
        assert_at_most(error[single], bound[single]);
    }
    print_message("Taylor, half-range 0.4 um: error %.1e in double, %.1e in float\n", error[0], error[1]);
    /* terms reach e^13 = 4e5, so float misses the tolerance by a hundred times and more */
    assert_at_most(error[0], 1e-7);
    assert_true(error[1] > 1e-5);
    dif_field_free(&field);
}

static void test_create__bad_arguments_have_their_codes(void **state)
{
    (void)state;
    dif_field field = test_rough_field(8, 8, 0.05, 0.05, 0.1, 1);
    const dif_window window = {.kind = DIF_WINDOW_FLAT}, bad_window = {DIF_WINDOW_GAUSS, (double)NAN, 0.0, 0.0};
    const dif_band bad_band = {1.0, 2.0, 1.0};
    dif_sheet *sheet;
    dif_error err;
    assert_int_equal(dif_sheet_create_line(&field, &window, 0.0, &BAND, 1.0, NULL, &sheet, &err), DIF_ERR_TOL);
    assert_string_equal(err.text, "tol = 1, want 1e-13 <= tol < 1");
    assert_null(sheet);
    assert_int_equal(dif_sheet_create_volume(&field, &window, &BAND, (double)NAN, NULL, &sheet, &err), DIF_ERR_TOL);
    assert_int_equal(dif_sheet_create_line(&field, &bad_window, 0.0, &BAND, 1e-3, NULL, &sheet, &err), DIF_ERR_ARG);
    assert_int_equal(dif_sheet_create_line(&field, &window, (double)INFINITY, &BAND, 1e-3, NULL, &sheet, &err),
                     DIF_ERR_ARG);
    assert_int_equal(dif_sheet_create_line(&field, &window, 0.0, &bad_band, 1e-3, NULL, &sheet, &err), DIF_ERR_ARG);
    field.z_um[9] = (double)NAN;
    assert_int_equal(dif_sheet_create_line(&field, &window, 0.0, &BAND, 1e-3, NULL, &sheet, &err), DIF_ERR_NONFINITE);
    assert_null(sheet);
    dif_field_free(&field);
}

/* Every allocation from the k-th on fails: a code, no handle, no block left. */
static int failing_allocations(const dif_field *field, int form)
{
    const dif_window window = {.kind = DIF_WINDOW_FLAT};
    const int live = test_alloc_live();
    for (int k = 1;; k++) {
        dif_sheet *sheet = NULL;
        test_alloc_fail_from(k);
        const dif_status status =
            form == 2 ? dif_sheet_create_volume(field, &window, &BAND, 1e-3, NULL, &sheet, NULL)
                      : dif_sheet_create_line(field, &window, form ? 0.5 : 0.0, &BAND, 1e-3, NULL, &sheet, NULL);
        test_alloc_fail_from(0);
        if (status == DIF_OK) {
            dif_sheet_free(sheet);
            assert_int_equal(test_alloc_live(), live);
            return k - 1;
        }
        assert_int_equal(status, DIF_ERR_NOMEM);
        assert_null(sheet);
        assert_int_equal(test_alloc_live(), live);
    }
}

static void test_create__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field = test_rough_field(16, 16, 0.05, 0.05, 0.1, 1);
    for (int form = 0; form < 3; form++)
        assert_true(failing_allocations(&field, form) >= 6);
    dif_field_free(&field);
}

static void test_response__allocates_nothing(void **state)
{
    (void)state;
    dif_field field = test_rough_field(16, 16, 0.05, 0.05, 0.1, 1);
    const dif_window window = {.kind = DIF_WINDOW_FLAT};
    dif_sheet *line = NULL, *volume = NULL;
    assert_int_equal(dif_sheet_create_line(&field, &window, 0.0, &BAND, 1e-3, NULL, &line, NULL), DIF_OK);
    assert_int_equal(dif_sheet_create_volume(&field, &window, &BAND, 1e-3, NULL, &volume, NULL), DIF_OK);
    const double s[3] = {0.1, 0.2, 0.3}, c[3] = {1.0, 1.1, 1.2};
    const dif_vec3 kappa[1] = {{1.0, 2.0, -3.0}};
    double power[3] = {0.0}, amp[3][2];
    test_alloc_fail_from(1);
    dif_response_line_power(line, 10.0, 3, s, c, 1.0, power);
    dif_response_volume(volume, 1, kappa, amp);
    const int n_call = test_alloc_calls();
    test_alloc_fail_from(0);
    assert_int_equal(n_call, 0);
    assert_true(power[0] > 0.0);
    dif_sheet_free(line);
    dif_sheet_free(volume);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_line__tolerance_sweep_along_the_axes),
        cmocka_unit_test(test_line__tolerance_sweep_at_other_azimuths),
        cmocka_unit_test(test_volume__tolerance_sweep),
        cmocka_unit_test(test_sheet__coarse_pitch_folds_the_band),
        cmocka_unit_test(test_sheet__smallest_fields),
        cmocka_unit_test(test_sheet__flat_mirror_is_one_at_the_mirror_direction),
        cmocka_unit_test(test_powers__taylor_meets_its_bound_and_float_breaks_on_a_deep_surface),
        cmocka_unit_test(test_create__bad_arguments_have_their_codes),
        cmocka_unit_test(test_create__every_failing_allocation_is_reported),
        cmocka_unit_test(test_response__allocates_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
