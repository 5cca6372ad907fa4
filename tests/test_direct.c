#include "core/direct.h"

#include "alloc_count.h"
#include "core/units.h"
#include "rough.h"

/* The definition, in long double, sample by sample. */
static void amplitude_long(const dif_field *field, const dif_window *window, dif_vec3 kappa, double *amp)
{
    long double re = 0.0L, im = 0.0L, sum = 0.0L;
    for (int iy = 0; iy < field->ny; iy++)
        for (int ix = 0; ix < field->nx; ix++) {
            const long double x = dif_field_x_um(field, ix), y = dif_field_y_um(field, iy);
            const long double dx = x - window->x_um, dy = y - window->y_um, s = window->sigma_um;
            const long double w = window->kind == DIF_WINDOW_FLAT ? 1.0L : expl(-(dx * dx + dy * dy) / (2.0L * s * s));
            const long double z = field->z_um[(size_t)iy * (size_t)field->nx + (size_t)ix];
            const long double phase = kappa.x * x + kappa.y * y + kappa.z * z;
            re += w * cosl(phase);
            im += w * sinl(phase);
            sum += w;
        }
    amp[0] = (double)(re / sum);
    amp[1] = (double)(im / sum);
}

static void test_amplitudes__are_the_definition(void **state)
{
    (void)state;
    uint64_t random = 5;
    dif_field field = test_rough_field(37, 53, 0.05, 0.07, 0.8, 3);
    const dif_window windows[] = {{DIF_WINDOW_GAUSS, 0.6, 0.1, -0.3}, {.kind = DIF_WINDOW_FLAT}};
    for (int w = 0; w < 2; w++)
        for (int i = 0; i < 40; i++) {
            const dif_vec3 kappa = {test_random(&random, -33.0, 33.0), test_random(&random, -33.0, 33.0),
                                    test_random(&random, -33.0, 0.0)};
            double got[1][2], want[2];
            assert_int_equal(dif_direct_amplitudes(&field, windows + w, 1, &kappa, got, NULL), DIF_OK);
            amplitude_long(&field, windows + w, kappa, want);
            /* phases up to 100 rad lose 1e-14 in double, and the vector library a few units in the last place */
            assert_near(got[0][0], want[0], 0.0, 2e-14);
            assert_near(got[0][1], want[1], 0.0, 2e-14);
        }
    dif_field_free(&field);
}

static void test_amplitudes__flat_window_is_a_dirichlet_kernel(void **state)
{
    (void)state;
    dif_field field;
    const int n = 64;
    const double pitch_um = 0.05, kx = 3.7;
    assert_int_equal(dif_field_create(n, 8, pitch_um, pitch_um, &field, NULL), DIF_OK);
    const dif_window window = {.kind = DIF_WINDOW_FLAT};
    const dif_vec3 kappa = {kx, 0.0, -20.0};
    double amp[1][2];
    assert_int_equal(dif_direct_amplitudes(&field, &window, 1, &kappa, amp, NULL), DIF_OK);
    assert_near(amp[0][0], sin(0.5 * n * kx * pitch_um) / (n * sin(0.5 * kx * pitch_um)), 0.0, 1e-15);
    assert_near(amp[0][1], 0.0, 0.0, 1e-15);
    dif_field_free(&field);
}

static void test_amplitudes__window_beside_the_patch_is_refused(void **state)
{
    (void)state;
    dif_field field = test_rough_field(8, 8, 0.05, 0.05, 0.1, 1);
    const dif_window window = {DIF_WINDOW_GAUSS, 0.01, 100.0, 0.0};
    const dif_vec3 kappa = {0.0, 0.0, -1.0};
    double amp[1][2];
    dif_error err;
    assert_int_equal(dif_direct_amplitudes(&field, &window, 1, &kappa, amp, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "the window misses every sample");
    dif_field_free(&field);
}

static void test_amplitudes__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field = test_rough_field(8, 8, 0.05, 0.05, 0.1, 1);
    const dif_window window = {.kind = DIF_WINDOW_FLAT};
    const dif_vec3 kappa = {1.0, 0.0, -1.0};
    double amp[1][2];
    const int live = test_alloc_live();
    int n_failed = 0;
    for (int k = 1;; k++) {
        test_alloc_fail_from(k);
        const dif_status status = dif_direct_amplitudes(&field, &window, 1, &kappa, amp, NULL);
        test_alloc_fail_from(0);
        assert_int_equal(test_alloc_live(), live);
        if (status == DIF_OK)
            break;
        assert_int_equal(status, DIF_ERR_NOMEM);
        n_failed++;
    }
    assert_int_equal(n_failed, 3);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_amplitudes__are_the_definition),
        cmocka_unit_test(test_amplitudes__flat_window_is_a_dirichlet_kernel),
        cmocka_unit_test(test_amplitudes__window_beside_the_patch_is_refused),
        cmocka_unit_test(test_amplitudes__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
