#include "bench/measure.h"

#include "alloc_count.h"
#include "bench/scan.h"
#include "core/units.h"
#include "rough.h"

static dif_plan make_plan(bool fixed_is_wo, double fixed_deg, double azimuth_deg, const char *angle_deg,
                          const char *lambda_nm)
{
    dif_range angle, lambda;
    dif_plan plan;
    assert_int_equal(dif_range_parse(angle_deg, &angle, NULL), DIF_OK);
    assert_int_equal(dif_range_parse(lambda_nm, &lambda, NULL), DIF_OK);
    assert_int_equal(dif_scan_plan(fixed_is_wo, fixed_deg, azimuth_deg, &angle, &lambda, &plan, NULL), DIF_OK);
    return plan;
}

static dif_table measure(const dif_field *field, const dif_plan *plan, double tol, const dif_measure_opts *opts,
                         dif_measure_stats *stats)
{
    dif_table table;
    dif_error err = {DIF_OK, ""};
    if (dif_measure_table(field, plan, tol, opts, &table, stats, &err) != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(err.status, DIF_OK);
    return table;
}

static double worst_amplitude(const dif_table *a, const dif_table *b)
{
    double worst = 0.0;
    for (int i = 0; i < a->plan.n_angle * a->plan.n_lambda; i++)
        worst = fmax(worst, fabs(sqrt(a->value[i]) - sqrt(b->value[i])));
    return worst;
}

static void test_table__methods_agree_within_their_tolerance(void **state)
{
    (void)state;
    dif_field field = test_rough_field(90, 71, 0.05, 0.05, 0.6, 9);
    dif_measure_opts opts = dif_measure_opts_default();
    opts.sigma_um = 1.0;
    opts.quantity = DIF_QUANTITY_POWER;
    for (int average = 0; average < 2; average++)
        for (int azimuth = 0; azimuth < 3; azimuth++) {
            const double azimuths_deg[] = {0.0, 90.0, 37.0};
            dif_plan plan = make_plan(azimuth == 1, 75.0, azimuths_deg[azimuth], "-60:60:7", "380:780:100");
            opts.average = (dif_average)average;
            opts.method = DIF_METHOD_DIRECT;
            dif_measure_stats stats;
            dif_table truth = measure(&field, &plan, 1e-3, &opts, &stats);
            assert_int_equal(stats.n_window,
                             average ? dif_window_tile_count(DIF_WINDOW_GAUSS, 1.0, DIF_AVERAGE_WELCH, &field) : 1);
            for (int method = 0; method < 2; method++)
                for (double tol = 1e-2; tol > 1e-11; tol *= 1e-4) {
                    opts.method = (dif_method)method;
                    dif_table table = measure(&field, &plan, tol, &opts, &stats);
                    assert_at_most(stats.bound, tol);
                    assert_at_most(worst_amplitude(&table, &truth), tol);
                    dif_table_free(&table);
                }
            dif_table_free(&truth);
            dif_plan_free(&plan);
        }
    dif_field_free(&field);
}

static void fill_queries(int n, dif_query *query)
{
    uint64_t random = 21;
    for (int i = 0; i < n; i++) {
        query[i].wi = dif_vec3_from_angles_rad(test_random(&random, 0.0, 1.5), test_random(&random, 0.0, DIF_TWO_PI));
        query[i].wo = dif_vec3_from_angles_rad(test_random(&random, 0.0, 1.5), test_random(&random, 0.0, DIF_TWO_PI));
        query[i].lambda_um = test_random(&random, 0.38, 0.78);
    }
}

static void test_queries__amplitudes_meet_the_tolerance(void **state)
{
    (void)state;
    enum { N = 100 };
    dif_field field = test_rough_field(80, 61, 0.05, 0.06, 0.4, 2);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_query query[N];
    dif_sample truth[N], sample[N];
    opts.sigma_um = 0.8;
    fill_queries(N, query);
    opts.method = DIF_METHOD_DIRECT;
    assert_int_equal(dif_measure_queries(&field, N, query, 1e-3, &opts, truth, NULL, NULL), DIF_OK);
    for (double tol = 1e-3; tol > 5e-13; tol *= 1e-3)
        for (int method = 0; method < 2; method++) {
            double worst = 0.0;
            dif_measure_stats stats;
            opts.method = (dif_method)method;
            assert_int_equal(dif_measure_queries(&field, N, query, tol, &opts, sample, &stats, NULL), DIF_OK);
            for (int i = 0; i < N; i++)
                worst = fmax(worst, hypot(sample[i].amp_re - truth[i].amp_re, sample[i].amp_im - truth[i].amp_im));
            assert_at_most(stats.bound, tol);
            assert_at_most(worst, tol);
        }
    dif_field_free(&field);
}

static void test_queries__power_is_reciprocal(void **state)
{
    (void)state;
    enum { N = 50 };
    dif_field field = test_rough_field(80, 61, 0.05, 0.06, 0.4, 2);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_query query[N], swapped[N];
    dif_sample a[N], b[N];
    opts.sigma_um = 0.8;
    fill_queries(N, query);
    for (int i = 0; i < N; i++)
        swapped[i] = (dif_query){query[i].wo, query[i].wi, query[i].lambda_um};
    assert_int_equal(dif_measure_queries(&field, N, query, 1e-9, &opts, a, NULL, NULL), DIF_OK);
    assert_int_equal(dif_measure_queries(&field, N, swapped, 1e-9, &opts, b, NULL, NULL), DIF_OK);
    for (int i = 0; i < N; i++) {
        assert_near(a[i].power, b[i].power, 0.0, 1e-12);
        /* the absolute BRDF is reciprocal, too; rho carries cos_o and is not */
        assert_near(a[i].brdf_per_sr, b[i].brdf_per_sr, 1e-9, 1e-12);
    }
    dif_field_free(&field);
}

static void test_queries__table_and_queries_agree(void **state)
{
    (void)state;
    dif_field field = test_rough_field(60, 61, 0.05, 0.06, 0.4, 2);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_plan plan = make_plan(false, 30.0, 200.0, "-80:80:20", "400:700:150");
    opts.sigma_um = 0.7;
    opts.average = DIF_AVERAGE_WELCH;
    for (int quantity = 0; quantity < 3; quantity++) {
        opts.quantity = (dif_quantity)quantity;
        dif_table table = measure(&field, &plan, 1e-9, &opts, NULL);
        for (int i = 0; i < plan.n_angle * plan.n_lambda; i++) {
            dif_query query = {.lambda_um = plan.lambda_um[i / plan.n_angle]};
            dif_sample sample;
            dif_plan_directions(&plan, i % plan.n_angle, &query.wi, &query.wo);
            assert_int_equal(dif_measure_queries(&field, 1, &query, 1e-9, &opts, &sample, NULL, NULL), DIF_OK);
            const double got[] = {sample.power, sample.rho, sample.brdf_per_sr};
            /* two amplitudes of at most 1, each good to 1e-9, times gains of up to 30 */
            assert_near(table.value[i], got[quantity], 0.0, 1e-7);
            assert_true(isnan(sample.amp_re));
        }
        dif_table_free(&table);
    }
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_table__flat_mirror_has_its_closed_form(void **state)
{
    (void)state;
    dif_field field;
    const int n = 64;
    const double pitch_um = 0.05;
    dif_measure_opts opts = dif_measure_opts_default();
    dif_plan plan = make_plan(false, 20.0, 0.0, "-60:20:1", "500");
    opts.window = DIF_WINDOW_FLAT;
    opts.quantity = DIF_QUANTITY_POWER;
    assert_int_equal(dif_field_create(n, n, pitch_um, pitch_um, &field, NULL), DIF_OK);
    dif_table table = measure(&field, &plan, 1e-11, &opts, NULL);
    for (int i = 0; i < plan.n_angle; i++) {
        double s, c;
        dif_plan_transfer(&plan, i, &s, &c);
        const double half = DIF_PI * s * pitch_um / 0.5;
        const double want = fabs(half) < 1e-12 ? 1.0 : pow(sin(n * half) / (n * sin(half)), 2.0);
        assert_near(table.value[i], want, 0.0, 3e-11);
    }
    dif_table_free(&table);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_check__sees_a_wrong_table(void **state)
{
    (void)state;
    dif_field field = test_rough_field(60, 40, 0.05, 0.05, 0.3, 2);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_plan plan = make_plan(false, 75.0, 0.0, "-60:60:10", "400:700:100");
    dif_measure_check check;
    opts.sigma_um = 1.0;
    dif_table table = measure(&field, &plan, 1e-6, &opts, NULL);
    assert_int_equal(dif_measure_check_table(&field, &table, &opts, 40, 1, &check, NULL), DIF_OK);
    assert_int_equal(check.n_sample, 40);
    assert_at_most(check.worst_amplitude, 1e-6);
    for (int i = 0; i < plan.n_angle * plan.n_lambda; i++)
        table.value[i] *= 1.1;
    assert_int_equal(dif_measure_check_table(&field, &table, &opts, 40, 1, &check, NULL), DIF_OK);
    assert_true(check.worst_amplitude > 1e-4);
    assert_near(check.worst_value, 1.1 * check.worst_direct, 1e-3, 0.0);
    dif_table_free(&table);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void note_progress(void *self, double share)
{
    double *last = self;
    assert_true(share > *last && share <= 1.0);
    *last = share;
}

static void test_table__progress_runs_up_to_one(void **state)
{
    (void)state;
    dif_field field = test_rough_field(60, 60, 0.05, 0.05, 0.3, 2);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_plan plan = make_plan(false, 75.0, 0.0, "-60:60:10", "400:700:100");
    double last = 0.0;
    opts.sigma_um = 0.5;
    opts.average = DIF_AVERAGE_WELCH;
    opts.n_thread = 1;
    opts.progress = note_progress;
    opts.progress_self = &last;
    dif_table table = measure(&field, &plan, 1e-3, &opts, NULL);
    assert_near(last, 1.0, 0.0, 0.0);
    dif_table_free(&table);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_measure__bad_arguments_have_their_codes(void **state)
{
    (void)state;
    dif_field field = test_rough_field(8, 8, 0.05, 0.05, 0.3, 2);
    dif_plan plan = make_plan(false, 75.0, 0.0, "-60:60:60", "400");
    dif_measure_opts opts = dif_measure_opts_default(), bad = opts;
    dif_table table;
    dif_sample sample;
    dif_error err;
    dif_query query = {dif_vec3_from_angles_rad(0.1, 0.0), dif_vec3_from_angles_rad(1.6, 0.0), 0.5};
    assert_int_equal(dif_measure_table(&field, &plan, 0.0, &opts, &table, NULL, &err), DIF_ERR_TOL);
    assert_null(table.value);
    bad.sigma_um = 0.0;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-3, &bad, &table, NULL, &err), DIF_ERR_ARG);
    bad = opts;
    bad.index.kappa = -1.0;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-3, &bad, &table, NULL, &err), DIF_ERR_ARG);
    bad = opts;
    bad.n_thread = -1;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-3, &bad, &table, NULL, &err), DIF_ERR_ARG);
    assert_int_equal(dif_measure_queries(&field, 1, &query, 1e-3, &opts, &sample, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "query 1: a direction is not above the surface");
    query.wo = dif_vec3_from_angles_rad(0.2, 0.0);
    query.lambda_um = -0.5;
    assert_int_equal(dif_measure_queries(&field, 1, &query, 1e-3, &opts, &sample, NULL, &err), DIF_ERR_ARG);
    plan.angle_rad[0] = 0.5 * DIF_PI;
    assert_int_equal(dif_measure_table(&field, &plan, 1e-3, &opts, &table, NULL, &err), DIF_ERR_ARG);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_measure__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field = test_rough_field(16, 16, 0.05, 0.05, 0.1, 1);
    dif_plan plan = make_plan(false, 75.0, 0.0, "-60:60:60", "400");
    const dif_measure_opts opts = dif_measure_opts_default();
    const int live = test_alloc_live();
    for (int form = 0; form < 2; form++) {
        int n_failed = 0;
        for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; n_failed++) {
            dif_table table = {0};
            const dif_query query = {{0.0, 0.0, 1.0}, {0.0, 0.6, 0.8}, 0.5};
            dif_sample sample;
            test_alloc_fail_from(n_failed + 1);
            status = form ? dif_measure_queries(&field, 1, &query, 1e-3, &opts, &sample, NULL, NULL)
                          : dif_measure_table(&field, &plan, 1e-3, &opts, &table, NULL, NULL);
            test_alloc_fail_from(0);
            assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
            dif_table_free(&table);
            assert_int_equal(test_alloc_live(), live);
        }
        assert_true(n_failed > 10);
    }
    dif_plan_free(&plan);
    dif_field_free(&field);
}

static void test_measure__null_options_are_the_defaults(void **state)
{
    (void)state;
    dif_field field = test_rough_field(20, 20, 0.1, 0.1, 0.3, 3);
    const dif_measure_opts opts = dif_measure_opts_default();
    const dif_query query = {dif_vec3_from_angles_rad(0.3, 0.1), dif_vec3_from_angles_rad(0.5, 2.0), 0.55};
    dif_plan plan = make_plan(false, 75.0, 0.0, "-60:60:30", "400:700:100");
    dif_sample said, unsaid;
    assert_int_equal(dif_measure_queries(&field, 1, &query, 1e-9, &opts, &said, NULL, NULL), DIF_OK);
    assert_int_equal(dif_measure_queries(&field, 1, &query, 1e-9, NULL, &unsaid, NULL, NULL), DIF_OK);
    assert_memory_equal(&said, &unsaid, sizeof said);
    dif_table with = measure(&field, &plan, 1e-9, &opts, NULL), without = measure(&field, &plan, 1e-9, NULL, NULL);
    assert_at_most(worst_amplitude(&with, &without), 0.0);
    double said_xyz[5][3], unsaid_xyz[5][3];
    assert_int_equal(plan.n_angle, 5);
    assert_int_equal(dif_measure_colours(&field, &plan, 1e-9, &opts, said_xyz, NULL, NULL), DIF_OK);
    assert_int_equal(dif_measure_colours(&field, &plan, 1e-9, NULL, unsaid_xyz, NULL, NULL), DIF_OK);
    assert_memory_equal(said_xyz, unsaid_xyz, sizeof said_xyz);
    dif_measure_check check;
    assert_int_equal(dif_measure_check_table(&field, &without, NULL, 5, 1, &check, NULL), DIF_OK);
    assert_at_most(check.worst_amplitude, 1e-9);
    dif_table_free(&with);
    dif_table_free(&without);
    dif_plan_free(&plan);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table__methods_agree_within_their_tolerance),
        cmocka_unit_test(test_queries__amplitudes_meet_the_tolerance),
        cmocka_unit_test(test_queries__power_is_reciprocal),
        cmocka_unit_test(test_queries__table_and_queries_agree),
        cmocka_unit_test(test_table__flat_mirror_has_its_closed_form),
        cmocka_unit_test(test_check__sees_a_wrong_table),
        cmocka_unit_test(test_table__progress_runs_up_to_one),
        cmocka_unit_test(test_measure__bad_arguments_have_their_codes),
        cmocka_unit_test(test_measure__every_failing_allocation_is_reported),
        cmocka_unit_test(test_measure__null_options_are_the_defaults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
