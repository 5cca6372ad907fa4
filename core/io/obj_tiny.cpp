#include "core/io/obj_tiny.h"

#include <climits>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include <tiny_obj_loader.h>

#include "core/alloc.h"
#include "core/guard.hpp"

extern "C" {
#include "core/io/file.h"
}

namespace
{

const size_t FILE_MAX = static_cast<size_t>(1) << 31;

// A corner as the loader gives it: which position, normal and texture coordinate, -1 = none.
struct Corner {
    int v, n, t;
    bool operator==(const Corner &o) const
    {
        return v == o.v && n == o.n && t == o.t;
    }
};

struct CornerHash {
    size_t operator()(const Corner &c) const
    {
        uint64_t z = static_cast<uint32_t>(c.v) * 0x9e3779b97f4a7c15u +
                     static_cast<uint32_t>(c.n) * 0xbf58476d1ce4e5b9u +
                     static_cast<uint32_t>(c.t) * 0x94d049bb133111ebu;
        return static_cast<size_t>(z ^ (z >> 29));
    }
};

// Vertices by first appearance, and the triangles' numbers of them.
struct Welded {
    std::vector<Corner> vertex;
    std::vector<int> number; // number[3 * triangles]
};

Welded weld(const std::vector<tinyobj::shape_t> &shapes)
{
    std::unordered_map<Corner, int, CornerHash> seen;
    Welded welded;
    for (const tinyobj::shape_t &shape : shapes)
        for (const tinyobj::index_t &index : shape.mesh.indices) {
            const Corner corner = {index.vertex_index, index.normal_index, index.texcoord_index};
            const auto found = seen.emplace(corner, static_cast<int>(welded.vertex.size()));
            if (found.second)
                welded.vertex.push_back(corner);
            welded.number.push_back(found.first->second);
        }
    return welded;
}

dif_vec3 triple(const std::vector<double> &list, int at)
{
    const size_t i = 3 * static_cast<size_t>(at);
    return {list[i], list[i + 1], list[i + 2]};
}

struct MeshGuard {
    dif_mesh mesh = {};
    ~MeshGuard()
    {
        dif_mesh_free(&mesh);
    }
};

// Normals of positions, whatever seams the texture coordinates have.
dif_status make_normals(const tinyobj::attrib_t &attrib, const Welded &welded, MeshGuard &smooth, dif_error *err)
{
    const int n_triangle = static_cast<int>(welded.number.size() / 3);
    const dif_status status =
        dif_mesh_create(static_cast<int>(attrib.vertices.size() / 3), n_triangle, false, &smooth.mesh, err);
    if (status)
        return status;
    for (int i = 0; i < smooth.mesh.n_vertex; i++)
        smooth.mesh.position[i] = triple(attrib.vertices, i);
    for (size_t i = 0; i < welded.number.size(); i++)
        smooth.mesh.triangle[i / 3][i % 3] = welded.vertex[static_cast<size_t>(welded.number[i])].v;
    return dif_mesh_complete(&smooth.mesh, err);
}

dif_status fill(const tinyobj::attrib_t &attrib, const Welded &welded, dif_mesh *out, dif_error *err)
{
    MeshGuard smooth;
    bool lacks_normal = false;
    for (const Corner &corner : welded.vertex)
        lacks_normal = lacks_normal || corner.n < 0;
    if (lacks_normal) {
        const dif_status status = make_normals(attrib, welded, smooth, err);
        if (status)
            return status;
    }
    for (size_t i = 0; i < welded.vertex.size(); i++) {
        const Corner &corner = welded.vertex[i];
        out->position[i] = triple(attrib.vertices, corner.v);
        out->normal[i] = corner.n < 0 ? smooth.mesh.normal[corner.v] : triple(attrib.normals, corner.n);
        for (size_t c = 0; c < 2 && out->uv && corner.t >= 0; c++)
            out->uv[i][c] = attrib.texcoords[2 * static_cast<size_t>(corner.t) + c];
    }
    for (size_t i = 0; i < welded.number.size(); i++)
        out->triangle[i / 3][i % 3] = welded.number[i];
    return dif_mesh_complete(out, err);
}

dif_status take(const tinyobj::ObjReader &reader, const char *name, dif_mesh *out, dif_error *err)
{
    const Welded welded = weld(reader.GetShapes());
    bool has_uv = false;
    for (const Corner &corner : welded.vertex)
        has_uv = has_uv || corner.t >= 0;
    if (welded.number.size() < 3)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: no face has an area", name);
    dif_status status = dif_mesh_create(static_cast<int>(welded.vertex.size()),
                                        static_cast<int>(welded.number.size() / 3), has_uv, out, err);
    if (!status)
        status = fill(reader.GetAttrib(), welded, out, err);
    if (status)
        dif_mesh_free(out);
    return status;
}

} // namespace

dif_status dif_obj_parse(const unsigned char *data, size_t n, const char *name, dif_mesh *out, dif_error *err)
{
    *out = dif_mesh{};
    return dif_guard(err, [&] {
        char *text = nullptr;
        size_t n_text = 0, n_triangle = 0;
        const dif_status status = dif_obj_clean(data, n, name, &text, &n_text, &n_triangle, err);
        if (status)
            return status;
        const std::unique_ptr<char, void (*)(void *)> keep(text, [](void *block) { dif_release(block); });
        tinyobj::ObjReader reader;
        tinyobj::ObjReaderConfig config;
        config.vertex_color = false;
        if (!reader.ParseFromString(std::string(text, n_text), std::string(), config))
            return dif_fail(err, DIF_ERR_FORMAT, "%s: %s", name, reader.Error().c_str());
        return take(reader, name, out, err);
    });
}

dif_status dif_obj_read(const char *path, dif_mesh *out, dif_error *err)
{
    unsigned char *data = nullptr;
    size_t n = 0;
    *out = dif_mesh{};
    dif_status status = dif_file_read(path, FILE_MAX, &data, &n, err);
    if (!status)
        status = dif_obj_parse(data, n, path, out, err);
    dif_release(data);
    return status;
}
