/* Maps written and read back; maps as pictures. */
#define _POSIX_C_SOURCE 200809L /* mkdtemp */

#include "core/io/map_io.h"

#include <unistd.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/file.h"
#include "core/io/image_head.h"
#include "core/units.h"
#include "tests/alloc_count.h"
#include "tests/exr_patch.h"

static char folder[64], path[96];

static int make_folder(void **state)
{
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/dif-map-XXXXXX");
    if (!mkdtemp(folder))
        return -1;
    snprintf(path, sizeof path, "%s/m.exr", folder);
    return 0;
}

/* Fails if a test left anything behind. */
static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

static dif_map_image make_map(int n_pixel, int n_lambda, bool with_layers)
{
    const size_t n = (size_t)n_pixel * (size_t)n_pixel;
    dif_map_image map = {.n_pixel = n_pixel,
                         .theta_rad = dif_rad_from_deg(30.0),
                         .phi_rad = dif_rad_from_deg(-125.5),
                         .quantity = DIF_QUANTITY_BRDF,
                         .n_lambda = n_lambda};
    uint64_t seed = 3;
    map.lambda_um = dif_alloc((size_t)n_lambda, sizeof *map.lambda_um);
    map.xyz = dif_alloc(3 * n, sizeof *map.xyz);
    map.layer = with_layers ? dif_alloc(n * (size_t)n_lambda, sizeof *map.layer) : NULL;
    assert_true(map.lambda_um && map.xyz && (map.layer || !with_layers));
    for (int i = 0; i < n_lambda; i++)
        map.lambda_um[i] = dif_um_from_nm(380.0 + 5.3 * i);
    for (size_t i = 0; i < 3 * n; i++)
        map.xyz[i] = (float)test_random(&seed, 0.0, 2.0);
    for (size_t i = 0; map.layer && i < n * (size_t)n_lambda; i++)
        map.layer[i] = (float)test_random(&seed, 0.0, 2.0);
    return map;
}

static unsigned char *bytes_of(const dif_map_image *map, size_t *n)
{
    unsigned char *data = NULL;
    dif_manifest manifest = {0};
    dif_error err;
    assert_int_equal(dif_manifest_set(&manifest, "window", "gauss", &err), DIF_OK);
    assert_int_equal(dif_map_write(path, map, 2.5, &manifest, &err), DIF_OK);
    assert_int_equal(dif_file_read(path, (size_t)1 << 30, &data, n, &err), DIF_OK);
    assert_int_equal(unlink(path), 0);
    dif_manifest_free(&manifest);
    return data;
}

static void test_write__comes_back(void **state)
{
    (void)state;
    for (int c = 0; c < 4; c++) {
        dif_map_image want = make_map(16 + 17 * (c / 2), 1 + 4 * c, c % 2), got;
        dif_manifest manifest;
        dif_error err;
        size_t n = 0;
        const size_t n_pixel = (size_t)want.n_pixel * (size_t)want.n_pixel;
        want.fixed_is_wo = c == 3;
        unsigned char *data = bytes_of(&want, &n);
        assert_int_equal(dif_map_parse(data, n, "f.exr", &got, &manifest, &err), DIF_OK);
        assert_int_equal(got.n_pixel, want.n_pixel);
        assert_int_equal(got.fixed_is_wo, want.fixed_is_wo);
        assert_int_equal(got.quantity, DIF_QUANTITY_BRDF);
        /* angles and wavelengths are written as the shortest text that leads back */
        assert_true(got.theta_rad == want.theta_rad && got.phi_rad == want.phi_rad);
        assert_int_equal(got.n_lambda, want.n_lambda);
        assert_memory_equal(got.lambda_um, want.lambda_um, (size_t)want.n_lambda * sizeof *want.lambda_um);
        assert_memory_equal(got.xyz, want.xyz, 3 * n_pixel * sizeof *want.xyz);
        assert_int_equal(got.layer != NULL, want.layer != NULL);
        if (want.layer)
            assert_memory_equal(got.layer, want.layer, n_pixel * (size_t)want.n_lambda * sizeof *want.layer);
        assert_string_equal(dif_manifest_get(&manifest, "window"), "gauss");
        assert_string_equal(dif_manifest_get(&manifest, "exposure"), "2.5");
        dif_manifest_free(&manifest);
        dif_map_image_free(&got);
        dif_map_image_free(&want);
        dif_release(data);
    }
}

/* The channels as other programs see them. */
static void test_write__channels_follow_the_spectral_layout(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"B", "G", "R", "T.380,000000nm", "T.385,300000nm", "X", "Y", "Z"};
    dif_map_image map = make_map(16, 2, true);
    dif_exr *exr = NULL;
    dif_error err;
    size_t n = 0;
    unsigned char *data = bytes_of(&map, &n);
    const dif_source source = dif_source_of(data, n, "f.exr");
    assert_int_equal(dif_exr_open(&source, &exr, &err), DIF_OK);
    assert_int_equal(dif_exr_n_channel(exr), 8);
    for (int i = 0; i < 8; i++)
        assert_string_equal(dif_exr_channel_name(exr, i), NAMES[i]);
    assert_string_equal(dif_exr_text(exr, "spectralLayoutVersion"), "1.0");
    float rgb[3][256];
    const dif_exr_target target[3] = {{"R", rgb[0], 1}, {"G", rgb[1], 1}, {"B", rgb[2], 1}};
    assert_int_equal(dif_exr_read_targets(exr, 3, target, &err), DIF_OK);
    for (int i = 0; i < 256; i++) {
        const double xyz[3] = {(double)map.xyz[3 * i], (double)map.xyz[3 * i + 1], (double)map.xyz[3 * i + 2]};
        double want[3];
        dif_colour_rgb_from_xyz(xyz, want);
        for (int c = 0; c < 3; c++)
            assert_near((double)rgb[c][i], want[c], 1e-6, 1e-7); /* floats */
    }
    const dif_exr_target none = {"Q", rgb[0], 1};
    assert_int_equal(dif_exr_read_targets(exr, 1, &none, &err), DIF_ERR_FORMAT);
    assert_string_equal(err.text, "f.exr: no channel 'Q'");
    dif_exr_close(exr);
    dif_release(data);
    dif_map_image_free(&map);
}

static void test_write__layers_that_would_share_a_name_are_refused(void **state)
{
    (void)state;
    dif_map_image map = make_map(16, 2, true);
    dif_error err;
    map.lambda_um[1] = map.lambda_um[0] * (1.0 + 1e-12);
    assert_int_equal(dif_map_write(path, &map, 1.0, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "two layers at 380 nm, want wavelengths 1e-6 nm apart");
    dif_map_image_free(&map);
}

static void assert_refused(const unsigned char *data, size_t n, dif_status want, const char *text)
{
    dif_map_image map;
    dif_manifest manifest;
    dif_error err;
    assert_int_equal(dif_map_parse(data, n, "f.exr", &map, &manifest, &err), want);
    assert_string_equal(err.text, text);
    assert_true(!map.xyz && !map.layer && !map.lambda_um && !manifest.item);
}

static void test_parse__damaged_maps_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text, *message;
    } CASES[] = {
        {"diffbench.layout", "lut", "f.exr: not a map of diffbench (attribute diffbench.layout)"},
        {"diffbench.map_version", "7", "f.exr: map of version 7, want 1"},
        {"diffbench.theta_i_deg", "90", "f.exr: map without a fixed direction"},
        {"diffbench.quantity", "bard", "f.exr: map of 'bard', want power, rho or brdf"},
        {"diffbench.wavelengths_nm", "x", "f.exr: diffbench.wavelengths_nm holds less than 2 numbers"},
        {"diffbench.wavelengths_nm", "381", "f.exr: no channel 'T.381,000000nm'"},
    };
    dif_map_image map = make_map(16, 2, true);
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        size_t n = 0;
        unsigned char *data = bytes_of(&map, &n);
        memcpy(exr_patch_text(data, n, CASES[i].name), CASES[i].text, strlen(CASES[i].text));
        assert_refused(data, n, DIF_ERR_FORMAT, CASES[i].message);
        dif_release(data);
    }
    size_t n = 0;
    map.xyz[3 * (2 * 16 + 5) + 1] = NAN;
    unsigned char *data = bytes_of(&map, &n);
    assert_refused(data, n, DIF_ERR_NONFINITE, "f.exr: pixel 5, 2 is not finite");
    dif_release(data);
    map.xyz[3 * (2 * 16 + 5) + 1] = 0.0f;
    map.layer[256 + 16] = INFINITY;
    data = bytes_of(&map, &n);
    assert_refused(data, n, DIF_ERR_NONFINITE, "f.exr: a layer's pixel 0, 1 is not finite");
    dif_release(data);
    dif_map_image_free(&map);
}

static void test_parse__every_beginning_and_failing_allocation_is_refused(void **state)
{
    (void)state;
    dif_map_image map = make_map(16, 2, true);
    size_t n = 0;
    unsigned char *data = bytes_of(&map, &n);
    const int live = test_alloc_live();
    int n_failed = 0;
    for (size_t k = 0; k < n; k += 7) {
        dif_map_image got;
        assert_int_not_equal(dif_map_parse(data, k, "f.exr", &got, NULL, NULL), DIF_OK);
        assert_null(got.xyz);
    }
    for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; n_failed++) {
        dif_map_image got;
        test_alloc_fail_from(n_failed + 1);
        status = dif_map_parse(data, n, "f.exr", &got, NULL, NULL);
        test_alloc_fail_from(0);
        assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
        dif_map_image_free(&got);
        assert_int_equal(test_alloc_live(), live);
    }
    assert_true(n_failed > 10);
    dif_release(data);
    dif_map_image_free(&map);
}

/* A map with light of one level at a few pixels. */
static dif_map_image make_spots(int n_pixel, const int (*at)[2], const float *level, int n_spot)
{
    dif_map_image map = make_map(n_pixel, 3, false);
    memset(map.xyz, 0, 3 * sizeof *map.xyz * (size_t)n_pixel * (size_t)n_pixel);
    map.theta_rad = map.phi_rad = 0.0;
    for (int i = 0; i < n_spot; i++) {
        const double grey[3] = {(double)level[i], (double)level[i], (double)level[i]};
        double xyz[3];
        dif_colour_xyz_from_rgb(grey, xyz);
        for (int c = 0; c < 3; c++)
            map.xyz[3 * (at[i][1] * n_pixel + at[i][0]) + c] = (float)xyz[c];
    }
    return map;
}

static void test_exposure__is_that_of_the_light_beside_the_mirror(void **state)
{
    (void)state;
    /* the mirror direction is the middle, between pixels 31 and 32 */
    static const int AT[][2] = {{31, 31}, {10, 20}, {40, 9}, {50, 40}, {20, 50}};
    const float level[] = {1.0f, 0.01f, 0.01f, 0.01f, 0.01f}, mirror[] = {0.5f};
    dif_map_image map = make_spots(64, AT, level, 5);
    /* bins of 1 %; the level of all the light beside the mirror becomes white */
    assert_near(dif_map_exposure(&map), 100.0, 0.02, 0.0);
    dif_map_image_free(&map);
    map = make_spots(64, AT, mirror, 1);
    assert_near(dif_map_exposure(&map), 2.0, 0.02, 0.0);
    dif_map_image_free(&map);
    map = make_spots(64, AT, mirror, 0);
    assert_near(dif_map_exposure(&map), 1.0, 0.0, 0.0);
    dif_map_image_free(&map);
}

static void test_draw__pixels_lie_where_directions_are(void **state)
{
    (void)state;
    /* a spot up left of the middle, away from every ring and label */
    static const int AT[][2] = {{100, 80}};
    const float level[] = {1.0f};
    const dif_map_look look = {1.0, DIF_GAMUT_CLIP};
    for (int small = 0; small < 2; small++) {
        const int n = small ? 64 : 256, enlarge = small ? 4 : 1, spot[][2] = {{AT[0][0] / enlarge, AT[0][1] / enlarge}};
        dif_map_image map = make_spots(n, spot, level, 1);
        uint8_t *rgb = NULL;
        int nx = 0, ny = 0, n_white = 0;
        dif_error err;
        assert_int_equal(dif_map_draw(&map, &look, &rgb, &nx, &ny, &err), DIF_OK);
        assert_true(ny > nx && nx > 256);
        const int margin = (nx - 256) / 2;
        for (int iy = 0; iy < enlarge; iy++)
            for (int ix = 0; ix < enlarge; ix++) {
                const int x = margin + spot[0][0] * enlarge + ix, y = margin + spot[0][1] * enlarge + iy;
                n_white += rgb[3 * (y * nx + x)] == 255 && rgb[3 * (y * nx + x) + 1] == 255;
            }
        assert_int_equal(n_white, enlarge * enlarge);
        dif_release(rgb);
        dif_map_image_free(&map);
    }
}

static void test_write_png__carries_the_manifest(void **state)
{
    (void)state;
    dif_map_image map = make_map(32, 3, false);
    const dif_map_look look = dif_map_look_default();
    dif_manifest manifest = {0};
    dif_image_head head;
    unsigned char *data = NULL;
    size_t n = 0;
    dif_error err;
    char long_key[200];
    memset(long_key, 'k', sizeof long_key - 1);
    long_key[sizeof long_key - 1] = '\0';
    assert_int_equal(dif_manifest_set(&manifest, "window", "gauss \xCF\x83 = 16 \xC2\xB5m", &err), DIF_OK);
    assert_int_equal(dif_manifest_set(&manifest, long_key, "cut", &err), DIF_OK);
    assert_int_equal(dif_map_write_png(path, &map, &look, &manifest, &err), DIF_OK);
    assert_int_equal(dif_file_read(path, (size_t)1 << 30, &data, &n, &err), DIF_OK);
    /* the reader checks every chunk's check sum */
    assert_int_equal(dif_image_head_read(data, n, &head, &err), DIF_OK);
    static const char TEXT[] = "iTXtdiffbench.window\0\0\0\0\0gauss";
    size_t at = 0;
    while (at + sizeof TEXT < n && memcmp(data + at, TEXT, sizeof TEXT - 1) != 0)
        at++;
    assert_true(at + sizeof TEXT < n);
    dif_release(data);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(dif_map_write_png("/nonexistent/m.png", &map, &look, &manifest, &err), DIF_ERR_IO);
    dif_manifest_free(&manifest);
    dif_map_image_free(&map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_write__comes_back),
        cmocka_unit_test(test_write__channels_follow_the_spectral_layout),
        cmocka_unit_test(test_write__layers_that_would_share_a_name_are_refused),
        cmocka_unit_test(test_parse__damaged_maps_are_refused),
        cmocka_unit_test(test_parse__every_beginning_and_failing_allocation_is_refused),
        cmocka_unit_test(test_exposure__is_that_of_the_light_beside_the_mirror),
        cmocka_unit_test(test_draw__pixels_lie_where_directions_are),
        cmocka_unit_test(test_write_png__carries_the_manifest),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
