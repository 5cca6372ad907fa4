#include "bench/regress_limits.h"

#include "near.h"

#include <string.h>

static dif_regress_case make_case(int method, dif_regress_question question)
{
    dif_regress_case c = {.method = method, .question = question, .path = "p"};
    c.values.n = 100;
    return c;
}

static void test_metric__names_lead_back(void **state)
{
    (void)state;
    dif_regress_metric metric;
    for (int i = 0; i < DIF_REGRESS_METRICS; i++) {
        assert_true(dif_regress_metric_from_name(dif_regress_metric_name((dif_regress_metric)i), &metric));
        assert_int_equal(metric, i);
        assert_true(strlen(dif_regress_metric_text((dif_regress_metric)i)) > 3);
    }
    assert_false(dif_regress_metric_from_name("abs.worse", &metric));
    assert_string_equal(dif_regress_metric_unit(DIF_REGRESS_PERIOD_OFF), "nm");
}

static void test_default__limits_have_reasons_and_are_finite(void **state)
{
    (void)state;
    int n;
    const dif_regress_limit *limit = dif_regress_limits_default(&n);
    assert_true(n > 8);
    for (int i = 0; i < n; i++) {
        assert_true(isfinite(limit[i].limit) && limit[i].limit >= 0.0);
        assert_true(strlen(limit[i].reason) >= 10);
    }
}

static void test_passes__each_limit_fails_beyond_itself(void **state)
{
    (void)state;
    int n, n_failed;
    const dif_regress_limit *limit = dif_regress_limits_default(&n);
    dif_regress_case c = make_case(0, DIF_REGRESS_TABLE);
    c.values.absolute.worst = 2e-6;
    c.values.relative.p99 = 1e-4;
    c.has_peaks = true;
    c.peaks.n = 5;
    c.fit = (dif_regress_fit){.tried = true, .device_um = 2.5, .reference_um = 2.500009};
    assert_true(dif_regress_passes(n, limit, &c, &n_failed));
    dif_regress_case bad = c;
    bad.values.absolute.worst = 2.0001e-6;
    assert_false(dif_regress_passes(n, limit, &bad, &n_failed));
    assert_int_equal(n_failed, 1);
    bad.values.relative.p99 = 2e-4;
    bad.peaks.n_lost = 1;
    assert_false(dif_regress_passes(n, limit, &bad, &n_failed));
    assert_int_equal(n_failed, 3);
    bad = c;
    bad.fit.device_um = 2.51;
    assert_false(dif_regress_passes(n, limit, &bad, &n_failed));
    bad = c;
    bad.fit.device = DIF_ERR_FIT; /* the reference alone has a period */
    assert_true(isinf(dif_regress_metric_of(&bad, DIF_REGRESS_PERIOD_OFF)));
    assert_false(dif_regress_passes(n, limit, &bad, &n_failed));
    bad.fit.reference = DIF_ERR_FIT; /* neither has: nothing to judge */
    assert_true(isnan(dif_regress_metric_of(&bad, DIF_REGRESS_PERIOD_OFF)));
    assert_true(dif_regress_passes(n, limit, &bad, &n_failed));
    bad = c;
    bad.values.n_one_sided = 1;
    assert_false(dif_regress_passes(n, limit, &bad, &n_failed));
}

static void test_passes__an_answer_that_is_missing_or_empty_fails(void **state)
{
    (void)state;
    int n, n_failed;
    const dif_regress_limit *limit = dif_regress_limits_default(&n);
    dif_regress_case c = make_case(0, DIF_REGRESS_TABLE);
    assert_true(dif_regress_passes(n, limit, &c, &n_failed));
    c.status = DIF_ERR_FOREIGN;
    assert_false(dif_regress_passes(n, limit, &c, &n_failed));
    assert_true(isnan(dif_regress_metric_of(&c, DIF_REGRESS_ABS_WORST)));
    c = make_case(0, DIF_REGRESS_TABLE);
    c.values.n = 0;
    assert_false(dif_regress_passes(n, limit, &c, &n_failed));
}

static void test_find__the_last_that_fits_counts(void **state)
{
    (void)state;
    const dif_regress_limit limits[] = {{"*", "table", DIF_REGRESS_ABS_WORST, 1.0, "first"},
                                        {"pq", "*", DIF_REGRESS_ABS_WORST, 2.0, "second"},
                                        {"*", "map", DIF_REGRESS_ABS_WORST, 3.0, "third"},
                                        {"*", "*", DIF_REGRESS_DE_P95, (double)INFINITY, "fourth"}};
    dif_regress_case c = make_case(3, DIF_REGRESS_TABLE); /* pq */
    assert_string_equal(dif_regress_limit_find(4, limits, &c, DIF_REGRESS_ABS_WORST)->reason, "second");
    c.question = DIF_REGRESS_MAP;
    assert_string_equal(dif_regress_limit_find(4, limits, &c, DIF_REGRESS_ABS_WORST)->reason, "third");
    c = make_case(0, DIF_REGRESS_TABLE);
    assert_string_equal(dif_regress_limit_find(4, limits, &c, DIF_REGRESS_ABS_WORST)->reason, "first");
    c.question = DIF_REGRESS_COLOUR;
    assert_null(dif_regress_limit_find(4, limits, &c, DIF_REGRESS_ABS_WORST));
    int n_failed;
    c.has_colours = true;
    c.de.p95 = 1e30;
    assert_true(dif_regress_passes(4, limits, &c, &n_failed)); /* infinity: not judged */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_metric__names_lead_back),
        cmocka_unit_test(test_default__limits_have_reasons_and_are_finite),
        cmocka_unit_test(test_passes__each_limit_fails_beyond_itself),
        cmocka_unit_test(test_passes__an_answer_that_is_missing_or_empty_fails),
        cmocka_unit_test(test_find__the_last_that_fits_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
