#include "tests/near.h"

#include <string.h>

#include "core/field.h"
#include "tests/alloc_count.h"

static void test_create__zero_heights_of_the_asked_shape(void **state)
{
    (void)state;
    dif_field field;
    dif_error err;
    assert_int_equal(dif_field_create(5, 3, 0.1, 0.2, &field, &err), DIF_OK);
    assert_int_equal(field.nx, 5);
    assert_int_equal(field.ny, 3);
    assert_int_equal(dif_field_n(&field), 15);
    for (int i = 0; i < 15; i++)
        assert_near(field.z_um[i], 0.0, 0.0, 0.0);
    assert_int_equal(dif_field_check(&field, &err), DIF_OK);
    dif_field_free(&field);
    assert_null(field.z_um);
    dif_field_free(&field); /* a zeroed one again */
    dif_field_free(NULL);
}

static void test_create__refuses_bad_shapes_with_reasons(void **state)
{
    (void)state;
    static const struct {
        int nx, ny;
        double pitch_x_um, pitch_y_um;
        dif_status status;
        const char *text;
    } cases[] = {
        {0, 4, 0.1, 0.1, DIF_ERR_ARG, "field of 0 x 4 samples, want at least 1 x 1"},
        {4, -1, 0.1, 0.1, DIF_ERR_ARG, "field of 4 x -1 samples, want at least 1 x 1"},
        {40000, 4, 0.1, 0.1, DIF_ERR_SIZE, "field of 40000 x 4 samples, want at most 32768 a side"},
        {3, 100000, 0.1, 0.1, DIF_ERR_SIZE, "field of 3 x 100000 samples, want at most 32768 a side"},
        {4, 4, 0.0, 0.1, DIF_ERR_ARG, "pitch_x = 0 um, want a finite number > 0"},
        {4, 4, 0.1, -2.5, DIF_ERR_ARG, "pitch_y = -2.5 um, want a finite number > 0"},
        {4, 4, NAN, 0.1, DIF_ERR_ARG, "pitch_x = nan um, want a finite number > 0"},
        {4, 4, 0.1, INFINITY, DIF_ERR_ARG, "pitch_y = inf um, want a finite number > 0"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        dif_field field = {.nx = 7};
        dif_error err;
        assert_int_equal(
            dif_field_create(cases[i].nx, cases[i].ny, cases[i].pitch_x_um, cases[i].pitch_y_um, &field, &err),
            cases[i].status);
        assert_string_equal(err.text, cases[i].text);
        assert_int_equal(field.nx, 0);
        assert_null(field.z_um);
    }
}

static void test_check__names_the_place_of_a_bad_height(void **state)
{
    (void)state;
    dif_field field;
    dif_error err;
    assert_int_equal(dif_field_create(4, 3, 0.1, 0.1, &field, &err), DIF_OK);
    field.z_um[2 * 4 + 1] = NAN;
    assert_int_equal(dif_field_check(&field, &err), DIF_ERR_NONFINITE);
    assert_string_equal(err.text, "height at column 1, row 2 is nan, want a finite number");
    field.z_um[2 * 4 + 1] = 0.0;
    field.z_um[3] = -INFINITY;
    assert_int_equal(dif_field_check(&field, &err), DIF_ERR_NONFINITE);
    assert_string_equal(err.text, "height at column 3, row 0 is -inf, want a finite number");
    dif_field_free(&field);
    dif_field none = {.nx = 1, .ny = 1, .pitch_x_um = 1.0, .pitch_y_um = 1.0};
    assert_int_equal(dif_field_check(&none, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "field without heights");
}

static void test_positions__follow_the_frame(void **state)
{
    (void)state;
    const dif_field field = {.nx = 5, .ny = 4, .pitch_x_um = 0.5, .pitch_y_um = 2.0};
    assert_near(dif_field_x_um(&field, 0), -1.0, 0.0, 0.0);
    assert_near(dif_field_x_um(&field, 4), 1.0, 0.0, 0.0);
    assert_near(dif_field_y_um(&field, 0), 3.0, 0.0, 0.0); /* row 0 is the top */
    assert_near(dif_field_y_um(&field, 3), -3.0, 0.0, 0.0);
}

/* z = offset + a x + b y: slopes exact at the edges too, deviation of a uniform grid known in closed form. */
static void test_stats__of_a_tilted_plane(void **state)
{
    (void)state;
    dif_field field;
    dif_field_stats stats;
    dif_error err;
    const double a = 0.25, b = -0.5, offset = 1e6;
    assert_int_equal(dif_field_create(64, 32, 0.5, 0.25, &field, &err), DIF_OK);
    for (int iy = 0; iy < 32; iy++) {
        for (int ix = 0; ix < 64; ix++)
            field.z_um[iy * 64 + ix] = offset + a * dif_field_x_um(&field, ix) + b * dif_field_y_um(&field, iy);
    }
    assert_int_equal(dif_field_stats_of(&field, &stats, &err), DIF_OK);
    const double var_x = 0.5 * 0.5 * (64.0 * 64.0 - 1.0) / 12.0, var_y = 0.25 * 0.25 * (32.0 * 32.0 - 1.0) / 12.0;
    /* heights are rounded to 1.2e-10 by the offset of 1e6; nothing worse may come on top */
    assert_near(stats.mean_um, offset, 0.0, 2e-10);
    assert_near(stats.rms_um, sqrt(a * a * var_x + b * b * var_y), 0.0, 1e-9);
    assert_near(stats.slope_x_rms, fabs(a), 0.0, 1e-9);
    assert_near(stats.slope_y_rms, fabs(b), 0.0, 1e-9);
    assert_near(stats.slope_max, hypot(a, b), 0.0, 1e-9);
    const double reach = 0.5 * (a * 63 * 0.5 - b * 31 * 0.25);
    assert_near(stats.max_um - stats.min_um, 2.0 * reach, 0.0, 1e-9);
    dif_field_free(&field);
}

static void test_stats__quantisation_step(void **state)
{
    (void)state;
    dif_field field;
    dif_field_stats stats;
    dif_error err;
    uint64_t random = 1;
    assert_int_equal(dif_field_create(300, 300, 0.1, 0.1, &field, &err), DIF_OK);
    assert_int_equal(dif_field_stats_of(&field, &stats, &err), DIF_OK);
    assert_near(stats.step_um, 0.0, 0.0, 0.0); /* one value: no step */
    for (int i = 0; i < 90000; i++)            /* eight bits, every third level */
        field.z_um[i] = 3.0 * 0.001 * (double)(test_random_next(&random) % 80);
    assert_int_equal(dif_field_stats_of(&field, &stats, &err), DIF_OK);
    assert_near(stats.step_um, 0.003, 1e-12, 0.0); /* differences of rounded products */
    for (int i = 0; i < 90000; i++)
        field.z_um[i] = test_random(&random, 0.0, 1.0);
    assert_int_equal(dif_field_stats_of(&field, &stats, &err), DIF_OK);
    assert_near(stats.step_um, 0.0, 0.0, 0.0); /* more than 65536 distinct heights */
    dif_field_free(&field);
}

static void test_stats__single_sample_and_single_row(void **state)
{
    (void)state;
    dif_field field;
    dif_field_stats stats;
    dif_error err;
    assert_int_equal(dif_field_create(1, 1, 0.1, 0.1, &field, &err), DIF_OK);
    field.z_um[0] = -2.5;
    assert_int_equal(dif_field_stats_of(&field, &stats, &err), DIF_OK);
    assert_near(stats.mean_um, -2.5, 0.0, 0.0);
    assert_near(stats.rms_um, 0.0, 0.0, 0.0);
    assert_near(stats.slope_max, 0.0, 0.0, 0.0);
    dif_field_free(&field);
    assert_int_equal(dif_field_create(3, 1, 1.0, 1.0, &field, &err), DIF_OK);
    field.z_um[1] = 1.0; /* 0 1 0: slopes 1, 0, -1 */
    assert_int_equal(dif_field_stats_of(&field, &stats, &err), DIF_OK);
    assert_near(stats.slope_x_rms, sqrt(2.0 / 3.0), 1e-15, 0.0);
    assert_near(stats.slope_y_rms, 0.0, 0.0, 0.0);
    dif_field_free(&field);
}

static void test_alloc_failing__leaves_nothing_behind(void **state)
{
    (void)state;
    dif_error err;
    dif_field field = {.nx = 3};
    test_alloc_fail_from(1);
    assert_int_equal(dif_field_create(8, 8, 0.1, 0.1, &field, &err), DIF_ERR_NOMEM);
    assert_string_equal(err.text, "field of 8 x 8 samples");
    assert_null(field.z_um);
    assert_int_equal(field.nx, 0);
    test_alloc_fail_from(0);
    assert_int_equal(dif_field_create(8, 8, 0.1, 0.1, &field, &err), DIF_OK);
    for (int k = 1; k <= 2; k++) {
        dif_field_stats stats;
        test_alloc_fail_from(k);
        assert_int_equal(dif_field_stats_of(&field, &stats, &err), DIF_ERR_NOMEM);
        assert_string_equal(err.text, "table of distinct heights");
        assert_int_equal(test_alloc_live(), 1);
    }
    test_alloc_fail_from(0);
    dif_field_free(&field);
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_create__zero_heights_of_the_asked_shape),
        cmocka_unit_test(test_create__refuses_bad_shapes_with_reasons),
        cmocka_unit_test(test_check__names_the_place_of_a_bad_height),
        cmocka_unit_test(test_positions__follow_the_frame),
        cmocka_unit_test(test_stats__of_a_tilted_plane),
        cmocka_unit_test(test_stats__quantisation_step),
        cmocka_unit_test(test_stats__single_sample_and_single_row),
        cmocka_unit_test(test_alloc_failing__leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
