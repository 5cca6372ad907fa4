/* A GLSL function over a texture of inputs, for tests that hold it against C's. */
#ifndef DIF_TEST_GPU_FUNCTION_H
#define DIF_TEST_GPU_FUNCTION_H

#include "gpu_bench.h"

enum { SIDE = 128, N = SIDE * SIDE };

/* Runs `vec4 f(vec4 x)` over N inputs in a fragment shader; x[i], out[i]: four floats each. The function may call those of
 * eval.glsl, colour.glsl and of one more file (NULL: none), and read `vec4 input_at(ivec2)`. */
static inline void run_function(dif_gpu *gpu, const char *more, const char *function, float (*x)[4], float (*out)[4])
{
    static const char INPUTS[] = "uniform sampler2D inputs;\n"
                                 "vec4 input_at(ivec2 at)\n{\n    return texelFetch(inputs, at, 0);\n}\n";
    static const char MAIN[] = "layout(location = 0) out vec4 result;\n"
                               "void main()\n{\n    result = f(input_at(ivec2(gl_FragCoord.xy)));\n}\n";
    const dif_gl_texture wanted = {
        .target = GL_TEXTURE_2D, .format = GL_RGBA32F, .nx = SIDE, .ny = SIDE, .n_layer = 1, .n_level = 1};
    const dif_gl_box whole = {0, 0, 0, SIDE, SIDE, 1};
    dif_gl_shader shader[2] = {{.stage = GL_FRAGMENT_SHADER}, {.stage = GL_VERTEX_SHADER}};
    dif_gl_shader_add(shader, dif_shader_part("prelude.glsl"));
    dif_gl_shader_add(shader, dif_shader_part("shared.h"));
    dif_gl_shader_add(shader, dif_shader_part("eval.glsl"));
    dif_gl_shader_add(shader, dif_shader_part("colour.glsl"));
    if (more)
        dif_gl_shader_add(shader, dif_shader_part(more));
    dif_gl_shader_add(shader, (dif_gl_part){"inputs", INPUTS});
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
    dif_gl_program_sampler(program, "inputs", 0);
    dif_gl_texture_bind(&from, 0);
    assert_int_equal(dif_gl_texture_target(gpu, &to, NULL), DIF_OK);
    glViewport(0, 0, SIDE, SIDE);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    assert_int_equal(dif_gl_texture_read(gpu, &to, SIDE, SIDE, &out[0][0], NULL), DIF_OK);
    dif_gl_texture_delete(gpu, &from);
    dif_gl_texture_delete(gpu, &to);
    dif_gl_program_delete(gpu, &program);
}

#endif
