/* pq: one period, cut from a surface and replicated. */
#include "core/replica.h"
#include "core/units.h"
#include "first_order.h"
#include "fixtures/surfaces.h"
#include "rough.h"

/* The surface that replicas of a cell make. */
static dif_field tile(const dif_field *cell, int nx, int ny)
{
    dif_field field;
    assert_int_equal(dif_field_create(nx * cell->nx, ny * cell->ny, cell->pitch_x_um, cell->pitch_y_um, &field, NULL),
                     DIF_OK);
    for (int iy = 0; iy < field.ny; iy++)
        for (int ix = 0; ix < field.nx; ix++)
            field.z_um[iy * field.nx + ix] = cell->z_um[iy % cell->ny * cell->nx + ix % cell->nx];
    return field;
}

static void test_pq__equals_the_direct_sum_of_its_replicas(void **state)
{
    (void)state;
    enum { N = 40 };
    dif_field field = test_rough_field(23, 17, 0.1, 0.12, 0.4, 6);
    const double periods_um[][3] = {{1.0, 0.6, 0.0}, {1.03, (double)NAN, 0.0}, {1.03, (double)NAN, 0.5 * DIF_PI}};
    for (int c = 0; c < 3; c++) {
        dif_measure_opts opts = dif_measure_opts_default();
        dif_query query[N];
        dif_sample got[N], want[N];
        dif_measure_stats stats;
        dif_field cell;
        dif_replica replica;
        uint64_t random = 3;
        opts.method = DIF_METHOD_PQ;
        opts.period_um = periods_um[c][0];
        opts.period_across_um = periods_um[c][1];
        opts.psi_rad = periods_um[c][2];
        opts.n_replica = 5;
        opts.n_replica_across = 2;
        for (int i = 0; i < N; i++) {
            query[i].wi = dif_vec3_from_angles_rad(test_random(&random, 0.0, 1.4), test_random(&random, 0.0, 6.0));
            query[i].wo = dif_vec3_from_angles_rad(test_random(&random, 0.0, 1.4), test_random(&random, 0.0, 6.0));
            query[i].lambda_um = test_random(&random, 0.38, 0.78);
        }
        assert_int_equal(dif_measure_queries(&field, N, query, 1e-10, &opts, got, &stats, NULL), DIF_OK);
        assert_int_equal(dif_measure_cell(&field, &opts, &cell, &replica, NULL), DIF_OK);
        assert_int_equal(stats.n_replica_x, c < 2 ? 5 : 2);
        assert_int_equal(stats.n_replica_y, c < 2 ? 2 : 5);
        dif_field tiled = tile(&cell, replica.nx, replica.ny);
        opts.method = DIF_METHOD_DIRECT;
        opts.window = DIF_WINDOW_FLAT;
        assert_int_equal(dif_measure_queries(&tiled, N, query, 1e-10, &opts, want, NULL, NULL), DIF_OK);
        for (int i = 0; i < N; i++) {
            assert_near(hypot(got[i].amp_re - want[i].amp_re, got[i].amp_im - want[i].amp_im), 0.0, 0.0, 2e-10);
            assert_near(got[i].brdf_per_sr, want[i].brdf_per_sr, 1e-6, 1e-9);
        }
        dif_field_free(&tiled);
        dif_field_free(&cell);
    }
    dif_field_free(&field);
}

static void test_pq__lands_on_the_grating_equation(void **state)
{
    (void)state;
    dif_surface surface = dif_surface_default(DIF_SURFACE_BLAZED);
    dif_field field;
    surface.ny = 8;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    dif_measure_opts opts = dif_measure_opts_default();
    double mean_nm, sd_nm;
    opts.method = DIF_METHOD_PQ;
    opts.period_um = 2.5;
    for (int side = 0; side < 2; side++) {
        opts.n_replica = 500;
        test_first_order(&field, &opts, 180.0 * side, "-55:-40:0.01", &mean_nm, &sd_nm);
        print_message("blazed, 500 replicas, azimuth %d: %.3f nm, sd %.3f\n", 180 * side, mean_nm, sd_nm);
        assert_near(mean_nm, 2500.0, 0.0, 0.05);
        /* 26 periods fill 65 um; a grating so short has its maxima beside the orders, as its direct sum has, too */
        opts.n_replica = DIF_REPLICAS_FROM_WINDOW;
        test_first_order(&field, &opts, 180.0 * side, "-55:-40:0.01", &mean_nm, &sd_nm);
        print_message("blazed, 26 replicas, azimuth %d: %.3f nm, sd %.3f\n", 180 * side, mean_nm, sd_nm);
        assert_true(fabs(mean_nm - 2500.0) > 0.5 && fabs(mean_nm - 2500.0) < 10.0);
    }
    dif_field_free(&field);
}

static void test_pq__answers_with_the_period_it_is_given(void **state)
{
    (void)state;
    dif_field field;
    dif_measure_opts opts = dif_measure_opts_default();
    if (!test_read_scan("elaphe_65um.png", 0.375, &field))
        skip();
    opts.method = DIF_METHOD_PQ;
    opts.n_replica = 500;
    for (int i = 0; i < 3; i++) {
        const double given_nm[] = {1110.0, 1126.8, 1144.262};
        double mean_nm, sd_nm;
        opts.period_um = dif_um_from_nm(given_nm[i]);
        test_first_order(&field, &opts, 180.0, "-40:-15:0.01", &mean_nm, &sd_nm);
        print_message("Elaphe, one period of %.3f nm replicated: %.3f nm, sd %.3f\n", given_nm[i], mean_nm, sd_nm);
        /* the angular grid's 0.01 deg are 0.3 nm here */
        assert_near(mean_nm, given_nm[i], 0.0, 0.1);
    }
    dif_field_free(&field);
}

static void test_pq__finds_its_period_in_the_heights(void **state)
{
    (void)state;
    dif_surface surface = dif_surface_default(DIF_SURFACE_BLAZED);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_field field, flat;
    double mean_nm, sd_nm;
    surface.ny = 32;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    assert_int_equal(dif_measure_find_period(&field, &opts, NULL), DIF_OK);
    assert_near(opts.period_um, 2.5, 0.0, 5e-5);
    assert_near(sin(opts.psi_rad), 0.0, 0.0, 1e-3);
    opts.method = DIF_METHOD_PQ;
    opts.n_replica = 500;
    test_first_order(&field, &opts, 0.0, "-55:-40:0.01", &mean_nm, &sd_nm);
    print_message("blazed, period found in its heights: %.3f nm, replicated 500 times: %.3f nm\n",
                  dif_nm_from_um(opts.period_um), mean_nm);
    assert_near(mean_nm, 2500.0, 0.0, 0.06); /* 0.045 of the fit and 0.01 of the angular grid */
    dif_field_free(&field);
    /* what has no period keeps none */
    opts = dif_measure_opts_default();
    assert_int_equal(dif_field_create(64, 64, 0.1, 0.1, &flat, NULL), DIF_OK);
    assert_int_equal(dif_measure_find_period(&flat, &opts, NULL), DIF_ERR_FIT);
    dif_error err;
    assert_int_equal(dif_measure_find_period(&flat, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "no options to put the period into");
    /* the defaults know no period */
    dif_field cell;
    dif_replica replica;
    assert_int_equal(dif_measure_cell(&flat, NULL, &cell, &replica, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "sheet needs the surface's period, and none was given");
    assert_null(cell.z_um);
    assert_true(isnan(opts.period_um));
    dif_field_free(&flat);
}

static void test_pq__bad_periods_have_their_codes(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 30, 0.1, 0.1, 0.2, 1);
    const struct {
        double period_um, across_um, psi_rad;
        int n_replica;
        dif_status status;
        const char *text;
    } bad[] = {
        {(double)NAN, (double)NAN, 0.0, 3, DIF_ERR_ARG, "pq needs the surface's period, and none was given"},
        {0.0, (double)NAN, 0.0, 3, DIF_ERR_ARG, "a period of 0 um, want > 0"},
        {-2.5, (double)NAN, 0.0, 3, DIF_ERR_ARG, "a period of -2.5 um, want > 0"},
        {4.5, (double)NAN, 0.0, 3, DIF_ERR_ARG, "a period of 4.5 um along x is larger than the patch of 4 um"},
        {3.5, (double)NAN, 0.5 * DIF_PI, 3, DIF_ERR_ARG, "a period of 3.5 um along y is larger than the patch of 3 um"},
        {0.15, (double)NAN, 0.0, 3, DIF_ERR_ARG, "a period of 0.15 um along x is below two samples of 0.1 um"},
        {1.0, -1.0, 0.0, 3, DIF_ERR_ARG, "a period of -1 um across, want > 0"},
        {1.0, 1.0, 0.5, 3, DIF_ERR_UNSUPPORTED,
         "two periods need grooves along x or y, these are turned by 28.6479 deg"},
        {1.0, (double)NAN, 0.0, 0, DIF_ERR_ARG, "0 replicas, want 1 ... 1000000"},
        {1.0, (double)NAN, 0.0, -7, DIF_ERR_ARG, "-7 replicas, want 1 ... 1000000"},
        {1.0, (double)NAN, 0.0, 2000000000, DIF_ERR_ARG, "2000000000 replicas, want 1 ... 1000000"},
    };
    dif_plan plan = test_plan(30.0, 0.0, "-40:40:20", "500");
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        dif_measure_opts opts = dif_measure_opts_default();
        dif_table table;
        dif_error err;
        opts.method = DIF_METHOD_PQ;
        opts.period_um = bad[i].period_um;
        opts.period_across_um = bad[i].across_um;
        opts.psi_rad = bad[i].psi_rad;
        opts.n_replica = bad[i].n_replica;
        assert_int_equal(dif_measure_table(&field, &plan, 1e-3, &opts, &table, NULL, &err), bad[i].status);
        assert_string_equal(err.text, bad[i].text);
        assert_null(table.value);
    }
    dif_plan_free(&plan);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pq__equals_the_direct_sum_of_its_replicas),
        cmocka_unit_test(test_pq__lands_on_the_grating_equation),
        cmocka_unit_test(test_pq__answers_with_the_period_it_is_given),
        cmocka_unit_test(test_pq__finds_its_period_in_the_heights),
        cmocka_unit_test(test_pq__bad_periods_have_their_codes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
