#include "core/mesh.h"

#include <math.h>
#include <stddef.h>

#include "core/alloc.h"

static const dif_vec3 ZERO = {0.0, 0.0, 0.0};

dif_status dif_mesh_create(int n_vertex, int n_triangle, bool with_uv, dif_mesh *out, dif_error *err)
{
    *out = (dif_mesh){0};
    if (!(n_vertex >= 1 && n_vertex <= DIF_MESH_VERTEX_MAX))
        return dif_fail(err, DIF_ERR_SIZE, "a mesh of %d vertices, want 1 ... %d", n_vertex, DIF_MESH_VERTEX_MAX);
    if (!(n_triangle >= 1 && n_triangle <= DIF_MESH_TRIANGLE_MAX))
        return dif_fail(err, DIF_ERR_SIZE, "a mesh of %d triangles, want 1 ... %d", n_triangle, DIF_MESH_TRIANGLE_MAX);
    const size_t n = (size_t)n_vertex;
    out->n_vertex = n_vertex;
    out->n_triangle = n_triangle;
    out->position = dif_alloc(n, sizeof *out->position);
    out->normal = dif_alloc(n, sizeof *out->normal);
    out->tangent = dif_alloc(n, sizeof *out->tangent);
    out->uv = with_uv ? dif_alloc(n, sizeof *out->uv) : NULL;
    out->triangle = dif_alloc((size_t)n_triangle, sizeof *out->triangle);
    if (out->position && out->normal && out->tangent && (!with_uv || out->uv) && out->triangle)
        return DIF_OK;
    dif_mesh_free(out);
    return dif_fail(err, DIF_ERR_NOMEM, "a mesh of %d vertices and %d triangles", n_vertex, n_triangle);
}

void dif_mesh_free(dif_mesh *mesh)
{
    dif_release(mesh->position);
    dif_release(mesh->normal);
    dif_release(mesh->tangent);
    dif_release(mesh->uv);
    dif_release(mesh->triangle);
    *mesh = (dif_mesh){0};
}

static bool is_finite(dif_vec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

static dif_status check(const dif_mesh *mesh, dif_error *err)
{
    if (mesh->n_vertex < 1 || mesh->n_triangle < 1)
        return dif_fail(err, DIF_ERR_FORMAT, "a mesh without triangles");
    for (int i = 0; i < mesh->n_vertex; i++) {
        const char *what = !is_finite(mesh->position[i])                                         ? "position"
                           : !is_finite(mesh->normal[i])                                         ? "normal"
                           : !is_finite(mesh->tangent[i])                                        ? "tangent"
                           : mesh->uv && !(isfinite(mesh->uv[i][0]) && isfinite(mesh->uv[i][1])) ? "texture coordinate"
                                                                                                 : NULL;
        if (what)
            return dif_fail(err, DIF_ERR_NONFINITE, "the %s of vertex %d is not a finite number", what, i);
    }
    for (int i = 0; i < mesh->n_triangle; i++)
        for (int c = 0; c < 3; c++)
            if (!(mesh->triangle[i][c] >= 0 && mesh->triangle[i][c] < mesh->n_vertex))
                return dif_fail(err, DIF_ERR_FORMAT, "triangle %d names vertex %d, want 0 ... %d", i,
                                mesh->triangle[i][c], mesh->n_vertex - 1);
    return DIF_OK;
}

/* The angle at corner c of a triangle, 0 if it has none. */
static double angle_at(const dif_mesh *mesh, const int triangle[3], int c)
{
    const dif_vec3 here = mesh->position[triangle[c]];
    const dif_vec3 a = dif_vec3_unit(dif_vec3_add(mesh->position[triangle[(c + 1) % 3]], -1.0, here));
    const dif_vec3 b = dif_vec3_unit(dif_vec3_add(mesh->position[triangle[(c + 2) % 3]], -1.0, here));
    const dif_vec3 across = dif_vec3_cross(a, b);
    return atan2(sqrt(dif_vec3_dot(across, across)), dif_vec3_dot(a, b));
}

static void edges_of(const dif_mesh *mesh, const int triangle[3], dif_vec3 edge[2])
{
    for (int c = 0; c < 2; c++)
        edge[c] = dif_vec3_add(mesh->position[triangle[c + 1]], -1.0, mesh->position[triangle[0]]);
}

/* Direction of rising uv[0] in a triangle; zero where uv is missing or does not change. */
static dif_vec3 along_u(const dif_mesh *mesh, const int triangle[3])
{
    dif_vec3 edge[2];
    if (!mesh->uv)
        return ZERO;
    const double *uv0 = mesh->uv[triangle[0]], *uv1 = mesh->uv[triangle[1]], *uv2 = mesh->uv[triangle[2]];
    const double v1 = uv1[1] - uv0[1], v2 = uv2[1] - uv0[1];
    const double area = (uv1[0] - uv0[0]) * v2 - (uv2[0] - uv0[0]) * v1;
    if (area == 0.0)
        return ZERO;
    edges_of(mesh, triangle, edge);
    const dif_vec3 along = dif_vec3_add(dif_vec3_add(ZERO, v2, edge[0]), -v1, edge[1]);
    return dif_vec3_unit(dif_vec3_add(ZERO, area > 0.0 ? 1.0 : -1.0, along));
}

/* The part of a vector across a unit normal, of length 1; zero if there is next to none. */
static dif_vec3 across_normal(dif_vec3 v, dif_vec3 normal)
{
    const dif_vec3 across = dif_vec3_add(v, -dif_vec3_dot(v, normal), normal);
    return dif_vec3_dot(across, across) > 1e-12 * dif_vec3_dot(v, v) ? dif_vec3_unit(across) : ZERO;
}

/* Where texture coordinates do not say. */
static dif_vec3 combed(dif_vec3 normal)
{
    static const dif_vec3 x = {1.0, 0.0, 0.0}, y = {0.0, 1.0, 0.0};
    return across_normal(fabs(normal.x) < 0.9 ? x : y, normal);
}

static bool is_zero(dif_vec3 a)
{
    return a.x == 0.0 && a.y == 0.0 && a.z == 0.0;
}

/* Adds what triangles say to vertices that lack it. */
static void gather(const dif_mesh *mesh, dif_vec3 *normal, dif_vec3 *tangent)
{
    for (int i = 0; i < mesh->n_triangle; i++) {
        const int *triangle = mesh->triangle[i];
        dif_vec3 edge[2];
        edges_of(mesh, triangle, edge);
        const dif_vec3 face = dif_vec3_unit(dif_vec3_cross(edge[0], edge[1])), along = along_u(mesh, triangle);
        for (int c = 0; c < 3; c++) {
            const int at = triangle[c];
            const double angle = angle_at(mesh, triangle, c);
            normal[at] = dif_vec3_add(normal[at], angle, face);
            tangent[at] = dif_vec3_add(tangent[at], angle, along);
        }
    }
}

dif_status dif_mesh_complete(dif_mesh *mesh, dif_error *err)
{
    const size_t n = (size_t)(mesh->n_vertex > 0 ? mesh->n_vertex : 0);
    dif_status status = check(mesh, err);
    if (status)
        return status;
    dif_vec3 *normal = dif_alloc(n, sizeof *normal), *tangent = dif_alloc(n, sizeof *tangent);
    if (normal && tangent) {
        gather(mesh, normal, tangent);
        for (size_t i = 0; i < n; i++) {
            dif_vec3 up = dif_vec3_unit(is_zero(mesh->normal[i]) ? normal[i] : mesh->normal[i]);
            up = is_zero(up) ? (dif_vec3){0.0, 0.0, 1.0} : up;
            dif_vec3 along = across_normal(is_zero(mesh->tangent[i]) ? tangent[i] : mesh->tangent[i], up);
            mesh->normal[i] = up;
            mesh->tangent[i] = is_zero(along) ? combed(up) : along;
        }
    } else {
        status = dif_fail(err, DIF_ERR_NOMEM, "normals and tangents of %zu vertices", n);
    }
    dif_release(normal);
    dif_release(tangent);
    return status;
}

void dif_mesh_bounds(const dif_mesh *mesh, dif_vec3 *centre, double *radius)
{
    dif_vec3 low = mesh->position[0], high = low;
    for (int i = 1; i < mesh->n_vertex; i++) {
        const dif_vec3 p = mesh->position[i];
        low = (dif_vec3){fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z)};
        high = (dif_vec3){fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z)};
    }
    *centre = (dif_vec3){0.5 * (low.x + high.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z)};
    *radius = 0.0;
    for (int i = 0; i < mesh->n_vertex; i++) {
        const dif_vec3 d = dif_vec3_add(mesh->position[i], -1.0, *centre);
        *radius = fmax(*radius, sqrt(dif_vec3_dot(d, d)));
    }
}
