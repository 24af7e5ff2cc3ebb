#include "accel/octree/point_octree.h"

#include <array>

#include "base/error.h"
#include "base/sink.h"
#include "math/bounds3.h"

namespace pertev {
namespace {

constexpr std::size_t kCheckedSpheres = 1 << 12; // a node with so many spheres checks the sink
constexpr int kMaxLevels = 64;                   // after this many halvings a cell is a leaf whatever it holds

class PointOctreeBuilder {
public:
    PointOctreeBuilder(std::span<const Sphere> spheres, uint32_t max_leaf, const PointOctreeSpace& space, Sink& sink)
        : spheres_(spheres), max_leaf_(max_leaf), space_(space), sink_(sink) {}

    /// Builds the subtree over `ids`, which ascend and lie in the cube of `side` at `corner`. `spare` has the size of
    /// `ids`.
    void build(std::span<uint32_t> ids, std::span<uint32_t> spare, Vec3 corner, float side, int levels) {
        for (; ids.size() > max_leaf_ && levels > 0; --levels) {
            if (ids.size() >= kCheckedSpheres) sink_.check();
            const float half = 0.5f * side;
            const Vec3 centre = corner + Vec3{half, half, half};
            std::array<std::size_t, 9> sizes = {}; // spheres that stay at the node, and of each octant
            for (const uint32_t id : ids) ++sizes[part_of(id, centre, half)];
            unsigned only = 1;
            while (only < 8 && sizes[only] != ids.size()) ++only;
            if (sizes[only] != ids.size()) return add_inner(ids, spare, sizes, corner, half, levels - 1);
            corner = corner_of(only - 1, corner, half); // if all are in one octant, this cell needs no node
            side = half;
        }
        add_node(ids, ids);
        space_.nodes[nodes_ - 1].skip = nodes_;
    }
    uint32_t nodes() const { return nodes_; }

private:
    static Vec3 corner_of(unsigned k, Vec3 corner, float half) {
        return corner +
               half * Vec3{static_cast<float>(k & 1), static_cast<float>(k >> 1 & 1), static_cast<float>(k >> 2)};
    }
    /// Returns 0 if the sphere is too large for an octant, else one more than the octant.
    unsigned part_of(uint32_t id, Vec3 centre, float half) const {
        const Sphere& s = spheres_[id];
        if (s.radius > half) return 0;
        return 1 + ((s.centre.x >= centre.x ? 1u : 0u) | (s.centre.y >= centre.y ? 2u : 0u) |
                    (s.centre.z >= centre.z ? 4u : 0u));
    }

    void add_inner(std::span<uint32_t> ids, std::span<uint32_t> spare, const std::array<std::size_t, 9>& sizes,
                   Vec3 corner, float half, int levels) {
        std::array<std::size_t, 9> ends = {};
        for (std::size_t k = 1; k < 9; ++k) ends[k] = ends[k - 1] + sizes[k - 1];
        for (const uint32_t id : ids) spare[ends[part_of(id, corner + Vec3{half, half, half}, half)]++] = id;
        const uint32_t at = nodes_;
        add_node(ids, spare.first(sizes[0]));
        for (unsigned k = 0; k < 8; ++k) {
            const std::size_t size = sizes[k + 1], first = ends[k + 1] - size;
            if (size == 0) continue;
            build(spare.subspan(first, size), ids.subspan(first, size), corner_of(k, corner, half), half, levels);
        }
        space_.nodes[at].skip = nodes_;
    }

    /// Appends a node over `ids`; the spheres `own` stay at it.
    void add_node(std::span<const uint32_t> ids, std::span<const uint32_t> own) {
        Bounds3 bounds;
        float max_radius = 0;
        for (const uint32_t id : ids) {
            bounds.extend(spheres_[id].centre);
            max_radius = max(max_radius, spheres_[id].radius);
        }
        space_.nodes[nodes_++] = {bounds.lo, placed_, bounds.hi, static_cast<uint32_t>(own.size()), max_radius, 0};
        for (const uint32_t id : own) {
            space_.spheres[placed_] = spheres_[id];
            space_.indices[placed_++] = id;
        }
    }

    std::span<const Sphere> spheres_;
    const uint32_t max_leaf_;
    const PointOctreeSpace& space_;
    Sink& sink_;
    uint32_t nodes_ = 0, placed_ = 0;
};

} // namespace

uint32_t build_point_octree(std::span<const Sphere> spheres, const PointOctreeSpace& space, Sink& sink,
                            uint32_t max_leaf) {
    PERTEV_CHECK(max_leaf >= 1);
    const std::size_t count = spheres.size();
    if (count > kMaxOctreeSpheres) {
        throw Error(ErrorCode::OverLimit, "an octree over spheres holds at most 2^30 of them");
    }
    PERTEV_CHECK(space.nodes.size() >= 2 * count && space.spheres.size() >= count);
    PERTEV_CHECK(space.indices.size() >= count && space.work.size() >= 2 * count);
    if (count == 0) return 0;
    Bounds3 bounds;
    const std::span<uint32_t> ids = space.work.first(count), spare = space.work.subspan(count, count);
    for (uint32_t i = 0; i < count; ++i) {
        PERTEV_CHECK(is_finite(spheres[i].centre) && is_finite(spheres[i].radius) && spheres[i].radius >= 0);
        bounds.extend(spheres[i].centre);
        ids[i] = i;
    }
    PointOctreeBuilder builder(spheres, max_leaf, space, sink);
    builder.build(ids, spare, bounds.lo, max_component(bounds.size()), kMaxLevels);
    return builder.nodes();
}

PointOctree build_point_octree(std::span<const Sphere> spheres, Sink& sink, uint32_t max_leaf) {
    const std::size_t count = spheres.size();
    PointOctree tree = {std::vector<PointOctreeNode>(2 * count), std::vector<Sphere>(count),
                        std::vector<uint32_t>(count)};
    std::vector<uint32_t> work(2 * count);
    tree.nodes.resize(build_point_octree(spheres, {tree.nodes, tree.spheres, tree.indices, work}, sink, max_leaf));
    return tree;
}

} // namespace pertev
