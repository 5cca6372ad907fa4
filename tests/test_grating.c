#include "tests/near.h"

#include <string.h>

#include "core/grating.h"
#include "core/units.h"
#include "tests/rows.h"

static const dif_profile PROFILES[] = {DIF_PROFILE_SINE, DIF_PROFILE_BLAZED, DIF_PROFILE_TRIANGLE,
                                       DIF_PROFILE_LAMELLAR};

static void test_profile__names_go_round(void **state)
{
    (void)state;
    static const char *const names[] = {"sine", "blazed", "triangle", "lamellar"};
    for (int i = 0; i < 4; i++) {
        dif_profile profile;
        assert_string_equal(dif_profile_name(PROFILES[i]), names[i]);
        assert_true(dif_profile_from_name(names[i], &profile));
        assert_int_equal(profile, PROFILES[i]);
    }
    dif_profile profile;
    assert_false(dif_profile_from_name("sin", &profile));
}

/* ---- directions ---- */

static dif_vec3 random_direction(uint64_t *random)
{
    return dif_vec3_from_angles_rad(test_random(random, 0.0, 1.55), test_random(random, 0.0, DIF_TWO_PI));
}

static void test_direction__in_plane_is_the_grating_equation(void **state)
{
    (void)state;
    for (int deg = -80; deg <= 80; deg += 10) {
        const double theta = dif_rad_from_deg(deg);
        const dif_vec3 wi = dif_vec3_from_angles_rad(theta, 0.0);
        for (int m = -6; m <= 6; m++) {
            dif_vec3 wo;
            const double sine = m * 0.5 / 2.4 - sin(theta);
            const bool propagates = dif_grating_direction(wi, 2.4, 0.0, 0.5, m, &wo);
            assert_int_equal(propagates, fabs(sine) < 1.0);
            assert_near(wo.x, sine, 0.0, 1e-15);
            assert_near(wo.z, propagates ? sqrt(1.0 - sine * sine) : 0.0, 0.0, 1e-14);
        }
    }
}

static void test_direction__order_zero_is_the_mirror(void **state)
{
    (void)state;
    uint64_t random = 21;
    for (int i = 0; i < 1000; i++) {
        const dif_vec3 wi = random_direction(&random);
        dif_vec3 wo;
        assert_true(dif_grating_direction(wi, 1.5, test_random(&random, -4.0, 4.0), 0.6, 0, &wo));
        assert_near(wo.x, -wi.x, 0.0, 0.0);
        assert_near(wo.y, -wi.y, 0.0, 0.0);
        assert_near(wo.z, wi.z, 0.0, 1e-12); /* 1 - sin^2 loses digits towards grazing */
    }
}

/* -(u, v) = (m lambda/d) s, |wo| = 1; light sent back along order m leaves along wi in the same order. */
static void test_direction__conical_orders_obey_the_vector_equation(void **state)
{
    (void)state;
    uint64_t random = 22;
    int n_found = 0;
    for (int i = 0; i < 4000; i++) {
        const dif_vec3 wi = random_direction(&random);
        const double d = test_random(&random, 0.4, 4.0), psi = test_random(&random, -4.0, 4.0);
        const int m = (int)test_random(&random, -8.0, 8.0);
        dif_vec3 wo, back;
        if (!dif_grating_direction(wi, d, psi, 0.55, m, &wo))
            continue;
        n_found++;
        const dif_vec3 uvw = dif_vec3_transfer(wi, wo);
        assert_near(-uvw.x, m * 0.55 / d * cos(psi), 0.0, 1e-14);
        assert_near(-uvw.y, m * 0.55 / d * sin(psi), 0.0, 1e-14);
        assert_near(dif_vec3_dot(wo, wo), 1.0, 0.0, 1e-14);
        assert_true(dif_grating_direction(wo, d, psi, 0.55, m, &back));
        assert_near(back.x, wi.x, 0.0, 1e-14);
        assert_near(back.y, wi.y, 0.0, 1e-14);
    }
    assert_in_range(n_found, 500, 4000);
}

static void test_direction__grazing_orders_count_as_evanescent(void **state)
{
    (void)state;
    dif_vec3 wo;
    const dif_vec3 up = {0.0, 0.0, 1.0};
    assert_false(dif_grating_direction(up, 2.5, 0.0, 0.5, 5, &wo));
    assert_near(wo.z, 0.0, 0.0, 0.0);
    /* sin 30 degrees rounds to just below one half */
    assert_false(dif_grating_direction(dif_vec3_from_angles_rad(dif_rad_from_deg(30.0), 0.0), 1.0, 0.0, 0.5, -1, &wo));
}

static void test_order_range__is_what_propagates(void **state)
{
    (void)state;
    uint64_t random = 23;
    for (int i = 0; i < 2000; i++) {
        const dif_vec3 wi = random_direction(&random);
        const double d = test_random(&random, 0.1, 6.0), psi = test_random(&random, -4.0, 4.0);
        int m_min, m_max;
        assert_true(dif_grating_order_range(wi, d, psi, 0.55, &m_min, &m_max));
        for (int m = -40; m <= 40; m++) {
            dif_vec3 wo;
            assert_int_equal(dif_grating_direction(wi, d, psi, 0.55, m, &wo), m >= m_min && m <= m_max);
        }
    }
    int m_min = 5, m_max = 5;
    assert_false(dif_grating_order_range((dif_vec3){0.6, 0.0, -0.8}, 1.0, 0.0, 0.5, &m_min, &m_max));
    assert_int_equal(m_min, 0);
    assert_int_equal(m_max, 0);
    const dif_vec3 up = {0.0, 0.0, 1.0};
    assert_true(dif_grating_order_range(up, 1e30, 0.0, 0.5, &m_min, &m_max)); /* no overflow of the order number */
    assert_in_range(m_max, 999999999, 1000000001);
}

/* ---- powers ---- */

static double height_of(dif_profile profile, double duty, double t)
{
    switch (profile) {
    case DIF_PROFILE_SINE:
        return 0.5 * sin(DIF_TWO_PI * t);
    case DIF_PROFILE_BLAZED:
        return t;
    case DIF_PROFILE_TRIANGLE:
        return t < 0.5 ? 2.0 * t : 2.0 - 2.0 * t;
    default:
        return t < duty ? 1.0 : 0.0;
    }
}

/* |c_m|^2 from its definition: midpoint sums over pieces between the corners at t = 0, 1/4, 1/2, 1. Each order is
 * exp(i kw H h(t) - 2 pi i m t): light of order m leaves at -u = m lambda/d. */
static double power_by_integral(dif_profile profile, int m, double a)
{
    enum { N = 40000 };
    double re = 0.0, im = 0.0;
    for (int i = 0; i < N; i++) {
        const double t = (i + 0.5) / N, phase = a * height_of(profile, 0.25, t) - DIF_TWO_PI * m * t;
        re += cos(phase) / N;
        im += sin(phase) / N;
    }
    return re * re + im * im;
}

static void test_power__is_the_integral_over_a_period(void **state)
{
    (void)state;
    uint64_t random = 31;
    for (int p = 0; p < 4; p++) {
        for (int trial = 0; trial < 12; trial++) {
            const double height_um = test_random(&random, 0.05, 0.6), kw = test_random(&random, -30.0, 0.0);
            const int m = (int)test_random(&random, -9.0, 9.0);
            const dif_grating grating = {PROFILES[p], 2.5, height_um, 0.25, 0.0};
            /* the midpoint rule is off by (phase slope/N)^2/24 < 4e-8, weighted by |c_m| */
            assert_near(dif_grating_power(&grating, m, kw), power_by_integral(PROFILES[p], m, kw * height_um), 0.0,
                        4e-8);
        }
    }
}

/* The sign: a ramp that rises towards +x, in reflection (kw < 0), at a depth of one wavelength of path sends all light
 * into m = -1, and the transmitted sign into m = +1. */
static void test_power__blazed_ramp_favours_negative_orders(void **state)
{
    (void)state;
    const dif_grating grating = {DIF_PROFILE_BLAZED, 2.5, 0.25, 0.5, 0.0};
    const double kw = -DIF_TWO_PI / 0.25;
    for (int m = -4; m <= 4; m++) {
        assert_near(dif_grating_power(&grating, m, kw), m == -1 ? 1.0 : 0.0, 0.0, 1e-15);
        assert_near(dif_grating_power(&grating, m, -kw), m == 1 ? 1.0 : 0.0, 0.0, 1e-15);
        assert_near(power_by_integral(DIF_PROFILE_BLAZED, m, kw * 0.25), m == -1 ? 1.0 : 0.0, 0.0, 1e-9);
    }
}

static void test_power__frozen_integrals(void **state)
{
    (void)state;
    FILE *file = test_rows_open("fixtures/expected", "order_powers.csv");
    assert_non_null(file);
    test_row row;
    int n_read = 0, n = 0;
    while (test_row_next(file, &n_read, &row)) {
        dif_grating grating = {.period_um = 1.0, .height_um = 0.5, .duty = strtod(row.cell[3], NULL)};
        assert_true(dif_profile_from_name(row.cell[0], &grating.profile));
        const double got = dif_grating_power(&grating, atoi(row.cell[1]), strtod(row.cell[2], NULL) / 0.5);
        assert_near(got, strtod(row.cell[4], NULL), 0.0, 1e-13);
        n++;
    }
    fclose(file);
    assert_int_equal(n, 200);
}

/* Large orders and negative arguments: J_m(x)^2, x = kw H / 2. */
static void test_power__sine_is_a_bessel_function(void **state)
{
    (void)state;
    const dif_grating grating = {DIF_PROFILE_SINE, 1.0, 2.0, 0.5, 0.0};
    FILE *file = test_rows_open("fixtures/expected", "bessel.csv");
    assert_non_null(file);
    test_row row;
    int n_read = 0, n = 0;
    while (test_row_next(file, &n_read, &row)) {
        const double j = strtod(row.cell[2], NULL);
        assert_near(dif_grating_power(&grating, atoi(row.cell[0]), strtod(row.cell[1], NULL)), j * j, 0.0, 1e-15);
        n++;
    }
    fclose(file);
    assert_int_equal(n, 180);
}

/* A phase plate keeps the power: the orders of each profile sum to one. What is left out beyond |m| = M falls as
 * 4 / (pi m)^2 for walls, so below 8 / (pi^2 M), and as 4 a^2 / (pi m)^4 for the triangle, so below 3e-12. */
static void test_power__orders_sum_to_one(void **state)
{
    (void)state;
    uint64_t random = 33;
    for (int trial = 0; trial < 20; trial++) {
        const double a = test_random(&random, -25.0, 0.0);
        for (int p = 0; p < 4; p++) {
            const dif_grating grating = {PROFILES[p], 1.0, 1.0, test_random(&random, 0.1, 0.9), 0.0};
            const int m_max = PROFILES[p] == DIF_PROFILE_SINE ? 200 : 20000; /* J_m(12.5) is gone long before */
            double sum = 0.0;
            for (int m = -m_max; m <= m_max; m++)
                sum += dif_grating_power(&grating, m, a);
            const bool walls = PROFILES[p] == DIF_PROFILE_BLAZED || PROFILES[p] == DIF_PROFILE_LAMELLAR;
            assert_at_most(sum, 1.0 + 1e-12);
            assert_near(sum, 1.0, 0.0, walls ? 2.0 * 4.0 / (DIF_PI * DIF_PI * 20000.0) : 1e-11);
        }
    }
}

static void test_power__flat_sends_all_into_the_mirror_order(void **state)
{
    (void)state;
    for (int p = 0; p < 4; p++) {
        const dif_grating grating = {PROFILES[p], 1.0, 0.0, 0.5, 0.0};
        for (int m = -5; m <= 5; m++)
            assert_near(dif_grating_power(&grating, m, -20.0), m == 0 ? 1.0 : 0.0, 0.0, 1e-30);
    }
}

static void test_efficiency__reciprocal_also_in_conical_mount(void **state)
{
    (void)state;
    uint64_t random = 34;
    int n_found = 0;
    for (int i = 0; i < 4000; i++) {
        const dif_grating grating = {PROFILES[i % 4], test_random(&random, 0.6, 4.0), test_random(&random, 0.0, 0.5),
                                     0.3, test_random(&random, -4.0, 4.0)};
        const dif_vec3 wi = random_direction(&random);
        const int m = (int)test_random(&random, -5.0, 5.0);
        dif_vec3 wo;
        if (!dif_grating_direction(wi, grating.period_um, grating.psi_rad, 0.5, m, &wo) || wo.z < 0.05 || wi.z < 0.05) {
            assert_true(wo.z > 0.0 || dif_grating_efficiency(&grating, wi, 0.5, 1.0, m) == 0.0);
            continue;
        }
        n_found++;
        const double there = dif_grating_efficiency(&grating, wi, 0.5, 0.9, m);
        assert_near(dif_grating_efficiency(&grating, wo, 0.5, 0.9, m), there, 1e-11, 1e-15);
    }
    assert_in_range(n_found, 500, 4000);
}

/* Turning grating and light together changes nothing. */
static void test_efficiency__depends_on_the_relative_azimuth_only(void **state)
{
    (void)state;
    uint64_t random = 35;
    for (int i = 0; i < 1000; i++) {
        const double theta = test_random(&random, -1.2, 1.2), phi = test_random(&random, -3.0, 3.0);
        const double turn = test_random(&random, -3.0, 3.0);
        dif_grating grating = {PROFILES[i % 4], 2.0, 0.3, 0.4, 0.2};
        const int m = (int)test_random(&random, -4.0, 4.0);
        const double before = dif_grating_efficiency(&grating, dif_vec3_from_angles_rad(theta, phi), 0.5, 1.0, m);
        grating.psi_rad += turn;
        const double after = dif_grating_efficiency(&grating, dif_vec3_from_angles_rad(theta, phi + turn), 0.5, 1.0, m);
        assert_near(after, before, 1e-9, 1e-12); /* near grazing 1/cos magnifies the rounding of the angle */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_profile__names_go_round),
        cmocka_unit_test(test_direction__in_plane_is_the_grating_equation),
        cmocka_unit_test(test_direction__order_zero_is_the_mirror),
        cmocka_unit_test(test_direction__conical_orders_obey_the_vector_equation),
        cmocka_unit_test(test_direction__grazing_orders_count_as_evanescent),
        cmocka_unit_test(test_order_range__is_what_propagates),
        cmocka_unit_test(test_power__is_the_integral_over_a_period),
        cmocka_unit_test(test_power__blazed_ramp_favours_negative_orders),
        cmocka_unit_test(test_power__frozen_integrals),
        cmocka_unit_test(test_power__sine_is_a_bessel_function),
        cmocka_unit_test(test_power__orders_sum_to_one),
        cmocka_unit_test(test_power__flat_sends_all_into_the_mirror_order),
        cmocka_unit_test(test_efficiency__reciprocal_also_in_conical_mount),
        cmocka_unit_test(test_efficiency__depends_on_the_relative_azimuth_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
