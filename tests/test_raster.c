/* core/raster: against rays that meet a ball and a plane in closed form. */
#include "core/raster.h"

#include "core/units.h"
#include "fixtures/meshes.h"
#include "tests/near.h"

enum { NX = 61, NY = 47 };

static dif_scene scene_of(const dif_mesh *mesh, double distance, double theta)
{
    return (dif_scene){.mesh = mesh,
                       .camera = dif_camera_orbit((dif_vec3){0.0, 0.0, 0.0}, distance, theta, -0.5 * DIF_PI, 0.6),
                       .n_light = 1,
                       .light = {{0.0, 0.0, 1.0}}};
}

/* Direction of a ray through a place of the picture. */
static dif_vec3 ray_at(const dif_camera *camera, double x, double y)
{
    const dif_vec3 forward = dif_vec3_unit(dif_vec3_add(camera->target, -1.0, camera->eye));
    const dif_vec3 right = dif_vec3_unit(dif_vec3_cross(forward, camera->up)), up = dif_vec3_cross(right, forward);
    const double t = tan(0.5 * camera->fov_y_rad);
    const dif_vec3 level = dif_vec3_add(forward, t * NX / NY * (2.0 * x / NX - 1.0), right);
    return dif_vec3_add(level, t * (1.0 - 2.0 * y / NY), up);
}

static void test_draw__a_ball_is_where_rays_meet_it(void **state)
{
    (void)state;
    dif_mesh mesh;
    dif_gbuffer g;
    int n_hit = 0;
    assert_int_equal(dif_mesh_make(DIF_MESH_SPHERE, 4, &mesh, NULL), DIF_OK);
    assert_int_equal(dif_gbuffer_create(NX, NY, &g, NULL), DIF_OK);
    const dif_scene scene = scene_of(&mesh, 4.0, 1.1);
    const dif_subsample centre = dif_subsample_centre();
    assert_int_equal(dif_raster_draw(&scene, &centre, &g, NULL), DIF_OK);
    for (int iy = 0; iy < NY; iy++)
        for (int ix = 0; ix < NX; ix++) {
            dif_hit hit;
            const dif_vec3 ray = ray_at(&scene.camera, ix + 0.5, iy + 0.5), eye = scene.camera.eye;
            const double a = dif_vec3_dot(ray, ray), b = dif_vec3_dot(ray, eye), c = dif_vec3_dot(eye, eye) - 1.0;
            const double root = b * b - a * c;
            const bool seen = dif_raster_hit(&scene, &g, ix, iy, &hit);
            if (fabs(root) < 0.02 * b * b) /* the polygon's outline */
                continue;
            assert_int_equal(seen, root > 0.0);
            if (!seen)
                continue;
            const dif_vec3 want = dif_vec3_add(eye, (-b - sqrt(root)) / a, ray);
            n_hit++;
            assert_near(hit.position.x, want.x, 0.0, 4e-3);
            assert_near(hit.position.y, want.y, 0.0, 4e-3);
            assert_near(hit.frame.normal.z, want.z, 0.0, 4e-3);
            assert_near(hit.depth, (-b - sqrt(root)) / a, 2e-3, 0.0);
            assert_near(dif_vec3_dot(hit.frame.tangent, (dif_vec3){0.0, 0.0, 1.0}), 0.0, 0.0,
                        1e-4); /* eastwards, but for the polygons */
        }
    assert_at_most(500, n_hit);
    dif_gbuffer_free(&g);
    dif_mesh_free(&mesh);
}

/* Jitter is the same for a seed and another for another. */
static void test_draw__jitter_follows_its_seed(void **state)
{
    (void)state;
    dif_mesh mesh;
    dif_gbuffer g[3];
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 1, &mesh, NULL), DIF_OK);
    const dif_scene scene = scene_of(&mesh, 2.5, 1.2);
    int n_same = 0, n_hit = 0;
    for (uint32_t k = 0; k < 3; k++) {
        const dif_subsample sample = {.n = 1, .jitter = true, .seed = k / 2};
        assert_int_equal(dif_gbuffer_create(NX, NY, &g[k], NULL), DIF_OK);
        assert_int_equal(dif_raster_draw(&scene, &sample, &g[k], NULL), DIF_OK);
    }
    for (int i = 0; i < NX * NY; i++) {
        dif_hit hit[3];
        bool seen = true;
        for (int k = 0; k < 3; k++)
            seen = dif_raster_hit(&scene, &g[k], i % NX, i / NX, &hit[k]) && seen;
        if (!seen)
            continue;
        n_hit++;
        assert_true(hit[0].uv[0] == hit[1].uv[0] && hit[0].uv[1] == hit[1].uv[1]);
        n_same += hit[0].uv[0] == hit[2].uv[0];
    }
    assert_at_most(100, n_hit);
    assert_int_equal(n_same, 0);
    for (int k = 0; k < 3; k++)
        dif_gbuffer_free(&g[k]);
    dif_mesh_free(&mesh);
}

/* The plane is seen exactly: position, uv and its derivatives against rays through neighbouring places. */
static void test_hit__uv_and_derivatives_of_a_plane(void **state)
{
    (void)state;
    dif_mesh mesh;
    dif_gbuffer g;
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 1, &mesh, NULL), DIF_OK);
    assert_int_equal(dif_gbuffer_create(NX, NY, &g, NULL), DIF_OK);
    const dif_scene scene = scene_of(&mesh, 2.5, 1.2);
    const dif_subsample sample = {.n = 4, .i = 1, .j = 2, .jitter = true};
    int n_hit = 0;
    assert_int_equal(dif_raster_draw(&scene, &sample, &g, NULL), DIF_OK);
    for (int iy = 0; iy < NY; iy++)
        for (int ix = 0; ix < NX; ix++) {
            dif_hit hit;
            if (!dif_raster_hit(&scene, &g, ix, iy, &hit))
                continue;
            n_hit++;
            assert_near(hit.position.z, 0.0, 0.0, 1e-12);
            assert_near(hit.uv[0], 0.5 * (hit.position.x + 1.0), 1e-11, 1e-12);
            assert_near(hit.uv[1], 0.5 * (hit.position.y + 1.0), 1e-11, 1e-12);
            /* back to the picture */
            double clip[3];
            for (int i = 0; i < 3; i++)
                clip[i] = g.projection.row[i][0] * hit.position.x + g.projection.row[i][1] * hit.position.y +
                          g.projection.row[i][3];
            const double x = 0.5 * NX * (1.0 + clip[0] / clip[2]), y = 0.5 * NY * (1.0 - clip[1] / clip[2]);
            assert_true(x - ix >= 0.25 && x - ix <= 0.5 && y - iy >= 0.5 && y - iy <= 0.75);
            for (int axis = 0; axis < 2; axis++) {
                const double step = 1e-4, dx = axis == 0 ? step : 0.0, dy = axis == 1 ? step : 0.0;
                const dif_vec3 ray = ray_at(&scene.camera, x + dx, y + dy), eye = scene.camera.eye;
                const dif_vec3 there = dif_vec3_add(eye, -eye.z / ray.z, ray);
                const double *got = axis == 0 ? hit.uv_dx : hit.uv_dy;
                assert_near(got[0], 0.5 * (there.x - hit.position.x) / step, 1e-3, 1e-7);
                assert_near(got[1], 0.5 * (there.y - hit.position.y) / step, 1e-3, 1e-7);
            }
        }
    assert_at_most(300, n_hit);
    dif_gbuffer_free(&g);
    dif_mesh_free(&mesh);
}

/* A plane that passes under and behind the eye needs no clipping. */
static void test_draw__triangles_behind_the_eye(void **state)
{
    (void)state;
    dif_mesh mesh;
    dif_gbuffer g;
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 1, &mesh, NULL), DIF_OK);
    assert_int_equal(dif_gbuffer_create(NX, NY, &g, NULL), DIF_OK);
    dif_scene scene = scene_of(&mesh, 1.0, 0.0);
    const dif_subsample centre = dif_subsample_centre();
    scene.camera.eye = (dif_vec3){0.0, 0.0, 0.1};
    scene.camera.target = (dif_vec3){0.0, 1.0, 0.05};
    scene.camera.up = (dif_vec3){0.0, 0.0, 1.0};
    assert_int_equal(dif_raster_draw(&scene, &centre, &g, NULL), DIF_OK);
    for (int ix = 0; ix < NX; ix++) {
        dif_hit hit;
        assert_false(dif_raster_hit(&scene, &g, ix, 0, &hit));
        assert_true(dif_raster_hit(&scene, &g, ix, NY - 1, &hit));
        assert_near(hit.position.z, 0.0, 0.0, 1e-12);
    }
    scene.camera.target.y = -1.0;
    scene.camera.eye = (dif_vec3){0.0, -3.0, 0.1}; /* all of it behind */
    scene.camera.target.y = -4.0;
    assert_int_equal(dif_raster_draw(&scene, &centre, &g, NULL), DIF_OK);
    for (int i = 0; i < NX * NY; i++)
        assert_int_equal(g.triangle[i], -1);
    dif_gbuffer_free(&g);
    dif_mesh_free(&mesh);
}

/* Pixel centres lie on the diagonal of the square: no hole. */
static void test_draw__nothing_shows_through_edges(void **state)
{
    (void)state;
    dif_mesh mesh;
    dif_gbuffer g;
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 1, &mesh, NULL), DIF_OK);
    assert_int_equal(dif_gbuffer_create(64, 64, &g, NULL), DIF_OK);
    const dif_subsample centre = dif_subsample_centre();
    dif_scene scene = scene_of(&mesh, 0.9 / tan(0.3), 0.0);
    assert_int_equal(dif_raster_draw(&scene, &centre, &g, NULL), DIF_OK);
    for (int i = 0; i < 64 * 64; i++)
        assert_at_most(0, g.triangle[i]);
    dif_gbuffer_free(&g);
    dif_mesh_free(&mesh);
}

static void test_create__refuses_sizes(void **state)
{
    (void)state;
    dif_error err;
    dif_gbuffer g;
    assert_int_equal(dif_gbuffer_create(0, 4, &g, &err), DIF_ERR_SIZE);
    assert_int_equal(dif_gbuffer_create(4, DIF_FRAME_SIDE_MAX + 1, &g, &err), DIF_ERR_SIZE);
    assert_string_equal(err.text, "a picture of 4 x 8193 pixels, want 1 ... 8192 a side");
    assert_null(g.triangle);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_draw__a_ball_is_where_rays_meet_it),
        cmocka_unit_test(test_draw__jitter_follows_its_seed),
        cmocka_unit_test(test_hit__uv_and_derivatives_of_a_plane),
        cmocka_unit_test(test_draw__triangles_behind_the_eye),
        cmocka_unit_test(test_draw__nothing_shows_through_edges),
        cmocka_unit_test(test_create__refuses_sizes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
