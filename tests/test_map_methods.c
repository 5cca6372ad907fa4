/* Maps by the methods that are read pixel by pixel. */
#include "alloc_count.h"
#include "bench/map.h"
#include "core/spectrum.h"
#include "core/units.h"
#include "rough.h"

enum { N_PIXEL = 17, N_ALL = N_PIXEL * N_PIXEL };
static const double LAMBDA_UM[] = {0.41, 0.5, 0.62};

static dif_map_plan make_plan(bool keep_layers)
{
    return (dif_map_plan){.fixed = dif_vec3_from_angles_rad(0.4, 0.0),
                          .n_pixel = N_PIXEL,
                          .n_lambda = 3,
                          .lambda_um = LAMBDA_UM,
                          .keep_layers = keep_layers};
}

static dif_measure_opts make_opts(dif_method method)
{
    dif_measure_opts opts = dif_measure_opts_default();
    opts.method = method;
    opts.sigma_um = 0.6;
    opts.period_um = 1.1;
    return opts;
}

static void compare_with_queries(const dif_field *field, const dif_map_plan *plan, const dif_measure_opts *opts,
                                 const dif_map *map)
{
    double weight[3][3], y[N_ALL] = {0.0};
    dif_query query[N_ALL];
    dif_sample sample[N_ALL];
    int pixel[N_ALL], n = 0;
    assert_int_equal(dif_spectrum_weights(3, LAMBDA_UM, weight, NULL), DIF_OK);
    for (int i = 0; i < N_ALL; i++)
        if (dif_map_direction(N_PIXEL, i % N_PIXEL, i / N_PIXEL, &query[n].wo))
            pixel[n++] = i;
    for (int l = 0; l < 3; l++) {
        for (int i = 0; i < n; i++) {
            query[i].wi = plan->fixed;
            query[i].lambda_um = LAMBDA_UM[l];
        }
        assert_int_equal(dif_measure_queries(field, (size_t)n, query, 1e-8, opts, sample, NULL, NULL), DIF_OK);
        for (int i = 0; i < n; i++) {
            const double values[] = {sample[i].power, sample[i].rho, sample[i].brdf_per_sr};
            const double want = values[opts->quantity];
            /* maps are float */
            assert_near((double)map->layer[l * N_ALL + pixel[i]], want, 1e-4, 1e-7);
            y[pixel[i]] += weight[l][1] * want;
        }
    }
    for (int i = 0; i < N_ALL; i++)
        assert_near((double)map->xyz[3 * i + 1], y[i], 1e-4, 1e-7);
}

static void test_map__layers_equal_queries_by_every_method(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 50, 0.05, 0.05, 0.2, 4);
    const dif_method methods[] = {DIF_METHOD_TAYLOR, DIF_METHOD_THESIS, DIF_METHOD_PQ, DIF_METHOD_STAM};
    for (int m = 0; m < 4; m++)
        for (int quantity = 0; quantity < 3; quantity++) {
            dif_measure_opts opts = make_opts(methods[m]);
            const dif_map_plan plan = make_plan(true);
            dif_map map;
            opts.quantity = (dif_quantity)quantity;
            if (methods[m] == DIF_METHOD_THESIS && quantity == DIF_QUANTITY_BRDF)
                continue; /* it has none */
            assert_int_equal(dif_map_measure(&field, &plan, 1e-8, &opts, &map, NULL, NULL), DIF_OK);
            compare_with_queries(&field, &plan, &opts, &map);
            dif_map_free(&map);
        }
    dif_field_free(&field);
}

static void test_map__nmm_has_the_colours_of_its_directions(void **state)
{
    (void)state;
    dif_field field = test_rough_field(80, 70, 0.1, 0.1, 0.2, 4);
    const dif_map_plan plan = make_plan(false);
    for (int quantity = 0; quantity < 3; quantity++)
        for (int average = 0; average < 2; average++) {
            dif_measure_opts opts = make_opts(DIF_METHOD_NMM);
            dif_plan line;
            dif_map map;
            double xyz[N_PIXEL - 2][3];
            opts.quantity = (dif_quantity)quantity;
            opts.average = (dif_average)average;
            opts.sigma_um = 2.0;
            opts.nmm_fixed = 4;
            /* the row through the middle lies in the plane of incidence */
            assert_int_equal(dif_plan_create(N_PIXEL - 2, 1, &line, NULL), DIF_OK);
            line.fixed_rad = 0.4;
            line.lambda_um[0] = 0.5;
            for (int i = 0; i < N_PIXEL - 2; i++) {
                dif_vec3 wo;
                assert_true(dif_map_direction(N_PIXEL, i + 1, N_PIXEL / 2, &wo));
                line.angle_rad[i] = asin(wo.x);
            }
            assert_int_equal(dif_measure_colours(&field, &line, 1e-7, &opts, xyz, NULL, NULL), DIF_OK);
            assert_int_equal(dif_map_measure(&field, &plan, 1e-7, &opts, &map, NULL, NULL), DIF_OK);
            for (int i = 0; i < N_PIXEL - 2; i++)
                for (int c = 0; c < 3; c++)
                    assert_near((double)map.xyz[3 * (N_PIXEL / 2 * N_PIXEL + i + 1) + c], xyz[i][c], 1e-3, 1e-6);
            dif_map_free(&map);
            dif_plan_free(&line);
        }
    dif_field_free(&field);
}

static void test_map__what_a_method_cannot_do_has_its_code(void **state)
{
    (void)state;
    dif_field field = test_rough_field(20, 20, 0.05, 0.05, 0.2, 4);
    dif_map_plan plan = make_plan(true);
    dif_measure_opts opts = make_opts(DIF_METHOD_NMM);
    dif_map map;
    dif_error err;
    assert_int_equal(dif_map_measure(&field, &plan, 1e-3, &opts, &map, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "nmm has no spectral layers: each pixel has wavelengths of its own");
    opts = make_opts(DIF_METHOD_THESIS);
    opts.quantity = DIF_QUANTITY_BRDF;
    assert_int_equal(dif_map_measure(&field, &plan, 1e-3, &opts, &map, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "the source's program has no absolute BRDF: its gain is 1");
    opts = make_opts(DIF_METHOD_PQ);
    opts.period_um = 1.2;
    assert_int_equal(dif_map_measure(&field, &plan, 1e-3, &opts, &map, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "a period of 1.2 um along x is larger than the patch of 1 um");
    assert_null(map.xyz);
    dif_field_free(&field);
}

static void test_map__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field = test_rough_field(12, 12, 0.1, 0.1, 0.2, 4);
    const int live = test_alloc_live();
    for (int method = DIF_METHOD_THESIS; method <= DIF_METHOD_STAM; method++) {
        const dif_measure_opts opts = make_opts((dif_method)method);
        const dif_map_plan plan = make_plan(false);
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
        assert_true(n_failed > 5);
    }
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_map__layers_equal_queries_by_every_method),
        cmocka_unit_test(test_map__nmm_has_the_colours_of_its_directions),
        cmocka_unit_test(test_map__what_a_method_cannot_do_has_its_code),
        cmocka_unit_test(test_map__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
