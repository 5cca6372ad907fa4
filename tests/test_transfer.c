#include "core/transfer.h"

#include "alloc_count.h"
#include "core/units.h"
#include "near.h"

enum { N = 65, N_SIGMA = 33 };

/* A colour map with a kink and a jump of slope. */
static void fill_map(double colour[N][3])
{
    for (int i = 0; i < N; i++) {
        const double t = (double)i / (N - 1);
        colour[i][0] = t * t;
        colour[i][1] = fabs(t - 0.4);
        colour[i][2] = t > 0.5 ? 1.0 : 0.1;
    }
}

static double map_at(const double colour[N][3], int c, double t)
{
    const double x = fmin(fmax(t, 0.0), 1.0) * (N - 1);
    const int i = x < N - 2 ? (int)x : N - 2;
    return colour[i][c] + (x - i) * (colour[i + 1][c] - colour[i][c]);
}

/* Mean of a piecewise linear map over a Gaussian: pieces of its knots, trapezoids inside. */
static double blurred(const double colour[N][3], int c, double mean, double sigma)
{
    enum { STEPS = 40000 };
    double sum = 0.0, weight = 0.0;
    for (int i = 0; i <= STEPS; i++) {
        const double z = -9.0 + 18.0 * i / STEPS, w = exp(-0.5 * z * z);
        sum += w * map_at(colour, c, mean + sigma * z);
        weight += w;
    }
    return sum / weight;
}

static dif_transfer make(double colour[N][3])
{
    dif_transfer transfer;
    fill_map(colour);
    assert_int_equal(dif_transfer_create(N, (const double(*)[3])colour, N_SIGMA, &transfer, NULL), DIF_OK);
    return transfer;
}

static void test_create__rows_are_gaussian_means(void **state)
{
    (void)state;
    double colour[N][3];
    dif_transfer t = make(colour);
    for (int row = 1; row < N_SIGMA; row += 5)
        for (int i = 0; i < N; i += 9)
            for (int c = 0; c < 3; c++) {
                const double part = (double)row / (N_SIGMA - 1), sigma = 0.5 * part * part;
                const double want = blurred((const double(*)[3])colour, c, (double)i / (N - 1), sigma);
                assert_near((double)t.rgb[3 * (row * N + i) + c], want, 0.0, 1e-6); /* float */
            }
    dif_transfer_free(&t);
}

static void test_create__sharp_row_is_the_map(void **state)
{
    (void)state;
    double colour[N][3];
    dif_transfer t = make(colour);
    for (int i = 0; i < N; i++)
        for (int c = 0; c < 3; c++)
            assert_near((double)t.rgb[3 * i + c], colour[i][c], 0.0, 1e-6);
    dif_transfer_free(&t);
}

static void test_create__linear_ramp_stays_where_it_is_in_the_middle(void **state)
{
    (void)state;
    double ramp[2][3] = {{0.0, 1.0, 0.5}, {1.0, 0.0, 0.5}}, rgb[3];
    dif_transfer t;
    assert_int_equal(dif_transfer_create(2, (const double(*)[3])ramp, N_SIGMA, &t, NULL), DIF_OK);
    dif_transfer_colour(&t, 0.5, 0.2, rgb);
    assert_near(rgb[0], 0.5, 1e-6, 0.0); /* by symmetry, although both ends are cut */
    assert_near(rgb[1], 0.5, 1e-6, 0.0);
    assert_near(rgb[2], 0.5, 1e-6, 0.0);
    /* at an end half of the Gaussian is cut: mean of max(0, sigma z) but for what passes the other end */
    dif_transfer_colour(&t, 0.0, 0.125, rgb);
    assert_near(rgb[0], 0.125 / sqrt(DIF_TWO_PI), 1e-5, 0.0);
    dif_transfer_free(&t);
}

static void test_colour__between_places_and_out_of_range(void **state)
{
    (void)state;
    double colour[N][3], rgb[3], edge[3];
    dif_transfer t = make(colour);
    uint64_t seed = 8;
    double worst = 0.0;
    for (int i = 0; i < 200; i++) {
        const double mean = test_random(&seed, 0.0, 1.0), sigma = test_random(&seed, 0.0, 0.5);
        dif_transfer_colour(&t, mean, sigma, rgb);
        worst = fmax(worst, fabs(rgb[0] - blurred((const double(*)[3])colour, 0, mean, sigma)));
    }
    print_message("largest error between places of a smooth channel: %.2g\n", worst);
    assert_at_most(worst, 2e-3); /* 33 rows */
    dif_transfer_colour(&t, 2.0, -1.0, rgb);
    dif_transfer_colour(&t, 1.0, 0.0, edge);
    assert_near(rgb[0], edge[0], 0.0, 0.0);
    dif_transfer_colour(&t, -3.0, 9.0, rgb);
    dif_transfer_colour(&t, 0.0, 0.5, edge);
    assert_near(rgb[1], edge[1], 0.0, 0.0);
    dif_transfer_colour(&t, NAN, NAN, rgb);
    dif_transfer_colour(&t, 0.0, 0.0, edge);
    assert_near(rgb[2], edge[2], 0.0, 0.0);
    dif_transfer_free(&t);
}

static void test_create__bad_input_is_refused(void **state)
{
    (void)state;
    double colour[N][3];
    dif_error err;
    dif_transfer t;
    fill_map(colour);
    const double(*map)[3] = (const double(*)[3])colour;
    assert_int_equal(dif_transfer_create(1, map, 5, &t, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "1 colours and 5 widths, want 2 ... 4096");
    colour[3][1] = NAN;
    assert_int_equal(dif_transfer_create(N, map, 5, &t, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "colour 3 is not finite");
    colour[3][1] = 0.0;
    for (int k = 1; k <= 2; k++) {
        test_alloc_fail_from(k);
        assert_int_equal(dif_transfer_create(N, map, 5, &t, &err), DIF_ERR_NOMEM);
        assert_null(t.rgb);
    }
    test_alloc_fail_from(0);
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_create__rows_are_gaussian_means),
        cmocka_unit_test(test_create__sharp_row_is_the_map),
        cmocka_unit_test(test_create__linear_ramp_stays_where_it_is_in_the_middle),
        cmocka_unit_test(test_colour__between_places_and_out_of_range),
        cmocka_unit_test(test_create__bad_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
