/* Wavefront OBJ meshes, through tinyobjloader.
 * Read are v, vn, vt and f lines; polygons become triangles, missing normals and tangents are made (core/mesh.h). Other
 * lines are passed over.
 * Does not: read materials, curves, points or lines. */
#ifndef DIF_OBJ_TINY_H
#define DIF_OBJ_TINY_H

#include <stddef.h>

#include "core/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a mesh.
 *
 * Status    DIF_ERR_FORMAT (no faces, a broken line, an index out of range; with its line),
 *           DIF_ERR_NONFINITE (NaN or infinity: the line), DIF_ERR_SIZE, DIF_ERR_NOMEM, DIF_ERR_FOREIGN; read: DIF_ERR_IO.
 *           *out zeroed on failure
 * Owns      the caller frees with dif_mesh_free */
DIF_MUST_USE dif_status dif_obj_parse(const unsigned char *data, size_t n, const char *name, dif_mesh *out,
                                      dif_error *err);
DIF_MUST_USE dif_status dif_obj_read(const char *path, dif_mesh *out, dif_error *err);

/* The lines that are read, checked: text[*n_text], freed with dif_release, and the number of triangles they make. */
DIF_MUST_USE dif_status dif_obj_clean(const unsigned char *data, size_t n, const char *name, char **text,
                                      size_t *n_text, size_t *n_triangle, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
