/* The elementary functions of eval.glsl and colour.glsl on the GPU against C's: 1e-7 everywhere, whatever the driver's are. */
#include "core/brdf.h"
#include "core/colour.h"
#include "gpu_function.h"

static float input[N][4], output[N][4];

/* Random inputs between two numbers. */
static void fill(double lo, double hi, uint64_t seed)
{
    for (int i = 0; i < N; i++)
        for (int c = 0; c < 4; c++)
            input[i][c] = (float)test_random(&seed, lo, hi);
}

static void test_cis__is_right_to_1e_7(void **state)
{
    double worst = 0.0;
    fill(-2.0, 2.0, 1);
    for (int i = 0; i < 33; i++) /* eighths of a turn */
        input[i][0] = (float)(i - 16) / 8.0f;
    run_function(gpu_of(state), NULL, "vec4 f(vec4 x) { return vec4(dif_cis(x.x), 0.0, 0.0); }", input, output);
    for (int i = 0; i < N; i++) {
        const double turns = (double)input[i][0];
        worst = fmax(worst, fabs((double)output[i][0] - cos(DIF_TWO_PI * turns)));
        worst = fmax(worst, fabs((double)output[i][1] - sin(DIF_TWO_PI * turns)));
    }
    print_message("cis: %.2g\n", worst);
    assert_at_most(worst, 1.2e-7); /* two roundings near 1 */
}

static void test_exp_minus__is_right_to_three_roundings(void **state)
{
    double worst = 0.0;
    fill(0.0, 80.0, 2);
    input[0][0] = 0.0f;
    input[1][0] = 1e-6f;
    input[2][0] = 200.0f; /* kept above the smallest normal float */
    run_function(gpu_of(state), NULL, "vec4 f(vec4 x) { return vec4(dif_exp_minus(x.x)); }", input, output);
    for (int i = 0; i < N; i++) {
        const double want = exp(-fmin((double)input[i][0], 87.0));
        worst = fmax(worst, fabs((double)output[i][0] - want) / want);
    }
    print_message("exp: %.2g\n", worst);
    assert_at_most(worst, 3e-7);
}

static void test_atan_turns__every_quadrant(void **state)
{
    double worst = 0.0;
    static const float AXES[][2] = {{0.0f, 0.0f}, {0.0f, 1.0f},  {1.0f, 0.0f},  {0.0f, -1.0f},  {-1.0f, 0.0f},
                                    {1.0f, 1.0f}, {1.0f, -1.0f}, {-1.0f, 1.0f}, {-1.0f, -1.0f}, {1e-20f, 1e-20f}};
    fill(-1.0, 1.0, 3);
    for (int i = 0; i < 10; i++)
        for (int c = 0; c < 2; c++)
            input[i][c] = AXES[i][c];
    run_function(gpu_of(state), NULL, "vec4 f(vec4 x) { return vec4(dif_atan_turns(x.x, x.y)); }", input, output);
    for (int i = 0; i < N; i++) {
        const double off = (double)output[i][0] - atan2((double)input[i][0], (double)input[i][1]) / DIF_TWO_PI;
        worst = fmax(worst, fabs(off - rint(off))); /* half a turn either way is one place */
    }
    print_message("atan: %.2g turns\n", worst);
    assert_at_most(worst, 1e-7);
}

static void test_asinh__is_right_to_3e_7(void **state)
{
    double worst = 0.0;
    fill(0.0, 0.1, 4);
    for (int i = 0; i < N / 2; i++)
        input[i][0] *= 1e4f; /* 2 / s0 */
    run_function(gpu_of(state), NULL, "vec4 f(vec4 x) { return vec4(dif_asinh(x.x)); }", input, output);
    for (int i = 0; i < N; i++) {
        const double want = asinh((double)input[i][0]);
        worst = fmax(worst, fabs((double)output[i][0] - want) / fmax(1.0, want));
    }
    print_message("asinh: %.2g\n", worst);
    assert_at_most(worst, 3e-7); /* the driver's logarithm, at most three roundings */
}

/* A product of thousands keeps its fraction to 1e-6 and better, where one float32 product has nothing left of it. */
static void test_rest__large_products_keep_their_fraction(void **state)
{
    static double x[N][2];
    double worst = 0.0, plain = 0.0;
    uint64_t seed = 5;
    for (int i = 0; i < N; i++) {
        x[i][0] = test_random(&seed, -2.0, 2.0);
        x[i][1] = test_random(&seed, 100.0, 900.0);
        dif_eval_pair(x[i][0], input[i]);
        dif_eval_pair(x[i][1], input[i] + 2);
    }
    run_function(gpu_of(state), NULL,
                 "vec4 f(vec4 x) { float whole, rest = dif_rest(x.xy, x.zw, whole);\n"
                 "return vec4(whole, rest, (x.x + x.y) * (x.z + x.w) - whole, 0.0); }",
                 input, output);
    for (int i = 0; i < N; i++) {
        const double want = x[i][0] * x[i][1] - (double)output[i][0];
        worst = fmax(worst, fabs((double)output[i][1] - want));
        plain = fmax(plain, fabs((double)output[i][2] - want));
        assert_true(fabs((double)output[i][1]) < 1.0 && !(fabsf(output[i][0] - rintf(output[i][0])) > 0.0f));
    }
    print_message("rest: %.2g, one product: %.2g\n", worst, plain);
    assert_at_most(worst, 2e-7);
    assert_true(plain > 1e-5);
}

static void test_pair__of_c_and_of_glsl(void **state)
{
    uint64_t seed = 6;
    fill(-2.0, 2.0, 7);
    run_function(gpu_of(state), NULL, "vec4 f(vec4 x) { return vec4(dif_pair(x.x), 0.0, 0.0); }", input, output);
    for (int i = 0; i < N; i++) {
        float pair[2];
        int exponent;
        const double number = test_random(&seed, -1e3, 1e3);
        dif_eval_pair(number, pair);
        assert_near((double)pair[0] + (double)pair[1], number, 1e-10, 0.0); /* 12 + 24 bits */
        const double grains = ldexp(frexp((double)pair[0], &exponent), 12);
        assert_true(!(fabs(grains - rint(grains)) > 0.0));
        assert_true(!(fabsf(output[i][0] + output[i][1] - input[i][0]) > 0.0f));
        const double grains_gpu = ldexp(frexp((double)output[i][0], &exponent), 12);
        assert_true(!(fabs(grains_gpu - rint(grains_gpu)) > 0.0));
    }
    float zero[2];
    dif_eval_pair(0.0, zero);
    assert_true(!(fabsf(zero[0]) > 0.0f) && !(fabsf(zero[1]) > 0.0f));
}

static void test_replica_power__as_the_cpu(void **state)
{
    double worst = 0.0;
    uint64_t seed = 8;
    for (int i = 0; i < N; i++) {
        const double u = i < 100 ? 0.01 * i : test_random(&seed, -2.0, 2.0),
                     turns = i < 100 ? 100.0 : test_random(&seed, 0.5, 8.0);
        dif_eval_pair(u, input[i]);
        dif_eval_pair(turns, input[i] + 2);
    }
    run_function(gpu_of(state), NULL, "vec4 f(vec4 x) { return vec4(dif_replica_power(40, x.xy, x.zw)); }", input,
                 output);
    for (int i = 0; i < N; i++) {
        const double x = ((double)input[i][0] + (double)input[i][1]) * ((double)input[i][2] + (double)input[i][3]);
        const double want = dif_replica_ratio(40, DIF_PI * x);
        worst = fmax(worst, fabs((double)output[i][0] - want * want));
    }
    print_message("replica: %.2g\n", worst);
    assert_at_most(worst, 2e-6);
}

static void test_gain__grazing_directions_keep_their_digits(void **state)
{
    double worst = 0.0;
    static dif_vec3 wi[N], wo[N];
    uint64_t seed = 9;
    for (int i = 0; i < N; i++) {
        const double theta = test_random(&seed, 0.0, 1.55), phi = test_random(&seed, 0.0, DIF_TWO_PI);
        wi[i] = dif_vec3_from_angles_rad(theta, phi);
        /* half of them near the opposite direction at grazing angles, where 1 + wi.wo cancels */
        wo[i] = i % 2 ? dif_vec3_from_angles_rad(test_random(&seed, 0.0, 1.55), test_random(&seed, 0.0, DIF_TWO_PI))
                      : dif_vec3_from_angles_rad(1.55, phi + DIF_PI + 1e-3);
        const dif_vec3 uvw = dif_vec3_transfer(wi[i], wo[i]);
        const double x[4] = {uvw.x, uvw.y, uvw.z, wo[i].z};
        for (int c = 0; c < 4; c++)
            input[i][c] = (float)x[c];
    }
    run_function(gpu_of(state), NULL,
                 "vec4 f(vec4 x) { return vec4(dif_gain_rho(x.xyz, vec2(1.0, x.w), vec2(1.5, 0.3))); }", input, output);
    for (int i = 0; i < N; i++) {
        const double want = dif_brdf_gain_rho((dif_index){1.5, 0.3}, wi[i], wo[i]);
        worst = fmax(worst, fabs((double)output[i][0] - want) / want);
    }
    print_message("rho: %.2g\n", worst);
    assert_at_most(worst, 1e-6);
}

static void test_colours__as_the_cpu(void **state)
{
    double worst = 0.0;
    fill(0.0, 1.2, 10);
    run_function(
        gpu_of(state), NULL,
        "vec4 f(vec4 x) { vec3 rgb = dif_fit_gamut(dif_rgb_from_xyz(x.xyz)); return vec4(dif_srgb_encode(rgb), 1.0); }",
        input, output);
    for (int i = 0; i < N; i++) {
        const double xyz[3] = {(double)input[i][0], (double)input[i][1], (double)input[i][2]};
        double rgb[3];
        dif_colour_rgb_from_xyz(xyz, rgb);
        dif_colour_fit_gamut(DIF_GAMUT_DESATURATE, rgb);
        for (int c = 0; c < 3; c++)
            worst = fmax(worst, fabs((double)output[i][c] - dif_colour_encode(rgb[c])));
    }
    print_message("encoded colours: %.2g\n", worst);
    assert_at_most(worst, 1e-5); /* the driver's pow; a step of 8 bits is 4e-3 */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cis__is_right_to_1e_7),
        cmocka_unit_test(test_exp_minus__is_right_to_three_roundings),
        cmocka_unit_test(test_atan_turns__every_quadrant),
        cmocka_unit_test(test_asinh__is_right_to_3e_7),
        cmocka_unit_test(test_rest__large_products_keep_their_fraction),
        cmocka_unit_test(test_pair__of_c_and_of_glsl),
        cmocka_unit_test(test_replica_power__as_the_cpu),
        cmocka_unit_test(test_gain__grazing_directions_keep_their_digits),
        cmocka_unit_test(test_colours__as_the_cpu),
    };
    return cmocka_run_group_tests(tests, open_gpu, close_gpu);
}
