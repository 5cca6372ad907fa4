#include "bench/view.h"

#include <string.h>

#include "alloc_count.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "near.h"
#include "rough.h"

/* Heights of 0 ... 1 um, as map positions. */
typedef struct scene {
    dif_field field;
    dif_pyramid pyramid;
    dif_transfer transfer;
} scene;

static scene scene_of(dif_field field)
{
    scene s = {.field = field};
    assert_int_equal(dif_pyramid_create(&s.field, 0.0, 1.0, &s.pyramid, NULL), DIF_OK);
    assert_int_equal(dif_view_transfer("viridis", &s.transfer, NULL), DIF_OK);
    return s;
}

static void scene_free(scene *s)
{
    dif_transfer_free(&s->transfer);
    dif_pyramid_free(&s->pyramid);
    dif_field_free(&s->field);
}

static dif_view view_of(const scene *s, const dif_view_plan *plan, dif_view_filter filter)
{
    dif_view view;
    assert_int_equal(dif_view_make(&s->pyramid, 1.0, &s->transfer, plan, filter, &view, NULL), DIF_OK);
    return view;
}

/* Random heights with a correlation of some samples, stretched to 0 ... 1. */
static dif_field smooth_random(int n)
{
    dif_surface surface = dif_surface_default(DIF_SURFACE_RANDOM);
    dif_field field;
    dif_field_stats stats;
    surface.nx = surface.ny = n;
    surface.pitch_um = 0.25;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    assert_int_equal(dif_field_stats_of(&field, &stats, NULL), DIF_OK);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        field.z_um[i] = (field.z_um[i] - stats.min_um) / (stats.max_um - stats.min_um);
    return field;
}

static void test_make__zoom_one_shows_the_samples(void **state)
{
    (void)state;
    scene s = scene_of(test_rough_field(20, 13, 0.1, 0.1, 0.8, 4));
    const dif_view_plan plan = dif_view_plan_default();
    dif_view view = view_of(&s, &plan, DIF_VIEW_POINT);
    assert_int_equal(view.nx, 20);
    assert_int_equal(view.ny, 13);
    for (int i = 0; i < 20 * 13; i++) {
        double rgb[3];
        dif_transfer_colour(&s.transfer, s.field.z_um[i], 0.0, rgb);
        assert_int_equal(view.inside[i], 2);
        for (int c = 0; c < 3; c++)
            assert_near((double)view.rgb[3 * i + c], rgb[c], 0.0, 1e-5); /* float heights */
    }
    dif_view_free(&view);
    scene_free(&s);
}

static void test_make__azimuth_turns_the_picture(void **state)
{
    (void)state;
    /* seen from azimuth 0 (the right), up is to the left: what was left is up */
    scene s = scene_of(test_rough_field(9, 7, 0.1, 0.1, 0.8, 4));
    dif_view_plan plan = dif_view_plan_default();
    dif_view straight = view_of(&s, &plan, DIF_VIEW_POINT);
    plan.phi_rad = 0.0;
    dif_view turned = view_of(&s, &plan, DIF_VIEW_POINT);
    assert_int_equal(turned.nx, 7);
    assert_int_equal(turned.ny, 9);
    for (int iy = 0; iy < 7; iy++)
        for (int ix = 0; ix < 9; ix++)
            assert_near((double)turned.rgb[3 * (ix * 7 + 6 - iy)], (double)straight.rgb[3 * (iy * 9 + ix)], 0.0, 1e-5);
    plan.theta_rad = dif_rad_from_deg(60.0); /* half as high, and nothing beside it */
    dif_view tilted = view_of(&s, &plan, DIF_VIEW_FILTERED);
    assert_int_equal(tilted.nx, 7);
    assert_int_equal(tilted.ny, 5);
    dif_view_free(&straight);
    dif_view_free(&turned);
    dif_view_free(&tilted);
    scene_free(&s);
}

static void test_make__beside_the_surface_is_white(void **state)
{
    (void)state;
    scene s = scene_of(test_rough_field(40, 40, 0.1, 0.1, 0.8, 4));
    dif_view_plan plan = dif_view_plan_default();
    plan.phi_rad = 0.25 * DIF_PI;
    dif_view view = view_of(&s, &plan, DIF_VIEW_FILTERED);
    assert_int_equal(view.inside[0], 0);
    assert_near((double)view.rgb[0], 1.0, 0.0, 0.0);
    assert_int_equal(view.inside[view.nx * (view.ny / 2) + view.nx / 2], 2);
    int n_edge = 0;
    for (int i = 0; i < view.nx * view.ny; i++)
        n_edge += view.inside[i] == 1;
    assert_in_range(n_edge, 60, 400); /* a rim around a square of 160 */
    dif_view_free(&view);
    scene_free(&s);
}

/* Differences of a filter from the truth. */
static dif_view_difference against_truth(const scene *s, const dif_view_plan *plan, dif_view_filter filter)
{
    dif_view_difference difference;
    dif_view view = view_of(s, plan, filter), truth = view_of(s, plan, DIF_VIEW_TRUTH);
    assert_int_equal(dif_view_compare(&view, &truth, &difference, NULL), DIF_OK);
    dif_view_free(&view);
    dif_view_free(&truth);
    return difference;
}

static void test_compare__filtered_is_nearest_to_the_truth_at_every_zoom(void **state)
{
    (void)state;
    scene s = scene_of(smooth_random(256));
    static const double zooms[] = {1.0, 0.25, 0.0625};
    for (int i = 0; i < 3; i++) {
        dif_view_plan plan = dif_view_plan_default();
        plan.zoom = zooms[i];
        const dif_view_difference point = against_truth(&s, &plan, DIF_VIEW_POINT);
        const dif_view_difference mean = against_truth(&s, &plan, DIF_VIEW_MEAN);
        const dif_view_difference filtered = against_truth(&s, &plan, DIF_VIEW_FILTERED);
        print_message("zoom %g: dE2000 mean %.3f without filter, %.3f mean height, %.3f filtered\n", zooms[i],
                      point.de_mean, mean.de_mean, filtered.de_mean);
        assert_true(filtered.n > 100);
        assert_at_most(filtered.de_mean, 0.6); /* below what an eye tells apart */
        assert_at_most(filtered.de_mean, 0.5 * mean.de_mean);
        assert_at_most(mean.de_mean, point.de_mean);
    }
    scene_free(&s);
}

static void test_compare__tilted_view_is_filtered_along_its_longer_axis(void **state)
{
    (void)state;
    scene s = scene_of(smooth_random(256));
    dif_view_plan plan = dif_view_plan_default();
    plan.zoom = 0.25;
    plan.theta_rad = dif_rad_from_deg(75.0);
    plan.phi_rad = dif_rad_from_deg(235.0);
    const dif_view_difference mean = against_truth(&s, &plan, DIF_VIEW_MEAN);
    const dif_view_difference filtered = against_truth(&s, &plan, DIF_VIEW_FILTERED);
    assert_at_most(filtered.de_mean, 0.6);
    assert_at_most(filtered.de_mean, 0.5 * mean.de_mean);
    scene_free(&s);
}

static void test_compare__of_itself_is_nothing(void **state)
{
    (void)state;
    scene s = scene_of(test_rough_field(30, 30, 0.1, 0.1, 0.8, 4));
    const dif_view_plan plan = dif_view_plan_default();
    dif_view a = view_of(&s, &plan, DIF_VIEW_TRUTH), b = view_of(&s, &plan, DIF_VIEW_TRUTH);
    dif_view_difference difference;
    assert_int_equal(dif_view_compare(&a, &b, &difference, NULL), DIF_OK); /* the same seed gives the same places */
    assert_near(difference.de_worst, 0.0, 0.0, 0.0);
    assert_near(difference.rms, 0.0, 0.0, 0.0);
    assert_int_equal(difference.n, 900);
    b.rgb[3 * (30 * 7 + 11)] += 0.5f;
    assert_int_equal(dif_view_compare(&a, &b, &difference, NULL), DIF_OK);
    assert_int_equal(difference.worst_x, 11);
    assert_int_equal(difference.worst_y, 7);
    assert_true(difference.de_worst > 1.0 && difference.de_median == 0.0);
    dif_view_free(&a);
    dif_view_free(&b);
    scene_free(&s);
}

static void test_encode__is_srgb(void **state)
{
    (void)state;
    float rgb[] = {0.0f, 1.0f, 0.2140f, 2.0f, -1.0f, 0.5f};
    uint8_t bytes[6];
    const dif_view view = {.nx = 2, .ny = 1, .rgb = rgb};
    dif_view_encode(&view, bytes);
    const uint8_t want[] = {0, 255, 127, 255, 0, 188};
    assert_memory_equal(bytes, want, 6);
}

static void test_bad_input__is_refused(void **state)
{
    (void)state;
    dif_error err;
    dif_view view;
    dif_transfer none;
    scene s = scene_of(test_rough_field(10, 10, 0.1, 0.1, 0.8, 4));
    static const struct {
        double zoom, theta_rad;
        int n_across, n_sample;
        dif_status status;
        const char *text;
    } cases[] = {
        {0.0, 0.0, 4, 32, DIF_ERR_ARG, "zoom 0, want > 0"},
        {1.0, 1.57, 4, 32, DIF_ERR_ARG, "view from theta 1.57, phi 4.71239 rad, want 0 ... 89 degrees and a number"},
        {1.0, 0.0, 1, 32, DIF_ERR_ARG, "1 places across a footprint, want 2 ... 16"},
        {1.0, 0.0, 4, 0, DIF_ERR_ARG, "0 samples on a side of a pixel, want 1 ... 256"},
        {1e4, 0.0, 4, 32, DIF_ERR_SIZE,
         "picture of 100000 x 100000 pixels, want at most 8192 on a side (a smaller zoom)"},
    };
    for (int i = 0; i < 5; i++) {
        dif_view_plan plan = dif_view_plan_default();
        plan.zoom = cases[i].zoom;
        plan.theta_rad = cases[i].theta_rad;
        plan.n_across = cases[i].n_across;
        plan.n_sample = cases[i].n_sample;
        assert_int_equal(dif_view_make(&s.pyramid, 1.0, &s.transfer, &plan, DIF_VIEW_POINT, &view, &err),
                         cases[i].status);
        assert_string_equal(err.text, cases[i].text);
        assert_null(view.rgb);
    }
    assert_int_equal(dif_view_transfer("mauve", &none, &err), DIF_ERR_ARG);
    const dif_view_plan plan = dif_view_plan_default();
    for (int k = 1; k <= 2; k++) {
        test_alloc_fail_from(k);
        assert_int_equal(dif_view_make(&s.pyramid, 1.0, &s.transfer, &plan, DIF_VIEW_POINT, &view, &err),
                         DIF_ERR_NOMEM);
        test_alloc_fail_from(0);
    }
    const dif_view small = {.nx = 1, .ny = 1}, large = {.nx = 2, .ny = 1};
    dif_view_difference difference;
    assert_int_equal(dif_view_compare(&small, &large, &difference, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "views of 1 x 1 and 2 x 1 pixels, want one size");
    scene_free(&s);
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_make__zoom_one_shows_the_samples),
        cmocka_unit_test(test_make__azimuth_turns_the_picture),
        cmocka_unit_test(test_make__beside_the_surface_is_white),
        cmocka_unit_test(test_compare__filtered_is_nearest_to_the_truth_at_every_zoom),
        cmocka_unit_test(test_compare__tilted_view_is_filtered_along_its_longer_axis),
        cmocka_unit_test(test_compare__of_itself_is_nothing),
        cmocka_unit_test(test_encode__is_srgb),
        cmocka_unit_test(test_bad_input__is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
