/* The visible slopes of gpu/shaders/slope.glsl against core/slope.h. */
#include "core/slope.h"

#include "gpu_function.h"

enum { N_CASE = N / 2 };

static float input[N][4], output[N][4];

/* ---- the cut standard normal ---- */

static void test_cut__as_the_cpu_from_minus_ten_thousand_up(void **state)
{
    double worst_mean = 0.0, worst_variance = 0.0, worst_ln = 0.0;
    uint64_t seed = 1;
    for (int i = 0; i < N; i++) {
        const double size = pow(10.0, test_random(&seed, -3.0, 4.0));
        const double z = i % 4 == 0 ? -size : i % 4 == 1 ? size : test_random(&seed, -8.0, 8.0);
        input[i][0] = (float)z;
    }
    for (int i = 0; i < 6; i++) { /* where one form ends and the next begins */
        static const float ENDS[] = {-2.0f, -2.0000002f, 1.0f, 0.99999994f, 6.0f, 6.0000005f};
        input[i][0] = ENDS[i];
    }
    run_function(gpu_of(state), "slope.glsl", "vec4 f(vec4 x) { return vec4(dif_slope_cut(x.x), 0.0); }", input,
                 output);
    for (int i = 0; i < N; i++) {
        const dif_slope_cut want = dif_slope_cut_at((double)input[i][0]);
        worst_mean = fmax(worst_mean, fabs((double)output[i][0] / want.mean - 1.0));
        worst_variance = fmax(worst_variance, fabs((double)output[i][1] / want.variance - 1.0));
        worst_ln = fmax(worst_ln, fabs((double)output[i][2] - want.ln_psi) / fmax(1.0, fabs(want.ln_psi)));
    }
    print_message("cut: mean %.2g, variance %.2g, ln psi %.2g\n", worst_mean, worst_variance, worst_ln);
    assert_at_most(worst_mean, 1e-6);
    assert_at_most(worst_variance, 2e-6); /* 3 r3 - 2 r2 gives away a digit */
    assert_at_most(worst_ln, 1e-6);
}

/* ---- visible slopes ---- */

/* Case i in two texels: mean, var_x, var_y; cov_xy, view. */
static void put_case(int i, const dif_slope_gauss *g, dif_vec3 view)
{
    const double x[8] = {g->mean_x, g->mean_y, g->var_x, g->var_y, g->cov_xy, view.x, view.y, view.z};
    for (int c = 0; c < 8; c++)
        input[2 * i + c / 4][c % 4] = (float)x[c];
}

/* What the CPU makes of the floats of case i. */
static dif_slope_visible want_case(int i, dif_slope_gauss *g, double *z)
{
    const float *x = input[2 * i];
    const double across = hypot((double)x[5], (double)x[6]), phi_rad = atan2((double)x[6], (double)x[5]);
    const double theta_rad = atan2(across, (double)x[7]), c = cos(phi_rad), s = sin(phi_rad);
    *g = (dif_slope_gauss){(double)x[0], (double)x[1], (double)x[2], (double)x[3], (double)x[4]};
    const double spread = sqrt(fmax(g->var_x * c * c + 2.0 * g->cov_xy * c * s + g->var_y * s * s, 0.0));
    *z = spread * across > 0.0 ? ((double)x[7] - (g->mean_x * c + g->mean_y * s) * across) / (spread * across) : 1e9;
    return dif_slope_visible_of(g, theta_rad, phi_rad);
}

/* Errors of a case in units of what float can hold of it. */
static void add_errors(int i, double worst[3])
{
    dif_slope_gauss g;
    double z;
    const dif_slope_visible want = want_case(i, &g, &z);
    const float *got = output[2 * i];
    /* sizes before anything cancels: the mean itself, and its shift E sd, which for z << 0 takes it to cot theta */
    const double sd = sqrt(fmax(g.var_x, g.var_y));
    const double mean = hypot(g.mean_x, g.mean_y) + sd * (1.0 + fabs(fmin(z, 0.0)));
    const double variance = fmax(g.var_x, g.var_y);
    worst[0] = fmax(worst[0], fabs((double)got[0] - want.gauss.mean_x) / mean);
    worst[0] = fmax(worst[0], fabs((double)got[1] - want.gauss.mean_y) / mean);
    worst[1] = fmax(worst[1], fabs((double)got[2] - want.gauss.var_x) / variance);
    worst[1] = fmax(worst[1], fabs((double)got[3] - want.gauss.var_y) / variance);
    worst[1] = fmax(worst[1], fabs((double)got[4] - want.gauss.cov_xy) / variance);
    /* a rounding of a is one of z: ln psi falls by z for each unit of z, and its float is as coarse as it is large */
    const double ln = fmax(1.0, fabs(want.ln_norm)) * (1.0 + fabs(fmin(z, 0.0)) / 4.0);
    worst[2] = fmax(worst[2], fabs((double)got[6] - want.ln_norm) / ln);
    if (want.norm > 1e-30)
        worst[2] = fmax(worst[2], fabs((double)got[5] / want.norm - 1.0) / ln);
}

static void run_cases(dif_gpu *gpu, double worst[3])
{
    run_function(gpu, "slope.glsl",
                 "vec4 f(vec4 x)\n{\n"
                 "    ivec2 at = ivec2(gl_FragCoord.xy), first = ivec2(at.x & ~1, at.y);\n"
                 "    vec4 low = input_at(first), high = input_at(first + ivec2(1, 0));\n"
                 "    dif_seen seen = dif_slope_visible(dif_gauss(low.xy, vec3(low.zw, high.x)), high.yzw);\n"
                 "    return at.x == first.x ? vec4(seen.gauss.mean, seen.gauss.cov.xy)\n"
                 "                           : vec4(seen.gauss.cov.z, seen.norm, seen.ln_norm, 0.0);\n}\n",
                 input, output);
    for (int i = 0; i < N_CASE; i++)
        add_errors(i, worst);
    print_message("visible slopes: mean %.2g, covariance %.2g, norm %.2g\n", worst[0], worst[1], worst[2]);
}

static dif_slope_gauss random_gauss(uint64_t *seed, double correlation)
{
    const double a = pow(10.0, test_random(seed, -3.0, 0.3)), b = pow(10.0, test_random(seed, -3.0, 0.3));
    return (dif_slope_gauss){.mean_x = test_random(seed, -1.0, 1.0),
                             .mean_y = test_random(seed, -1.0, 1.0),
                             .var_x = a * a,
                             .var_y = b * b,
                             .cov_xy = correlation * a * b};
}

static void test_visible__random_slopes_and_views(void **state)
{
    double worst[3] = {0.0, 0.0, 0.0};
    uint64_t seed = 2;
    for (int i = 0; i < N_CASE; i++) {
        static const double THETAS[] = {0.0, 1e-8, 1e-4, 0.5 * DIF_PI};
        const dif_slope_gauss g = random_gauss(&seed, test_random(&seed, -0.99, 0.99));
        const double theta_rad = i % 16 < 4 ? THETAS[i % 16] : test_random(&seed, 0.0, 0.5 * DIF_PI);
        put_case(i, &g, dif_vec3_from_angles_rad(theta_rad, test_random(&seed, 0.0, DIF_TWO_PI)));
    }
    run_cases(gpu_of(state), worst);
    assert_at_most(worst[0], 3e-6); /* E is up to 1e4 of a spread that the view's azimuth cuts to a hundredth */
    assert_at_most(worst[1], 3e-6);
    assert_at_most(worst[2], 1e-5);
}

/* Slopes nearly all turned away, z from -3 down to -1e4. */
static void test_visible__far_in_the_tail(void **state)
{
    double worst[3] = {0.0, 0.0, 0.0}, deepest = 0.0;
    uint64_t seed = 3;
    for (int i = 0; i < N_CASE; i++) {
        const double sd = pow(10.0, test_random(&seed, -4.0, -1.0)), phi_rad = test_random(&seed, 0.0, DIF_TWO_PI);
        const dif_slope_gauss g = {cos(phi_rad) * 2.0, sin(phi_rad) * 2.0, sd * sd, sd * sd, 0.3 * sd * sd};
        put_case(i, &g, dif_vec3_from_angles_rad(test_random(&seed, 0.7, 1.5), phi_rad + 0.1));
        dif_slope_gauss same;
        double z;
        (void)want_case(i, &same, &z);
        deepest = fmin(deepest, z);
    }
    run_cases(gpu_of(state), worst);
    print_message("z down to %.3g\n", deepest);
    assert_true(deepest < -1e4);
    assert_at_most(worst[0], 3e-6);
    assert_at_most(worst[1], 3e-6);
    assert_at_most(worst[2], 1e-5);
}

/* Straight from above every slope is seen as it is; without variance along the view nothing moves; turned away is 0. */
static void test_visible__what_has_no_cut(void **state)
{
    static const dif_slope_gauss WIDE = {0.3, -0.2, 0.04, 0.09, 0.05}, LINE = {0.2, 0.0, 0.0, 0.25, 0.0},
                                 AWAY = {4.0, 0.0, 0.0, 0.0, 0.0};
    double worst[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < N_CASE; i++)
        put_case(i, &WIDE, (dif_vec3){0.0, 0.0, 1.0});
    put_case(1, &LINE, (dif_vec3){0.6, 0.0, 0.8});
    put_case(2, &AWAY, (dif_vec3){0.6, 0.0, 0.8});
    run_cases(gpu_of(state), worst);
    for (int c = 0; c < 4; c++)
        for (int i = 0; i < 3; i++)
            assert_true(!(fabsf(output[2 * i][c] - input[2 * i][c]) > 1e-7f));
    assert_near((double)output[1][1], 1.0, 1e-7, 0.0);
    assert_near((double)output[3][1], 0.8 - 0.2 * 0.6, 1e-6, 0.0);
    assert_true(!(fabsf(output[5][1]) > 0.0f) && isinf(output[5][2]) && output[5][2] < 0.0f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cut__as_the_cpu_from_minus_ten_thousand_up),
        cmocka_unit_test(test_visible__random_slopes_and_views),
        cmocka_unit_test(test_visible__far_in_the_tail),
        cmocka_unit_test(test_visible__what_has_no_cut),
    };
    return cmocka_run_group_tests(tests, open_gpu, close_gpu);
}
