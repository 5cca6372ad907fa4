/* The reference evaluator against direct sums, and what it refuses. What it makes of measured models: test_model_build. */
#include "alloc_count.h"
#include "core/brdf.h"
#include "core/direct.h"
#include "core/evaluator.h"
#include "core/units.h"
#include "rough.h"

static const double LAMBDA_UM[] = {0.4, 0.5, 0.6, 0.7};

/* A model by sheet with two windows. */
typedef struct bed {
    dif_field field;
    dif_window window[2];
    dif_sheet *own[2];
    const dif_sheet *sheet[2];
    double share[2];
    dif_model model;
    dif_evaluator cpu;
} bed;

static void bed_make(bool line, bed *b)
{
    const double k = DIF_TWO_PI / 0.4;
    const dif_band band = {1.9 * k, 0.1, 2.0 * k};
    *b = (bed){.field = test_rough_field(50, 41, 0.06, 0.07, 0.3, 8),
               .window = {{DIF_WINDOW_GAUSS, 0.6, 0.3, 0.1}, {DIF_WINDOW_GAUSS, 0.8, -0.2, 0.4}},
               .share = {0.3, 0.7}};
    for (int i = 0; i < 2; i++) {
        dif_sheet **sheet = b->own + i;
        assert_int_equal(line ? dif_sheet_create_line(&b->field, b->window + i, 0.4, &band, 1e-10, NULL, sheet, NULL)
                              : dif_sheet_create_volume(&b->field, b->window + i, &band, 1e-10, NULL, sheet, NULL),
                         DIF_OK);
        b->sheet[i] = *sheet;
    }
    b->model = (dif_model){.kind = DIF_MODEL_SHEET,
                           .n_sheet = 2,
                           .sheet = b->sheet,
                           .share = b->share,
                           .n_lambda = 4,
                           .lambda_um = LAMBDA_UM,
                           .quantity = DIF_QUANTITY_BRDF,
                           .index = dif_index_default(),
                           .area_um2 = 7.0};
    assert_int_equal(dif_cpu_evaluator_open(&b->model, &b->cpu, NULL), DIF_OK);
}

static void bed_free(bed *b)
{
    dif_evaluator_close(&b->cpu);
    assert_null(b->cpu.close);
    dif_evaluator_close(&b->cpu);
    for (int i = 0; i < 2; i++)
        dif_sheet_free(b->own[i]);
    dif_field_free(&b->field);
}

static void test_values__average_the_direct_sums_of_the_windows(void **state)
{
    (void)state;
    enum { N = 60 };
    bed b;
    uint64_t random = 4;
    bed_make(false, &b);
    dif_query query[N];
    double value[N];
    for (int i = 0; i < N; i++) {
        query[i].wi = dif_vec3_from_angles_rad(test_random(&random, 0.0, 1.2), test_random(&random, 0.0, DIF_TWO_PI));
        query[i].wo = dif_vec3_from_angles_rad(test_random(&random, 0.0, 1.2), test_random(&random, 0.0, DIF_TWO_PI));
        query[i].lambda_um = test_random(&random, 0.4, 0.7);
    }
    const int calls_before = test_alloc_calls();
    assert_int_equal(b.cpu.values(b.cpu.self, N, query, value, NULL, NULL), DIF_OK);
    assert_int_equal(test_alloc_calls(), calls_before); /* evaluation allocates nothing */
    for (int i = 0; i < N; i++) {
        double power = 0.0;
        for (int w = 0; w < 2; w++) {
            double amp[1][2];
            const dif_vec3 q = dif_vec3_transfer(query[i].wi, query[i].wo);
            const double k = DIF_TWO_PI / query[i].lambda_um;
            const dif_vec3 kappa = {k * q.x, k * q.y, k * q.z};
            assert_int_equal(dif_direct_amplitudes(&b.field, b.window + w, 1, &kappa, amp, NULL), DIF_OK);
            power += b.share[w] * (amp[0][0] * amp[0][0] + amp[0][1] * amp[0][1]);
        }
        const double gain =
            dif_brdf_gain_per_sr(b.model.index, query[i].wi, query[i].wo, query[i].lambda_um, b.model.area_um2);
        /* an amplitude error of tol is one of 2 tol sqrt(p) of the power */
        assert_near(value[i], gain * power, 1e-12, gain * 3e-10 * sqrt(power));
    }
    bed_free(&b);
}

static void test_values__bad_queries_have_their_codes(void **state)
{
    (void)state;
    bed b;
    dif_error err;
    double value;
    dif_query query = {{0.0, 0.0, 1.0}, {0.6, 0.0, 0.8}, 0.5};
    bed_make(false, &b);
    assert_int_equal(b.cpu.values(b.cpu.self, 1, &query, &value, NULL, &err), DIF_OK);
    query.lambda_um = 0.2;
    assert_int_equal(b.cpu.values(b.cpu.self, 1, &query, &value, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "a direction or wavelength outside the band that the model was made for");
    query.lambda_um = (double)NAN;
    assert_int_equal(b.cpu.values(b.cpu.self, 1, &query, &value, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "query 1: wavelength nan um, want > 0");
    query = (dif_query){{0.0, 0.0, 1.0}, {0.6, 0.0, 0.81}, 0.5};
    assert_int_equal(b.cpu.values(b.cpu.self, 1, &query, &value, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "query 1: directions are not unit vectors");
    bed_free(&b);
}

static void test_lines__serve_tables_of_their_azimuth_only(void **state)
{
    (void)state;
    bed b;
    dif_error err;
    double value[4], xyz[1][3];
    const dif_query query = {{0.0, 0.0, 1.0}, {0.6, 0.0, 0.8}, 0.5};
    dif_plan plan;
    bed_make(true, &b);
    assert_int_equal(dif_plan_create(1, 4, &plan, NULL), DIF_OK);
    for (int i = 0; i < 4; i++)
        plan.lambda_um[i] = LAMBDA_UM[i];
    plan.angle_rad[0] = 0.5;
    plan.azimuth_rad = 0.4;
    assert_int_equal(b.cpu.table(b.cpu.self, &plan, value, NULL, &err), DIF_OK);
    plan.azimuth_rad = DIF_PI / 6.0;
    assert_int_equal(b.cpu.table(b.cpu.self, &plan, value, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "a table at azimuth 30 deg, the model's sheets are at 22.9183118 deg");
    assert_int_equal(b.cpu.values(b.cpu.self, 1, &query, value, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "line sheets serve tables only");
    b.model.quantity = DIF_QUANTITY_RHO;
    assert_int_equal(b.cpu.colours(b.cpu.self, 1, &query.wi, &query.wo, xyz, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "line sheets serve tables only");
    dif_plan_free(&plan);
    bed_free(&b);
}

static void test_colours__what_they_refuse(void **state)
{
    (void)state;
    bed b;
    dif_error err;
    double xyz[1][3];
    const dif_vec3 wi = {0.0, 0.0, 1.0}, below = {0.6, 0.0, -0.8};
    bed_make(false, &b);
    assert_int_equal(b.cpu.colours(b.cpu.self, 1, &wi, &wi, xyz, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "colours of the BRDF, want those of power or rho");
    b.model.quantity = DIF_QUANTITY_RHO;
    assert_int_equal(b.cpu.colours(b.cpu.self, 1, &wi, &below, xyz, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "query 1: a direction is not above the surface");
    assert_int_equal(b.cpu.colours(b.cpu.self, 1, &wi, &wi, xyz, NULL, &err), DIF_OK);
    b.model.n_lambda = 0;
    assert_int_equal(b.cpu.colours(b.cpu.self, 1, &wi, &wi, xyz, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "colours of a model without wavelengths");
    bed_free(&b);
}

static void test_open__refuses_what_the_model_check_refuses(void **state)
{
    (void)state;
    dif_evaluator cpu;
    dif_error err;
    const dif_model model = {.kind = DIF_MODEL_PQ, .index = dif_index_default()};
    assert_int_equal(dif_cpu_evaluator_open(&model, &cpu, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "a model by pq without sheets");
    assert_null(cpu.self);
    dif_evaluator_close(&cpu);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values__average_the_direct_sums_of_the_windows),
        cmocka_unit_test(test_values__bad_queries_have_their_codes),
        cmocka_unit_test(test_lines__serve_tables_of_their_azimuth_only),
        cmocka_unit_test(test_colours__what_they_refuse),
        cmocka_unit_test(test_open__refuses_what_the_model_check_refuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
