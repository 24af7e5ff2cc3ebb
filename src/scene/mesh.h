#pragma once

// A triangle mesh: only geometry, in local space. Material and transform belong to the instance.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "math/bounds3.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "math/vec4.h"
#include "scene/texture.h"

namespace pertev {

struct Mesh {
    std::string name, origin;
    std::vector<Vec3> positions; // [vertices], metres
    std::vector<Vec3> normals;   // [vertices] unit, or empty: the geometric normal applies
    std::vector<Vec4> tangents;  // [vertices] unit xyz, w = +-1 handedness of the bitangent; or empty
    std::array<std::vector<Vec2>, kTextureSets> uv; // [vertices] each, or empty
    std::vector<Vec4> colors;                       // [vertices] linear RGBA in [0, 1], or empty
    std::vector<uint32_t> indices;                  // [3 * triangles], counter-clockwise seen from the front

    uint32_t triangle_count() const { return static_cast<uint32_t>(indices.size() / 3); }
};

/// Box of all positions that triangles use.
Bounds3 bounds_of(const Mesh& mesh);

} // namespace pertev
