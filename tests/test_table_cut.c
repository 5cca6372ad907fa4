#include "bench/table_cut.h"

#include "core/units.h"
#include "near.h"

static void test_cut__keeps_the_asked_range_alone(void **state)
{
    (void)state;
    dif_plan plan;
    dif_table table, part;
    assert_int_equal(dif_plan_create(161, 3, &plan, NULL), DIF_OK);
    plan.fixed_rad = 0.3;
    for (int i = 0; i < 161; i++)
        plan.angle_rad[i] = dif_rad_from_deg(i - 80.0);
    for (int i = 0; i < 3; i++)
        plan.lambda_um[i] = 0.4 + 0.1 * i;
    assert_int_equal(dif_table_create(&plan, DIF_QUANTITY_RHO, &table, NULL), DIF_OK);
    for (int i = 0; i < 161 * 3; i++)
        table.value[i] = i + 1.0;
    assert_int_equal(dif_table_cut(&table, 0.5, 2.0, dif_rad_from_deg(60.0), &part, NULL), DIF_OK);
    assert_int_equal(part.quantity, DIF_QUANTITY_RHO);
    int n_kept = 0;
    for (int i = 0; i < 161 * 3; i++) {
        const double f = fabs(sin(0.3) + sin(plan.angle_rad[i % 161])) / plan.lambda_um[i / 161];
        const bool inside = f >= 0.5 && f <= 2.0 && fabs(plan.angle_rad[i % 161]) <= dif_rad_from_deg(60.0);
        assert_true((isnan(part.value[i]) != 0) != inside);
        if (inside)
            assert_near(part.value[i], i + 1.0, 0.0, 0.0);
        n_kept += inside;
    }
    assert_true(n_kept > 50 && n_kept < 400);
    dif_table_free(&part);
    assert_int_equal(dif_table_cut(&table, 0.0, (double)INFINITY, 2.0, &part, NULL), DIF_OK);
    for (int i = 0; i < 161 * 3; i++)
        assert_near(part.value[i], table.value[i], 0.0, 0.0);
    dif_table_free(&part);
    dif_table_free(&table);
    dif_plan_free(&plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cut__keeps_the_asked_range_alone)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
