#include "formats/ply/ply_textures.h"

#include <algorithm>
#include <bit>
#include <utility>

#include <fmt/format.h>

#include "base/key_numbers.h"
#include "base/message_text.h"
#include "formats/gltf/uri.h"
#include "formats/mesh/vertex_key.h"

namespace pertev {
namespace {

/// Returns the values of `from` at `selected`; none if `from` is empty.
template <class T>
std::vector<T> gathered(const std::vector<T>& from, const std::vector<uint32_t>& selected) {
    std::vector<T> to;
    if (from.empty()) return to;
    to.reserve(selected.size());
    for (const uint32_t index : selected) to.push_back(from[index]);
    return to;
}

void gather_vertices(Mesh& mesh, const std::vector<uint32_t>& selected) {
    mesh.positions = gathered(mesh.positions, selected);
    mesh.normals = gathered(mesh.normals, selected);
    mesh.colors = gathered(mesh.colors, selected);
    mesh.uv[0] = gathered(mesh.uv[0], selected);
}

struct Part {
    int32_t texture = kNoPlyTexture;
    Mesh mesh;
};

/// Returns the triangles of one texture, with the vertices that they use.
Mesh part_of(const Mesh& mesh, const std::vector<int32_t>& of_triangles, int32_t texture) {
    Mesh part = mesh;
    part.indices.clear();
    std::vector<uint32_t> selected, vertices(mesh.positions.size(), 0xffffffffu);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        if (of_triangles[i / 3] != texture) continue;
        uint32_t& vertex = vertices[mesh.indices[i]];
        if (vertex == 0xffffffffu) {
            vertex = static_cast<uint32_t>(selected.size());
            selected.push_back(mesh.indices[i]);
        }
        part.indices.push_back(vertex);
    }
    gather_vertices(part, selected);
    return part;
}

/// Splits a mesh by texture, in the order of the header; triangles without a texture are the last part.
std::vector<Part> split_by_texture(Mesh mesh, const std::vector<uint32_t>& sizes, const std::vector<int32_t>& of_faces,
                                   std::size_t textures) {
    std::vector<Part> parts;
    if (of_faces.empty() || std::ranges::all_of(of_faces, [&](int32_t t) { return t == of_faces.front(); })) {
        parts.push_back({of_faces.empty() ? 0 : of_faces.front(), std::move(mesh)});
        return parts;
    }
    std::vector<int32_t> of_triangles;
    std::vector<bool> used(textures + 1);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        of_triangles.insert(of_triangles.end(), sizes[i] - 2, of_faces[i]);
        used[of_faces[i] == kNoPlyTexture ? textures : static_cast<std::size_t>(of_faces[i])] = true;
    }
    for (std::size_t i = 0; i <= textures; ++i) {
        const int32_t texture = i == textures ? kNoPlyTexture : static_cast<int32_t>(i);
        if (used[i]) parts.push_back({texture, part_of(mesh, of_triangles, texture)});
    }
    return parts;
}

} // namespace

void split_vertices(const std::vector<Vec2>& uvs, std::vector<uint32_t>& corners, Mesh& mesh) {
    KeyNumbers<VertexKey> table(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        corners[i] =
            table.number_of({corners[i], std::bit_cast<uint32_t>(uvs[i].x), std::bit_cast<uint32_t>(uvs[i].y)});
    }
    std::vector<uint32_t> selected;
    std::vector<Vec2> uv;
    for (const VertexKey& vertex : table.keys()) {
        selected.push_back(vertex.position);
        uv.push_back({std::bit_cast<float>(vertex.uv), std::bit_cast<float>(vertex.normal)});
    }
    mesh.uv[0].clear();
    gather_vertices(mesh, selected);
    mesh.uv[0] = std::move(uv);
}

Scene make_ply_scene(Mesh mesh, const std::vector<uint32_t>& sizes, const PlyFaceTextures& of_faces,
                     const PlyHeader& header, const std::string& file, TextureLoader& loader, Sink& sink) {
    Scene scene;
    const std::string name = mesh.name;
    const bool has_uv = !mesh.uv[0].empty();
    if (!header.textures.empty() && !has_uv) {
        sink.leave_out({FileLocation{file, header.textures.front().line},
                        fmt::format("{} left out: neither vertices nor faces have texture coordinates",
                                    counted(header.textures.size(), "texture"))});
    }
    for (Part& part : split_by_texture(std::move(mesh), sizes, of_faces.textures, header.textures.size())) {
        Material& material = scene.materials.emplace_back();
        material.name = name;
        if (has_uv && part.texture != kNoPlyTexture && !header.textures.empty()) {
            const PlyTexture& texture = header.textures[static_cast<std::size_t>(part.texture)];
            if (header.textures.size() > 1) material.name = fmt::format("{} {}", name, texture.name);
            material.base_color_texture.image =
                loader.add_file(FileLocation{file, texture.line}, gltf::plain_file_name(texture.name));
            material.base_color_texture.is_srgb = true;
        }
        const auto number = static_cast<uint32_t>(scene.meshes.size());
        scene.meshes.push_back(std::move(part.mesh));
        scene.instances.push_back({.name = name, .mesh = number, .material = number, .world_from_local = {}});
    }
    loader.load_into(scene);
    bool has_colors_beside = false;
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        Material& material = scene.materials[i];
        std::vector<Vec4>& colors = scene.meshes[i].colors;
        if (!colors.empty() || material.base_color_texture.has_image()) material.base_color = grey(1);
        if (!material.base_color_texture.has_image() || colors.empty()) continue;
        colors.clear();
        has_colors_beside = true;
    }
    if (has_colors_beside) {
        sink.leave_out({FileLocation{file}, "vertex colours are left out, because a texture defines the colour"});
    }
    return scene;
}

} // namespace pertev
