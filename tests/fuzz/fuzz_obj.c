/* OBJ meshes. What was read is a mesh that can be drawn. */
#include "core/io/obj_tiny.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    dif_error err = {0};
    dif_mesh mesh;
    const dif_status status = dif_obj_parse(data, n, "input", &mesh, &err);
    FUZZ_PROMISE(status == err.status || status == DIF_OK);
    if (status) {
        FUZZ_PROMISE(!mesh.position && mesh.n_vertex == 0);
        FUZZ_PROMISE(err.text[0]);
        return 0;
    }
    FUZZ_PROMISE(mesh.n_triangle >= 1);
    for (int i = 0; i < mesh.n_vertex; i++)
        FUZZ_PROMISE(fabs(dif_vec3_dot(mesh.normal[i], mesh.normal[i]) - 1.0) < 1e-6 &&
                     fabs(dif_vec3_dot(mesh.normal[i], mesh.tangent[i])) < 1e-6);
    FUZZ_PROMISE(dif_mesh_complete(&mesh, &err) == DIF_OK);
    dif_mesh_free(&mesh);
    return 0;
}
