#pragma once

// The text of a Wavefront OBJ file as arrays: vertices, and triangles by object, group and material. Wavefront's
// "Object Files (.obj)", appendix B1 of the Advanced Visualizer manual; vertex colours as MeshLab and Blender write
// them.
//
// Why not tinyobjloader: its 2.0rc10 reads a number that it cannot parse, `nan` too, as 0 without a word; takes a
// minute for one polygon of 200 000 corners; rounds numbers through libm's pow; and knows no line for what is wrong.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/messages.h"
#include "formats/mesh/vertex_key.h"
#include "math/double_bounds3.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "math/vec4.h"

namespace pertev {

inline constexpr uint32_t kNoIndex = 0xffffffffu;

/// Zero-based; texture coordinate and normal may be kNoIndex.
using ObjCorner = VertexKey;

/// Objects and groups are told apart up to so many (with their materials); where a file has more, its faces are put
/// together by material alone.
inline constexpr std::size_t kMostObjGroups = std::size_t(1) << 16;

struct ObjGroup {
    std::string name;               // of o and g, apart by a slash where both are there and differ; or empty
    std::string material;           // of usemtl; empty before the first
    uint32_t line = 0;              // of the first face
    std::vector<ObjCorner> corners; // [3 * triangles], in file order, every index in range
};

/// One mtllib statement: a name that may hold spaces, or several apart by spaces.
struct ObjMaterialFiles {
    std::string names;
    uint32_t line;
};

using FoundMaterials = std::function<void(const ObjMaterialFiles&)>;

struct ObjData {
    std::vector<Vec3> positions; // relative to origin_for(box), which is taken off in double
    DoubleBounds3 box;           // round those that faces name, in the coordinates of the file
    std::vector<Vec4> colors;    // [positions], linear; or empty
    std::vector<Vec3> normals;
    std::vector<Vec2> uvs;        // v as in the file: upwards
    std::vector<ObjGroup> groups; // by object, group and material, in the order of first use; none is empty
    std::vector<ObjMaterialFiles> material_files;
};

/// Throws Error(BadInput) that names `file` and the line for a face that cannot be understood or whose vertex does not
/// exist. A number that cannot be read becomes NaN, with a warning: validate() drops its triangles. `found_materials`
/// is called with the first of material_files where that stands in the first piece: once, when it is met, perhaps on
/// another thread, and also where this function throws later. It throws nothing. A thread takes about `piece_bytes` at
/// once; what is returned does not depend on it.
ObjData parse_obj(std::span<const std::byte> bytes, const std::string& file, Messages& messages,
                  const FoundMaterials& found_materials = {}, std::size_t piece_bytes = std::size_t(1) << 20);

} // namespace pertev
