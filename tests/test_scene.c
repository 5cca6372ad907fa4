/* core/scene: cameras, frames, textures. */
#include "core/scene.h"

#include "core/alloc.h"
#include "core/units.h"
#include "fixtures/meshes.h"
#include "tests/near.h"

static void project(const dif_projection *p, dif_vec3 at, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = p->row[i][0] * at.x + p->row[i][1] * at.y + p->row[i][2] * at.z + p->row[i][3];
}

static void test_projection__target_is_the_middle_and_the_field_ends_at_one(void **state)
{
    (void)state;
    const dif_vec3 centre = {1.0, 2.0, 3.0};
    for (int k = 0; k < 5; k++) {
        const double theta = 0.4 * k, phi = -1.0 + k, fov = 0.6;
        const dif_camera camera = dif_camera_orbit(centre, 5.0, theta, phi, fov);
        const dif_projection p = dif_scene_projection(&camera, 1.5);
        double clip[3];
        project(&p, centre, clip);
        assert_near(clip[0], 0.0, 0.0, 1e-14);
        assert_near(clip[1], 0.0, 0.0, 1e-14);
        assert_near(clip[2], 5.0, 1e-14, 0.0);
        /* the picture's top lies away from phi, at a height of distance * tan(fov/2) */
        const dif_vec3 up = {-cos(theta) * cos(phi), -cos(theta) * sin(phi), sin(theta)};
        project(&p, dif_vec3_add(centre, 5.0 * tan(0.5 * fov), up), clip);
        assert_near(clip[0], 0.0, 0.0, 1e-14);
        assert_near(clip[1] / clip[2], 1.0, 1e-13, 0.0);
    }
}

static void test_distance__a_ball_just_fits(void **state)
{
    (void)state;
    const double d = dif_camera_distance(2.0, 0.8, 3.0), narrow = dif_camera_distance(2.0, 0.8, 0.25);
    assert_near(asin(2.0 / d), 0.4, 1e-14, 0.0);
    assert_near(tan(asin(2.0 / narrow)), 0.25 * tan(0.4), 1e-14, 0.0);
}

static void test_framing__fills_the_share_in_the_middle(void **state)
{
    (void)state;
    dif_mesh mesh;
    dif_error err = {0};
    assert_int_equal(dif_mesh_create(3, 1, false, &mesh, &err), DIF_OK);
    mesh.position[0] = (dif_vec3){1.0, 0.0, 0.0};
    mesh.position[1] = (dif_vec3){3.0, 0.5, 0.2};
    mesh.position[2] = (dif_vec3){1.5, 2.0, 4.0};
    const dif_camera camera = dif_camera_framing(&mesh, 1.1, -0.4, 0.6, 1.5, 0.9);
    const dif_projection p = dif_scene_projection(&camera, 1.5);
    double low[2] = {2.0, 2.0}, high[2] = {-2.0, -2.0};
    for (int i = 0; i < 3; i++) {
        double clip[3];
        project(&p, mesh.position[i], clip);
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], clip[k] / clip[2]);
            high[k] = fmax(high[k], clip[k] / clip[2]);
        }
    }
    /* a pixel of a picture of 1000 pixels: what the rounds leave */
    for (int k = 0; k < 2; k++)
        assert_near(low[k] + high[k], 0.0, 0.0, 2e-3);
    assert_near(fmax(high[0], high[1]), 0.9, 0.0, 2e-3);
    dif_mesh_free(&mesh);
}

static void test_frame__turns_about_the_normal(void **state)
{
    (void)state;
    uint64_t random = 7;
    for (int k = 0; k < 100; k++) {
        dif_vec3 n = {test_random(&random, -1.0, 1.0), test_random(&random, -1.0, 1.0),
                      test_random(&random, -1.0, 1.0)};
        const dif_vec3 t = {test_random(&random, -1.0, 1.0), test_random(&random, -1.0, 1.0), 0.3};
        const double turn = test_random(&random, -7.0, 7.0);
        const dif_frame3 still = dif_scene_frame(n, t, 0.0), turned = dif_scene_frame(n, t, turn);
        assert_near(dif_vec3_dot(turned.tangent, still.tangent), cos(turn), 0.0, 1e-12);
        assert_near(dif_vec3_dot(turned.tangent, still.bitangent), sin(turn), 0.0, 1e-12);
        assert_near(dif_vec3_dot(turned.bitangent, still.tangent), -sin(turn), 0.0, 1e-12);
        assert_near(dif_vec3_dot(turned.normal, dif_vec3_cross(turned.tangent, turned.bitangent)), 1.0, 1e-12, 0.0);
    }
}

static void test_turn__is_seen_as_the_mesh_turned(void **state)
{
    (void)state;
    const dif_vec3 centre = {0.5, -0.25, 0.1}, z = {0.0, 0.0, 1.0}, at = {1.0, 0.75, 0.5};
    dif_scene scene = {.camera = dif_camera_orbit(centre, 4.0, 1.0, 0.3, 0.5),
                       .n_light = 1,
                       .light = {dif_vec3_from_angles_rad(0.4, 2.0)}};
    const dif_projection before = dif_scene_projection(&scene.camera, 1.0);
    const dif_vec3 moved = dif_vec3_add(centre, 1.0, dif_vec3_turn(dif_vec3_add(at, -1.0, centre), z, 0.9));
    const dif_vec3 light = scene.light[0];
    dif_scene_turn(&scene, centre, 0.9);
    const dif_projection after = dif_scene_projection(&scene.camera, 1.0);
    double want[3], got[3];
    project(&before, moved, want);
    project(&after, at, got);
    for (int i = 0; i < 3; i++)
        assert_near(got[i], want[i], 1e-13, 1e-13);
    assert_near(dif_vec3_turn(scene.light[0], z, 0.9).x, light.x, 1e-14, 0.0);
}

static void test_texture__is_read_linearly_and_repeats(void **state)
{
    (void)state;
    float rgb[2 * 2 * 3] = {0.0F};
    rgb[0] = 1.0F; /* upper left: red */
    rgb[9] = 8.0F; /* lower right */
    const dif_texture texture = {2, 2, rgb};
    const struct {
        double uv[2], want;
    } cases[] = {{{0.25, 0.75}, 1.0},  {{0.75, 0.25}, 8.0},  {{0.75, 0.75}, 0.0}, {{0.5, 0.5}, 2.25},
                 {{1.25, -0.25}, 1.0}, {{-3.25, 2.25}, 8.0}, {{0.0, 0.75}, 0.5},  {{1.0, 0.75}, 0.5}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double got[3];
        dif_texture_read(&texture, cases[i].uv, got);
        assert_near(got[0], cases[i].want, 1e-14, 0.0);
        assert_near(got[1], 0.0, 0.0, 0.0);
    }
}

static void test_check__refuses_with_the_reason(void **state)
{
    (void)state;
    dif_error err;
    dif_mesh mesh;
    float white[3] = {1.0F, 1.0F, 1.0F};
    const dif_texture base = {1, 1, white};
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 1, &mesh, NULL), DIF_OK);
    const dif_scene good = {.mesh = &mesh,
                            .camera = dif_camera_orbit((dif_vec3){0.0, 0.0, 0.0}, 3.0, 0.0, 0.0, 0.5),
                            .n_light = 1,
                            .light = {{0.0, 0.0, 1.0}},
                            .base = &base};
    assert_int_equal(dif_scene_check(&good, &err), DIF_OK);
    dif_scene bad = good;
    bad.n_light = 0;
    assert_int_equal(dif_scene_check(&bad, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "0 lights, want 1 ... 8");
    bad = good;
    bad.light[0].z = NAN;
    assert_int_equal(dif_scene_check(&bad, &err), DIF_ERR_ARG);
    bad = good;
    bad.camera.fov_y_rad = DIF_PI;
    assert_int_equal(dif_scene_check(&bad, &err), DIF_ERR_ARG);
    bad = good;
    bad.camera.up = (dif_vec3){0.0, 0.0, -2.0};
    assert_int_equal(dif_scene_check(&bad, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "the camera looks nowhere or along its up direction");
    dif_release(mesh.uv);
    mesh.uv = NULL;
    assert_int_equal(dif_scene_check(&good, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "a base colour texture needs texture coordinates, and the mesh has none");
    dif_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_projection__target_is_the_middle_and_the_field_ends_at_one),
        cmocka_unit_test(test_distance__a_ball_just_fits),
        cmocka_unit_test(test_framing__fills_the_share_in_the_middle),
        cmocka_unit_test(test_frame__turns_about_the_normal),
        cmocka_unit_test(test_turn__is_seen_as_the_mesh_turned),
        cmocka_unit_test(test_texture__is_read_linearly_and_repeats),
        cmocka_unit_test(test_check__refuses_with_the_reason),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
