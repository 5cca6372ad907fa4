#include "near.h"

#include <string.h>

#include "alloc_count.h"
#include "bench/fit.h"
#include "core/grating.h"
#include "core/units.h"

/* A synthetic instrument: Gaussian lines at the orders of a blazed grating. */
typedef struct instrument {
    double theta_i_deg, low_deg, high_deg, step_deg;
    double lambda_nm[3]; /* min, max, step */
    double period_um;    /* NaN: no grating at all */
    double sigma_per_um, noise, background, offset_rad;
    dif_quantity quantity;
} instrument;

static const instrument bench = {.theta_i_deg = 10.0,
                                 .low_deg = -60.0,
                                 .high_deg = 60.0,
                                 .step_deg = 0.05,
                                 .lambda_nm = {380.0, 780.0, 8.0},
                                 .period_um = 2.5,
                                 .sigma_per_um = 0.0069,
                                 .noise = 1e-3};

static double gauss(uint64_t *seed)
{
    const double u = test_random(seed, 1e-300, 1.0);
    return sqrt(-2.0 * log(u)) * cos(test_random(seed, 0.0, DIF_TWO_PI));
}

static dif_plan make_plan(const instrument *in)
{
    const int n_angle = (int)lround((in->high_deg - in->low_deg) / in->step_deg) + 1;
    const int n_lambda = (int)lround((in->lambda_nm[1] - in->lambda_nm[0]) / in->lambda_nm[2]) + 1;
    dif_plan plan;
    dif_error err;
    assert_int_equal(dif_plan_create(n_angle, n_lambda, &plan, &err), DIF_OK);
    plan.fixed_rad = dif_rad_from_deg(in->theta_i_deg);
    for (int i = 0; i < n_angle; i++)
        plan.angle_rad[i] = dif_rad_from_deg(in->low_deg + i * in->step_deg);
    for (int i = 0; i < n_lambda; i++)
        plan.lambda_um[i] = dif_um_from_nm(in->lambda_nm[0] + i * in->lambda_nm[2]);
    return plan;
}

/* Power of the lines at one angle and wavelength. */
static double lines(const instrument *in, double fixed_rad, double angle_rad, double lambda_um)
{
    const dif_grating grating = {.profile = DIF_PROFILE_BLAZED, .period_um = in->period_um, .height_um = 0.25};
    const double f = (sin(fixed_rad) + sin(angle_rad)) / lambda_um;
    const double w = -(cos(fixed_rad) + cos(angle_rad));
    double sum = 0.0;
    for (int m = -8; m <= 8 && in->period_um > 0.0; m++) {
        const double t = (f - m / in->period_um) / in->sigma_per_um;
        if (fabs(t) < 9.0)
            sum += dif_grating_power(&grating, m, DIF_TWO_PI * w / lambda_um) * exp(-0.5 * t * t);
    }
    return sum;
}

static dif_table make_table(const instrument *in)
{
    dif_plan plan = make_plan(in);
    dif_table table;
    dif_error err;
    uint64_t seed = 7;
    assert_int_equal(dif_table_create(&plan, in->quantity, &table, &err), DIF_OK);
    for (int il = 0; il < plan.n_lambda; il++)
        for (int ia = 0; ia < plan.n_angle; ia++) {
            const double p = lines(in, plan.fixed_rad, plan.angle_rad[ia] + in->offset_rad, plan.lambda_um[il]);
            dif_vec3 wi, wo;
            dif_plan_directions(&plan, ia, &wi, &wo);
            table.value[(size_t)il * (size_t)plan.n_angle + (size_t)ia] =
                (p + in->background + in->noise * gauss(&seed)) *
                dif_brdf_gain(in->quantity, dif_index_default(), wi, wo, plan.lambda_um[il], 4000.0);
        }
    dif_plan_free(&plan);
    return table;
}

static dif_fit_table_opts grating_opts(void)
{
    dif_fit_table_opts opts = dif_fit_table_opts_default();
    opts.common_period = true;
    return opts;
}

static dif_fit_result fit(const dif_table *table, const dif_fit_table_opts *opts)
{
    dif_fit_result result;
    dif_error err = {.text = ""};
    const dif_status status = dif_fit_table(table, opts, &result, &err);
    if (status != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(status, DIF_OK);
    return result;
}

/* Fits and expects a refusal whose line begins with `text`. */
static void refuse(const dif_table *table, const dif_fit_table_opts *opts, dif_status want, const char *text)
{
    dif_fit_result result;
    dif_error err = {.text = ""};
    const dif_status status = dif_fit_table(table, opts, &result, &err);
    if (status != want || strncmp(err.text, text, strlen(text)) != 0)
        print_error("status %d, \"%s\", want %d, \"%s\"\n", (int)status, err.text, (int)want, text);
    assert_int_equal(status, want);
    assert_memory_equal(err.text, text, strlen(text));
    assert_int_equal(result.n_ridge, 0);
    assert_true(result.period_um == 0.0); /* zeroed: nothing to mistake for a period */
}

/* Period within 3 of its own stated uncertainties, and those small. */
static void assert_period(const dif_fit_result *r, double want_um, double uncertainty_max_um)
{
    assert_at_most(r->period_uncertainty_um, uncertainty_max_um);
    assert_near(r->period_um, want_um, 0.0, 3.0 * r->period_uncertainty_um);
    assert_true(r->period_uncertainty_um >= r->period_sd_um);
    assert_true(!(r->period_uncertainty_um < r->period_scatter_um));
}

static void test_table__several_orders_one_period(void **state)
{
    (void)state;
    dif_table table = make_table(&bench);
    const dif_fit_table_opts opts = grating_opts();
    const dif_fit_result r = fit(&table, &opts);
    assert_period(&r, 2.5, 2e-5);
    assert_true(r.n_ridge >= 5);
    assert_int_equal(r.ridge[0].order, -1); /* the blazed one */
    double sum = 0.0;
    bool seen[17] = {false};
    for (int k = 0; k < r.n_ridge; k++) {
        const dif_fit_ridge *q = &r.ridge[k];
        assert_near(q->f_per_um, q->order / r.period_um, 1e-12, 0.0);
        assert_near(q->width_per_um, bench.sigma_per_um, 0.01, 0.0);
        assert_true(k == 0 || q->weight <= r.ridge[k - 1].weight);
        assert_true(q->order >= -8 && q->order <= 8 && q->order != 0 && !seen[q->order + 8]);
        seen[q->order + 8] = true;
        sum += q->weight;
    }
    assert_true(seen[8 - 3] && seen[8 - 2] && seen[8 + 1] && seen[8 + 2] && seen[8 + 3]);
    assert_near(sum, 1.0, 1e-12, 0.0);
    assert_string_equal(r.note, "");
    assert_near(r.residual_rms, bench.noise, 0.05, 0.0); /* all that is left is the noise */
    dif_table_free(&table);
}

static void test_table__gain_is_divided_out(void **state)
{
    (void)state;
    const dif_fit_table_opts opts = grating_opts();
    instrument in = bench;
    in.noise = 0.0;
    double period[3];
    for (int q = 0; q < 3; q++) {
        in.quantity = (dif_quantity)q;
        dif_table table = make_table(&in);
        period[q] = fit(&table, &opts).period_um;
        dif_table_free(&table);
    }
    assert_near(period[1], period[0], 1e-9, 0.0);
    assert_near(period[2], period[0], 1e-9, 0.0);
    assert_near(period[0], 2.5, 1e-6, 0.0); /* splines of the amplitudes are good to a few 1e-4 */
}

static void test_table__background_and_holes(void **state)
{
    (void)state;
    instrument in = bench;
    in.background = 0.3;
    dif_table table = make_table(&in);
    const size_t n = (size_t)table.plan.n_angle * (size_t)table.plan.n_lambda;
    for (size_t i = 0; i < n; i += 3)
        table.value[i] = NAN;
    for (size_t i = 100; i < n; i += 997)
        table.value[i] += 0.5; /* glints */
    const dif_fit_table_opts opts = grating_opts();
    const dif_fit_result r = fit(&table, &opts);
    assert_period(&r, 2.5, 1e-3);
    dif_table_free(&table);
}

static void test_table__separate_ridges(void **state)
{
    (void)state;
    instrument in = bench;
    in.low_deg = 5.0; /* orders 1 ... 3 */
    dif_table table = make_table(&in);
    const dif_fit_table_opts opts = dif_fit_table_opts_default();
    const dif_fit_result r = fit(&table, &opts);
    assert_true(r.n_ridge >= 2);
    for (int k = 0; k < r.n_ridge; k++) {
        const double m = round(2.5 * r.ridge[k].f_per_um);
        assert_int_equal(r.ridge[k].order, 1);
        assert_near(r.ridge[k].f_per_um, m / 2.5, 0.0, 4.0 * r.ridge[k].f_sd_per_um + 1e-6);
        assert_near(r.ridge[k].period_um, 1.0 / r.ridge[k].f_per_um, 1e-12, 0.0);
    }
    assert_near(r.period_um, r.ridge[0].period_um, 0.0, 0.0);
    assert_non_null(strstr(r.note, "order 1 assumed for each ridge"));
    dif_table_free(&table);
}

static void test_table__order_of_one_ridge(void **state)
{
    (void)state;
    instrument in = bench;
    in.low_deg = 6.0;
    in.high_deg = 20.0; /* order 1 of 1.2 um, f = 0.83, alone in 0.70 ... 1.03 */
    in.period_um = 1.2;
    in.lambda_nm[0] = 400.0;
    in.lambda_nm[1] = 500.0;
    in.lambda_nm[2] = 2.0;
    dif_table table = make_table(&in);
    dif_fit_table_opts opts = grating_opts();
    dif_fit_result r = fit(&table, &opts);
    assert_period(&r, 1.2, 1e-3);
    assert_non_null(strstr(r.note, "order 1 assumed: one ridge cannot determine its order"));
    opts.order = 2;
    r = fit(&table, &opts);
    assert_near(r.period_um, 2.4, 0.0, 3.0 * r.period_uncertainty_um);
    assert_non_null(strstr(r.note, "order 2 as given: one ridge cannot check it"));
    opts.order = -1;
    refuse(&table, &opts, DIF_ERR_FIT, "order -1 is given, but the strongest ridge lies at 0.83");
    opts = grating_opts();
    opts.period_start_um = 0.75;
    refuse(&table, &opts, DIF_ERR_FIT, "the strongest ridge (0.83");
    dif_table_free(&table);
}

static void test_table__wrong_order_is_refused(void **state)
{
    (void)state;
    dif_table table = make_table(&bench);
    dif_fit_table_opts opts = grating_opts();
    for (int order = -3; order <= -2; order++) {
        char text[64];
        snprintf(text, sizeof text, "order %d of the strongest ridge: all ", order);
        opts.order = order;
        refuse(&table, &opts, DIF_ERR_FIT, text);
    }
    opts.order = -1;
    const dif_fit_result r = fit(&table, &opts);
    assert_period(&r, 2.5, 2e-5);
    dif_table_free(&table);
}

static void test_table__angular_offset(void **state)
{
    (void)state;
    instrument in = bench;
    in.offset_rad = 2e-3;
    dif_table table = make_table(&in);
    dif_fit_table_opts opts = grating_opts();
    opts.offset_free = true;
    const dif_fit_result r = fit(&table, &opts);
    assert_near(r.offset_rad, in.offset_rad, 0.0, 4.0 * r.offset_sd_rad);
    assert_at_most(r.offset_sd_rad, 1e-4);
    assert_period(&r, 2.5, 2e-3);
    dif_table_free(&table);
    /* one order over 3 % of the wavelengths cannot tell an offset from a period */
    in.low_deg = 1.0;
    in.high_deg = 9.0;
    in.lambda_nm[0] = 600.0;
    in.lambda_nm[1] = 620.0;
    in.lambda_nm[2] = 0.5;
    table = make_table(&in);
    refuse(&table, &opts, DIF_ERR_FIT, "the ");
    dif_table_free(&table);
}

static void test_table__nothing_to_fit(void **state)
{
    (void)state;
    dif_fit_table_opts opts = grating_opts();
    instrument in = bench;
    in.low_deg = 2.0;
    in.high_deg = 20.0;
    in.period_um = NAN;
    in.noise = 0.01;
    in.background = 1.0;
    dif_table table = make_table(&in); /* noise only */
    opts.line = (dif_fit_line){.known = true, .window = {.sigma_um = 16.25}, .size_x_um = 65.0, .size_y_um = 65.0};
    refuse(&table, &opts, DIF_ERR_FIT, "no ridge is supported by the table: of ");
    opts = grating_opts();
    refuse(&table, &opts, DIF_ERR_FIT, "no ");
    const size_t n = (size_t)table.plan.n_angle * (size_t)table.plan.n_lambda;
    for (size_t i = 0; i < n; i++)
        table.value[i] = 0.25;
    refuse(&table, &opts, DIF_ERR_FIT, "the table is constant: no ridge to fit");
    for (size_t i = 0; i < n; i++)
        table.value[i] = -1.0 - 1e-3 * (double)(i % 7);
    refuse(&table, &opts, DIF_ERR_FIT, "the table holds no positive value");
    for (size_t i = 0; i < n; i++)
        table.value[i] = NAN;
    refuse(&table, &opts, DIF_ERR_FIT, "the table holds no measured value");
    dif_table_free(&table);
    in = bench;
    in.lambda_nm[0] = 400.0;
    in.lambda_nm[1] = 440.0;
    in.lambda_nm[2] = 20.0;
    table = make_table(&in);
    refuse(&table, &opts, DIF_ERR_FIT, "3 wavelengths with values, want at least 8");
    dif_table_free(&table);
}

static void test_table__range_without_an_order(void **state)
{
    (void)state;
    instrument in = bench;
    in.low_deg = -9.0; /* between the mirror direction and order 1 */
    in.high_deg = -1.0;
    in.step_deg = 0.02;
    dif_table table = make_table(&in);
    const dif_fit_table_opts opts = grating_opts();
    refuse(&table, &opts, DIF_ERR_FIT, "no ");
    dif_table_free(&table);
    in.low_deg = -14.0; /* the mirror direction alone: no period in it */
    in.high_deg = -6.0;
    table = make_table(&in);
    refuse(&table, &opts, DIF_ERR_FIT, "only the specular ridge is in the scan: it has no period");
    const dif_fit_table_opts separate = dif_fit_table_opts_default();
    refuse(&table, &separate, DIF_ERR_FIT, "only the specular ridge is in the scan: it has no period");
    dif_table_free(&table);
}

static void test_table__bad_options(void **state)
{
    (void)state;
    dif_table table = make_table(&bench);
    const dif_fit_table_opts good = dif_fit_table_opts_default();
    dif_fit_table_opts bad[5] = {good, good, good, good, good}, opts = good;
    bad[0].n_ridge_max = 17;
    bad[1].order = 0;
    bad[2].period_start_um = -2.0;
    bad[3].n_part = 1;
    bad[4].index.n = NAN;
    refuse(&table, &bad[0], DIF_ERR_ARG, "n_ridge_max = 17, want 1 ... 16");
    refuse(&table, &bad[1], DIF_ERR_ARG, "order = 0, want a whole number from 1 to 1000 of either sign");
    refuse(&table, &bad[2], DIF_ERR_ARG, "start period = -2 um, want a positive number");
    refuse(&table, &bad[3], DIF_ERR_ARG, "n_part = 1, want 2 ... 64");
    refuse(&table, &bad[4], DIF_ERR_ARG, "refractive index nan");
    opts.line.known = true;
    refuse(&table, &opts, DIF_ERR_ARG, "patch of the line shape is 0 um x 0 um, want positive sizes");
    opts.line.size_x_um = opts.line.size_y_um = 65.0;
    refuse(&table, &opts, DIF_ERR_ARG, "window sigma of the line shape is 0 um, want it positive");
    table.plan.lambda_um[3] = table.plan.lambda_um[2];
    refuse(&table, NULL, DIF_ERR_ARG, "wavelengths do not increase at row 3");
    dif_table_free(&table);
    refuse(NULL, NULL, DIF_ERR_ARG, "no table to fit");
}

static void test_table__out_of_memory(void **state)
{
    (void)state;
    instrument in = bench;
    in.low_deg = 2.0;
    in.high_deg = 20.0;
    in.step_deg = 0.2;
    in.lambda_nm[2] = 20.0;
    dif_table table = make_table(&in);
    const dif_fit_table_opts opts = grating_opts();
    dif_fit_result result;
    dif_error err;
    const int live = test_alloc_live();
    test_alloc_fail_from(0);
    assert_int_equal(dif_fit_table(&table, &opts, &result, &err), DIF_OK);
    const int n_call = test_alloc_calls();
    assert_true(n_call > 10);
    for (int k = 1; k <= n_call; k++) {
        test_alloc_fail_from(k);
        const dif_status status = dif_fit_table(&table, &opts, &result, &err);
        test_alloc_fail_from(0);
        assert_int_equal(status, DIF_ERR_NOMEM);
        assert_int_equal(result.n_ridge, 0);
        assert_int_equal(test_alloc_live(), live);
    }
    dif_table_free(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table__several_orders_one_period),
        cmocka_unit_test(test_table__gain_is_divided_out),
        cmocka_unit_test(test_table__background_and_holes),
        cmocka_unit_test(test_table__separate_ridges),
        cmocka_unit_test(test_table__order_of_one_ridge),
        cmocka_unit_test(test_table__wrong_order_is_refused),
        cmocka_unit_test(test_table__angular_offset),
        cmocka_unit_test(test_table__nothing_to_fit),
        cmocka_unit_test(test_table__range_without_an_order),
        cmocka_unit_test(test_table__bad_options),
        cmocka_unit_test(test_table__out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
