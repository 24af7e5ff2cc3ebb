#include "radiosity/corner_light.h"

#include <algorithm>
#include <cmath>

#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr float kSameSurface = 0.866f; // cosine between normals
constexpr int kMostHanging = 8;        // levels between the patches on either side of an edge

/// A place, rounded to a grid.
struct Cell {
    int64_t x, y, z;
    auto operator<=>(const Cell&) const = default;
};

struct Corner {
    Cell cell;
    uint32_t patch, number;
};

struct PatchShape {
    Vec3 corner[3], normal;
};

class CornerTable {
public:
    CornerTable(const SceneView& scene, const PatchTree& tree, float size) : tree_(tree), shapes_(tree.patches.size()) {
        cell_ = size > 0 ? size * 0x1p-16f : 1.0f;
        corners_.resize(3 * tree.patches.size());
        parallel_for(tree.patches.size(), 256, [&](uint64_t i) {
            const Patch& patch = tree.patches[i];
            const PlacedTriangle triangle = place_on(scene, patch, patch.corners.middle());
            shapes_[i].normal = normal_of(scene, patch, triangle);
            for (uint32_t k = 0; k < 3; ++k) {
                const Vec2 at = patch.corners.at[k];
                shapes_[i].corner[k] = triangle.at(at.x, at.y);
                corners_[3 * i + k] = {cell_of(shapes_[i].corner[k]), static_cast<uint32_t>(i), k};
            }
        });
        std::ranges::sort(corners_, [](const Corner& a, const Corner& b) {
            return std::tie(a.cell, a.patch, a.number) < std::tie(b.cell, b.patch, b.number);
        });
    }

    const PatchShape& shape(uint32_t patch) const { return shapes_[patch]; }
    /// Corners that lie there.
    std::span<const Corner> at(Vec3 place) const {
        const Cell cell = cell_of(place);
        const auto range = std::ranges::equal_range(corners_, cell, {}, &Corner::cell);
        return {range.begin(), range.end()};
    }
    bool are_one_place(Vec3 a, Vec3 b) const { return cell_of(a) == cell_of(b); }
    bool is_same_surface(uint32_t a, uint32_t b) const {
        return dot(shapes_[a].normal, shapes_[b].normal) > kSameSurface;
    }
    /// Of the patches that meet at a corner of `patch`, by their areas.
    Rgb mean_at(uint32_t patch, uint32_t number, std::span<const Rgb> irradiance) const {
        double sum[3] = {}, areas = 0;
        for (const Corner& corner : at(shapes_[patch].corner[number])) {
            if (!is_same_surface(patch, corner.patch)) continue;
            const auto area = static_cast<double>(tree_.patches[corner.patch].area);
            const Rgb light = irradiance[corner.patch];
            areas += area;
            sum[0] += area * static_cast<double>(light.r);
            sum[1] += area * static_cast<double>(light.g);
            sum[2] += area * static_cast<double>(light.b);
        }
        return {static_cast<float>(sum[0] / areas), static_cast<float>(sum[1] / areas),
                static_cast<float>(sum[2] / areas)};
    }

private:
    Cell cell_of(Vec3 p) const {
        const auto round = [&](float x) {
            return static_cast<int64_t>(std::floor(static_cast<double>(x / cell_) + 0.5));
        };
        return {round(p.x), round(p.y), round(p.z)};
    }

    const PatchTree& tree_;
    std::vector<PatchShape> shapes_;
    float cell_;
    std::vector<Corner> corners_;
};

/// Corners that lie on the edge of a larger patch.
class HangingCorners {
public:
    HangingCorners(const CornerTable& table, std::vector<PatchLight>& lights) : table_(table), lights_(lights) {}

    void anchor(uint32_t patch) {
        const PatchShape& shape = table_.shape(patch);
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t next = (k + 1) % 3;
            anchor(patch, shape.corner[k], shape.corner[next], lights_[patch].corner[k], lights_[patch].corner[next],
                   0);
        }
    }

private:
    void anchor(uint32_t patch, Vec3 a, Vec3 b, Rgb at_a, Rgb at_b, int depth) {
        const Vec3 middle = 0.5f * (a + b);
        if (table_.are_one_place(a, middle) || table_.are_one_place(b, middle))
            return; // no finer corners are told apart
        const Rgb light = 0.5f * (at_a + at_b);
        bool any = false;
        for (const Corner& corner : table_.at(middle)) {
            if (!table_.is_same_surface(patch, corner.patch)) continue;
            lights_[corner.patch].corner[corner.number] = light;
            any = true;
        }
        if (!any || depth >= kMostHanging) return;
        anchor(patch, a, middle, at_a, light, depth + 1);
        anchor(patch, middle, b, light, at_b, depth + 1);
    }

    const CornerTable& table_;
    std::vector<PatchLight>& lights_;
};

} // namespace

std::vector<PatchLight> light_corners(const SceneView& scene, const PatchTree& tree, std::span<const Rgb> irradiance,
                                      float size) {
    const CornerTable table(scene, tree, size);
    std::vector<PatchLight> lights(tree.patches.size());
    parallel_for(lights.size(), 256, [&](uint64_t i) {
        const auto patch = static_cast<uint32_t>(i);
        for (uint32_t k = 0; k < 3; ++k) lights[i].corner[k] = table.mean_at(patch, k, irradiance);
        lights[i].mean = irradiance[i];
    });
    // Large ones first: what lies on their edges is then settled before it is an end of smaller ones.
    std::vector<uint32_t> by_area(lights.size());
    for (uint32_t i = 0; i < by_area.size(); ++i) by_area[i] = i;
    std::ranges::stable_sort(by_area,
                             [&](uint32_t a, uint32_t b) { return tree.patches[a].area > tree.patches[b].area; });
    HangingCorners hanging(table, lights);
    for (const uint32_t patch : by_area) hanging.anchor(patch);
    return lights;
}

} // namespace pertev
