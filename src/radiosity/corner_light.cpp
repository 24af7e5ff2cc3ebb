#include "radiosity/corner_light.h"

#include <algorithm>

#include "base/parallel_for.h"
#include "radiosity/corner_table.h"

namespace pertev {
namespace {

constexpr int kMaxHanging = 8; // levels between the patches on either side of an edge

/// Sets the light of all sheets of one surface that meet at a point to the area-weighted mean of their patches.
void show_means(std::span<CornerSheet> sheets) {
    for (CornerSheet& sheet : sheets) {
        double sum[3] = {}, areas = 0;
        for (const CornerSheet& other : sheets) {
            if (&other != &sheet && !is_same_surface(sheet.normal, other.normal)) continue;
            areas += other.areas;
            for (int k = 0; k < 3; ++k) sum[k] += other.light[k];
        }
        sheet.shown = {static_cast<float>(sum[0] / areas), static_cast<float>(sum[1] / areas),
                       static_cast<float>(sum[2] / areas)};
    }
}

/// Corners on the edge of a larger patch.
class HangingCorners {
public:
    HangingCorners(CornerTable& table, const PatchTree& tree) : table_(table), tree_(tree) {}

    void anchor(uint32_t patch) {
        for (uint32_t k = 0; k < 3; ++k) anchor(patch, end_of(patch, k), end_of(patch, (k + 1) % 3), 0);
    }

private:
    struct End {
        double u, v; // weights of the second and third corner of the patch's triangle
        Vec3 position;
        Rgb light;
    };
    End end_of(uint32_t patch, uint32_t number) const {
        const Vec2 at = tree_.patches[patch].corners.at[number];
        const CornerSheet& sheet = table_.sheet_of(patch, number);
        return {static_cast<double>(at.x), static_cast<double>(at.y), sheet.position, sheet.shown};
    }

    void anchor(uint32_t patch, const End& a, const End& b, int depth) {
        End middle = {0.5 * (a.u + b.u), 0.5 * (a.v + b.v), {}, 0.5f * (a.light + b.light)};
        middle.position = table_.position_of(patch, middle.u, middle.v);
        if (middle.position == a.position || middle.position == b.position)
            return; // floats do not distinguish finer corners
        bool any = false;
        for (CornerSheet& sheet : table_.at(middle.position)) {
            if (!is_same_surface(table_.normal_of(patch), sheet.normal)) continue;
            sheet.shown = middle.light;
            any = true;
        }
        if (!any || depth >= kMaxHanging) return;
        anchor(patch, a, middle, depth + 1);
        anchor(patch, middle, b, depth + 1);
    }

    CornerTable& table_;
    const PatchTree& tree_;
};

} // namespace

std::vector<PatchLight> light_corners(const SceneView& scene, const PatchTree& tree, std::span<const Rgb> irradiance) {
    CornerTable table(scene, tree, irradiance);
    table.for_each_position(show_means);
    // Large ones first: what lies on their edges is then settled before it is an end of smaller ones.
    std::vector<uint32_t> by_area(tree.patches.size());
    for (uint32_t i = 0; i < by_area.size(); ++i) by_area[i] = i;
    std::ranges::stable_sort(by_area,
                             [&](uint32_t a, uint32_t b) { return tree.patches[a].area > tree.patches[b].area; });
    HangingCorners hanging(table, tree);
    for (const uint32_t patch : by_area) hanging.anchor(patch);
    std::vector<PatchLight> lights(tree.patches.size());
    parallel_for(lights.size(), 256, [&](uint64_t i) {
        for (uint32_t k = 0; k < 3; ++k) {
            lights[i].corner[k] = table.sheet_of(static_cast<uint32_t>(i), k).shown;
        }
        lights[i].mean = irradiance[i];
    });
    return lights;
}

} // namespace pertev
