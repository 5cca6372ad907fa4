#include "bench/map.h"

#include "alloc_count.h"
#include "core/spectrum.h"
#include "core/units.h"
#include "rough.h"

static const double LAMBDA_UM[] = {0.41, 0.5, 0.62};

static dif_map_plan make_plan(double theta_deg, double phi_deg, int n_pixel)
{
    return (dif_map_plan){.fixed = dif_vec3_from_angles_rad(dif_rad_from_deg(theta_deg), dif_rad_from_deg(phi_deg)),
                          .n_pixel = n_pixel,
                          .n_lambda = 3,
                          .lambda_um = LAMBDA_UM,
                          .keep_layers = true};
}

static dif_map measure(const dif_field *field, const dif_map_plan *plan, double tol, const dif_measure_opts *opts)
{
    dif_map map;
    dif_error err = {DIF_OK, ""};
    if (dif_map_measure(field, plan, tol, opts, &map, NULL, &err) != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(err.status, DIF_OK);
    return map;
}

static void test_measure__layers_equal_the_direct_sum(void **state)
{
    (void)state;
    dif_field field = test_rough_field(60, 47, 0.05, 0.06, 0.5, 4);
    dif_measure_opts opts = dif_measure_opts_default();
    opts.sigma_um = 0.7;
    opts.quantity = DIF_QUANTITY_POWER;
    for (int c = 0; c < 4; c++) {
        dif_map_plan plan = make_plan(c < 2 ? 10.0 : 70.0, 130.0, c % 2 ? 33 : 40);
        opts.average = c == 3 ? DIF_AVERAGE_WELCH : DIF_AVERAGE_NONE;
        plan.fixed_is_wo = c == 1;
        opts.method = DIF_METHOD_DIRECT;
        dif_map truth = measure(&field, &plan, 1e-3, &opts);
        opts.method = DIF_METHOD_SHEET;
        for (double tol = 1e-2; tol > 1e-9; tol *= 1e-2) {
            dif_map map = measure(&field, &plan, tol, &opts);
            double worst = 0.0;
            const int n = plan.n_pixel * plan.n_pixel;
            for (int i = 0; i < 3 * n; i++)
                worst = fmax(worst, fabs(sqrt((double)map.layer[i]) - sqrt((double)truth.layer[i])));
            /* layers are float: sqrt(p) of at most 1 is good to 3e-8 where p is not tiny */
            assert_at_most(worst, fmax(tol, 1e-7));
            dif_map_free(&map);
        }
        dif_map_free(&truth);
    }
    dif_field_free(&field);
}

static void test_measure__xyz_is_the_weighted_sum_of_the_layers(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 40, 0.05, 0.05, 0.2, 4);
    dif_measure_opts opts = dif_measure_opts_default();
    const dif_map_plan plan = make_plan(20.0, 0.0, 24);
    double weight[3][3];
    opts.sigma_um = 0.6;
    assert_int_equal(dif_spectrum_weights(3, LAMBDA_UM, weight, NULL), DIF_OK);
    for (int quantity = 0; quantity < 3; quantity++) {
        opts.quantity = (dif_quantity)quantity;
        dif_map map = measure(&field, &plan, 1e-5, &opts);
        for (int i = 0; i < 24 * 24; i++)
            for (int c = 0; c < 3; c++) {
                double sum = 0.0;
                for (int l = 0; l < 3; l++)
                    sum += weight[l][c] * (double)map.layer[l * 24 * 24 + i];
                assert_near((double)map.xyz[3 * i + c], sum, 1e-5, 1e-12);
            }
        dif_map_free(&map);
    }
    dif_field_free(&field);
}

static void test_measure__map_and_queries_agree_on_every_quantity(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 50, 0.05, 0.05, 0.2, 4);
    dif_measure_opts opts = dif_measure_opts_default();
    const dif_map_plan plan = make_plan(35.0, 250.0, 16);
    opts.sigma_um = 0.6;
    for (int quantity = 0; quantity < 3; quantity++) {
        opts.quantity = (dif_quantity)quantity;
        dif_map map = measure(&field, &plan, 1e-8, &opts);
        for (int i = 0; i < 16 * 16; i++) {
            dif_query query = {.wi = plan.fixed, .lambda_um = LAMBDA_UM[1]};
            dif_sample sample;
            if (!dif_map_direction(16, i % 16, i / 16, &query.wo))
                continue;
            assert_int_equal(dif_measure_queries(&field, 1, &query, 1e-8, &opts, &sample, NULL, NULL), DIF_OK);
            const double want[] = {sample.power, sample.rho, sample.brdf_per_sr};
            assert_near((double)map.layer[16 * 16 + i], want[quantity], 1e-4, 1e-7);
        }
        dif_map_free(&map);
    }
    dif_field_free(&field);
}

static void test_measure__mirror_is_one_spot_of_the_windows_size(void **state)
{
    (void)state;
    dif_field field;
    dif_measure_opts opts = dif_measure_opts_default();
    const double sigma_um = 2.0, lambda_um[1] = {0.5};
    const dif_map_plan plan = {.fixed = dif_vec3_from_angles_rad(0.4, 0.7),
                               .n_pixel = 256,
                               .n_lambda = 1,
                               .lambda_um = lambda_um,
                               .keep_layers = true};
    opts.sigma_um = sigma_um;
    opts.quantity = DIF_QUANTITY_BRDF;
    opts.index = (dif_index){1.5, 0.0};
    assert_int_equal(dif_field_create(256, 256, 0.0625, 0.0625, &field, NULL), DIF_OK);
    dif_map map = measure(&field, &plan, 1e-6, &opts);
    double sum = 0.0, peak = 0.0, peak_x = 0.0, peak_y = 0.0, moment = 0.0;
    for (int i = 0; i < 256 * 256; i++) {
        dif_vec3 wo;
        if (!dif_map_direction(256, i % 256, i / 256, &wo))
            continue;
        const double f = (double)map.layer[i], du = wo.x + plan.fixed.x, dv = wo.y + plan.fixed.y;
        sum += f; /* f cos_o dwo = f du dv */
        moment += f * (du * du + dv * dv);
        if (f > peak) {
            peak = f;
            peak_x = wo.x;
            peak_y = wo.y;
        }
    }
    const double cell = 4.0 / (256.0 * 256.0);
    /* one pixel is 0.0078 wide: the peak lies within it of the mirror direction */
    assert_near(peak_x, -plan.fixed.x, 0.0, 0.0079);
    assert_near(peak_y, -plan.fixed.y, 0.0, 0.0079);
    /* integral R = 0.04 of glass at 23 degrees, 1e-3 of it, and the window's spot: sigma_f = 1/(2 pi sigma sqrt 2) */
    assert_near(sum * cell, dif_fresnel_schlick(opts.index, plan.fixed.z), 2e-3, 0.0);
    const double spot = lambda_um[0] / (DIF_TWO_PI * sigma_um * sqrt(2.0));
    assert_near(moment / sum, 2.0 * spot * spot, 0.02, 0.0);
    dif_map_free(&map);
    dif_field_free(&field);
}

static void test_measure__bad_arguments_have_their_codes(void **state)
{
    (void)state;
    dif_field field = test_rough_field(8, 8, 0.05, 0.05, 0.2, 4);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_map_plan plan = make_plan(35.0, 250.0, 15);
    dif_map map;
    dif_error err;
    assert_int_equal(dif_map_measure(&field, &plan, 1e-3, &opts, &map, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "15 pixels across, want 16 ... 4096");
    plan.n_pixel = 1000000;
    assert_int_equal(dif_map_measure(&field, &plan, 1e-3, &opts, &map, NULL, &err), DIF_ERR_ARG);
    plan.n_pixel = 16;
    opts.method = DIF_METHOD_NMM;
    assert_int_equal(dif_map_measure(&field, &plan, 1e-3, &opts, &map, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "nmm has no spectral layers: each pixel has wavelengths of its own");
    opts.method = DIF_METHOD_SHEET;
    plan.fixed.z = 0.0;
    assert_int_equal(dif_map_measure(&field, &plan, 1e-3, &opts, &map, NULL, &err), DIF_ERR_ARG);
    assert_null(map.xyz);
    dif_field_free(&field);
}

static void test_measure__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field = test_rough_field(12, 12, 0.05, 0.05, 0.2, 4);
    const dif_measure_opts opts = dif_measure_opts_default();
    const dif_map_plan plan = make_plan(35.0, 250.0, 16);
    const int live = test_alloc_live();
    int n_failed = 0;
    for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; n_failed++) {
        dif_map map = {0};
        test_alloc_fail_from(n_failed + 1);
        status = dif_map_measure(&field, &plan, 1e-3, &opts, &map, NULL, NULL);
        test_alloc_fail_from(0);
        assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
        dif_map_free(&map);
        assert_int_equal(test_alloc_live(), live);
    }
    assert_true(n_failed > 15);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_measure__layers_equal_the_direct_sum),
        cmocka_unit_test(test_measure__xyz_is_the_weighted_sum_of_the_layers),
        cmocka_unit_test(test_measure__map_and_queries_agree_on_every_quantity),
        cmocka_unit_test(test_measure__mirror_is_one_spot_of_the_windows_size),
        cmocka_unit_test(test_measure__bad_arguments_have_their_codes),
        cmocka_unit_test(test_measure__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
