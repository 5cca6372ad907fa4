#define _POSIX_C_SOURCE 200809L /* getpid */
/* The sources of every shader that the library can make, checked by glslangValidator without any GL: ES 3.10 for compute, ES
 * 3.00 for fragment and vertex shaders. GLSLANG is its path, or empty. */
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gpu/gpu_render_impl.h"
#include "gpu_bench.h"

/* Shaders that wait for the validator, in a folder of their own. */
typedef struct pile {
    char folder[64];
    int n;
} pile;

static pile pile_open(void)
{
    pile p = {.n = 0};
    snprintf(p.folder, sizeof p.folder, "/tmp/dif_shaders_%ld", (long)getpid());
    assert_int_equal(mkdir(p.folder, 0700), 0);
    return p;
}

/* Writes a shader as the driver gets it. */
static void pile_add(pile *p, const dif_gl_shader *shader)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%d.%s", p->folder, p->n++,
             shader->stage == GL_COMPUTE_SHADER  ? "comp"
             : shader->stage == GL_VERTEX_SHADER ? "vert"
                                                 : "frag");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(dif_gl_version_line(shader->stage), file);
    for (int i = 0; i < shader->n_part; i++) {
        assert_non_null(shader->part[i].text);
        fprintf(file, "#line 1\n%s", shader->part[i].text);
    }
    assert_int_equal(fclose(file), 0);
}

/* The validator's verdict on all of them, which then go. */
static bool pile_is_valid(pile *p)
{
    char command[1024];
    snprintf(command, sizeof command,
             "'%s' %s/* > %s.log 2>&1; code=$?; [ $code -eq 0 ] || grep ERROR %s.log; rm -r %s %s.log; exit $code",
             GLSLANG, p->folder, p->folder, p->folder, p->folder, p->folder);
    print_message("%d shaders\n", p->n);
    return system(command) == 0;
}

static void add_variants(pile *p, const dif_sheet *sheet, dif_model_kind kind, int jobs_from, int jobs_to)
{
    static dif_eval_source source;
    for (int job = jobs_from; job <= jobs_to; job++)
        for (int path = DIF_GPU_COMPUTE; path <= DIF_GPU_FRAGMENT; path++)
            for (int fault = DIF_GPU_FAULT_NONE; fault <= DIF_GPU_FAULT_TAP; fault++) {
                const dif_eval_variant variant = {.kind = kind,
                                                  .job = job,
                                                  .quantity = (dif_quantity)((job + fault) % 3),
                                                  .shadowing = (dif_shadowing)((2 * job + fault + path) % 4),
                                                  .path = (dif_gpu_path)path,
                                                  .fault = (dif_gpu_fault)fault,
                                                  .sheet = sheet};
                dif_eval_source_make(&variant, &source);
                assert_int_equal(source.n_shader, path == DIF_GPU_COMPUTE ? 1 : 2);
                for (int i = 0; i < source.n_shader; i++)
                    pile_add(p, &source.shader[i]);
            }
}

static void need_validator(void)
{
    if (*GLSLANG)
        return;
    print_message("glslangValidator (glslang-tools) not found: skipping\n");
    skip();
}

static void test_source__every_variant_is_valid(void **state)
{
    (void)state;
    need_validator();
    /* kernels of 4 and of 16 taps, even and odd */
    static const double TOLS[] = {1e-2, 1e-7, 1e-12};
    const dif_window window = {.kind = DIF_WINDOW_FLAT};
    const dif_band band = {10.0, 0.0, 10.0};
    dif_field field = test_rough_field(16, 16, 0.3, 0.3, 0.2, 1);
    pile p = pile_open();
    for (int i = 0; i < 3; i++) {
        dif_sheet *line, *volume;
        assert_int_equal(dif_sheet_create_line(&field, &window, 0.0, &band, TOLS[i], NULL, &line, NULL), DIF_OK);
        assert_int_equal(dif_sheet_create_volume(&field, &window, &band, TOLS[i], NULL, &volume, NULL), DIF_OK);
        print_message("%d and %d taps\n", line->s.kernel.width, volume->z.kernel.width);
        add_variants(&p, line, DIF_MODEL_SHEET, DIF_JOB_IS_TABLE, DIF_JOB_IS_TABLE);
        add_variants(&p, volume,
                     i == 0   ? DIF_MODEL_SHEET
                     : i == 1 ? DIF_MODEL_NMM
                              : DIF_MODEL_PQ,
                     DIF_JOB_IS_VALUES, DIF_JOB_IS_COLOURS);
        dif_sheet_free(line);
        dif_sheet_free(volume);
    }
    add_variants(&p, NULL, DIF_MODEL_STAM, DIF_JOB_IS_VALUES, DIF_JOB_IS_COLOURS);
    add_variants(&p, NULL, DIF_MODEL_LUT, DIF_JOB_IS_COLOURS, DIF_JOB_IS_COLOURS);
    assert_true(pile_is_valid(&p));
    dif_field_free(&field);
}

static void test_source__renderer_is_valid(void **state)
{
    (void)state;
    need_validator();
    dif_gl_shader shader[2];
    dif_render_source_make(shader);
    pile p = pile_open();
    pile_add(&p, shader);
    pile_add(&p, shader + 1);
    assert_true(pile_is_valid(&p));
}

static void test_source__colour_functions_are_valid(void **state)
{
    (void)state;
    need_validator();
    dif_gl_shader shader = {.stage = GL_FRAGMENT_SHADER};
    dif_gl_shader_add(&shader, dif_shader_part("prelude.glsl"));
    dif_gl_shader_add(&shader, dif_shader_part("colour.glsl"));
    dif_gl_shader_add(&shader, (dif_gl_part){"main", "out vec4 c;\nvoid main()\n{\n    c = vec4(dif_srgb_encode("
                                                     "dif_fit_gamut(dif_rgb_from_xyz(vec3(1.0)))), 1.0);\n}\n"});
    pile p = pile_open();
    pile_add(&p, &shader);
    assert_true(pile_is_valid(&p));
    shader.part[0].text = ""; /* no precision: the validator sees it */
    p = pile_open();
    pile_add(&p, &shader);
    assert_false(pile_is_valid(&p));
}

/* GLSL of the kernels against core/kernel.h, by a small reader of the text: every coefficient is there with nine digits. */
static void test_source__kernels_hold_their_coefficients(void **state)
{
    (void)state;
    static dif_eval_source source;
    const dif_window window = {.kind = DIF_WINDOW_FLAT};
    const dif_band band = {10.0, 0.0, 10.0};
    dif_field field = test_rough_field(16, 16, 0.3, 0.3, 0.2, 1);
    dif_sheet *sheet;
    assert_int_equal(dif_sheet_create_line(&field, &window, 0.0, &band, 1e-7, NULL, &sheet, NULL), DIF_OK);
    const dif_eval_variant variant = {.kind = DIF_MODEL_SHEET, .job = DIF_JOB_IS_TABLE, .sheet = sheet};
    dif_eval_source_make(&variant, &source);
    const dif_kernel *kernel = &sheet->s.kernel;
    for (int k = 0; k <= kernel->degree; k++)
        for (int i = 0; i < (kernel->width + 1) / 2; i++) {
            char number[40];
            snprintf(number, sizeof number, "%.9g", (double)(float)kernel->coef[k][i]);
            assert_non_null(strstr(source.kernels, number));
        }
    dif_sheet_free(sheet);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_source__every_variant_is_valid),
        cmocka_unit_test(test_source__renderer_is_valid),
        cmocka_unit_test(test_source__colour_functions_are_valid),
        cmocka_unit_test(test_source__kernels_hold_their_coefficients),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
