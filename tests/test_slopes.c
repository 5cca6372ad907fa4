#include "bench/slopes.h"

#include "alloc_count.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "near.h"
#include "rough.h"

static dif_field random_surface(int n)
{
    dif_surface surface = dif_surface_default(DIF_SURFACE_RANDOM);
    dif_field field;
    surface.nx = surface.ny = n;
    surface.pitch_um = 0.1;
    surface.height_um = 0.4;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    return field;
}

/* Integral and mean of a density over the square. */
static void integrate(const dif_slopes *s, const float *density, double sum[3])
{
    const int n = s->square.n;
    const double side = 2.0 * s->square.half / n;
    sum[0] = sum[1] = sum[2] = 0.0;
    for (int i = 0; i < n * n; i++) {
        double at[2];
        dif_slope_bin(&s->square, i % n, i / n, at);
        const double w = (double)density[i] * side * side;
        sum[0] += w;
        sum[1] += w * at[0];
        sum[2] += w * at[1];
    }
}

static void test_of_gauss__exact_density_has_the_models_moments(void **state)
{
    (void)state;
    for (int i = 0; i < DIF_SLOPES_CASES; i++) {
        const dif_slopes_case at = dif_slopes_case_at(i);
        dif_slopes s;
        double sum[3];
        assert_int_equal(
            dif_slopes_of_gauss(&at.gauss, dif_rad_from_deg(at.theta_deg), dif_rad_from_deg(at.phi_deg), &s, NULL),
            DIF_OK);
        integrate(&s, s.visible, sum);
        assert_near(sum[0], 1.0, 0.0, 3e-3); /* 3.5 standard deviations hold all but 5e-4 each way */
        assert_near(sum[1] / sum[0], s.model.gauss.mean_x, 0.0, 3e-3);
        assert_near(sum[2] / sum[0], s.model.gauss.mean_y, 0.0, 3e-3);
        assert_in_range((int)(100.0 * s.overlap), 89, 100); /* even the hardest case is nine tenths right */
        dif_slopes_free(&s);
    }
}

static void test_of_gauss__from_above_is_the_gaussian(void **state)
{
    (void)state;
    const dif_slope_gauss gauss = {0.1, -0.2, 0.04, 0.09, 0.03};
    dif_slopes s;
    assert_int_equal(dif_slopes_of_gauss(&gauss, 0.0, 0.0, &s, NULL), DIF_OK);
    assert_near(s.overlap, 1.0, 0.0, 5e-3); /* a bin's mean against its middle, and the tails */
    for (int i = 0; i < s.square.n * s.square.n; i++)
        assert_near((double)s.visible[i], (double)s.unseen[i], 1e-6, 0.0);
    dif_slopes_free(&s);
}

static void test_of_field__random_surface_is_nearly_gaussian(void **state)
{
    (void)state;
    dif_field field = random_surface(256);
    dif_slopes s;
    double sum[3];
    assert_int_equal(dif_slopes_of_field(&field, 0.0, 1.0, 0.5, &s, NULL), DIF_OK);
    integrate(&s, s.visible, sum);
    assert_near(sum[0], s.inside, 1e-5, 0.0);
    assert_at_most(0.99, s.inside);
    assert_near(s.seen.norm, s.model.norm, 0.03, 0.0);
    assert_near(s.seen.gauss.mean_x, s.model.gauss.mean_x, 0.0, 0.03);
    assert_near(s.seen.gauss.var_x, s.model.gauss.var_x, 0.2, 0.0);
    assert_at_most(0.7, s.overlap); /* a patch of some hundred correlation areas is no smooth histogram */
    dif_slopes_free(&s);
    dif_field_free(&field);
}

static void test_of_field__quantised_heights_leave_no_empty_bins(void **state)
{
    (void)state;
    dif_field field = random_surface(256);
    const double step_um = 0.004;
    for (size_t i = 0; i < dif_field_n(&field); i++)
        field.z_um[i] = step_um * rint(field.z_um[i] / step_um);
    dif_slopes s;
    assert_int_equal(dif_slopes_of_field(&field, step_um, 0.0, 0.0, &s, NULL), DIF_OK);
    const double per_bin = 2.0 * s.square.half / s.square.n / (0.5 * step_um / field.pitch_x_um);
    assert_near(per_bin / 2.0, rint(per_bin / 2.0), 1e-9, 0.0); /* an even number of half steps */
    int n_empty = 0, n_near = 0;
    for (int i = 0; i < s.square.n * s.square.n; i++) {
        double at[2];
        dif_slope_bin(&s.square, i % s.square.n, i / s.square.n, at);
        if (hypot(at[0], at[1]) > 0.25) /* one standard deviation */
            continue;
        n_near++;
        n_empty += !(s.unseen[i] > 0.0f);
    }
    assert_true(n_near >= 16);
    assert_int_equal(n_empty, 0);
    dif_slopes_free(&s);
    dif_field_free(&field);
}

static void test_of_field__flat_surface(void **state)
{
    (void)state;
    dif_field field;
    dif_slopes s;
    assert_int_equal(dif_field_create(16, 16, 0.1, 0.1, &field, NULL), DIF_OK);
    assert_int_equal(dif_slopes_of_field(&field, 0.0, 1.0, 0.0, &s, NULL), DIF_OK);
    assert_near(s.seen.norm, cos(1.0), 1e-14, 0.0);
    assert_near(s.model.norm, cos(1.0), 1e-14, 0.0);
    assert_near(s.inside, 1.0, 0.0, 0.0);
    dif_slopes_free(&s);
    dif_field_free(&field);
}

static void test_bad_input__is_refused(void **state)
{
    (void)state;
    dif_error err;
    dif_slopes s;
    dif_field field = test_rough_field(12, 12, 0.1, 0.1, 0.1, 1);
    assert_int_equal(dif_slopes_of_field(&field, 0.0, 1.6, 0.0, &s, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "view at theta = 1.6 rad, want 0 ... pi/2");
    assert_int_equal(dif_slopes_of_field(&field, 0.0, 1.0, NAN, &s, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "view at azimuth nan rad, want a number");
    const dif_slope_gauss thin = {0.0, 0.0, 0.1, 0.0, 0.0};
    assert_int_equal(dif_slopes_of_gauss(&thin, 1.0, 0.0, &s, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "slopes without spread along a direction have no density");
    for (int k = 1; k <= 2; k++) {
        test_alloc_fail_from(k);
        assert_int_equal(dif_slopes_of_field(&field, 0.0, 1.0, 0.0, &s, &err), DIF_ERR_NOMEM);
        test_alloc_fail_from(0);
        assert_null(s.unseen);
    }
    dif_field_free(&field);
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_of_gauss__exact_density_has_the_models_moments),
        cmocka_unit_test(test_of_gauss__from_above_is_the_gaussian),
        cmocka_unit_test(test_of_field__random_surface_is_nearly_gaussian),
        cmocka_unit_test(test_of_field__quantised_heights_leave_no_empty_bins),
        cmocka_unit_test(test_of_field__flat_surface),
        cmocka_unit_test(test_bad_input__is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
