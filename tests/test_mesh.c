/* core/mesh: what is made, what is refused. */
#include "core/mesh.h"

#include <string.h>

#include "tests/alloc_count.h"
#include "tests/near.h"

/* Two triangles of a square in the plane z = 2, uv turned by an angle against x. */
static void make_square(double turn_rad, bool with_uv, dif_mesh *mesh)
{
    static const double CORNERS[4][2] = {{0.0, 0.0}, {3.0, 0.0}, {3.0, 3.0}, {0.0, 3.0}};
    static const int TRIANGLES[2][3] = {{0, 1, 2}, {0, 2, 3}};
    assert_int_equal(dif_mesh_create(4, 2, with_uv, mesh, NULL), DIF_OK);
    for (int i = 0; i < 4; i++) {
        const double x = CORNERS[i][0], y = CORNERS[i][1];
        mesh->position[i] = (dif_vec3){x, y, 2.0};
        if (with_uv) {
            mesh->uv[i][0] = x * cos(turn_rad) + y * sin(turn_rad);
            mesh->uv[i][1] = -x * sin(turn_rad) + y * cos(turn_rad);
        }
    }
    memcpy(mesh->triangle, TRIANGLES, sizeof TRIANGLES);
}

static void test_complete__normals_and_tangents_of_a_square(void **state)
{
    (void)state;
    dif_mesh mesh;
    make_square(0.7, true, &mesh);
    assert_int_equal(dif_mesh_complete(&mesh, NULL), DIF_OK);
    for (int i = 0; i < 4; i++) {
        assert_near(mesh.normal[i].z, 1.0, 1e-15, 0.0);
        assert_near(mesh.tangent[i].x, cos(0.7), 1e-14, 0.0);
        assert_near(mesh.tangent[i].y, sin(0.7), 1e-14, 0.0);
    }
    dif_mesh_free(&mesh);
}

static void test_complete__mirrored_uv_keep_the_direction_of_u(void **state)
{
    (void)state;
    dif_mesh mesh;
    make_square(0.7, true, &mesh);
    for (int i = 0; i < 4; i++)
        mesh.uv[i][1] = -mesh.uv[i][1];
    assert_int_equal(dif_mesh_complete(&mesh, NULL), DIF_OK);
    assert_near(mesh.tangent[0].x, cos(0.7), 1e-14, 0.0);
    assert_near(mesh.tangent[0].y, sin(0.7), 1e-14, 0.0);
    dif_mesh_free(&mesh);
}

static void test_complete__without_uv_tangents_are_combed_along_x(void **state)
{
    (void)state;
    dif_mesh mesh;
    make_square(0.0, false, &mesh);
    mesh.normal[1] = (dif_vec3){5.0, 0.0, 0.1}; /* nearly along x: combed along y */
    mesh.normal[2] = (dif_vec3){1.0, 0.0, 1.0};
    assert_int_equal(dif_mesh_complete(&mesh, NULL), DIF_OK);
    assert_near(mesh.tangent[0].x, 1.0, 1e-15, 0.0);
    assert_near(mesh.tangent[1].y, 1.0, 1e-15, 0.0);
    assert_near(mesh.tangent[2].x, sqrt(0.5), 1e-14, 0.0);
    assert_near(mesh.tangent[2].z, -sqrt(0.5), 1e-14, 0.0);
    for (int i = 0; i < 4; i++) {
        assert_near(dif_vec3_dot(mesh.normal[i], mesh.normal[i]), 1.0, 1e-14, 0.0);
        assert_near(dif_vec3_dot(mesh.normal[i], mesh.tangent[i]), 0.0, 0.0, 1e-15);
    }
    dif_mesh_free(&mesh);
}

static void test_complete__degenerate_triangles_still_give_frames(void **state)
{
    (void)state;
    dif_mesh mesh;
    make_square(0.0, true, &mesh);
    for (int i = 0; i < 4; i++)
        mesh.position[i] = (dif_vec3){1.0, 1.0, 1.0};
    assert_int_equal(dif_mesh_complete(&mesh, NULL), DIF_OK);
    assert_near(mesh.normal[3].z, 1.0, 0.0, 0.0);
    assert_near(mesh.tangent[3].x, 1.0, 0.0, 0.0);
    dif_mesh_free(&mesh);
}

static void test_complete__refuses_what_cannot_be_drawn(void **state)
{
    (void)state;
    dif_error err;
    dif_mesh mesh;
    make_square(0.0, true, &mesh);
    mesh.normal[2].y = NAN;
    assert_int_equal(dif_mesh_complete(&mesh, &err), DIF_ERR_NONFINITE);
    assert_string_equal(err.text, "the normal of vertex 2 is not a finite number");
    mesh.normal[2].y = 0.0;
    mesh.position[1].x = (double)INFINITY;
    assert_int_equal(dif_mesh_complete(&mesh, &err), DIF_ERR_NONFINITE);
    assert_string_equal(err.text, "the position of vertex 1 is not a finite number");
    mesh.position[1].x = 3.0;
    mesh.uv[0][1] = NAN;
    assert_int_equal(dif_mesh_complete(&mesh, &err), DIF_ERR_NONFINITE);
    assert_string_equal(err.text, "the texture coordinate of vertex 0 is not a finite number");
    mesh.uv[0][1] = 0.0;
    mesh.triangle[1][2] = 4;
    assert_int_equal(dif_mesh_complete(&mesh, &err), DIF_ERR_FORMAT);
    assert_string_equal(err.text, "triangle 1 names vertex 4, want 0 ... 3");
    mesh.triangle[1][2] = -1;
    assert_int_equal(dif_mesh_complete(&mesh, &err), DIF_ERR_FORMAT);
    dif_mesh_free(&mesh);
    assert_int_equal(dif_mesh_create(0, 1, false, &mesh, &err), DIF_ERR_SIZE);
    assert_int_equal(dif_mesh_create(3, DIF_MESH_TRIANGLE_MAX + 1, false, &mesh, &err), DIF_ERR_SIZE);
    assert_null(mesh.position);
}

static void test_create__fails_clean_without_memory(void **state)
{
    (void)state;
    const int live = test_alloc_live();
    for (int k = 1; k <= 7; k++) {
        dif_mesh mesh;
        test_alloc_fail_from(k);
        dif_status status = dif_mesh_create(3, 1, true, &mesh, NULL);
        if (status == DIF_OK)
            status = dif_mesh_complete(&mesh, NULL);
        test_alloc_fail_from(0);
        assert_int_equal(status, DIF_ERR_NOMEM);
        dif_mesh_free(&mesh);
        assert_int_equal(test_alloc_live(), live);
    }
}

static void test_bounds__hold_every_vertex(void **state)
{
    (void)state;
    dif_mesh mesh;
    dif_vec3 centre;
    double radius;
    make_square(0.0, false, &mesh);
    dif_mesh_bounds(&mesh, &centre, &radius);
    assert_near(centre.x, 1.5, 0.0, 0.0);
    assert_near(centre.z, 2.0, 0.0, 0.0);
    assert_near(radius, 1.5 * sqrt(2.0), 1e-15, 0.0);
    dif_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_complete__normals_and_tangents_of_a_square),
        cmocka_unit_test(test_complete__mirrored_uv_keep_the_direction_of_u),
        cmocka_unit_test(test_complete__without_uv_tangents_are_combed_along_x),
        cmocka_unit_test(test_complete__degenerate_triangles_still_give_frames),
        cmocka_unit_test(test_complete__refuses_what_cannot_be_drawn),
        cmocka_unit_test(test_create__fails_clean_without_memory),
        cmocka_unit_test(test_bounds__hold_every_vertex),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
