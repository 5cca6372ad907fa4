/* A mesh as vertex and index buffers. */
#include <string.h>

#include "core/alloc.h"
#include "gpu/gpu_render_impl.h"

enum { FLOATS = 11 }; /* position, normal, tangent, uv */

static void put_vec3(float *out, dif_vec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static void attribute(GLuint index, GLint n, size_t first)
{
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, n, GL_FLOAT, GL_FALSE, FLOATS * (GLsizei)sizeof(float),
                          (const void *)(first * sizeof(float))); /* an offset into the buffer */
}

static void fill_vertices(const dif_mesh *mesh, float *out)
{
    for (int i = 0; i < mesh->n_vertex; i++) {
        float *at = out + (size_t)FLOATS * (size_t)i;
        put_vec3(at, mesh->position[i]);
        put_vec3(at + 3, mesh->normal[i]);
        put_vec3(at + 6, mesh->tangent[i]);
        for (int c = 0; c < 2; c++)
            at[9 + c] = mesh->uv ? (float)mesh->uv[i][c] : 0.0f;
    }
}

dif_status dif_gl_mesh_create(dif_gpu *gpu, const dif_mesh *mesh, dif_gl_mesh *out, dif_error *err)
{
    const size_t n_float = (size_t)FLOATS * (size_t)mesh->n_vertex;
    *out = (dif_gl_mesh){0};
    float *vertices = dif_alloc(n_float, sizeof *vertices);
    if (!vertices)
        return dif_fail(err, DIF_ERR_NOMEM, "%d vertices", mesh->n_vertex);
    fill_vertices(mesh, vertices);
    glGenVertexArrays(1, &out->array);
    glGenBuffers(1, &out->vertices);
    glGenBuffers(1, &out->indices);
    gpu->n_live += 3;
    glBindVertexArray(out->array);
    glBindBuffer(GL_ARRAY_BUFFER, out->vertices);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(n_float * sizeof *vertices), vertices, GL_STATIC_DRAW);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, out->indices);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)((size_t)mesh->n_triangle * sizeof *mesh->triangle),
                 mesh->triangle, GL_STATIC_DRAW);
    attribute(0, 3, 0);
    attribute(1, 3, 3);
    attribute(2, 3, 6);
    attribute(3, 2, 9);
    glBindVertexArray(0);
    out->n_index = 3 * mesh->n_triangle;
    dif_release(vertices);
    const dif_status status = dif_gpu_check(gpu, "loading a mesh", err);
    if (status != DIF_OK)
        dif_gl_mesh_delete(gpu, out);
    return status;
}

void dif_gl_mesh_delete(dif_gpu *gpu, dif_gl_mesh *mesh)
{
    if (!mesh->array)
        return;
    glDeleteVertexArrays(1, &mesh->array);
    glDeleteBuffers(1, &mesh->vertices);
    glDeleteBuffers(1, &mesh->indices);
    gpu->n_live -= 3;
    *mesh = (dif_gl_mesh){0};
}
