#pragma once

// The octree over spheres of influence, and over points as spheres of radius 0, for irradiance caches: all records
// whose sphere covers a point, and all whose centre is within a radius of it.
//
// Source: Ward, Rubinstein, Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988, section 4: a
// sphere stays at the level whose cells have about its size, so that a large sphere does not enlarge small cells.
// Nodes are in depth-first order, each with a link to the node after its subtree, so that a search needs no stack. A
// node holds the bounds of the centres below it and their largest radius, and is skipped only if it is farther than
// that.

#include <cstdint>
#include <span>
#include <vector>

#include "accel/nearest_points.h"
#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

class Sink;

inline constexpr uint32_t kMaxOctreeSpheres = 1u << 30; // there are at most twice as many nodes

struct alignas(16) Sphere {
    Vec3 centre;
    float radius = 0; // >= 0
};

struct alignas(16) PointOctreeNode {
    Vec3 lo;        // bounds of the centres in the subtree
    uint32_t first; // first of the spheres that stay at this node
    Vec3 hi;
    uint32_t count;
    float max_radius; // largest radius in the subtree
    uint32_t skip;    // the node after the subtree
    uint32_t unused[2] = {0, 0};
};
static_assert(sizeof(PointOctreeNode) == 48);

struct PointOctree {
    std::vector<PointOctreeNode> nodes; // empty if there is no sphere
    std::vector<Sphere> spheres;        // ordered by node
    std::vector<uint32_t> indices;      // [spheres] index in the builder's input; ascending within a node
};

/// Memory that a tree over n spheres is built in.
struct PointOctreeSpace {
    std::span<PointOctreeNode> nodes; // [2 n]
    std::span<Sphere> spheres;        // [n]
    std::span<uint32_t> indices;      // [n]
    std::span<uint32_t> work;         // [2 n] of no meaning after the build
};

/// Arrays of a PointOctree for searches, as plain pointers of host or device.
struct PointOctreeView {
    const PointOctreeNode* nodes = nullptr;
    const Sphere* spheres = nullptr;
    const uint32_t* indices = nullptr;
    uint32_t node_count = 0;
};

inline PointOctreeView view_of(const PointOctree& tree) {
    return {tree.nodes.data(), tree.spheres.data(), tree.indices.data(), static_cast<uint32_t>(tree.nodes.size())};
}

/// Builds the tree. Cells with more than max_leaf spheres are split; spheres larger than half a cell stay at its
/// node. Spheres are finite, |coordinate| and radius <= kMaxCoordinate. Throws Error(OverLimit) for more than
/// kMaxOctreeSpheres, and Error(Interrupted) if `sink` stops it.
PointOctree build_point_octree(std::span<const Sphere> spheres, Sink& sink, uint32_t max_leaf = 4);
/// Builds the tree in `space`, which may be for more spheres, and returns its number of nodes.
uint32_t build_point_octree(std::span<const Sphere> spheres, const PointOctreeSpace& space, Sink& sink,
                            uint32_t max_leaf = 4);

/// Squared distance from `at` to the box, 0 inside; no more than squared_distance to a point of it.
HD inline float squared_distance_to_box(Vec3 lo, Vec3 hi, Vec3 at) {
    const Vec3 d = max(max(lo - at, at - hi), Vec3{0, 0, 0});
    return d.x * d.x + d.y * d.y + d.z * d.z;
}

/// Calls visit(NearPoint) for each sphere that covers `at`, surface included, in the order of the tree.
template <class Visit>
HD inline void visit_covering(const PointOctreeView& tree, Vec3 at, Visit&& visit) {
    for (uint32_t i = 0; i < tree.node_count;) {
        const PointOctreeNode node = tree.nodes[i];
        if (squared_distance_to_box(node.lo, node.hi, at) > node.max_radius * node.max_radius) {
            i = node.skip;
            continue;
        }
        for (uint32_t k = node.first; k < node.first + node.count; ++k) {
            const Sphere sphere = tree.spheres[k];
            const float distance_squared = squared_distance(sphere.centre, at);
            if (distance_squared <= sphere.radius * sphere.radius) visit(NearPoint{distance_squared, tree.indices[k]});
        }
        ++i;
    }
}

/// Offers `found` each centre that may be within its limit; see point_kd_tree.h.
template <class Found>
HD inline void search_points(const PointOctreeView& tree, Vec3 at, Found& found) {
    for (uint32_t i = 0; i < tree.node_count;) {
        const PointOctreeNode node = tree.nodes[i];
        if (!(squared_distance_to_box(node.lo, node.hi, at) <= found.limit())) {
            i = node.skip;
            continue;
        }
        for (uint32_t k = node.first; k < node.first + node.count; ++k) {
            found.offer({squared_distance(tree.spheres[k].centre, at), tree.indices[k]});
        }
        ++i;
    }
}

} // namespace pertev
