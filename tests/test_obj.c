/* core/io/obj_tiny, obj_clean: meshes as text. */
#include "core/io/obj_tiny.h"

#include <string.h>

#include "tests/alloc_count.h"
#include "tests/near.h"

static dif_status parse(const char *text, dif_mesh *mesh, dif_error *err)
{
    return dif_obj_parse((const unsigned char *)text, strlen(text), "m.obj", mesh, err);
}

static void test_parse__a_square_becomes_two_triangles(void **state)
{
    (void)state;
    dif_mesh mesh;
    assert_int_equal(
        parse("# a square\r\no x\r\nv 0 0 0\nv 2 0 0 1.0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
              "vn 0 0 2\nusemtl none\nf 1/1/1 2/2/1 3/3/1 4/4/1\n",
              &mesh, NULL),
        DIF_OK);
    assert_int_equal(mesh.n_triangle, 2);
    assert_int_equal(mesh.n_vertex, 4);
    for (int i = 0; i < 4; i++) {
        assert_near(mesh.normal[i].z, 1.0, 0.0, 0.0);
        assert_near(mesh.tangent[i].x, 1.0, 1e-15, 0.0);
        assert_near(mesh.uv[i][0], 0.5 * mesh.position[i].x, 0.0, 0.0);
    }
    dif_mesh_free(&mesh);
}

static void test_parse__negative_indices_count_from_the_end(void **state)
{
    (void)state;
    dif_mesh mesh;
    assert_int_equal(parse("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\n", &mesh, NULL), DIF_OK);
    assert_int_equal(mesh.n_vertex, 3);
    assert_null(mesh.uv);
    assert_near(mesh.position[1].x, 1.0, 0.0, 0.0);
    assert_near(mesh.normal[0].z, 1.0, 1e-15, 0.0);
    dif_mesh_free(&mesh);
}

/* Two faces at a right angle; a seam of the texture runs along their common edge. */
static void test_parse__made_normals_are_smooth_across_seams(void **state)
{
    (void)state;
    dif_mesh mesh;
    assert_int_equal(parse("v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 0 0 -1\nv 0 1 -1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                           "f 1/1 3/2 4/3 2/4\nf 1/2 2/3 6/4 5/1\n",
                           &mesh, NULL),
                     DIF_OK);
    assert_int_equal(mesh.n_vertex, 8);
    int n_edge = 0;
    for (int i = 0; i < mesh.n_vertex; i++)
        if (mesh.position[i].x == 0.0 && mesh.position[i].z == 0.0) {
            assert_near(mesh.normal[i].x, -sqrt(0.5), 1e-12, 0.0);
            assert_near(mesh.normal[i].z, sqrt(0.5), 1e-12, 0.0);
            n_edge++;
        }
    assert_int_equal(n_edge, 4);
    dif_mesh_free(&mesh);
}

static void test_parse__polygons_keep_their_area(void **state)
{
    (void)state;
    dif_mesh mesh;
    /* an arrow head: not convex */
    assert_int_equal(parse("v 0 0 0\nv 4 -2 0\nv 2 0 0\nv 4 2 0\nv 0 1 0\nf 1 2 3 4 5\n", &mesh, NULL), DIF_OK);
    double area = 0.0;
    for (int i = 0; i < mesh.n_triangle; i++) {
        const int *t = mesh.triangle[i];
        area += 0.5 * dif_vec3_cross(dif_vec3_add(mesh.position[t[1]], -1.0, mesh.position[t[0]]),
                                     dif_vec3_add(mesh.position[t[2]], -1.0, mesh.position[t[0]]))
                          .z;
    }
    assert_near(area, 6.0, 1e-12, 0.0); /* shoelace formula */
    dif_mesh_free(&mesh);
}

static void check_refusal(const char *text, dif_status status, const char *want)
{
    dif_error err = {0};
    dif_mesh mesh;
    assert_int_equal(parse(text, &mesh, &err), status);
    assert_string_equal(err.text, want);
    assert_null(mesh.position);
    assert_int_equal(mesh.n_vertex, 0);
}

static void test_parse__refuses_with_the_line(void **state)
{
    (void)state;
#define V3 "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    check_refusal("", DIF_ERR_FORMAT, "m.obj: no faces, want an OBJ mesh of v and f lines");
    check_refusal("\x89PNG\r\n", DIF_ERR_FORMAT, "m.obj: no faces, want an OBJ mesh of v and f lines");
    check_refusal(V3 "vn 0 nan 1\nf 1 2 3\n", DIF_ERR_NONFINITE, "m.obj: line 4: a normal of nan, want finite numbers");
    check_refusal("v 0 inf 1\nf 1 1 1\n", DIF_ERR_NONFINITE, "m.obj: line 1: a vertex of inf, want finite numbers");
    check_refusal("v 0 1e99 1\nf 1 1 1\n", DIF_ERR_NONFINITE, "m.obj: line 1: a vertex of 1e+99, want finite numbers");
    check_refusal("v 0 1\nf 1 1 1\n", DIF_ERR_FORMAT, "m.obj: line 1: a v line of 2 numbers, want 3");
    check_refusal("v 0 1 x\nf 1 1 1\n", DIF_ERR_FORMAT, "m.obj: line 1: a v line with something that is no number");
    check_refusal(V3 "f 1 2\n", DIF_ERR_FORMAT, "m.obj: line 4: a face of 2 corners, want 3");
    check_refusal(V3 "f 1 2 4\n", DIF_ERR_FORMAT, "m.obj: line 4: a face names a vertex that is not there");
    check_refusal(V3 "f 1 2 -4\n", DIF_ERR_FORMAT, "m.obj: line 4: a face names a vertex that is not there");
    check_refusal(V3 "f 1 2 0\n", DIF_ERR_FORMAT, "m.obj: line 4: a face names a vertex that is not there");
    check_refusal(V3 "f 1/1 2/1 3/1\n", DIF_ERR_FORMAT,
                  "m.obj: line 4: a face names a texture coordinate that is not there");
    check_refusal(V3 "f 1//9 2 3\n", DIF_ERR_FORMAT, "m.obj: line 4: a face names a normal that is not there");
    check_refusal(V3 "f 1x 2 3\n", DIF_ERR_FORMAT, "m.obj: line 4: a corner of a face that is no v/vt/vn");
    check_refusal(V3 "f 1 2 \\\n3\n", DIF_ERR_UNSUPPORTED, "m.obj: line 4 goes on in the next one, want whole lines");
#undef V3
}

static void test_parse__gives_everything_back(void **state)
{
    (void)state;
    static const char TEXT[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const int live = test_alloc_live();
    int n_failed = 0;
    for (int k = 1; k < 30; k++) {
        dif_mesh mesh;
        test_alloc_fail_from(k);
        const dif_status status = parse(TEXT, &mesh, NULL);
        test_alloc_fail_from(0);
        n_failed += status == DIF_ERR_NOMEM;
        assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
        dif_mesh_free(&mesh);
        assert_int_equal(test_alloc_live(), live);
    }
    assert_at_most(5, n_failed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parse__a_square_becomes_two_triangles),
        cmocka_unit_test(test_parse__negative_indices_count_from_the_end),
        cmocka_unit_test(test_parse__made_normals_are_smooth_across_seams),
        cmocka_unit_test(test_parse__polygons_keep_their_area),
        cmocka_unit_test(test_parse__refuses_with_the_line),
        cmocka_unit_test(test_parse__gives_everything_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
