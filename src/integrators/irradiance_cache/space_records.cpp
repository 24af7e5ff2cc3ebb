#include "integrators/irradiance_cache/space_records.h"

#include "base/parallel_for.h"

namespace pertev {

std::vector<float> clamp_by_neighbours(std::span<const Sphere> records) {
    const PointOctree tree = build_point_octree(records);
    const PointOctreeView view = view_of(tree);
    std::vector<float> clamped(records.size());
    parallel_for(records.size(), 64, [&](uint64_t i) {
        float radius = records[i].radius;
        // What is as far as the radius makes it no smaller.
        visit_within(view, records[i].centre, records[i].radius, [&](const NearPoint& near) {
            radius = min(radius, records[near.index].radius + sqrt(near.distance_squared));
        });
        clamped[i] = radius;
    });
    return clamped;
}

} // namespace pertev
