#include "bench/map.h"

#include "alloc_count.h"
#include "core/io/field_io.h"
#include "core/spectrum.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
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

/* Luminance-weighted spread (standard deviation) along x and y of the light between two distances from the mirror
 * direction. */
static void spread_of(const dif_map *map, const dif_map_plan *plan, double near_s, double far_s, double spread[2])
{
    double sum = 0.0, xx = 0.0, yy = 0.0;
    const int n = map->n_pixel;
    for (int i = 0; i < n * n; i++) {
        dif_vec3 wo;
        if (!dif_map_direction(n, i % n, i / n, &wo))
            continue;
        const double u = wo.x + plan->fixed.x, v = wo.y + plan->fixed.y, s = hypot(u, v);
        const double value = s > near_s && s < far_s ? (double)map->xyz[3 * i + 1] : 0.0;
        sum += value;
        xx += value * u * u;
        yy += value * v * v;
    }
    spread[0] = sqrt(xx / sum);
    spread[1] = sqrt(yy / sum);
}

static void test_measure__measured_sheds_spread_across_their_ridges(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        double height_um;
        int wide; /* along x or y */
    } SCANS[] = {{"measured/elaphe_65um.png", 0.375, 0}, {"measured/xenopeltis_65um.png", 0.81869, 1}};
    const char *folder = test_data_folder();
    double lambda_um[21];
    if (!folder)
        skip();
    for (int i = 0; i < 21; i++)
        lambda_um[i] = dif_um_from_nm(380.0 + 20.0 * i);
    for (int k = 0; k < 2; k++) {
        char path[512];
        dif_field_request request = dif_field_request_default();
        dif_field_file file;
        dif_error err;
        double spread[2];
        const dif_map_plan plan = {
            .fixed = {0.0, 0.0, 1.0}, .n_pixel = 200, .n_lambda = 21, .lambda_um = lambda_um, .keep_layers = false};
        request.size_um = 65.0;
        request.height_um = SCANS[k].height_um;
        snprintf(path, sizeof path, "%s/%s", folder, SCANS[k].file);
        if (dif_field_read(path, &request, &file, &err) != DIF_OK) {
            print_message("%s: skipping\n", err.text);
            skip();
        }
        dif_map map = measure(&file.field, &plan, 1e-3, NULL);
        /* outside the mirror's spot and inside the first orders of the ridges; finer structure scatters farther out */
        spread_of(&map, &plan, 0.1, 0.7, spread);
        print_message("%s: spread %.3f along x, %.3f along y\n", SCANS[k].file, spread[0], spread[1]);
        assert_at_most(1.5 * spread[1 - SCANS[k].wide], spread[SCANS[k].wide]);
        dif_map_free(&map);
        dif_field_file_free(&file);
    }
}

/* Orders of a blazed grating: peaks along its plane. */
static void test_measure__blazed_orders_lie_on_the_grating_equation(void **state)
{
    (void)state;
    enum { N = 601 };
    dif_surface grating = dif_surface_default(DIF_SURFACE_BLAZED);
    dif_measure_opts opts = dif_measure_opts_default();
    dif_field field;
    const double lambda_um[1] = {0.5}, period_um = 2.5, sin_i = 0.5;
    const dif_map_plan plan = {.fixed = dif_vec3_from_angles_rad(asin(sin_i), 0.0),
                               .n_pixel = N,
                               .n_lambda = 1,
                               .lambda_um = lambda_um,
                               .keep_layers = true};
    opts.quantity = DIF_QUANTITY_POWER;
    opts.sigma_um = 5.0;
    grating.period_um = period_um;
    grating.height_um = 0.25;
    grating.nx = grating.ny = 400;
    grating.pitch_um = 0.1;
    assert_int_equal(dif_surface_make(&grating, &field, NULL), DIF_OK);
    dif_map map = measure(&field, &plan, 1e-5, &opts);
    const float *row = map.layer + (size_t)N * (N / 2); /* N is odd: y = 0 */
    int brightest = 0;
    double peak[8] = {0.0};
    for (int m = 0; m < 8; m++) {
        const double x = (m - 2) * lambda_um[0] / period_um - sin_i; /* orders -2 ... 5, all between -0.9 and 0.5 */
        double sum = 0.0, centre = 0.0;
        for (int ix = 0; ix < N; ix++) {
            const double at = (2.0 * ix + 1.0) / N - 1.0;
            if (fabs(at - x) > 0.05)
                continue;
            sum += (double)row[ix];
            centre += (double)row[ix] * at;
            peak[m] = fmax(peak[m], (double)row[ix]);
        }
        if (peak[m] > 1e-3) /* weaker ones lie on the flanks of others */
            assert_near(centre / sum, x, 0.0, 1.0 / N);
        brightest = peak[m] > peak[brightest] ? m : brightest;
    }
    /* sinc(m + w H / lambda)^2, w = cos_i + cos_m: 0.79 at order -1 */
    assert_int_equal(brightest - 2, -1);
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
        cmocka_unit_test(test_measure__blazed_orders_lie_on_the_grating_equation),
        cmocka_unit_test(test_measure__measured_sheds_spread_across_their_ridges),
        cmocka_unit_test(test_measure__bad_arguments_have_their_codes),
        cmocka_unit_test(test_measure__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
