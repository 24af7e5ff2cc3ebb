#include "formats/shapes/bilinear_patches.h"

#include <algorithm>
#include <utility>

namespace pertev {
namespace {

constexpr float kShareOfDiagonal = 1e-3f;
constexpr uint32_t kMostPieces = 32;
constexpr uint64_t kMostTriangles = uint64_t(1) << 20;

struct Patch {
    Vec3 p00, p10, p01, p11;
    Vec3 twist() const { return (p00 - p10) + (p11 - p01); }
    Vec3 normal(float u, float v) const {
        const Vec3 du = lerp(p10 - p00, p11 - p01, v), dv = lerp(p01 - p00, p11 - p10, u);
        return cross(du, dv);
    }
    /// The distance of the furthest corner from the plane of the others.
    float bend() const {
        const Vec3 across = cross(p10 - p00, p01 - p00);
        const float area = length(across);
        return area > 0 ? abs(dot(p11 - p00, across)) / area : 0.0f;
    }
};

Patch patch_of(const Mesh& mesh, const BilinearCorners& c) {
    return {mesh.positions[c[0]], mesh.positions[c[1]], mesh.positions[c[2]], mesh.positions[c[3]]};
}

/// The number of pieces along each side. A piece of 1 / n bends by twist / (4 n^2) from its triangles.
uint32_t pieces_of(const Patch& patch) {
    const float diagonal = max(length(patch.p11 - patch.p00), length(patch.p10 - patch.p01));
    if (!(patch.bend() > 1e-5f * diagonal)) return 1;
    const float pieces = sqrt(length(patch.twist()) / (4 * kShareOfDiagonal * diagonal));
    return static_cast<uint32_t>(clamp(-floor(-pieces), 2.0f, static_cast<float>(kMostPieces)));
}

template <class T>
T bilinear(const std::vector<T>& values, const BilinearCorners& c, float u, float v) {
    const auto between = [](T a, T b, float t) { return a + t * (b - a); };
    return between(between(values[c[0]], values[c[1]], u), between(values[c[2]], values[c[3]], u), v);
}

} // namespace

void triangulate_patches(const std::vector<BilinearCorners>& patches, Mesh& mesh) {
    uint32_t pieces = 1;
    for (const BilinearCorners& corners : patches) pieces = std::max(pieces, pieces_of(patch_of(mesh, corners)));
    while (pieces > 1 && 2 * uint64_t(pieces) * pieces * patches.size() > kMostTriangles) --pieces;
    const bool has_uv = !mesh.uv[0].empty(), has_normals = !mesh.normals.empty();
    if (pieces == 1 && has_uv) {
        for (const BilinearCorners& c : patches)
            mesh.indices.insert(mesh.indices.end(), {c[0], c[1], c[3], c[0], c[3], c[2]});
        return;
    }
    Mesh cut;
    cut.name = std::move(mesh.name);
    cut.origin = std::move(mesh.origin);
    const uint32_t side = pieces + 1;
    for (const BilinearCorners& corners : patches) {
        const Patch patch = patch_of(mesh, corners);
        const auto first = static_cast<uint32_t>(cut.positions.size());
        for (uint32_t row = 0; row < side; ++row) {
            for (uint32_t column = 0; column < side; ++column) {
                const float u = static_cast<float>(column) / static_cast<float>(pieces);
                const float v = static_cast<float>(row) / static_cast<float>(pieces);
                cut.positions.push_back(bilinear(mesh.positions, corners, u, v));
                if (has_normals) {
                    cut.normals.push_back(bilinear(mesh.normals, corners, u, v));
                } else if (pieces > 1) {
                    cut.normals.push_back(patch.normal(u, v));
                }
                cut.uv[0].push_back(has_uv ? bilinear(mesh.uv[0], corners, u, v) : Vec2{u, 1 - v});
            }
        }
        for (uint32_t row = 0; row < pieces; ++row) {
            for (uint32_t column = 0; column < pieces; ++column) {
                const uint32_t a = first + row * side + column, b = a + 1, d = a + side, c = d + 1;
                cut.indices.insert(cut.indices.end(), {a, b, c, a, c, d});
            }
        }
    }
    for (Vec3& normal : cut.normals) {
        const float size = length(normal);
        normal = size > 0 ? normal / size : Vec3{};
    }
    mesh = std::move(cut);
}

} // namespace pertev
