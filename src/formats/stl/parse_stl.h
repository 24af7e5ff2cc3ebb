#pragma once

// Parses STL, the triangles of 3D Systems' stereolithography files (1987), as text and as binary. A binary file may
// begin with `solid` too, so its size decides first: 80 bytes, a count, and 50 bytes for each triangle. Triangles have
// no common vertices and no unit; their stored normals are ignored, because the order of the corners defines the front.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/sink.h"
#include "math/double_vec3.h"
#include "math/vec3.h"

namespace pertev {

/// A `solid` of a text, or the whole of a binary file.
struct StlSolid {
    std::string name;
    std::size_t line = 0;      // line of the solid in a text
    std::size_t triangles = 0; // number of its triangles, which follow those of the solid before in StlData
};

struct StlData {
    std::vector<StlSolid> solids;
    std::vector<Vec3> corners;     // three for each triangle; NaN if unreadable
    std::vector<DoubleVec3> exact; // the corners as precise as in a text, or empty
};

/// Parses the bytes of a file. Anything left out gives a warning with the first line. Throws Error(BadInput) that names
/// `file` if it is no STL, and Error(OverLimit) for more than kMaxTrianglesPerMesh triangles.
StlData parse_stl(std::span<const std::byte> bytes, const std::string& file, Sink& sink);

} // namespace pertev
