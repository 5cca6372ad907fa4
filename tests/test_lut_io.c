/* The integrated table written and read back, and files that are none. */
#define _POSIX_C_SOURCE 200809L /* mkdtemp */

#include "core/io/lut_io.h"

#include <unistd.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/file.h"
#include "tests/alloc_count.h"
#include "tests/exr_patch.h"

static char folder[64], path[96];

static int make_folder(void **state)
{
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/dif-lut-XXXXXX");
    if (!mkdtemp(folder))
        return -1;
    snprintf(path, sizeof path, "%s/t.exr", folder);
    return 0;
}

/* Fails if a test left anything behind. */
static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

/* A table of random numbers of all sizes. */
static dif_lut make_lut(int n_azimuth, int n_radius, int n_map)
{
    dif_lut lut = {.n_azimuth = n_azimuth, .n_radius = n_radius, .n_map = n_map, .s0 = 0.1 / 3.0, .tail = 1e-5 / 7.0};
    const size_t n = 3 * (size_t)n_azimuth * (size_t)n_radius * (size_t)n_map;
    uint64_t seed = 23;
    lut.coef = dif_alloc(n, sizeof *lut.coef);
    assert_non_null(lut.coef);
    for (size_t i = 0; i < n; i++)
        lut.coef[i] = (float)(test_random(&seed, -1.0, 1.0) * pow(10.0, test_random(&seed, -40.0, 3.0)));
    return lut;
}

/* The bytes of a table's file, freed with dif_release. */
static unsigned char *bytes_of(const dif_lut *lut, size_t *n)
{
    unsigned char *data = NULL;
    dif_manifest manifest = {0};
    dif_error err;
    assert_int_equal(dif_manifest_set(&manifest, "window", "gauss", &err), DIF_OK);
    assert_int_equal(dif_lut_write(path, lut, &manifest, &err), DIF_OK);
    assert_int_equal(dif_file_read(path, (size_t)1 << 30, &data, n, &err), DIF_OK);
    assert_int_equal(unlink(path), 0);
    dif_manifest_free(&manifest);
    return data;
}

static void assert_refused(const unsigned char *data, size_t n, dif_status want, const char *text)
{
    dif_lut lut;
    dif_manifest manifest;
    dif_error err;
    assert_int_equal(dif_lut_parse(data, n, "f.exr", &lut, &manifest, &err), want);
    assert_string_equal(err.text, text);
    assert_null(lut.coef);
    assert_null(manifest.item);
}

static void test_write__comes_back_to_the_last_bit(void **state)
{
    (void)state;
    static const int SIZES[][3] = {{16, 8, 1}, {64, 33, 5}, {20, 9, 48}};
    for (int i = 0; i < 3; i++) {
        dif_lut want = make_lut(SIZES[i][0], SIZES[i][1], SIZES[i][2]), got;
        dif_manifest manifest;
        dif_error err;
        size_t n = 0;
        unsigned char *data = bytes_of(&want, &n);
        assert_int_equal(dif_lut_parse(data, n, "f.exr", &got, &manifest, &err), DIF_OK);
        assert_int_equal(got.n_azimuth, want.n_azimuth);
        assert_int_equal(got.n_radius, want.n_radius);
        assert_int_equal(got.n_map, want.n_map);
        assert_true(got.s0 == want.s0 && got.tail == want.tail);
        assert_memory_equal(got.coef, want.coef,
                            3 * sizeof *got.coef * (size_t)(want.n_azimuth * want.n_radius * want.n_map));
        assert_string_equal(dif_manifest_get(&manifest, "window"), "gauss");
        assert_string_equal(dif_manifest_get(&manifest, "lut_version"), DIF_LUT_VERSION);
        dif_manifest_free(&manifest);
        dif_release(data);
        dif_lut_free(&got);
        dif_lut_free(&want);
    }
}

static void test_parse__attributes_out_of_range_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text, *message;
    } CASES[] = {
        {"diffbench.lut_version", "2", "f.exr: table of version 2, want 1: build it again"},
        {"diffbench.lut_version", "x", "f.exr: table of version x, want 1: build it again"},
        {"diffbench.layout", "map", "f.exr: not a table that `lut` writes (attribute diffbench.layout)"},
        {"diffbench.n_map", "3", "f.exr: 6 channels, want 9 for 3 maps"},
        {"diffbench.n_map", "0", "f.exr: diffbench.n_map is 0, want 1 ... 48"},
        {"diffbench.n_map", "x", "f.exr: diffbench.n_map is nan, want 1 ... 48"},
        {"diffbench.s0", "-", "f.exr: diffbench.s0 is -0.0333333, want 1e-9 ... 2"},
        {"diffbench.s0", "3", "f.exr: diffbench.s0 is 3.03333, want 1e-9 ... 2"},
        {"diffbench.tail", "-", "f.exr: diffbench.tail is -4.28571e-07, want >= 0"},
    };
    dif_lut lut = make_lut(16, 8, 2);
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        size_t n = 0;
        unsigned char *data = bytes_of(&lut, &n);
        memcpy(exr_patch_text(data, n, CASES[i].name), CASES[i].text, strlen(CASES[i].text));
        assert_refused(data, n, DIF_ERR_FORMAT, CASES[i].message);
        dif_release(data);
    }
    dif_lut_free(&lut);
}

static void test_parse__numbers_that_are_none_have_their_place(void **state)
{
    (void)state;
    static const float BAD[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        dif_lut lut = make_lut(16, 8, 2);
        size_t n = 0;
        lut.coef[(5 * 16 + 7) * 6 + 4] = BAD[i];
        unsigned char *data = bytes_of(&lut, &n);
        assert_refused(data, n, DIF_ERR_NONFINITE, "f.exr: map 1 is not finite at azimuth 7, radius 5");
        dif_release(data);
        dif_lut_free(&lut);
    }
}

static void test_parse__sizes_out_of_range_are_refused(void **state)
{
    (void)state;
    static const int SIZES[][2] = {{15, 8}, {16, 7}, {16385, 8}, {16, 4097}};
    for (int i = 0; i < 4; i++) {
        dif_lut lut = make_lut(SIZES[i][0], SIZES[i][1], 1);
        size_t n = 0;
        char message[120];
        unsigned char *data = bytes_of(&lut, &n);
        snprintf(message, sizeof message, "f.exr: table of %d azimuths x %d radii, want 16 ... 16384 x 8 ... 4096",
                 SIZES[i][0], SIZES[i][1]);
        assert_refused(data, n, DIF_ERR_SIZE, message);
        dif_release(data);
        dif_lut_free(&lut);
    }
}

static void test_parse__other_files_are_refused(void **state)
{
    (void)state;
    static const float PIXEL[4] = {0.0f};
    const dif_exr_layer layer = {"height", PIXEL, 1};
    const dif_exr_image image = {.nx = 2, .ny = 2, .layer = &layer, .n_layer = 1};
    unsigned char *data = NULL;
    size_t n = 0;
    dif_lut lut;
    dif_error err;
    assert_refused((const unsigned char *)"P5 2 2", 6, DIF_ERR_FORMAT,
                   "f.exr: not an EXR file, want a table that `lut` writes");
    assert_int_equal(dif_exr_encode(&image, &data, &n, &err), DIF_OK);
    assert_refused(data, n, DIF_ERR_FORMAT, "f.exr: not a table that `lut` writes (attribute diffbench.layout)");
    dif_release(data);
    assert_int_equal(dif_lut_read("/nonexistent/t.exr", &lut, NULL, &err), DIF_ERR_IO);
    assert_null(lut.coef);
}

static void test_parse__every_beginning_is_refused(void **state)
{
    (void)state;
    dif_lut lut = make_lut(16, 8, 1);
    size_t n = 0;
    const int live = test_alloc_live();
    unsigned char *data = bytes_of(&lut, &n);
    for (size_t k = 0; k < n; k++) {
        unsigned char *part = malloc(k ? k : 1);
        dif_lut got;
        dif_error err;
        assert_non_null(part);
        memcpy(part, data, k);
        assert_int_not_equal(dif_lut_parse(part, k, "f.exr", &got, NULL, &err), DIF_OK);
        assert_int_equal(strncmp(err.text, "f.exr: ", 7), 0);
        assert_null(got.coef);
        free(part);
    }
    dif_release(data);
    assert_int_equal(test_alloc_live(), live);
    dif_lut_free(&lut);
}

static void test_parse__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_lut lut = make_lut(16, 8, 2);
    size_t n = 0;
    unsigned char *data = bytes_of(&lut, &n);
    const int live = test_alloc_live();
    int n_failed = 0;
    for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; n_failed++) {
        dif_lut got;
        dif_manifest manifest;
        test_alloc_fail_from(n_failed + 1);
        dif_error err = {0};
        status = dif_lut_parse(data, n, "f.exr", &got, &manifest, &err);
        test_alloc_fail_from(0);
        if (status != DIF_OK && status != DIF_ERR_NOMEM)
            fail_msg("allocation %d: %s", n_failed + 1, err.text);
        dif_lut_free(&got);
        dif_manifest_free(&manifest);
        assert_int_equal(test_alloc_live(), live);
    }
    assert_true(n_failed > 10);
    dif_release(data);
    dif_lut_free(&lut);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_write__comes_back_to_the_last_bit),
        cmocka_unit_test(test_parse__attributes_out_of_range_are_refused),
        cmocka_unit_test(test_parse__numbers_that_are_none_have_their_place),
        cmocka_unit_test(test_parse__sizes_out_of_range_are_refused),
        cmocka_unit_test(test_parse__other_files_are_refused),
        cmocka_unit_test(test_parse__every_beginning_is_refused),
        cmocka_unit_test(test_parse__every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
