/* fixtures/meshes: closed forms of the simple ones, invariants of all. */
#include "fixtures/meshes.h"

#include "core/units.h"
#include "tests/near.h"

static const dif_mesh_kind ALL[] = {DIF_MESH_PLANE, DIF_MESH_DISC, DIF_MESH_CYLINDER, DIF_MESH_SPHERE, DIF_MESH_SNAKE};
enum { N_ALL = sizeof ALL / sizeof *ALL };

static dif_vec3 face_of(const dif_mesh *mesh, int i)
{
    const int *t = mesh->triangle[i];
    return dif_vec3_cross(dif_vec3_add(mesh->position[t[1]], -1.0, mesh->position[t[0]]),
                          dif_vec3_add(mesh->position[t[2]], -1.0, mesh->position[t[0]]));
}

static double area_of(const dif_mesh *mesh)
{
    double sum = 0.0;
    for (int i = 0; i < mesh->n_triangle; i++) {
        const dif_vec3 face = face_of(mesh, i);
        sum += 0.5 * sqrt(dif_vec3_dot(face, face));
    }
    return sum;
}

static void test_make__frames_are_orthonormal_and_faces_look_outwards(void **state)
{
    (void)state;
    for (int k = 0; k < N_ALL; k++) {
        dif_mesh mesh;
        assert_int_equal(dif_mesh_make(ALL[k], 1, &mesh, NULL), DIF_OK);
        assert_non_null(mesh.uv);
        for (int i = 0; i < mesh.n_vertex; i++) {
            assert_near(dif_vec3_dot(mesh.normal[i], mesh.normal[i]), 1.0, 1e-12, 0.0);
            assert_near(dif_vec3_dot(mesh.tangent[i], mesh.tangent[i]), 1.0, 1e-12, 0.0);
            assert_near(dif_vec3_dot(mesh.normal[i], mesh.tangent[i]), 0.0, 0.0, 1e-12);
        }
        for (int i = 0; i < mesh.n_triangle; i++) {
            const dif_vec3 face = face_of(&mesh, i);
            const double size = sqrt(dif_vec3_dot(face, face));
            for (int c = 0; c < 3 && size > 1e-9; c++) /* the ends of snake and sphere have triangles without area */
                assert_at_most(0.3 * size, dif_vec3_dot(face, mesh.normal[mesh.triangle[i][c]]));
        }
        dif_mesh_free(&mesh);
    }
}

static void test_make__areas_are_those_of_the_shapes(void **state)
{
    (void)state;
    /* of inscribed polygons: below by a share of (step angle)^2 / 6 */
    const double area[] = {4.0, DIF_PI * (1.0 - 0.38 * 0.38), DIF_TWO_PI, 4.0 * DIF_PI};
    for (int k = 0; k < 4; k++) {
        dif_mesh mesh;
        assert_int_equal(dif_mesh_make(ALL[k], 4, &mesh, NULL), DIF_OK);
        assert_near(area_of(&mesh), area[k], 2e-3, 0.0);
        dif_mesh_free(&mesh);
    }
}

static void test_make__tangents_follow_u(void **state)
{
    (void)state;
    for (int k = 0; k < N_ALL; k++) {
        dif_mesh mesh;
        int n_seen = 0;
        assert_int_equal(dif_mesh_make(ALL[k], 2, &mesh, NULL), DIF_OK);
        for (int i = 0; i < mesh.n_triangle; i++) {
            const int *t = mesh.triangle[i];
            for (int c = 0; c < 3; c++) {
                const int a = t[c], b = t[(c + 1) % 3];
                const double du = mesh.uv[b][0] - mesh.uv[a][0], dv = mesh.uv[b][1] - mesh.uv[a][1];
                const dif_vec3 step = dif_vec3_add(mesh.position[b], -1.0, mesh.position[a]);
                const double length = sqrt(dif_vec3_dot(step, step));
                if (!(dv == 0.0 && length > 1e-3))
                    continue;
                assert_at_most(0.9 * length, dif_vec3_dot(step, mesh.tangent[a]) * (du > 0.0 ? 1.0 : -1.0));
                n_seen++;
            }
        }
        assert_at_most(2, n_seen);
        dif_mesh_free(&mesh);
    }
}

static void test_make__snake_lies_on_the_ground_and_ends_in_points(void **state)
{
    (void)state;
    dif_mesh mesh;
    double low = 1.0, high = 0.0;
    assert_int_equal(dif_mesh_make(DIF_MESH_SNAKE, 1, &mesh, NULL), DIF_OK);
    for (int i = 0; i < mesh.n_vertex; i++) {
        low = fmin(low, mesh.position[i].z);
        high = fmax(high, mesh.position[i].z);
        assert_at_most(hypot(mesh.position[i].x, mesh.position[i].y), 1.1);
    }
    assert_near(low, 0.0, 0.0, 5e-3);
    assert_at_most(0.3, high);
    const dif_vec3 first = mesh.position[0], around = mesh.position[641 * 24];
    assert_near(first.x, around.x, 0.0, 1e-12);
    assert_near(first.z, around.z, 0.0, 1e-12);
    dif_mesh_free(&mesh);
}

static void test_make__refuses_unknown_kinds_and_details(void **state)
{
    (void)state;
    dif_error err;
    dif_mesh mesh;
    dif_mesh_kind kind;
    assert_int_equal(dif_mesh_make((dif_mesh_kind)99, 1, &mesh, &err), DIF_ERR_ARG);
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 0, &mesh, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "detail 0, want 1 ... 16");
    assert_null(mesh.position);
    for (int k = 0; k < N_ALL; k++) {
        assert_true(dif_mesh_kind_from_name(dif_mesh_kind_name(ALL[k]), &kind));
        assert_int_equal(kind, ALL[k]);
    }
    assert_false(dif_mesh_kind_from_name("torus", &kind));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_make__frames_are_orthonormal_and_faces_look_outwards),
        cmocka_unit_test(test_make__areas_are_those_of_the_shapes),
        cmocka_unit_test(test_make__tangents_follow_u),
        cmocka_unit_test(test_make__snake_lies_on_the_ground_and_ends_in_points),
        cmocka_unit_test(test_make__refuses_unknown_kinds_and_details),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
