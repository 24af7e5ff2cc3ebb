#include "formats/shapes/quadrics.h"

#include <vector>

#include "math/portable_math.h"
#include "math/vec3.h"

namespace pertev {
namespace {

struct SurfacePoint {
    Vec3 position, normal;
};

/// The directions of the columns of vertices around z; a full turn ends exactly where it begins.
std::vector<Vec2> directions_of(float sweep) {
    const float turn = clamp(sweep, 0.0f, 2 * kPi) / (2 * kPi);
    const auto sides = static_cast<uint32_t>(max(-floor(1e-3f - turn * float(kCircleSegments)), 1.0f));
    std::vector<Vec2> directions;
    for (uint32_t i = 0; i <= sides; ++i) {
        const float angle = 2 * kPi * turn * static_cast<float>(i) / static_cast<float>(sides);
        directions.push_back({cos(angle), sin(angle)});
    }
    if (turn == 1) directions.back() = directions.front();
    return directions;
}

/// Makes a mesh of `rows` rows of quads. point(direction, v) is a point of the surface for v in [0, 1].
template <class Point>
Mesh make_grid(const std::vector<Vec2>& directions, uint32_t rows, const Point& point) {
    Mesh mesh;
    const auto columns = static_cast<uint32_t>(directions.size());
    for (uint32_t row = 0; row <= rows; ++row) {
        const float v = static_cast<float>(row) / static_cast<float>(rows);
        for (uint32_t i = 0; i < columns; ++i) {
            const SurfacePoint p = point(directions[i], v);
            mesh.positions.push_back(p.position);
            mesh.normals.push_back(p.normal);
            mesh.uv[0].push_back({static_cast<float>(i) / static_cast<float>(columns - 1), 1 - v});
        }
    }
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        const Vec3 p = mesh.positions[a], q = mesh.positions[b], r = mesh.positions[c];
        if (p == q || q == r || r == p) return; // at a pole
        mesh.indices.insert(mesh.indices.end(), {a, b, c});
    };
    for (uint32_t row = 0; row < rows; ++row) {
        for (uint32_t i = 0; i + 1 < columns; ++i) {
            const uint32_t low = row * columns + i, high = low + columns;
            add(low, low + 1, high + 1);
            add(low, high + 1, high);
        }
    }
    return mesh;
}

} // namespace

Mesh make_sphere(float z_low, float z_high, float sweep) {
    const float low = acos(clamp(z_low, -1.0f, 1.0f)), high = acos(clamp(z_high, -1.0f, 1.0f)); // from +z
    const auto rows = static_cast<uint32_t>(max(-floor(1e-3f - (low - high) / kPi * (0.5f * kCircleSegments)), 1.0f));
    return make_grid(directions_of(sweep), rows, [&](Vec2 direction, float v) {
        const float angle = low + v * (high - low);
        const bool is_pole = (v == 0 && z_low <= -1) || (v == 1 && z_high >= 1);
        const float radius = is_pole ? 0.0f : sin(angle), z = is_pole ? (v == 0 ? -1.0f : 1.0f) : cos(angle);
        const Vec3 p = {radius * direction.x, radius * direction.y, z};
        return SurfacePoint{p, normalize(p)};
    });
}

Mesh make_disk(float inner, float sweep) {
    return make_grid(directions_of(sweep), 1, [&](Vec2 direction, float v) {
        const float radius = 1 - v * (1 - inner);
        return SurfacePoint{{radius * direction.x, radius * direction.y, 0}, {0, 0, 1}};
    });
}

Mesh make_cylinder(float z_low, float z_high, float sweep) {
    return make_grid(directions_of(sweep), 1, [&](Vec2 direction, float v) {
        return SurfacePoint{{direction.x, direction.y, z_low + v * (z_high - z_low)}, {direction.x, direction.y, 0}};
    });
}

} // namespace pertev
