/* The context: what is said where there is no GPU, many of them in a row, two side by side. */
#include "gpu/egl_ctx.h"
#include "near.h"

#include <string.h>

/* A context, or NULL with the reason printed. */
static dif_gpu *open_or_skip(void)
{
    dif_gpu *gpu = NULL;
    dif_error err;
    if (dif_gpu_open(NULL, &gpu, &err) != DIF_OK) {
        print_message("%s: skipping\n", err.text);
        skip();
    }
    return gpu;
}

static void test_probe__a_missing_library_is_a_missing_resource(void **state)
{
    (void)state;
    dif_error err;
    assert_int_equal(dif_egl_probe("libdif-is-not-there.so.1", &err), DIF_ERR_RESOURCE);
    assert_string_equal(err.text, "no GPU: libdif-is-not-there.so.1 cannot be loaded (Debian: libegl1, libgles2, "
                                  "libgl1-mesa-dri)");
    assert_int_equal(err.status, DIF_ERR_RESOURCE);
}

static void test_is_software__knows_the_renderers(void **state)
{
    (void)state;
    assert_true(dif_gpu_is_software("llvmpipe (LLVM 15.0.6, 256 bits)"));
    assert_true(dif_gpu_is_software("Google SwiftShader"));
    assert_true(dif_gpu_is_software("softpipe"));
    assert_false(dif_gpu_is_software("NVIDIA H100 80GB HBM3/PCIe/SSE2"));
    assert_false(dif_gpu_is_software("AMD Radeon Graphics (radeonsi, gfx1036)"));
    assert_false(dif_gpu_is_software(""));
}

static void test_open__says_what_was_found(void **state)
{
    (void)state;
    dif_gpu *gpu = open_or_skip();
    const dif_gpu_info info = dif_gpu_info_of(gpu);
    print_message("%s; %s; %s; %s\n", info.renderer, info.vendor, info.version, info.platform);
    assert_true(info.renderer[0] && info.version[0]);
    assert_true(info.texture_max >= 2048 && info.layers_max >= 256); /* what OpenGL ES 3.1 promises */
    assert_int_equal(info.software, dif_gpu_is_software(info.renderer));
    assert_int_equal(dif_gpu_live(gpu), 1);
    dif_gpu_close(gpu);
    dif_gpu_close(NULL);
}

static void test_open__software_is_refused_where_hardware_is_required(void **state)
{
    (void)state;
    dif_gpu *gpu = open_or_skip();
    const bool software = dif_gpu_info_of(gpu).software;
    dif_gpu_close(gpu);
    dif_gpu_opts opts = dif_gpu_opts_default();
    assert_false(opts.require_hardware);
    opts.require_hardware = true;
    dif_error err;
    const dif_status status = dif_gpu_open(&opts, &gpu, &err);
    assert_int_equal(status, software ? DIF_ERR_RESOURCE : DIF_OK);
    assert_int_equal(gpu == NULL, software);
    if (software)
        assert_non_null(strstr(err.text, "hardware is required, and only a software renderer was found: "));
    dif_gpu_close(gpu);
}

static void test_begin__two_contexts_take_turns(void **state)
{
    (void)state;
    dif_gpu *first = open_or_skip(), *second = NULL;
    assert_int_equal(dif_gpu_open(NULL, &second, NULL), DIF_OK);
    assert_int_equal(dif_gpu_begin(first, NULL), DIF_OK);
    glEnable(GL_BLEND);
    assert_int_equal(dif_gpu_begin(second, NULL), DIF_OK);
    assert_int_equal(glIsEnabled(GL_BLEND), GL_FALSE);
    dif_gpu_close(second); /* the first outlives it */
    assert_int_equal(dif_gpu_begin(first, NULL), DIF_OK);
    assert_int_equal(glIsEnabled(GL_BLEND), GL_TRUE);
    assert_int_equal(dif_gpu_check(first, "nothing", NULL), DIF_OK);
    dif_gpu_close(first);
}

static void test_check__an_error_is_named_and_gone(void **state)
{
    (void)state;
    dif_gpu *gpu = open_or_skip();
    dif_error err;
    glEnable(0x1234);
    assert_int_equal(dif_gpu_check(gpu, "enabling nonsense", &err), DIF_ERR_FOREIGN);
    assert_string_equal(err.text, "OpenGL: invalid enumerator (0x500), enabling nonsense");
    assert_int_equal(dif_gpu_check(gpu, "enabling nonsense", &err), DIF_OK);
    dif_gpu_close(gpu);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_probe__a_missing_library_is_a_missing_resource),
        cmocka_unit_test(test_is_software__knows_the_renderers),
        cmocka_unit_test(test_open__says_what_was_found),
        cmocka_unit_test(test_open__software_is_refused_where_hardware_is_required),
        cmocka_unit_test(test_begin__two_contexts_take_turns),
        cmocka_unit_test(test_check__an_error_is_named_and_gone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
