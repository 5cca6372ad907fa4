/* Programs and textures: logs that name our files, limits with both numbers, floats there and back. */
#include "gpu/gl_program.h"
#include "gpu/gl_texture.h"
#include "near.h"

#include <string.h>

static int open_gpu(void **state)
{
    dif_gpu *gpu = NULL;
    dif_error err;
    if (dif_gpu_open(NULL, &gpu, &err) != DIF_OK)
        print_message("%s: skipping\n", err.text);
    *state = gpu;
    return 0;
}

static int close_gpu(void **state)
{
    dif_gpu_close(*state);
    return 0;
}

/* The context that the tests share, or skip. */
static dif_gpu *gpu_of(void **state)
{
    if (!*state)
        skip();
    assert_int_equal(dif_gpu_begin(*state, NULL), DIF_OK);
    return *state;
}

static dif_gl_shader compute_of(dif_gl_part main_part)
{
    dif_gl_shader shader = {.stage = GL_COMPUTE_SHADER};
    dif_gl_shader_add(&shader, dif_shader_part("prelude.glsl"));
    dif_gl_shader_add(&shader, main_part);
    return shader;
}

static void test_shader_part__files_are_inside_the_library(void **state)
{
    (void)state;
    assert_non_null(strstr(dif_shader_part("eval.glsl").text, "dif_lut_colour"));
    assert_string_equal(dif_shader_part("eval.glsl").name, "eval.glsl");
    assert_non_null(strstr(dif_shader_part("shared.h").text, "DIF_LIST_SHIFT"));
    assert_null(dif_shader_part("none.glsl").text);
}

static void test_log_translate__numbers_become_file_names(void **state)
{
    (void)state;
    const dif_gl_shader shader = compute_of((dif_gl_part){"main.glsl", ""});
    char text[200];
    dif_gl_log_translate(&shader, "0:8012(5): error: x\n1(4003) : error C7\nERROR: 2:8009: y\n0:12001: z\nplain\n",
                         sizeof text, text);
    assert_string_equal(
        text, "main.glsl:12(5): error: x\nprelude.glsl(3) : error C7\nERROR: main.glsl:9: y\n0:12001: z\nplain");
    dif_gl_log_translate(&shader, "0:8012(5): error: x\n", 12, text); /* as much as there is room for */
    assert_string_equal(text, "main.glsl:1");
    dif_gl_log_translate(&shader, "", sizeof text, text);
    assert_string_equal(text, "");
}

static void test_program__a_broken_shader_is_named_with_its_line(void **state)
{
    dif_gpu *gpu = gpu_of(state);
    const dif_gl_shader shader =
        compute_of((dif_gl_part){"broken.glsl", "layout(local_size_x = 1) in;\n\nvoid main()\n{\n    nothing();\n}\n"});
    GLuint program = 7;
    dif_error err;
    const int live = dif_gpu_live(gpu);
    assert_int_equal(dif_gl_program_create(gpu, 1, &shader, &program, &err), DIF_ERR_FOREIGN);
    assert_int_equal(program, 0);
    /* drivers differ in what stands around the place */
    assert_non_null(strstr(err.text, "a shader does not compile: "));
    assert_true(strstr(err.text, "broken.glsl:5") || strstr(err.text, "broken.glsl(5"));
    assert_int_equal(dif_gpu_live(gpu), live);
    assert_int_equal(dif_gpu_check(gpu, "after a broken shader", &err), DIF_OK);
}

static void test_program__a_missing_source_is_named(void **state)
{
    dif_gpu *gpu = gpu_of(state);
    const dif_gl_shader shader = compute_of(dif_shader_part("none.glsl"));
    GLuint program;
    dif_error err;
    assert_int_equal(dif_gl_program_create(gpu, 1, &shader, &program, &err), DIF_ERR_FOREIGN);
    assert_string_equal(err.text, "the shader source none.glsl is not in the library");
}

static void test_texture__a_size_beyond_the_limit_names_both_numbers(void **state)
{
    dif_gpu *gpu = gpu_of(state);
    const dif_gpu_info info = dif_gpu_info_of(gpu);
    dif_gl_texture wanted = {
        .target = GL_TEXTURE_2D, .format = GL_RG32F, .nx = info.texture_max + 1, .ny = 3, .n_layer = 1, .n_level = 1};
    dif_gl_texture made;
    dif_error err;
    char want[200];
    assert_int_equal(dif_gl_texture_create(gpu, "a list", &wanted, &made, &err), DIF_ERR_SIZE);
    snprintf(want, sizeof want, "a list needs a texture of %d x 3, and the GPU's largest side is %d",
             info.texture_max + 1, info.texture_max);
    assert_string_equal(err.text, want);
    assert_int_equal(made.id, 0);
    wanted = (dif_gl_texture){.target = GL_TEXTURE_2D_ARRAY,
                              .format = GL_RG32F,
                              .nx = 2,
                              .ny = 2,
                              .n_layer = info.layers_max + 1,
                              .n_level = 1};
    assert_int_equal(dif_gl_texture_create(gpu, "a sheet", &wanted, &made, &err), DIF_ERR_SIZE);
    snprintf(want, sizeof want, "a sheet needs a texture of %d layers, and the GPU has at most %d", info.layers_max + 1,
             info.layers_max);
    assert_string_equal(err.text, want);
    wanted.n_layer = 0;
    assert_int_equal(dif_gl_texture_create(gpu, "a sheet", &wanted, &made, &err), DIF_ERR_ARG);
}

static void test_texture__floats_come_back_as_they_were(void **state)
{
    enum { NX = 5, NY = 3, ROW = 7 };
    dif_gpu *gpu = gpu_of(state);
    const dif_gl_texture wanted = {
        .target = GL_TEXTURE_2D, .format = GL_RGBA32F, .nx = NX, .ny = NY, .n_layer = 1, .n_level = 1};
    const dif_gl_box whole = {0, 0, 0, NX, NY, 1};
    dif_gl_texture made;
    float data[NY][ROW][4], back[NY][NX][4];
    uint64_t seed = 3;
    for (int i = 0; i < NY * ROW * 4; i++)
        (&data[0][0][0])[i] = (float)test_random(&seed, -1e-9, 1e9);
    const int live = dif_gpu_live(gpu);
    assert_int_equal(dif_gl_texture_create(gpu, "numbers", &wanted, &made, NULL), DIF_OK);
    assert_int_equal(dif_gpu_live(gpu), live + 1);
    dif_gl_texture_store(&made, &whole, ROW, &data[0][0][0]);
    assert_int_equal(dif_gl_texture_read(gpu, &made, NX, NY, &back[0][0][0], NULL), DIF_OK);
    for (int y = 0; y < NY; y++)
        assert_memory_equal(data[y], back[y], sizeof back[y]);
    dif_gl_texture_delete(gpu, &made);
    dif_gl_texture_delete(gpu, &made);
    assert_int_equal(dif_gpu_live(gpu), live);
    assert_int_equal(dif_gpu_check(gpu, "numbers", NULL), DIF_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shader_part__files_are_inside_the_library),
        cmocka_unit_test(test_log_translate__numbers_become_file_names),
        cmocka_unit_test(test_program__a_broken_shader_is_named_with_its_line),
        cmocka_unit_test(test_program__a_missing_source_is_named),
        cmocka_unit_test(test_texture__a_size_beyond_the_limit_names_both_numbers),
        cmocka_unit_test(test_texture__floats_come_back_as_they_were),
    };
    return cmocka_run_group_tests(tests, open_gpu, close_gpu);
}
