#include "tests/near.h"

#include <string.h>

#include "core/plan.h"
#include "core/units.h"
#include "tests/alloc_count.h"

static void test_quantity__names_and_units_go_round(void **state)
{
    (void)state;
    static const char *const names[] = {"power", "rho", "brdf"}, *const units[] = {"1", "1", "sr^-1"};
    for (int i = 0; i < 3; i++) {
        dif_quantity quantity;
        assert_string_equal(dif_quantity_name((dif_quantity)i), names[i]);
        assert_string_equal(dif_quantity_unit((dif_quantity)i), units[i]);
        assert_true(dif_quantity_from_name(names[i], &quantity));
        assert_int_equal(quantity, i);
    }
    dif_quantity quantity = DIF_QUANTITY_BRDF;
    assert_false(dif_quantity_from_name("Rho", &quantity));
    assert_false(dif_quantity_from_name("", &quantity));
    assert_int_equal(quantity, DIF_QUANTITY_BRDF);
}

static dif_plan make_plan(int n_angle, int n_lambda)
{
    dif_plan plan;
    dif_error err;
    assert_int_equal(dif_plan_create(n_angle, n_lambda, &plan, &err), DIF_OK);
    for (int i = 0; i < n_angle; i++)
        plan.angle_rad[i] = -1.2 + 2.0 * i / n_angle;
    for (int i = 0; i < n_lambda; i++)
        plan.lambda_um[i] = 0.38 + 0.001 * i;
    plan.fixed_rad = 0.7;
    plan.azimuth_rad = 0.4;
    return plan;
}

static void test_create__refuses_bad_counts(void **state)
{
    (void)state;
    dif_plan plan = {.n_angle = 9};
    dif_error err;
    assert_int_equal(dif_plan_create(0, 3, &plan, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "plan of 0 angles and 3 wavelengths, want at least 1 of each");
    assert_int_equal(plan.n_angle, 0);
    assert_int_equal(dif_plan_create(3, -1, &plan, &err), DIF_ERR_ARG);
    assert_int_equal(dif_plan_create(10000000, 10000000, &plan, &err), DIF_ERR_SIZE);
    assert_string_equal(err.text, "plan of 10000000 angles and 10000000 wavelengths, want at most 268435456 cells");
    assert_null(plan.angle_rad);
}

static void test_check__refuses_what_cannot_be_measured(void **state)
{
    (void)state;
    dif_plan plan = make_plan(4, 3);
    dif_error err;
    assert_int_equal(dif_plan_check(&plan, &err), DIF_OK);
    plan.angle_rad[2] = dif_rad_from_deg(90.0);
    assert_int_equal(dif_plan_check(&plan, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "angle 2 is 90 deg, want -90 < angle < 90");
    plan.angle_rad[2] = dif_rad_from_deg(89.999999);
    assert_int_equal(dif_plan_check(&plan, &err), DIF_OK);
    plan.fixed_rad = dif_rad_from_deg(-90.0);
    assert_int_equal(dif_plan_check(&plan, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "fixed angle -90 deg, want -90 < angle < 90");
    plan.fixed_rad = NAN;
    assert_int_equal(dif_plan_check(&plan, &err), DIF_ERR_ARG);
    plan.fixed_rad = 0.0;
    plan.azimuth_rad = INFINITY;
    assert_int_equal(dif_plan_check(&plan, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "azimuth inf deg, want a finite number");
    plan.azimuth_rad = 0.0;
    static const double bad_um[] = {0.0, -0.5, NAN, INFINITY};
    for (size_t i = 0; i < 4; i++) {
        plan.lambda_um[1] = bad_um[i];
        assert_int_equal(dif_plan_check(&plan, &err), DIF_ERR_ARG);
        assert_non_null(strstr(err.text, "wavelength 1 is "));
        assert_non_null(strstr(err.text, " nm, want a finite number > 0"));
    }
    dif_plan_free(&plan);
    assert_int_equal(dif_plan_check(&plan, &err), DIF_ERR_ARG);
}

static void test_copy__is_deep(void **state)
{
    (void)state;
    dif_plan plan = make_plan(5, 4), copy;
    dif_error err;
    plan.fixed_is_wo = true;
    assert_int_equal(dif_plan_copy(&plan, &copy, &err), DIF_OK);
    assert_ptr_not_equal(copy.angle_rad, plan.angle_rad);
    assert_memory_equal(copy.angle_rad, plan.angle_rad, 5 * sizeof(double));
    assert_memory_equal(copy.lambda_um, plan.lambda_um, 4 * sizeof(double));
    assert_true(copy.fixed_is_wo);
    assert_near(copy.fixed_rad, 0.7, 0.0, 0.0);
    assert_near(copy.azimuth_rad, 0.4, 0.0, 0.0);
    dif_plan_free(&plan);
    dif_plan_free(&copy);
    dif_plan_free(NULL);
}

/* (u, v, w) of the directions equals what dif_plan_transfer says along the azimuth, and nothing across it. */
static void test_transfer__agrees_with_the_directions(void **state)
{
    (void)state;
    dif_plan plan = make_plan(50, 1);
    for (int swapped = 0; swapped < 2; swapped++) {
        plan.fixed_is_wo = swapped == 1;
        for (int i = 0; i < plan.n_angle; i++) {
            dif_vec3 wi, wo;
            double sin_sum, cos_sum;
            dif_plan_directions(&plan, i, &wi, &wo);
            dif_plan_transfer(&plan, i, &sin_sum, &cos_sum);
            const dif_vec3 uvw = dif_vec3_transfer(wi, wo);
            const double along = uvw.x * cos(0.4) + uvw.y * sin(0.4), across = uvw.y * cos(0.4) - uvw.x * sin(0.4);
            assert_near(along, -sin_sum, 0.0, 1e-15);
            assert_near(across, 0.0, 0.0, 1e-15);
            assert_near(uvw.z, -cos_sum, 0.0, 1e-15);
            assert_near(dif_vec3_dot(wi, wi), 1.0, 1e-15, 0.0);
            assert_near(dif_vec3_dot(wo, wo), 1.0, 1e-15, 0.0);
            const dif_vec3 fixed = swapped ? wo : wi;
            assert_near(fixed.z, cos(0.7), 1e-15, 0.0);
        }
    }
    dif_plan_free(&plan);
}

static void test_table__holds_a_copy_of_its_plan(void **state)
{
    (void)state;
    dif_plan plan = make_plan(3, 2);
    dif_table table;
    dif_error err;
    assert_int_equal(dif_table_create(&plan, DIF_QUANTITY_BRDF, &table, &err), DIF_OK);
    dif_plan_free(&plan);
    assert_int_equal(table.quantity, DIF_QUANTITY_BRDF);
    assert_near(table.plan.lambda_um[1], 0.381, 0.0, 0.0);
    for (int i = 0; i < 6; i++)
        assert_near(table.value[i], 0.0, 0.0, 0.0);
    dif_table_free(&table);
    assert_null(table.value);
    dif_table_free(NULL);
}

static void test_alloc_failing__leaves_nothing_behind(void **state)
{
    (void)state;
    dif_plan plan = make_plan(3, 2);
    dif_error err;
    for (int k = 1; k <= 3; k++) {
        dif_table table = {.value = plan.angle_rad};
        test_alloc_fail_from(k);
        assert_int_equal(dif_table_create(&plan, DIF_QUANTITY_RHO, &table, &err), DIF_ERR_NOMEM);
        assert_non_null(strstr(err.text, " of 3 angles and 2 wavelengths"));
        assert_null(table.value);
        assert_null(table.plan.angle_rad);
        assert_int_equal(test_alloc_live(), 2);
    }
    test_alloc_fail_from(0);
    dif_plan_free(&plan);
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quantity__names_and_units_go_round),
        cmocka_unit_test(test_create__refuses_bad_counts),
        cmocka_unit_test(test_check__refuses_what_cannot_be_measured),
        cmocka_unit_test(test_copy__is_deep),
        cmocka_unit_test(test_transfer__agrees_with_the_directions),
        cmocka_unit_test(test_table__holds_a_copy_of_its_plan),
        cmocka_unit_test(test_alloc_failing__leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
