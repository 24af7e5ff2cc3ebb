#include "scene/position_bounds.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "base/parallel_for.h"

namespace pertev {

Bounds3 bounds_of(std::span<const Vec3> positions, std::span<const uint32_t> indices) {
    constexpr std::size_t kAtOnce = 1 << 16;
    std::vector<Bounds3> parts((indices.size() + kAtOnce - 1) / kAtOnce);
    parallel_for(parts.size(), 1, [&](uint64_t part) {
        const std::size_t begin = part * kAtOnce, count = std::min(kAtOnce, indices.size() - begin);
        Bounds3 bounds;
        for (const uint32_t index : indices.subspan(begin, count)) bounds.extend(positions[index]);
        parts[part] = bounds;
    });
    Bounds3 bounds;
    for (const Bounds3& part : parts) bounds.extend(part); // in order, because of two zeros the first counts
    return bounds;
}

DoubleBounds3 double_box_of(const Bounds3& box) {
    constexpr float kMaxFloat = std::numeric_limits<float>::max();
    const auto inside = [](float x) { return static_cast<double>(clamp(x, -kMaxFloat, kMaxFloat)); };
    if (box.is_empty()) return {};
    return {{inside(box.lo.x), inside(box.lo.y), inside(box.lo.z)},
            {inside(box.hi.x), inside(box.hi.y), inside(box.hi.z)}};
}

} // namespace pertev
