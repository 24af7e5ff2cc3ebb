#pragma once

// Reads Mitsuba's serialized meshes, versions 3 and 4: compressed by zlib one by one, with a table of their places at
// the end of the file.
//
// Source: the description of the format in Mitsuba's documentation (plugin serialized).

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "math/double_vec3.h"
#include "scene/mesh.h"

namespace pertev::mitsuba {

struct SerializedMesh {
    Mesh mesh;                     // v of texture coordinates as in the file; without colours
    std::vector<DoubleVec3> exact; // positions in double; empty if those of the file are floats
    bool has_face_normals = false; // the file says that it is not smooth
};

/// Returns the mesh `index` in the bytes of `file`. Throws Error(BadInput) if there is none or if it is damaged, and
/// Error(OverLimit) if it decompresses to more than its size justifies.
SerializedMesh read_serialized(std::span<const std::byte> bytes, uint32_t index, const std::string& file);

} // namespace pertev::mitsuba
