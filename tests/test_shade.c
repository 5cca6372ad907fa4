/* core/shade: frames with an evaluator whose answers are known. */
#include "core/shade.h"

#include "core/brdf.h"
#include "core/colour.h"
#include "core/spectrum.h"
#include "core/units.h"
#include "fixtures/meshes.h"
#include "tests/alloc_count.h"
#include "tests/near.h"

enum { NX = 32, NY = 24 };

/* Answers white times a function of the directions that only the right frame gives. */
static double known(dif_vec3 wi, dif_vec3 wo)
{
    return 0.5 + 0.3 * wi.x + 0.1 * wi.y * wo.y + 0.05 * wo.x;
}

static dif_status answer(void *self, size_t n, const dif_vec3 *wi, const dif_vec3 *wo, double (*xyz)[3],
                         dif_eval_cost *cost, dif_error *err)
{
    double white[3];
    dif_spectrum_white(white);
    *cost = (dif_eval_cost){.run_s = 1.0};
    if (self)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "no");
    for (size_t i = 0; i < n; i++) {
        assert_true(wi[i].z > 0.0 && wo[i].z > 0.0);
        assert_near(dif_vec3_dot(wi[i], wi[i]), 1.0, 1e-12, 0.0);
        for (int c = 0; c < 3; c++)
            xyz[i][c] = known(wi[i], wo[i]) * white[c];
    }
    return DIF_OK;
}

static dif_scene scene_of(const dif_mesh *mesh, double distance)
{
    return (dif_scene){.mesh = mesh,
                       .camera = dif_camera_orbit((dif_vec3){0.0, 0.0, 0.0}, distance, 0.9, -1.2, 0.5),
                       .n_light = 2,
                       .light = {dif_vec3_from_angles_rad(0.3, 0.5), dif_vec3_from_angles_rad(2.0, 1.0)},
                       .groove_rad = 0.6,
                       .base_rgb = {0.1, 0.2, 0.3}};
}

static void test_draw__a_plane_pixel_by_pixel(void **state)
{
    (void)state;
    dif_mesh mesh;
    dif_frame frame;
    dif_gbuffer g;
    dif_eval_cost cost;
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 1, &mesh, NULL), DIF_OK);
    assert_int_equal(dif_frame_create(NX, NY, &frame, NULL), DIF_OK);
    assert_int_equal(dif_gbuffer_create(NX, NY, &g, NULL), DIF_OK);
    const dif_scene scene = scene_of(&mesh, 6.0);
    const dif_evaluator evaluator = {.name = "known", .colours = answer};
    const dif_subsample centre = dif_subsample_centre();
    assert_int_equal(dif_raster_draw(&scene, &centre, &g, NULL), DIF_OK);
    assert_int_equal(dif_shade_draw(&scene, &evaluator, NULL, &frame, &cost, NULL), DIF_OK);
    assert_near(cost.run_s, 1.0, 0.0, 0.0);
    const dif_vec3 wi = dif_vec3_turn(scene.light[0], (dif_vec3){0.0, 0.0, 1.0}, -0.6); /* the second is below */
    int n_seen = 0;
    for (int i = 0; i < NX * NY; i++) {
        dif_hit hit;
        const bool seen = dif_raster_hit(&scene, &g, i % NX, i / NX, &hit);
        assert_near((double)frame.coverage[i], seen ? 1.0 : 0.0, 0.0, 0.0);
        const dif_vec3 wo = dif_vec3_turn(hit.to_eye, (dif_vec3){0.0, 0.0, 1.0}, -0.6);
        for (int c = 0; c < 3; c++) {
            assert_near((double)frame.light[3 * i + c], seen ? known(wi, wo) : 0.0, 2e-6, 1e-6);
            assert_near((double)frame.base[3 * i + c], seen ? wi.z * scene.base_rgb[c] : 0.0, 1e-6, 0.0);
        }
        n_seen += seen;
    }
    assert_at_most(100, n_seen);
    dif_gbuffer_free(&g);
    dif_frame_free(&frame);
    dif_mesh_free(&mesh);
}

static void test_draw__samples_average_and_cover_edges_partly(void **state)
{
    (void)state;
    dif_mesh mesh;
    dif_frame one, many;
    double sum_one = 0.0, sum_many = 0.0, light_one = 0.0, light_many = 0.0;
    int n_part = 0;
    assert_int_equal(dif_mesh_make(DIF_MESH_SPHERE, 2, &mesh, NULL), DIF_OK);
    assert_int_equal(dif_frame_create(NX, NY, &one, NULL), DIF_OK);
    assert_int_equal(dif_frame_create(NX, NY, &many, NULL), DIF_OK);
    const dif_scene scene = scene_of(&mesh, 5.0);
    const dif_evaluator evaluator = {.name = "known", .colours = answer};
    dif_shade_opts opts = dif_shade_opts_default();
    assert_int_equal(dif_shade_draw(&scene, &evaluator, &opts, &one, NULL, NULL), DIF_OK);
    opts.n_sub = 5;
    opts.jitter = true;
    assert_int_equal(dif_shade_draw(&scene, &evaluator, &opts, &many, NULL, NULL), DIF_OK);
    for (int i = 0; i < NX * NY; i++) {
        const double share = (double)many.coverage[i];
        sum_one += (double)one.coverage[i];
        sum_many += share;
        n_part += share > 0.01 && share < 0.99;
        light_one += (double)one.light[3 * i];
        light_many += (double)many.light[3 * i];
    }
    assert_at_most(20, n_part);
    /* a disc of tan(asin(1/5)) / tan(0.25) half picture heights */
    const double radius = 0.5 * NY * tan(asin(0.2)) / tan(0.25);
    assert_near(sum_many, DIF_PI * radius * radius, 0.01, 0.0);
    assert_near(light_many, light_one, 0.04, 0.0);
    assert_near(sum_one, DIF_PI * radius * radius, 0.04, 0.0);
    dif_frame_free(&one);
    dif_frame_free(&many);
    dif_mesh_free(&mesh);
}

static void test_draw__a_mirror_is_white_at_exposure_one(void **state)
{
    (void)state;
    /* rho of a flat surface seen in its mirror direction at normal incidence is 1 */
    const dif_vec3 z = {0.0, 0.0, 1.0};
    double white[3], rgb[3];
    dif_spectrum_white(white);
    dif_colour_rgb_from_xyz(white, rgb);
    assert_near(dif_brdf_gain_rho(dif_index_default(), z, z), 1.0, 1e-15, 0.0);
    for (int c = 0; c < 3; c++)
        assert_near(rgb[c], 1.0, 1e-4, 0.0);
}

static void test_draw__shadowing_scales(void **state)
{
    (void)state;
    dif_mesh mesh;
    dif_frame plain, shadowed;
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 1, &mesh, NULL), DIF_OK);
    assert_int_equal(dif_frame_create(NX, NY, &plain, NULL), DIF_OK);
    assert_int_equal(dif_frame_create(NX, NY, &shadowed, NULL), DIF_OK);
    dif_scene scene = scene_of(&mesh, 500.0);
    scene.camera = dif_camera_orbit((dif_vec3){0.0, 0.0, 0.0}, 1e4, 1.3, -1.2, 1e-4); /* one direction for all */
    const dif_evaluator evaluator = {.name = "known", .colours = answer};
    const dif_shadow shadow = {.kind = DIF_SHADOWING_VCAVITY};
    dif_shade_opts opts = dif_shade_opts_default();
    assert_int_equal(dif_shade_draw(&scene, &evaluator, &opts, &plain, NULL, NULL), DIF_OK);
    opts.shadow = &shadow;
    assert_int_equal(dif_shade_draw(&scene, &evaluator, &opts, &shadowed, NULL, NULL), DIF_OK);
    const double factor = dif_shadow_vcavity(scene.light[0], dif_vec3_from_angles_rad(1.3, -1.2));
    const int middle = 3 * (NX * (NY / 2) + NX / 2);
    assert_true(factor > 0.1 && factor < 0.9);
    assert_near((double)shadowed.light[middle] / (double)plain.light[middle], factor, 1e-3, 0.0);
    dif_frame_free(&plain);
    dif_frame_free(&shadowed);
    dif_mesh_free(&mesh);
}

static void test_exposure__leaves_a_share_above_white(void **state)
{
    (void)state;
    dif_frame frame;
    assert_int_equal(dif_frame_create(100, 10, &frame, NULL), DIF_OK);
    assert_near(dif_frame_exposure(&frame, 0.1), 1.0, 0.0, 0.0);
    for (int i = 0; i < 1000; i++) {
        frame.coverage[i] = 1.0F;
        frame.light[3 * i + i % 3] = (float)(1e-4 * (i + 1));
    }
    assert_near(dif_frame_exposure(&frame, 0.1), 1.0 / 0.09, 0.02, 0.0);
    frame.light[0] = 1e6F; /* one more, however bright, moves next to nothing */
    assert_near(dif_frame_exposure(&frame, 0.1), 1.0 / 0.0901, 0.02, 0.0);
    dif_frame_free(&frame);
}

static void test_draw__bad_options_and_failures(void **state)
{
    (void)state;
    dif_error err;
    dif_mesh mesh;
    dif_frame frame;
    int self = 0;
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 1, &mesh, NULL), DIF_OK);
    assert_int_equal(dif_frame_create(NX, NY, &frame, NULL), DIF_OK);
    const dif_scene scene = scene_of(&mesh, 6.0);
    const dif_evaluator good = {.name = "known", .colours = answer}, bad = {.self = &self, .colours = answer};
    dif_shade_opts opts = dif_shade_opts_default();
    const int live = test_alloc_live();
    assert_int_equal(dif_shade_draw(&scene, &bad, &opts, &frame, NULL, &err), DIF_ERR_UNSUPPORTED);
    assert_string_equal(err.text, "no");
    opts.n_sub = 0;
    assert_int_equal(dif_shade_draw(&scene, &good, &opts, &frame, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "0 x 0 samples a pixel, want 1 ... 64 a side");
    opts = dif_shade_opts_default();
    opts.cos_min = NAN;
    assert_int_equal(dif_shade_draw(&scene, &good, &opts, &frame, NULL, &err), DIF_ERR_ARG);
    for (int k = 1; k <= 8; k++) {
        test_alloc_fail_from(k);
        const dif_status status = dif_shade_draw(&scene, &good, NULL, &frame, NULL, NULL);
        test_alloc_fail_from(0);
        assert_int_equal(status, DIF_ERR_NOMEM);
        assert_int_equal(test_alloc_live(), live);
    }
    dif_frame_free(&frame);
    dif_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_draw__a_plane_pixel_by_pixel),
        cmocka_unit_test(test_draw__samples_average_and_cover_edges_partly),
        cmocka_unit_test(test_draw__a_mirror_is_white_at_exposure_one),
        cmocka_unit_test(test_draw__shadowing_scales),
        cmocka_unit_test(test_exposure__leaves_a_share_above_white),
        cmocka_unit_test(test_draw__bad_options_and_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
