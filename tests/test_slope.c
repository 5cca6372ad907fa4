#include "core/slope.h"

#include <string.h>

#include "alloc_count.h"
#include "core/units.h"
#include "near.h"
#include "rough.h"

enum { PANEL = 8 };
static const long double NODE[PANEL / 2] = {0.18343464249564980494L, 0.52553240991632898582L, 0.79666647741362673959L,
                                            0.96028985649753623168L};
static const long double WEIGHT[PANEL / 2] = {0.36268378337836198297L, 0.31370664587788728734L, 0.22238103445337447054L,
                                              0.10122853629037625915L};

/* Node i of n * PANEL over [a, b] by Gauss's rule on n panels, and its weight. */
static long double quadrature(long double a, long double b, int n, int i, long double *weight)
{
    const long double half = 0.5L * (b - a) / n, middle = a + half * (2 * (i / PANEL) + 1);
    const int k = i % PANEL, j = k < PANEL / 2 ? k : k - PANEL / 2;
    *weight = half * WEIGHT[j];
    return k < PANEL / 2 ? middle - half * NODE[j] : middle + half * NODE[j];
}

/* The cut normal by quadrature over s = z - t, around the mode of s exp(z s - s^2 / 2). */
static dif_slope_cut cut_by_quadrature(double z)
{
    const int n = 400;
    const long double zl = z, root = sqrtl(zl * zl + 4.0L);
    const long double mode = zl > 0.0L ? 0.5L * (zl + root) : 2.0L / (root - zl); /* no cancellation */
    const long double width = 1.0L / sqrtl(1.0L + 1.0L / (mode * mode));
    const long double from = fmaxl(mode - 14.0L * width, 0.0L), to = mode + 60.0L * width;
    long double sum[3] = {0.0L, 0.0L, 0.0L}, mean = 0.0L;
    for (int pass = 0; pass < 2; pass++) {
        memset(sum, 0, sizeof sum);
        for (int i = 0; i < n * PANEL; i++) {
            long double w;
            const long double s = quadrature(from, to, n, i, &w), d = s - mode;
            w *= s * expl(zl * d - 0.5L * (s - mode) * (s + mode));
            sum[0] += w;
            sum[1] += w * s;
            sum[2] += w * (s - mean) * (s - mean);
        }
        mean = sum[1] / sum[0];
    }
    /* -(z - s)^2 / 2 = -z^2/2 + z s - s^2 / 2, of which that at the mode was left out */
    const long double ln_psi =
        logl(sum[0]) + zl * mode - 0.5L * mode * mode - 0.5L * zl * zl - 0.5L * logl(2.0L * 3.14159265358979323846264L);
    return (dif_slope_cut){(double)expl(ln_psi), (double)ln_psi, (double)(zl - mean), (double)(sum[2] / sum[0])};
}

static void test_cut_at__matches_quadrature(void **state)
{
    (void)state;
    static const double at[] = {-1e4, -1e3, -100.0, -38.0, -20.0, -12.0, -8.0, -5.0, -3.0, -2.0001, -2.0, -1.9999,
                                -1.0, -0.1, 0.0,    0.1,   1.0,   3.0,   8.0,  20.0, 39.9, 40.1,    300.0};
    double worst = 0.0;
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        const dif_slope_cut got = dif_slope_cut_at(at[i]), want = cut_by_quadrature(at[i]);
        assert_near(got.ln_psi, want.ln_psi, 1e-13, 1e-13);
        if (at[i] > -38.0)                              /* below it Psi leaves the range of normal numbers */
            assert_near(got.psi, want.psi, 1e-12, 0.0); /* exp(-z^2 / 2) magnifies rounding by z^2 */
        assert_near(got.mean, want.mean, 1e-13, 1e-300);
        assert_near(got.variance, want.variance, 1e-12, 0.0); /* loses a factor 40 just above z = -2 */
        worst = fmax(worst, fabs(got.variance / want.variance - 1.0));
    }
    print_message("largest relative error of the variance: %.2g\n", worst);
}

static void test_cut_at__ends(void **state)
{
    (void)state;
    const dif_slope_cut far = dif_slope_cut_at((double)INFINITY), deep = dif_slope_cut_at(-1e8);
    assert_near(far.mean, 0.0, 0.0, 0.0);
    assert_near(far.variance, 1.0, 0.0, 0.0);
    assert_near(deep.variance * 1e16, 2.0, 1e-12,
                0.0); /* an exponential decay of length 1/x, weighted by s: Gamma(2) */
    assert_near(deep.mean, -1e8 - 2e-8, 3e-16, 0.0);
    assert_near(deep.psi, 0.0, 0.0, 0.0);
    assert_true(isfinite(deep.ln_psi));
}

/* A random Gaussian of slopes: correlated up to +-0.95. */
static dif_slope_gauss random_gauss(uint64_t *seed, double mean, double sd)
{
    const double sx = test_random(seed, 0.05 * sd, sd), sy = test_random(seed, 0.05 * sd, sd);
    return (dif_slope_gauss){test_random(seed, -mean, mean), test_random(seed, -mean, mean), sx * sx, sy * sy,
                             test_random(seed, -0.95, 0.95) * sx * sy};
}

/* The definition itself, in two dimensions: p(s) max(0, cos - s.v sin), no Gaussian algebra. */
static dif_slope_visible visible_by_quadrature(const dif_slope_gauss *g, double theta_rad, double phi_rad)
{
    enum { N_ALONG = 70, N_ACROSS = 500 };
    const double c = cos(phi_rad), s = sin(phi_rad), reach = 13.0;
    const double mo = g->mean_x * c + g->mean_y * s, mp = g->mean_y * c - g->mean_x * s;
    const double so = sqrt(g->var_x * c * c + g->var_y * s * s + 2.0 * g->cov_xy * c * s);
    const double sp = sqrt(g->var_x * s * s + g->var_y * c * c - 2.0 * g->cov_xy * c * s);
    const double cut = cos(theta_rad) / sin(theta_rad), high = fmin(cut, mo + reach * so);
    const double low = fmin(cut, mo) - reach * so, step = 2.0 * reach * sp / N_ACROSS;
    double w0 = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
    for (int i = 0; i < N_ALONG * PANEL; i++) {
        long double weight;
        const double o = (double)quadrature((long double)low, (long double)high, N_ALONG, i, &weight);
        for (int j = 0; j <= N_ACROSS; j++) {
            const double p = mp - reach * sp + j * step, slope[2] = {o * c - p * s, o * s + p * c};
            const double w =
                (double)weight * step * dif_slope_density(g, slope) * dif_slope_weight(theta_rad, phi_rad, slope);
            w0 += w;
            x += w * slope[0];
            y += w * slope[1];
            xx += w * slope[0] * slope[0];
            yy += w * slope[1] * slope[1];
            xy += w * slope[0] * slope[1];
        }
    }
    x /= w0;
    y /= w0;
    return (dif_slope_visible){{x, y, xx / w0 - x * x, yy / w0 - y * y, xy / w0 - x * y}, w0, log(w0)};
}

static void test_visible_of__matches_quadrature_in_two_dimensions(void **state)
{
    (void)state;
    uint64_t seed = 41;
    double worst = 0.0;
    for (int i = 0; i < 40; i++) {
        const dif_slope_gauss g = random_gauss(&seed, 0.6, 0.8);
        const double theta = i == 0 ? 0.5 * DIF_PI : test_random(&seed, 0.02, 0.5 * DIF_PI);
        const double phi = test_random(&seed, -4.0, 4.0), size = g.var_x + g.var_y;
        const dif_slope_visible got = dif_slope_visible_of(&g, theta, phi),
                                want = visible_by_quadrature(&g, theta, phi);
        assert_near(got.norm, want.norm, 1e-9, 0.0);
        assert_near(got.ln_norm, want.ln_norm, 1e-9, 1e-9);
        assert_near(got.gauss.mean_x, want.gauss.mean_x, 1e-9, 1e-9 * sqrt(size));
        assert_near(got.gauss.mean_y, want.gauss.mean_y, 1e-9, 1e-9 * sqrt(size));
        assert_near(got.gauss.var_x, want.gauss.var_x, 1e-9, 1e-9 * size);
        assert_near(got.gauss.var_y, want.gauss.var_y, 1e-9, 1e-9 * size);
        assert_near(got.gauss.cov_xy, want.gauss.cov_xy, 1e-9, 1e-9 * size);
        worst = fmax(worst, fabs(got.norm / want.norm - 1.0));
    }
    print_message("largest relative error of the norm: %.2g\n", worst);
}

/* Where the two-dimensional sum underflows: one dimension at a time, through the cut normal's own quadrature. */
static void test_visible_of__deep_and_grazing(void **state)
{
    (void)state;
    static const double z_of[] = {-1e4, -300.0, -40.0, -9.0, -2.5};
    for (size_t i = 0; i < sizeof z_of / sizeof *z_of; i++) {
        /* seen at pi/2 along x: a = -m_x, b = sd_x */
        const double sd = 0.3, cov = 0.02;
        const dif_slope_gauss g = {-z_of[i] * sd, 0.1, sd * sd, 0.05, cov};
        const dif_slope_visible got = dif_slope_visible_of(&g, 0.5 * DIF_PI, 0.0);
        const dif_slope_cut want = cut_by_quadrature(z_of[i]);
        assert_near(got.ln_norm, log(sd) + want.ln_psi, 1e-11, 0.0); /* cos(pi/2) = 6e-17 moves z by 2e-16 z */
        assert_near(got.gauss.mean_x, g.mean_x + sd * want.mean, 1e-12, 1e-12 * g.mean_x);
        assert_near(got.gauss.mean_y, 0.1 + cov / sd * want.mean, 1e-9, 0.0);
        assert_near(got.gauss.var_x, sd * sd * want.variance, 1e-9, 0.0);
        assert_near(got.gauss.var_y, 0.05 - cov * cov / (sd * sd) * (1.0 - want.variance), 1e-9, 0.0);
        assert_near(got.gauss.cov_xy, cov * want.variance, 1e-9, 0.0);
    }
}

static void assert_same_gauss(const dif_slope_gauss *got, const dif_slope_gauss *want, double tol)
{
    assert_near(got->mean_x, want->mean_x, tol, tol);
    assert_near(got->mean_y, want->mean_y, tol, tol);
    assert_near(got->var_x, want->var_x, tol, tol);
    assert_near(got->var_y, want->var_y, tol, tol);
    assert_near(got->cov_xy, want->cov_xy, tol, tol);
}

static void test_visible_of__from_above_is_the_slopes_themselves(void **state)
{
    (void)state;
    const dif_slope_gauss g = {0.2, -0.3, 0.09, 0.04, 0.03};
    const dif_slope_visible above = dif_slope_visible_of(&g, 0.0, 1.2), near = dif_slope_visible_of(&g, 1e-8, 1.2);
    assert_near(above.norm, 1.0, 0.0, 0.0);
    assert_same_gauss(&above.gauss, &g, 1e-15);
    /* to first order the norm is 1 - m_o theta and the mean moves by -var theta */
    assert_near(near.norm, 1.0 - 1e-8 * (0.2 * cos(1.2) - 0.3 * sin(1.2)), 1e-15, 0.0);
    assert_same_gauss(&near.gauss, &g, 1.1e-9);
    assert_near((near.gauss.mean_x - 0.2) * 1e8, -(0.09 * cos(1.2) + 0.03 * sin(1.2)), 0.0, 1e-7);
    const dif_slope_visible small = dif_slope_visible_of(&g, 1e-4, 1.2), want = visible_by_quadrature(&g, 1e-4, 1.2);
    assert_near(small.norm, want.norm, 1e-9, 0.0);
    assert_same_gauss(&small.gauss, &want.gauss, 1e-9);
}

static void test_visible_of__surfaces_without_spread(void **state)
{
    (void)state;
    const dif_slope_gauss plane = {0.5, 0.0, 0.0, 0.0, 0.0}, wall = {3.0, 0.2, 0.0, 0.04, 0.0};
    const dif_slope_visible seen = dif_slope_visible_of(&plane, 0.7, 0.0);
    assert_near(seen.norm, cos(0.7) - 0.5 * sin(0.7), 1e-15, 0.0);
    assert_same_gauss(&seen.gauss, &plane, 0.0);
    const dif_slope_visible hidden = dif_slope_visible_of(&wall, 0.7, 0.0);
    assert_near(hidden.norm, 0.0, 0.0, 0.0);
    assert_true(isinf(hidden.ln_norm) && hidden.ln_norm < 0.0);
    assert_same_gauss(&hidden.gauss, &wall, 0.0);
    const dif_slope_visible edge = dif_slope_visible_of(&(dif_slope_gauss){0}, 0.5 * DIF_PI, 0.3);
    assert_near(edge.norm, 0.0, 0.0, 1e-16);
    assert_true(isfinite(edge.gauss.mean_x + edge.gauss.var_x + edge.gauss.cov_xy));
}

static void test_visible_of__continuous_across_its_branches(void **state)
{
    (void)state;
    /* z passes 40 and -2 as theta grows; neighbours on both sides of each must agree */
    static const double z_of[] = {40.0, -2.0};
    for (size_t i = 0; i < 2; i++) {
        const double sd = 0.5;
        const dif_slope_gauss low = {-z_of[i] * sd * (1.0 - 1e-12), 0.0, sd * sd, 0.1, 0.05};
        dif_slope_gauss high = low;
        high.mean_x = -z_of[i] * sd * (1.0 + 1e-12);
        const dif_slope_visible a = dif_slope_visible_of(&low, 0.5 * DIF_PI, 0.0);
        const dif_slope_visible b = dif_slope_visible_of(&high, 0.5 * DIF_PI, 0.0);
        assert_near(a.norm, b.norm, 1e-10, 0.0);
        assert_same_gauss(&a.gauss, &b.gauss, 1e-10);
    }
}

static void test_visible_of__covariance_stays_positive(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int i = 0; i < 20000; i++) {
        const double mean = test_random(&seed, 0.0, 1.0) < 0.5 ? 0.5 : 50.0;
        const dif_slope_gauss g = random_gauss(&seed, mean, 0.7);
        const dif_slope_visible v =
            dif_slope_visible_of(&g, test_random(&seed, 0.0, 0.5 * DIF_PI), test_random(&seed, 0.0, 7.0));
        const double size = g.var_x + g.var_y;
        assert_true(v.norm >= 0.0 && !isnan(v.ln_norm));
        assert_at_most(-v.gauss.var_x, 1e-13 * size);
        assert_at_most(-v.gauss.var_y, 1e-13 * size);
        assert_at_most(v.gauss.var_x + v.gauss.var_y, size * (1.0 + 1e-12)); /* a cut narrows */
        assert_at_most(v.gauss.cov_xy * v.gauss.cov_xy, v.gauss.var_x * v.gauss.var_y + 1e-13 * size * size);
    }
}

/* A field that is one plane. */
static dif_field plane_field(int n, double slope_x, double slope_y)
{
    dif_field field;
    assert_int_equal(dif_field_create(n, n + 3, 0.1, 0.2, &field, NULL), DIF_OK);
    for (int iy = 0; iy < field.ny; iy++)
        for (int ix = 0; ix < field.nx; ix++)
            field.z_um[iy * field.nx + ix] =
                slope_x * dif_field_x_um(&field, ix) + slope_y * dif_field_y_um(&field, iy);
    return field;
}

static void test_of_field__plane_has_its_slope(void **state)
{
    (void)state;
    dif_field field = plane_field(9, 0.3, -0.2);
    dif_slope_gauss g;
    assert_int_equal(dif_slope_of_field(&field, &g, NULL), DIF_OK);
    assert_same_gauss(&g, &(dif_slope_gauss){0.3, -0.2, 0.0, 0.0, 0.0}, 1e-14);
    dif_slope_visible v;
    assert_int_equal(dif_slope_of_field_visible(&field, 0.6, 0.4, &v, NULL), DIF_OK);
    const double s[2] = {0.3, -0.2};
    assert_near(v.norm, dif_slope_weight(0.6, 0.4, s), 1e-14, 0.0);
    dif_field_free(&field);
}

static void test_of_field__sine_has_half_the_square_of_its_steepest_slope(void **state)
{
    (void)state;
    dif_field field;
    const double amp_um = 0.05, period_um = 1.6;
    assert_int_equal(dif_field_create(1025, 5, 0.0125, 0.01, &field, NULL), DIF_OK); /* 8 periods exactly */
    for (int iy = 0; iy < 5; iy++)
        for (int ix = 0; ix < field.nx; ix++)
            field.z_um[iy * field.nx + ix] = amp_um * sin(DIF_TWO_PI * dif_field_x_um(&field, ix) / period_um);
    dif_slope_gauss g;
    assert_int_equal(dif_slope_of_field(&field, &g, NULL), DIF_OK);
    const double steepest = DIF_TWO_PI * amp_um / period_um, half = DIF_PI * 0.0125 / period_um;
    assert_near(g.mean_x, 0.0, 0.0, 1e-15);
    assert_near(g.var_x, 0.5 * pow(steepest * sin(half) / half, 2.0), 1e-12, 0.0); /* a difference sees the chord */
    assert_near(g.var_y, 0.0, 0.0, 1e-15);
    dif_field_free(&field);
}

static void test_histogram__agrees_with_the_moments(void **state)
{
    (void)state;
    enum { N = 160 };
    dif_field field = test_rough_field(80, 70, 0.3, 0.4, 0.2, 7);
    const dif_slope_square square = {N, 0.02, -0.03, 1.2};
    static double density[N * N];
    const double views[] = {0.0, 0.9};
    for (int i = 0; i < 2; i++) {
        double inside, sum[3] = {0.0, 0.0, 0.0};
        dif_slope_visible v;
        assert_int_equal(dif_slope_histogram(&field, views[i], 2.0, &square, density, &inside, NULL), DIF_OK);
        assert_int_equal(dif_slope_of_field_visible(&field, views[i], 2.0, &v, NULL), DIF_OK);
        for (int iy = 0; iy < N; iy++)
            for (int ix = 0; ix < N; ix++) {
                double s[2];
                dif_slope_bin(&square, ix, iy, s);
                const double w = density[iy * N + ix] * (2.4 / N) * (2.4 / N);
                sum[0] += w;
                sum[1] += w * s[0];
                sum[2] += w * s[1];
            }
        assert_near(inside, 1.0, 0.0, 0.0);
        assert_near(sum[0], 1.0, 1e-12, 0.0);
        assert_near(sum[1], v.gauss.mean_x, 0.0, 0.001); /* half a bin is 0.0075, but evenly spread */
        assert_near(sum[2], v.gauss.mean_y, 0.0, 0.001);
    }
    dif_field_free(&field);
}

static void test_histogram__counts_what_it_leaves_out(void **state)
{
    (void)state;
    dif_field field = plane_field(6, 0.5, 0.5);
    double density[4], inside;
    const dif_slope_square beside = {2, 0.0, 0.0, 0.4}, around = {2, 0.0, 0.0, 1.0};
    assert_int_equal(dif_slope_histogram(&field, 0.0, 0.0, &beside, density, &inside, NULL), DIF_OK);
    assert_near(inside, 0.0, 0.0, 0.0);
    assert_int_equal(dif_slope_histogram(&field, 0.0, 0.0, &around, density, &inside, NULL), DIF_OK);
    assert_near(inside, 1.0, 0.0, 0.0);
    assert_near(density[1], 1.0, 1e-14, 0.0); /* upper right: both slopes positive; the bin's area is 1 */
    assert_near(density[0] + density[2] + density[3], 0.0, 0.0, 0.0);
    dif_field_free(&field);
}

static void test_bad_input__is_refused(void **state)
{
    (void)state;
    dif_error err;
    dif_field one = {0}, field = plane_field(4, 0.0, 0.0);
    dif_slope_gauss g;
    double density[1];
    assert_int_equal(dif_field_create(1, 5, 1.0, 1.0, &one, NULL), DIF_OK);
    assert_int_equal(dif_slope_of_field(&one, &g, &err), DIF_ERR_SIZE);
    assert_string_equal(err.text, "1 x 5 samples have no slopes, want at least 2 x 2");
    const dif_slope_square none = {1, 0.0, 0.0, 0.0};
    assert_int_equal(dif_slope_histogram(&field, 0.0, 0.0, &none, density, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "1 bins over slopes (0, 0) +- 0, want 1 ... 8192 and a half width > 0");
    const dif_slope_gauss bad[] = {{NAN, 0, 1, 1, 0}, {0, 0, -1, 1, 0}, {0, 0, 1, INFINITY, 0}, {0, 0, 1, 4, 2.1}};
    const char *const text[] = {"mean slope (nan, 0), want finite numbers", "slope variances (-1, 1), want >= 0",
                                "slope variances (1, inf), want >= 0", "slope covariance 2.1, want at most 2 in size"};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(dif_slope_check(bad + i, &err), DIF_ERR_ARG);
        assert_string_equal(err.text, text[i]);
    }
    assert_int_equal(dif_slope_check(&(dif_slope_gauss){0, 0, 1, 4, -2}, &err), DIF_OK);
    dif_field_free(&one);
    dif_field_free(&field);
}

static void test_evaluation__allocates_nothing(void **state)
{
    (void)state;
    dif_field field = test_rough_field(20, 20, 0.1, 0.1, 0.1, 3);
    dif_slope_gauss g;
    test_alloc_fail_from(0);
    assert_int_equal(dif_slope_of_field(&field, &g, NULL), DIF_OK);
    assert_true(dif_slope_visible_of(&g, 1.0, 0.2).norm > 0.0);
    assert_int_equal(test_alloc_calls(), 0);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cut_at__matches_quadrature),
        cmocka_unit_test(test_cut_at__ends),
        cmocka_unit_test(test_visible_of__matches_quadrature_in_two_dimensions),
        cmocka_unit_test(test_visible_of__deep_and_grazing),
        cmocka_unit_test(test_visible_of__from_above_is_the_slopes_themselves),
        cmocka_unit_test(test_visible_of__surfaces_without_spread),
        cmocka_unit_test(test_visible_of__continuous_across_its_branches),
        cmocka_unit_test(test_visible_of__covariance_stays_positive),
        cmocka_unit_test(test_of_field__plane_has_its_slope),
        cmocka_unit_test(test_of_field__sine_has_half_the_square_of_its_steepest_slope),
        cmocka_unit_test(test_histogram__agrees_with_the_moments),
        cmocka_unit_test(test_histogram__counts_what_it_leaves_out),
        cmocka_unit_test(test_bad_input__is_refused),
        cmocka_unit_test(test_evaluation__allocates_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
