/* Triangle meshes that wear a surface: positions, shading normals, tangents, texture coordinates.
 * Does not: open files (core/io/obj_tiny.h), place a camera (core/scene.h). */
#ifndef DIF_MESH_H
#define DIF_MESH_H

#include <stdbool.h>

#include "core/status.h"
#include "core/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_MESH_VERTEX_MAX = 50 * 1000 * 1000, DIF_MESH_TRIANGLE_MAX = 50 * 1000 * 1000 };

/* Triangles run counter-clockwise seen from outside. The tangent is the x axis of the surface patch on the mesh, along
 * rising uv[0]; the patch's y axis is normal x tangent always: a measured surface is never mirrored, whatever uv does. */
typedef struct dif_mesh {
    int n_vertex, n_triangle;
    dif_vec3 *position; /* position[n_vertex], any unit of length, finite; owned, as all below            */
    dif_vec3 *normal;   /* normal[n_vertex], unit; zero = missing                                         */
    dif_vec3 *tangent;  /* tangent[n_vertex], unit, across the normal; zero = missing                     */
    double (*uv)[2];    /* uv[n_vertex], or NULL: the mesh has none                                       */
    int (*triangle)[3]; /* triangle[n_triangle], vertex numbers                                           */
} dif_mesh;

/* A mesh of zeros. Status DIF_ERR_SIZE, DIF_ERR_NOMEM; *out zeroed on failure. */
DIF_MUST_USE dif_status dif_mesh_create(int n_vertex, int n_triangle, bool with_uv, dif_mesh *out, dif_error *err);
void dif_mesh_free(dif_mesh *mesh);

/* Checks a mesh and makes what is missing.
 *   normals    mean of the triangles around, weighted by their angles at the vertex; z where there is none
 *   tangents   along rising uv[0], mean of the triangles around; without texture coordinates, or where these do not
 *              change, the mesh's x axis laid into the tangent plane (its y axis where the normal lies within 26 degrees
 *              of x)
 * Every normal is brought to length 1, every tangent to length 1 and across its normal.
 *
 * Status    DIF_ERR_NONFINITE (the vertex, and what of it), DIF_ERR_FORMAT (no triangle, a vertex number out of range),
 *           DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_mesh_complete(dif_mesh *mesh, dif_error *err);

/* Centre of the bounding box and the largest distance of a vertex from it. */
void dif_mesh_bounds(const dif_mesh *mesh, dif_vec3 *centre, double *radius);

#ifdef __cplusplus
}
#endif
#endif
