#include "accel/bvh/tlas.h"

#include <cmath>

#include "accel/bvh/build_tree.h"

namespace pertev {
namespace {

struct WorldBox {
    Bounds3 bounds;
    float reach;
};

/// Box around the eight transformed corners, rounded outwards, computed from centre and half size.
WorldBox move_box(const Transform& m, const Bounds3& local) {
    WorldBox world{{}, 0};
    const auto axis = [&](Vec3 row, float translation, float& lo, float& hi) {
        double centre = static_cast<double>(translation), half = 0, reach = std::fabs(centre);
        for (int k = 0; k < 3; ++k) {
            const double r = static_cast<double>(component(row, k));
            const double a = static_cast<double>(component(local.lo, k)),
                         b = static_cast<double>(component(local.hi, k));
            centre += r * 0.5 * (a + b);
            half += std::fabs(r) * 0.5 * (b - a);
            reach += std::fabs(r) * std::fmax(std::fabs(a), std::fabs(b));
        }
        lo = std::nextafterf(static_cast<float>(centre - half), -kInfinity) + 0.0f;
        hi = std::nextafterf(static_cast<float>(centre + half), kInfinity) + 0.0f;
        world.reach = max(world.reach, std::nextafterf(static_cast<float>(reach), kInfinity));
    };
    axis(m.row0, m.translation.x, world.bounds.lo.x, world.bounds.hi.x);
    axis(m.row1, m.translation.y, world.bounds.lo.y, world.bounds.hi.y);
    axis(m.row2, m.translation.z, world.bounds.lo.z, world.bounds.hi.z);
    return world;
}

/// Box of everything that instance `placed` covers while it moves from `rest`.
WorldBox swept(const WorldBox& rest, const PlacedBvh& placed) {
    const MotionKeys& motions = *placed.motions;
    WorldBox all = {swept_bounds(motions, placed.motion, rest.bounds), 0};
    all.bounds.extend(rest.bounds); // rays may query it at rest (kAtRest)
    const float lengths = max_component(abs(motions.pivots[placed.motion])) + all.bounds.max_abs() + rest.reach;
    all.reach = 1.01f * lengths; // all positions of the pivot lie within the bounds
    return all;
}

} // namespace

Tlas build_tlas(std::span<const PlacedBvh> instances) {
    Tlas top;
    std::vector<BuildReference> references;
    for (const PlacedBvh& placed : instances) {
        if (placed.local_bounds.is_empty()) continue;
        WorldBox world = move_box(placed.world_from_local, placed.local_bounds);
        const bool moves = placed.motion != kNoMotion;
        if (moves) world = swept(world, placed);
        references.push_back({world.bounds.lo, static_cast<uint32_t>(references.size()), world.bounds.hi});
        top.instances.push_back({inverse(placed.world_from_local), placed.blas, placed.instance, placed.motion});
        top.reach = max(top.reach, world.reach);
        top.growth = max(top.growth, 2 * condition_number(placed.world_from_local) + (moves ? 16.0f : 0.0f));
    }
    BuiltTree tree = build_tree(std::move(references), {.max_leaf = 1, .max_depth = kMaxTlasDepth});
    top.nodes = std::move(tree.nodes);
    top.bounds = tree.bounds;
    top.root = tree.root;
    top.depth = tree.depth;
    // Records in the tree's order: one instance per leaf, so a leaf link is a position.
    std::vector<InstanceRecord> ordered;
    for (const uint32_t id : tree.order) ordered.push_back(top.instances[id]);
    top.instances = std::move(ordered);
    return top;
}

} // namespace pertev
