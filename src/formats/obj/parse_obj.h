#pragma once

// Parses the text of a Wavefront OBJ file to arrays: vertices, and triangles by object, group and material.
// Wavefront's "Object Files (.obj)", appendix B1 of the Advanced Visualizer manual; vertex colours as MeshLab and
// Blender write them.
//
// Why not tinyobjloader: its 2.0rc10 reads an invalid number, also `nan`, as 0 without a message; takes a minute for
// one polygon of 200 000 corners; rounds numbers through libm's pow; and reports no line numbers.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/sink.h"
#include "formats/mesh/vertex_key.h"
#include "math/double_bounds3.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "math/vec4.h"

namespace pertev {

inline constexpr uint32_t kNoIndex = 0xffffffffu;

/// Zero-based indices; texture coordinate and normal may be kNoIndex.
using ObjCorner = VertexKey;

/// Maximum number of separate objects and groups (with their materials); in a file with more, faces are grouped only
/// by material.
inline constexpr std::size_t kMaxObjGroups = std::size_t(1) << 16;

struct ObjGroup {
    std::string name;               // o and g, separated by a slash if both are given and differ; or empty
    std::string material;           // usemtl; empty before the first
    uint32_t line = 0;              // line of the first face
    std::vector<ObjCorner> corners; // [3 * triangles], in file order, every index in range
};

/// An mtllib statement: a name that may contain spaces, or several separated by spaces.
struct ObjMaterialFiles {
    std::string names;
    uint32_t line;
};

using FoundMaterials = std::function<void(const ObjMaterialFiles&)>;

struct ObjData {
    std::vector<Vec3> positions; // relative to origin_for(box), which is subtracted in double
    DoubleBounds3 box;           // bounds of the vertices of faces, in the coordinates of the file
    std::vector<Vec4> colors;    // [positions], linear; or empty
    std::vector<Vec3> normals;
    std::vector<Vec2> uvs;        // v as in the file: upwards
    std::vector<ObjGroup> groups; // by object, group and material, in the order of first use; not empty
    std::vector<ObjMaterialFiles> material_files;
};

/// Parses an OBJ file. Throws Error(BadInput) that names `file` and the line for a face that is invalid or refers to a
/// missing vertex. An unreadable number becomes NaN, with a warning; validate() drops its triangles. `found_materials`
/// is called once with the first of material_files if that is in the first piece, possibly from another thread, and
/// even if this function throws later. It must not throw. A thread parses about `piece_bytes` at once; the result does
/// not depend on it.
ObjData parse_obj(std::span<const std::byte> bytes, const std::string& file, Sink& sink,
                  const FoundMaterials& found_materials = {}, std::size_t piece_bytes = std::size_t(1) << 20);

} // namespace pertev
