/* A surface by every method on two devices, both of them the reference: one reads coarser sheets, or lies. */
#include "bench/regress_run.h"

#include "alloc_count.h"
#include "bench/regress_limits.h"
#include "bench/scan.h"
#include "core/alloc.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "near.h"

#include <string.h>

static const double LAYER_UM[] = {0.45, 0.6}, LAMBDA_UM[] = {0.4, 0.5, 0.6, 0.7};

/* A device that answers like the reference, but for one number. */
typedef enum lie { LIE_NONE, LIE_SCALE, LIE_NAN, LIE_FAIL } lie;

typedef struct liar {
    dif_evaluator honest;
    lie lie;
} liar;

static dif_status lie_table(void *self, const dif_plan *plan, double *value, dif_eval_cost *cost, dif_error *err)
{
    liar *l = self;
    const dif_status status = l->honest.table(l->honest.self, plan, value, cost, err);
    if (l->lie == LIE_FAIL)
        return dif_fail(err, DIF_ERR_FOREIGN, "the shader broke");
    if (l->lie == LIE_NAN)
        value[7] = (double)NAN;
    else
        value[plan->n_angle + 3] += 1e-3;
    return status;
}

static dif_status honest_values(void *self, size_t n, const dif_query *query, double *value, dif_eval_cost *cost,
                                dif_error *err)
{
    liar *l = self;
    return l->honest.values(l->honest.self, n, query, value, cost, err);
}

static dif_status honest_colours(void *self, size_t n, const dif_vec3 *wi, const dif_vec3 *wo, double (*xyz)[3],
                                 dif_eval_cost *cost, dif_error *err)
{
    liar *l = self;
    return l->honest.colours(l->honest.self, n, wi, wo, xyz, cost, err);
}

static void liar_close(void *self)
{
    liar *l = self;
    dif_evaluator_close(&l->honest);
    free(l);
}

static dif_status open_device(void *self, int path, const dif_model *model, dif_evaluator *out, dif_error *err)
{
    const lie what = *(const lie *)self;
    if (path == 0 || what == LIE_NONE)
        return dif_cpu_evaluator_open(model, out, err);
    liar *l = calloc(1, sizeof *l);
    l->lie = what;
    *out = (dif_evaluator){"liar", l, honest_values, lie_table, honest_colours, liar_close};
    return dif_cpu_evaluator_open(model, &l->honest, err);
}

/* What the listener hears. */
typedef struct heard {
    int n, n_bad;
    double worst_de, worst_abs;
    char text[1024];
    dif_regress_case sheet_table, last_bad;
} heard;

static dif_status hear(void *self, const dif_regress_plan *plan, const dif_regress_case *result, const double *device,
                       const double *reference, dif_error *err)
{
    heard *h = self;
    int n_limit, n_failed;
    (void)err;
    const dif_regress_limit *limits = dif_regress_limits_default(&n_limit);
    assert_int_equal(device != NULL, result->status == DIF_OK);
    assert_int_equal(reference != NULL, result->status == DIF_OK);
    if (reference && result->values.n > 0) {
        const dif_regress_place at = dif_regress_place_of(plan, result->question, result->values.absolute.worst_at);
        assert_near(reference[result->values.absolute.worst_at], result->values.absolute.worst_b, 0.0, 0.0);
        assert_true((isnan(at.angle_rad) != 0) == (result->question != DIF_REGRESS_TABLE));
    }
    if (!dif_regress_passes(n_limit, limits, result, &n_failed)) {
        h->n_bad++;
        h->last_bad = *result;
    }
    if (result->question == DIF_REGRESS_TABLE && result->method == 0)
        h->sheet_table = *result;
    if (result->question != DIF_REGRESS_FULL) {
        h->worst_abs = fmax(h->worst_abs, result->values.absolute.worst);
        h->worst_de = fmax(h->worst_de, result->has_colours ? result->de.worst : 0.0);
    }
    snprintf(h->text + strlen(h->text), sizeof h->text - strlen(h->text), "%s.%s.%s ",
             dif_regress_method_name(result->method), dif_regress_question_name(result->question), result->path);
    h->n++;
    return DIF_OK;
}

typedef struct bed {
    dif_field field;
    dif_plan table;
    dif_regress_plan plan;
    dif_measure_opts opts;
} bed;

static bed make_bed(void)
{
    dif_surface surface = dif_surface_default(DIF_SURFACE_SINE);
    dif_range angle, lambda;
    bed b = {.opts = dif_measure_opts_default(), .plan = dif_regress_plan_default()};
    surface.nx = surface.ny = 128;
    surface.pitch_um = 0.1;
    surface.period_um = 1.6;
    surface.height_um = 0.2;
    assert_int_equal(dif_surface_make(&surface, &b.field, NULL), DIF_OK);
    assert_int_equal(dif_range_parse("-70:70:0.25", &angle, NULL), DIF_OK);
    assert_int_equal(dif_range_parse("400:700:10", &lambda, NULL), DIF_OK);
    assert_int_equal(dif_scan_plan(false, 20.0, 0.0, &angle, &lambda, &b.table, NULL), DIF_OK);
    b.opts.sigma_um = 2.5;
    b.opts.period_um = 1.6;
    b.plan.wi = dif_vec3_from_angles_rad(0.3, 0.0);
    b.plan.n_pixel = 17;
    b.plan.n_layer = 2;
    b.plan.layer_um = LAYER_UM;
    b.plan.n_lambda = b.plan.n_full = 4;
    b.plan.lambda_um = b.plan.full_um = LAMBDA_UM;
    b.plan.lut = (dif_lut_opts){.n_azimuth = 256, .n_radius = 96, .n_map = DIF_LUT_MAPS_FROM_TOL};
    b.plan.has_period = b.plan.is_grating = true;
    b.plan.f_min_per_um = 0.3;
    b.plan.fit = false;
    return b;
}

static void bed_free(bed *b)
{
    dif_plan_free(&b->table);
    dif_field_free(&b->field);
}

static heard run(bed *b, lie what, int n_path)
{
    static const char *const paths[] = {"one", "two"};
    heard h = {0};
    dif_error err = {DIF_OK, ""};
    b->plan.table = &b->table;
    const dif_regress_device device = {&what, n_path, paths, open_device};
    const dif_regress_listener listener = {&h, NULL, hear};
    if (dif_regress_run(&b->field, &b->plan, &b->opts, &device, &listener, &err) != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(err.status, DIF_OK);
    return h;
}

static void test_run__asks_every_method_every_question(void **state)
{
    (void)state;
    bed b = make_bed();
    const heard h = run(&b, LIE_NONE, 1);
    assert_string_equal(h.text, "sheet.table.one sheet.map.one sheet.colour.one nmm.table.one nmm.map.one "
                                "nmm.colour.one nmm-lines.table.one nmm-lines.map.one nmm-lines.colour.one "
                                "pq.table.one pq.map.one pq.colour.one lut.colour.one lut.full.one stam.table.one "
                                "stam.map.one stam.colour.one ");
    /* sheets of tol 1e-7 against 1e-9: a power of at most 1 is off by at most twice that */
    assert_at_most(h.worst_abs, 2.1e-7);
    assert_true(h.worst_abs > 0.0);
    assert_at_most(h.worst_de, 1e-2);
    assert_true(h.sheet_table.has_peaks && h.sheet_table.peaks.n > 10);
    assert_int_equal(h.sheet_table.peaks.n_lost, 0);
    assert_true(h.sheet_table.wall_reference_s > 0.0 && h.sheet_table.build_device_s > 0.0);
    bed_free(&b);
    assert_int_equal(test_alloc_live(), 0);
}

static void test_run__leaves_out_what_needs_a_period(void **state)
{
    (void)state;
    bed b = make_bed();
    b.plan.has_period = false;
    b.plan.method[4] = false; /* lut */
    assert_string_equal(run(&b, LIE_NONE, 1).text, "sheet.table.one sheet.map.one sheet.colour.one nmm.table.one "
                                                   "nmm.map.one nmm.colour.one stam.table.one stam.map.one "
                                                   "stam.colour.one ");
    b.opts.period_um = (double)NAN;
    b.plan.method[1] = false;
    assert_string_equal(run(&b, LIE_NONE, 1).text, "sheet.table.one sheet.map.one sheet.colour.one ");
    bed_free(&b);
}

static void only_sheets(bed *b)
{
    for (int i = 1; i < DIF_REGRESS_METHODS; i++)
        b->plan.method[i] = false;
}

static void test_run__a_lie_is_caught_with_its_place(void **state)
{
    (void)state;
    bed b = make_bed();
    only_sheets(&b);
    assert_int_equal(run(&b, LIE_NONE, 2).n_bad, 0);
    const heard scaled = run(&b, LIE_SCALE, 2);
    assert_int_equal(scaled.n, 6);
    assert_int_equal(scaled.n_bad, 1);
    assert_string_equal(scaled.last_bad.path, "two");
    assert_int_equal(scaled.last_bad.values.absolute.worst_at, b.table.n_angle + 3);
    const dif_regress_place at = dif_regress_place_of(&b.plan, DIF_REGRESS_TABLE, (size_t)b.table.n_angle + 3);
    assert_near(dif_deg_from_rad(at.angle_rad), -69.25, 1e-9, 0.0);
    assert_near(at.lambda_um, 0.41, 1e-12, 0.0);
    const heard nan = run(&b, LIE_NAN, 2);
    assert_int_equal(nan.n_bad, 1);
    assert_int_equal(nan.last_bad.values.n_one_sided, 1);
    assert_int_equal(nan.last_bad.values.one_sided_at, 7);
    const heard failed = run(&b, LIE_FAIL, 2);
    assert_int_equal(failed.n_bad, 1);
    assert_int_equal(failed.last_bad.status, DIF_ERR_FOREIGN);
    assert_string_equal(failed.last_bad.text, "the shader broke");
    bed_free(&b);
}

static void test_run__periods_of_both_sides_agree(void **state)
{
    (void)state;
    bed b = make_bed();
    only_sheets(&b);
    b.plan.fit = true;
    const dif_regress_fit fit = run(&b, LIE_NONE, 2).sheet_table.fit; /* of the second path */
    assert_string_equal(fit.text, "");
    assert_true(fit.tried);
    assert_int_equal(fit.reference, DIF_OK);
    assert_int_equal(fit.device, DIF_OK);
    assert_near(fit.reference_um, 1.6, 2e-3, 0.0); /* eight periods under the window */
    assert_near(fit.device_um, fit.reference_um, 0.0, 1e-6);
    bed_free(&b);
}

static void test_place__pixels_and_channels(void **state)
{
    (void)state;
    bed b = make_bed();
    dif_regress_place at = dif_regress_place_of(&b.plan, DIF_REGRESS_MAP, 17 * 17 + 17 * 8 + 12);
    assert_int_equal(at.ix, 12);
    assert_int_equal(at.iy, 8);
    assert_near(at.lambda_um, 0.6, 0.0, 0.0);
    assert_near(at.wo.x, 25.0 / 17.0 - 1.0, 1e-15, 0.0);
    assert_near(at.wo.y, 0.0, 0.0, 1e-15);
    at = dif_regress_place_of(&b.plan, DIF_REGRESS_COLOUR, 3 * (17 * 8 + 12) + 2);
    assert_int_equal(at.ix, 12);
    assert_int_equal(at.channel, 2);
    assert_true(isnan(at.lambda_um));
    bed_free(&b);
}

static void test_run__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    bed b = make_bed();
    static const char *const paths[] = {"one"};
    lie none = LIE_NONE;
    b.plan.table = &b.table;
    only_sheets(&b);
    const dif_regress_device device = {&none, 1, paths, open_device};
    const int live = test_alloc_live();
    int k = 1;
    for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; k += k < 30 ? 1 : 7) {
        heard h = {0};
        const dif_regress_listener listener = {&h, NULL, hear};
        test_alloc_fail_from(k);
        status = dif_regress_run(&b.field, &b.plan, &b.opts, &device, &listener, NULL);
        test_alloc_fail_from(0);
        assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
        assert_int_equal(test_alloc_live(), live);
    }
    assert_true(k > 30);
    bed_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_run__asks_every_method_every_question),
        cmocka_unit_test(test_run__leaves_out_what_needs_a_period),
        cmocka_unit_test(test_run__a_lie_is_caught_with_its_place),
        cmocka_unit_test(test_run__periods_of_both_sides_agree),
        cmocka_unit_test(test_place__pixels_and_channels),
        cmocka_unit_test(test_run__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
