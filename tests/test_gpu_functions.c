/* The elementary functions of eval.glsl and colour.glsl on the GPU against C's: 1e-7 everywhere, whatever the driver's are. */
#include "core/brdf.h"
#include "core/colour.h"
#include "gpu_bench.h"

enum { SIDE = 128, N = SIDE * SIDE };

/* Runs `vec4 f(vec4 x)` over N inputs; x[i], out[i]: four floats each. */
static void run_on(dif_gpu *gpu, const char *function, float (*x)[4], float (*out)[4])
{
    static const char MAIN[] = "uniform sampler2D x;\n"
                               "layout(location = 0) out vec4 result;\n"
                               "void main()\n{\n    result = f(texelFetch(x, ivec2(gl_FragCoord.xy), 0));\n}\n";
    const dif_gl_texture wanted = {
        .target = GL_TEXTURE_2D, .format = GL_RGBA32F, .nx = SIDE, .ny = SIDE, .n_layer = 1, .n_level = 1};
    const dif_gl_box whole = {0, 0, 0, SIDE, SIDE, 1};
    dif_gl_shader shader[2] = {{.stage = GL_FRAGMENT_SHADER}, {.stage = GL_VERTEX_SHADER}};
    dif_gl_shader_add(shader, dif_shader_part("prelude.glsl"));
    dif_gl_shader_add(shader, dif_shader_part("shared.h"));
    dif_gl_shader_add(shader, dif_shader_part("eval.glsl"));
    dif_gl_shader_add(shader, dif_shader_part("colour.glsl"));
    dif_gl_shader_add(shader, (dif_gl_part){"function", function});
    dif_gl_shader_add(shader, (dif_gl_part){"main", MAIN});
    dif_gl_shader_add(shader + 1, dif_shader_part("whole.vert"));
    dif_gl_texture from, to;
    GLuint program;
    dif_error err;
    assert_int_equal(dif_gpu_begin(gpu, NULL), DIF_OK);
    if (dif_gl_program_create(gpu, 2, shader, &program, &err) != DIF_OK)
        fail_msg("%s", err.text);
    assert_int_equal(dif_gl_texture_create(gpu, "x", &wanted, &from, NULL), DIF_OK);
    assert_int_equal(dif_gl_texture_create(gpu, "y", &wanted, &to, NULL), DIF_OK);
    dif_gl_texture_store(&from, &whole, 0, &x[0][0]);
    dif_gl_program_sampler(program, "x", 0);
    dif_gl_texture_bind(&from, 0);
    assert_int_equal(dif_gl_texture_target(gpu, &to, NULL), DIF_OK);
    glViewport(0, 0, SIDE, SIDE);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    assert_int_equal(dif_gl_texture_read(gpu, &to, SIDE, SIDE, &out[0][0], NULL), DIF_OK);
    dif_gl_texture_delete(gpu, &from);
    dif_gl_texture_delete(gpu, &to);
    dif_gl_program_delete(gpu, &program);
}

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
    run_on(gpu_of(state), "vec4 f(vec4 x) { return vec4(dif_cis(x.x), 0.0, 0.0); }", input, output);
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
    run_on(gpu_of(state), "vec4 f(vec4 x) { return vec4(dif_exp_minus(x.x)); }", input, output);
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
    run_on(gpu_of(state), "vec4 f(vec4 x) { return vec4(dif_atan_turns(x.x, x.y)); }", input, output);
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
    run_on(gpu_of(state), "vec4 f(vec4 x) { return vec4(dif_asinh(x.x)); }", input, output);
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
    run_on(gpu_of(state),
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
    run_on(gpu_of(state), "vec4 f(vec4 x) { return vec4(dif_pair(x.x), 0.0, 0.0); }", input, output);
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
    run_on(gpu_of(state), "vec4 f(vec4 x) { return vec4(dif_replica_power(40, x.xy, x.zw)); }", input, output);
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
    run_on(gpu_of(state), "vec4 f(vec4 x) { return vec4(dif_gain_rho(x.xyz, vec2(1.0, x.w), vec2(1.5, 0.3))); }", input,
           output);
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
    run_on(
        gpu_of(state),
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
