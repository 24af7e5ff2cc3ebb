#include "integrators/photon_map/photon_targets.h"

namespace pertev {
namespace {

constexpr float kGrown = 1.0f + 0x1p-10f; // margin for rounding

bool is_nothing(const hploc::OrderedBounds& bounds) { return bounds.least[0] == 0x7f7f7f7f; }

Float4 sphere_around(const Bounds3& box) {
    const Vec3 centre = box.centre();
    return {centre.x, centre.y, centre.z, kGrown * (0.5f * length(box.size()) + 0x1p-20f * box.max_abs())};
}

/// Returns the spheres of the cells, of which `together` along each axis form one.
std::vector<Float4> spheres_of_cells(const SpecularBounds& found, uint32_t together) {
    constexpr uint32_t kAcross = kTargetCellsAcross;
    const uint32_t across = kAcross / together;
    std::vector<Bounds3> boxes(std::size_t(across) * across * across);
    for (uint32_t i = 0; i < kMaxTargets; ++i) {
        if (is_nothing(found.cells[i])) continue;
        const uint32_t x = i % kAcross / together, y = i / kAcross % kAcross / together;
        boxes[(i / (kAcross * kAcross) / together * across + y) * across + x].extend(
            Bounds3{found.cells[i].lo(), found.cells[i].hi()});
    }
    std::vector<Float4> spheres;
    for (const Bounds3& box : boxes) {
        if (!box.is_empty()) spheres.push_back(sphere_around(box));
    }
    return spheres;
}

float area_of(const std::vector<Float4>& spheres) {
    float sum = 0;
    for (const Float4& sphere : spheres) sum += square(sphere.w);
    return sum;
}

} // namespace

std::vector<Float4> choose_targets(const SpecularBounds& found) {
    if (is_nothing(found.all)) return {};
    const Bounds3 box = {found.all.lo(), found.all.hi()};
    Float4 round_all = sphere_around(box);
    round_all.w = min(round_all.w, kGrown * (sqrt(-hploc::unordered(found.reach)) + 0x1p-20f * box.max_abs()));
    std::vector<Float4> best = {round_all};
    for (const uint32_t together : {2u, 1u}) {
        std::vector<Float4> spheres = spheres_of_cells(found, together);
        if (!spheres.empty() && area_of(spheres) < area_of(best)) best = std::move(spheres);
    }
    return best;
}

} // namespace pertev
