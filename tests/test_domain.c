/* Scalar theory held against rigorous theory, and the rules of trust held against the sweep. */
#include "tests/near.h"

#include <string.h>

#include "core/domain.h"
#include "core/grating.h"
#include "core/units.h"
#include "tests/rows.h"

enum { ORDER_MAX = 16 };

/* Both theories' order powers of one grating, wavelength and angle, kept by order + ORDER_MAX. */
typedef struct shares {
    double ours[2 * ORDER_MAX + 1], rigorous[2 * ORDER_MAX + 1];
    bool is_there[2 * ORDER_MAX + 1];
} shares;

/* Columns of the order files. */
enum { PROFILE, D_NM, H_NM, DUTY, THETA_DEG, LAMBDA_NM, ORDER, THETA_M_DEG, W, ABS_C2, RHO, EFF, EFF_AVG = 10 };

static double number(const test_row *row, int column)
{
    return strtod(row->cell[column], NULL);
}

static dif_grating grating_of(const test_row *row)
{
    dif_grating grating = {.period_um = dif_um_from_nm(number(row, D_NM)),
                           .height_um = dif_um_from_nm(number(row, H_NM)),
                           .duty = number(row, DUTY)};
    const char *name = strcmp(row->cell[PROFILE], "sin") == 0 ? "sine" : row->cell[PROFILE];
    assert_true(dif_profile_from_name(name, &grating.profile));
    return grating;
}

static FILE *open_rigorous(const char *name)
{
    const char *folder = test_data_folder();
    if (!folder)
        skip();
    FILE *file = test_rows_open(folder, name);
    assert_non_null(file);
    return file;
}

static void test_grating__closed_forms_equal_the_tabulated_ones(void **state)
{
    (void)state;
    FILE *file = open_rigorous("rigorous/scalar_orders.csv");
    test_row row;
    int n_read = 0, n = 0;
    double worst = 0.0;
    while (test_row_next(file, &n_read, &row)) {
        const dif_grating grating = grating_of(&row);
        const double lambda_um = dif_um_from_nm(number(&row, LAMBDA_NM));
        const dif_vec3 wi = dif_vec3_from_angles_rad(dif_rad_from_deg(number(&row, THETA_DEG)), 0.0);
        const int m = (int)number(&row, ORDER);
        dif_vec3 wm;
        assert_true(dif_grating_direction(wi, grating.period_um, 0.0, lambda_um, m, &wm));
        assert_near(dif_deg_from_rad(atan2(wm.x, wm.z)), number(&row, THETA_M_DEG), 0.0, 1e-8); /* printed digits */
        const double w = -(wi.z + wm.z);
        const double c2 = dif_grating_power(&grating, m, DIF_TWO_PI * w / lambda_um);
        const double eff = dif_grating_efficiency(&grating, wi, lambda_um, 1.0, m);
        const double scale = fmax(1.0, number(&row, EFF));
        assert_near(c2, number(&row, ABS_C2), 0.0, 1e-9);
        assert_near(eff * wi.z, number(&row, RHO), 0.0, 1e-9 * scale);
        assert_near(eff, number(&row, EFF), 0.0, 1e-9 * scale);
        worst = fmax(worst, fabs(c2 - number(&row, ABS_C2)));
        n++;
    }
    fclose(file);
    print_message("%d orders, |c_m|^2 off by at most %.2g\n", n, worst);
    assert_int_equal(n, 474);
}

/* Loads one grating's rows of the perfect conductor with our efficiencies beside them; returns the number of orders. */
static int load_shares(const char *profile, double d_nm, double h_nm, double theta_deg, double lambda_nm, shares *out)
{
    memset(out, 0, sizeof *out);
    FILE *file = open_rigorous("rigorous/pec_orders.csv");
    test_row row;
    int n_read = 0, n = 0;
    double sum_ours = 0.0, sum_rigorous = 0.0;
    while (test_row_next(file, &n_read, &row)) {
        if (strcmp(row.cell[PROFILE], profile) != 0 || number(&row, D_NM) != d_nm || number(&row, H_NM) != h_nm ||
            number(&row, THETA_DEG) != theta_deg || number(&row, LAMBDA_NM) != lambda_nm)
            continue;
        const dif_grating grating = grating_of(&row);
        const dif_vec3 wi = dif_vec3_from_angles_rad(dif_rad_from_deg(theta_deg), 0.0);
        const int m = (int)number(&row, ORDER), at = m + ORDER_MAX;
        assert_in_range(at, 0, 2 * ORDER_MAX);
        out->is_there[at] = true;
        out->ours[at] = dif_grating_efficiency(&grating, wi, dif_um_from_nm(lambda_nm), 1.0, m);
        out->rigorous[at] = number(&row, EFF_AVG);
        sum_ours += out->ours[at];
        sum_rigorous += out->rigorous[at];
        n++;
    }
    fclose(file);
    for (int i = 0; i <= 2 * ORDER_MAX; i++) { /* shares of the power of all propagating orders */
        out->ours[i] /= sum_ours;
        out->rigorous[i] /= sum_rigorous;
    }
    return n;
}

/* Half the sum of absolute differences: the power that sits in the wrong order. */
static double total_variation(const shares *s)
{
    double sum = 0.0;
    for (int i = 0; i <= 2 * ORDER_MAX; i++)
        sum += 0.5 * fabs(s->ours[i] - s->rigorous[i]);
    return sum;
}

/* Largest relative error of a share among the orders that carry at least `least` of the power. */
static double worst_relative(const shares *s, double least)
{
    double worst = 0.0;
    for (int i = 0; i <= 2 * ORDER_MAX; i++) {
        if (s->is_there[i] && s->rigorous[i] >= least)
            worst = fmax(worst, fabs(s->ours[i] / s->rigorous[i] - 1.0));
    }
    return worst;
}

/* Sinusoid 2500/250 nm: within 1 % at normal incidence, within 5 % at 30 degrees. What is within: the total variation
 * of the shares, and, which is sharper, the relative error of the share of every order that carries 5 % of the power. */
static void test_grating__sinusoid_agrees_with_rigorous_theory(void **state)
{
    (void)state;
    static const struct {
        double theta_deg, lambda_nm, within;
    } rows[] = {{0.0, 400.0, 0.01}, {0.0, 600.0, 0.01}, {0.0, 700.0, 0.01}, {30.0, 400.0, 0.05}, {30.0, 500.0, 0.05}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        shares s;
        assert_in_range(load_shares("sin", 2500.0, 250.0, rows[i].theta_deg, rows[i].lambda_nm, &s), 6, 13);
        print_message("theta %2g deg, %g nm: total variation %.5f, worst order of 5 %% and more %.5f\n",
                      rows[i].theta_deg, rows[i].lambda_nm, total_variation(&s), worst_relative(&s, 0.05));
        assert_at_most(total_variation(&s), rows[i].within);
        assert_at_most(worst_relative(&s, 0.05), rows[i].within);
    }
}

static double dominant_error(const shares *s)
{
    int top = 0;
    for (int i = 1; i <= 2 * ORDER_MAX; i++)
        top = s->rigorous[i] > s->rigorous[top] ? i : top;
    return fabs(s->ours[top] / s->rigorous[top] - 1.0);
}

/* Walls: the dominant order is right to 10 % at normal incidence and wrong by two thirds where +75 degrees shines on the
 * wall: the verdict must not promise more. */
static void test_grating__walls_hold_for_the_dominant_order_only(void **state)
{
    (void)state;
    static const struct {
        const char *profile;
        double h_nm;
    } gratings[] = {{"blazed", 250.0}, {"lamellar", 150.0}};
    for (int g = 0; g < 2; g++) {
        for (double lambda_nm = 400.0; lambda_nm <= 700.0; lambda_nm += 100.0) {
            shares s;
            assert_true(load_shares(gratings[g].profile, 2500.0, gratings[g].h_nm, 0.0, lambda_nm, &s) > 5);
            assert_at_most(dominant_error(&s), 0.10);
            assert_at_most(total_variation(&s), 0.10);
            const double d = 2500.0 / lambda_nm, h = gratings[g].h_nm / lambda_nm;
            assert_int_equal(dif_domain_verdict(DIF_RELIEF_WALLS, d, h, 0.0, NULL), DIF_TRUST_DOMINANT);
        }
    }
    shares s;
    assert_true(load_shares("blazed", 2500.0, 250.0, 75.0, 400.0, &s) > 5);
    assert_at_most(0.5, dominant_error(&s));
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_WALLS, 6.25, 0.625, dif_rad_from_deg(75.0), NULL), DIF_TRUST_NONE);
}

/* Columns of the sweep: D2 the largest error of one order's share, TV the total variation, both of shares of the power,
 * unpolarised, in the form that our efficiencies have. */
enum { SWEEP_D = 1, SWEEP_H, SWEEP_THETA, SWEEP_D2 = 8, SWEEP_TV = 9 };

/* Every row that a rule lets through keeps what the rule promises; what the rules leave out although it would do is
 * counted, because that is where they fail: on the careful side. */
static void test_verdict__keeps_its_promise_over_the_sweep(void **state)
{
    (void)state;
    FILE *file = open_rigorous("rigorous/domain_sweep.csv");
    test_row row;
    int n_read = 0, n[3] = {0}, n_too_careful = 0;
    double worst_tv = 0.0, worst_d2 = 0.0;
    while (test_row_next(file, &n_read, &row)) {
        const bool walls = strcmp(row.cell[PROFILE], "blazed") == 0;
        const double tv = number(&row, SWEEP_TV), d2 = number(&row, SWEEP_D2);
        const dif_trust trust =
            dif_domain_verdict(walls ? DIF_RELIEF_WALLS : DIF_RELIEF_SMOOTH, number(&row, SWEEP_D),
                               number(&row, SWEEP_H), dif_rad_from_deg(number(&row, SWEEP_THETA)), NULL);
        n[trust]++;
        if (trust == DIF_TRUST_SHARES)
            worst_tv = fmax(worst_tv, tv);
        if (trust == DIF_TRUST_DOMINANT)
            worst_d2 = fmax(worst_d2, d2);
        n_too_careful += (trust == DIF_TRUST_DOMINANT && tv <= 0.05) || (trust == DIF_TRUST_NONE && d2 <= 0.10);
    }
    fclose(file);
    print_message(
        "shares %d rows, worst total variation %.4f; dominant %d rows, worst share off by %.4f; none %d rows; "
        "stricter than needed for %d rows\n",
        n[DIF_TRUST_SHARES], worst_tv, n[DIF_TRUST_DOMINANT], worst_d2, n[DIF_TRUST_NONE], n_too_careful);
    assert_int_equal(n[0] + n[1] + n[2], 491);
    assert_in_range(n[DIF_TRUST_SHARES], 60, 491);
    assert_in_range(n[DIF_TRUST_DOMINANT], 60, 491);
    assert_at_most(worst_tv, 0.05);
    assert_at_most(worst_d2, 0.10);
}

static void test_verdict__edges_lines_and_measured_scans(void **state)
{
    (void)state;
    const char *line = NULL;
    const double deg = DIF_PI / 180.0;
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_SMOOTH, 5.0, 0.35, 30.0 * deg, &line), DIF_TRUST_SHARES);
    assert_string_equal(line, "Scalar theory gives the shares of the orders within 5 % here; angles and periods hold.");
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_SMOOTH, 5.0, 0.36, -30.0 * deg, &line), DIF_TRUST_DOMINANT);
    assert_non_null(strstr(line, "dominant orders only"));
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_SMOOTH, 5.0, 0.1, 75.0 * deg, NULL), DIF_TRUST_SHARES);
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_SMOOTH, 5.0, 0.11, 75.0 * deg, NULL), DIF_TRUST_DOMINANT);
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_SMOOTH, 5.0, 0.01, 80.0 * deg, &line), DIF_TRUST_NONE);
    assert_non_null(strstr(line, "does not give trustworthy powers"));
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_MEASURED, 20.0, 0.01, 0.0, NULL), DIF_TRUST_DOMINANT);
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_MEASURED, 2.0, 0.2, 75.0 * deg, NULL), DIF_TRUST_NONE);
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_WALLS, 20.0, 0.05, 16.0 * deg, NULL), DIF_TRUST_NONE);
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_SMOOTH, NAN, 0.1, 0.0, NULL), DIF_TRUST_NONE);
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_SMOOTH, 9.0, NAN, 0.0, NULL), DIF_TRUST_NONE);
    assert_int_equal(dif_domain_verdict(DIF_RELIEF_SMOOTH, 9.0, 0.1, NAN, NULL), DIF_TRUST_NONE);
    assert_string_equal(dif_trust_name(DIF_TRUST_NONE), "none");
    assert_string_equal(dif_trust_name(DIF_TRUST_DOMINANT), "dominant");
    assert_string_equal(dif_trust_name(DIF_TRUST_SHARES), "shares");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grating__closed_forms_equal_the_tabulated_ones),
        cmocka_unit_test(test_grating__sinusoid_agrees_with_rigorous_theory),
        cmocka_unit_test(test_grating__walls_hold_for_the_dominant_order_only),
        cmocka_unit_test(test_verdict__keeps_its_promise_over_the_sweep),
        cmocka_unit_test(test_verdict__edges_lines_and_measured_scans),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
