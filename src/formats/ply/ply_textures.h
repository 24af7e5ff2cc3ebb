#pragma once

// Textures of PLY files, which the format's author did not foresee: MeshLab, and photogrammetry after it, name them in
// comments `TextureFile NAME` of the header. Texture coordinates are properties of vertices, or a list `texcoord` of
// two numbers for each corner of a face; a face's `texnumber` says which texture it has.

#include <cstdint>
#include <string>
#include <vector>

#include "base/messages.h"
#include "formats/files/load_textures.h"
#include "formats/ply/ply_header.h"
#include "math/vec2.h"
#include "scene/scene.h"

namespace pertev {

inline constexpr int32_t kNoPlyTexture = -1;

/// What a file says of its faces' textures.
struct PlyFaceTextures {
    std::vector<Vec2> uvs;         // of all corners of faces, one face after the other, v downwards; or empty
    std::vector<int32_t> textures; // of faces: an index into PlyHeader::textures, or kNoPlyTexture; or empty: all 0
};

/// Gives `mesh` a vertex for each different pair of a vertex and a texture coordinate, and `corners`, of its faces,
/// their numbers.
void split_vertices(const std::vector<Vec2>& uvs, std::vector<uint32_t>& corners, Mesh& mesh);

/// The scene of a PLY file: `mesh`, whose faces had `sizes` corners before they were cut into triangles, by texture,
/// each with its own material. Vertex colours count where there is no texture.
Scene make_ply_scene(Mesh mesh, const std::vector<uint32_t>& sizes, const PlyFaceTextures& of_faces,
                     const PlyHeader& header, const std::string& file, TextureLoader& loader, Messages& messages);

} // namespace pertev
