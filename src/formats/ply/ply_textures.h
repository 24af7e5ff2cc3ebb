#pragma once

// Textures of PLY files, which are not part of the format: MeshLab, and photogrammetry programs after it, name them
// in header comments `TextureFile NAME`. Texture coordinates are properties of vertices, or a list `texcoord` of two
// numbers for each corner of a face; a face's `texnumber` is the index of its texture.

#include <cstdint>
#include <string>
#include <vector>

#include "base/sink.h"
#include "formats/files/load_textures.h"
#include "formats/ply/ply_header.h"
#include "math/vec2.h"
#include "scene/scene.h"

namespace pertev {

inline constexpr int32_t kNoPlyTexture = -1;

/// Textures of a file's faces.
struct PlyFaceTextures {
    std::vector<Vec2> uvs;         // [corner of faces, one face after the other], v downwards; or empty
    std::vector<int32_t> textures; // [face] index into PlyHeader::textures, or kNoPlyTexture; or empty: all 0
};

/// Makes a vertex of `mesh` for each different pair of a vertex and a texture coordinate, and renumbers `corners`,
/// which are those of its faces.
void split_vertices(const std::vector<Vec2>& uvs, std::vector<uint32_t>& corners, Mesh& mesh);

/// Makes the scene of a PLY file from `mesh`, whose faces had `sizes` corners before triangulation: a mesh for each
/// texture, with its own material. Vertex colours apply where there is no texture.
Scene make_ply_scene(Mesh mesh, const std::vector<uint32_t>& sizes, const PlyFaceTextures& of_faces,
                     const PlyHeader& header, const std::string& file, TextureLoader& loader, Sink& sink);

} // namespace pertev
