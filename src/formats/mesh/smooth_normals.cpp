#include "formats/mesh/smooth_normals.h"

#include "math/portable_math.h"

namespace pertev {

std::vector<Vec3> angle_weighted_normals(const Mesh& mesh) {
    std::vector<Vec3> normals(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        const std::size_t first = i - i % 3;
        const Vec3 p = mesh.positions[mesh.indices[i]];
        const Vec3 to_next = normalize(mesh.positions[mesh.indices[first + (i + 1) % 3]] - p);
        const Vec3 to_last = normalize(mesh.positions[mesh.indices[first + (i + 2) % 3]] - p);
        const Vec3 normal = normalize(cross(to_next, to_last));
        if (!is_finite(normal)) continue;
        normals[mesh.indices[i]] += acos(clamp(dot(to_next, to_last), -1.0f, 1.0f)) * normal;
    }
    for (Vec3& normal : normals) {
        const float size = length(normal);
        normal = size > 0 ? normal / size : Vec3{};
    }
    return normals;
}

} // namespace pertev
