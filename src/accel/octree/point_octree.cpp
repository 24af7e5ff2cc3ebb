#include "accel/octree/point_octree.h"

#include <array>

#include "base/error.h"
#include "math/bounds3.h"

namespace pertev {
namespace {

constexpr int kMaxLevels = 64; // after as many halvings a cell is a leaf whatever it holds

class PointOctreeBuilder {
public:
    PointOctreeBuilder(std::span<const Sphere> spheres, uint32_t max_leaf, PointOctree& tree)
        : spheres_(spheres), max_leaf_(max_leaf), tree_(tree) {}

    /// `ids` ascend and lie in the cube of `side` at `corner`.
    void build(std::vector<uint32_t> ids, Vec3 corner, float side, int levels) {
        std::vector<uint32_t> own;
        std::array<std::vector<uint32_t>, 8> octants;
        for (; ids.size() > max_leaf_ && levels > 0; --levels) {
            const float half = 0.5f * side;
            const Vec3 centre = corner + Vec3{half, half, half};
            own.clear();
            for (auto& octant : octants) octant.clear();
            for (const uint32_t id : ids) {
                const Sphere& s = spheres_[id];
                const unsigned k = (s.centre.x >= centre.x ? 1u : 0u) | (s.centre.y >= centre.y ? 2u : 0u) |
                                   (s.centre.z >= centre.z ? 4u : 0u);
                (s.radius > half ? own : octants[k]).push_back(id);
            }
            unsigned only = 0;
            while (only < 7 && octants[only].size() != ids.size()) ++only;
            if (octants[only].size() != ids.size()) return add_inner(ids, own, octants, corner, half, levels - 1);
            corner = corner_of(only, corner, half); // all in one octant: no node for this cell
            side = half;
        }
        add_node(ids, ids);
        tree_.nodes.back().skip = static_cast<uint32_t>(tree_.nodes.size());
    }

private:
    static Vec3 corner_of(unsigned k, Vec3 corner, float half) {
        return corner +
               half * Vec3{static_cast<float>(k & 1), static_cast<float>(k >> 1 & 1), static_cast<float>(k >> 2)};
    }

    void add_inner(std::vector<uint32_t>& ids, const std::vector<uint32_t>& own,
                   std::array<std::vector<uint32_t>, 8>& octants, Vec3 corner, float half, int levels) {
        const std::size_t at = tree_.nodes.size();
        add_node(ids, own);
        ids = {}; // its memory is needed below
        for (unsigned k = 0; k < 8; ++k) {
            if (!octants[k].empty()) build(std::move(octants[k]), corner_of(k, corner, half), half, levels);
        }
        tree_.nodes[at].skip = static_cast<uint32_t>(tree_.nodes.size());
    }

    /// A node over `ids`, of which `own` stay at it.
    void add_node(const std::vector<uint32_t>& ids, const std::vector<uint32_t>& own) {
        Bounds3 bounds;
        float max_radius = 0;
        for (const uint32_t id : ids) {
            bounds.extend(spheres_[id].centre);
            max_radius = max(max_radius, spheres_[id].radius);
        }
        const auto first = static_cast<uint32_t>(tree_.spheres.size());
        tree_.nodes.push_back({bounds.lo, first, bounds.hi, static_cast<uint32_t>(own.size()), max_radius, 0});
        for (const uint32_t id : own) {
            tree_.spheres.push_back(spheres_[id]);
            tree_.indices.push_back(id);
        }
    }

    std::span<const Sphere> spheres_;
    const uint32_t max_leaf_;
    PointOctree& tree_;
};

} // namespace

PointOctree build_point_octree(std::span<const Sphere> spheres, uint32_t max_leaf) {
    PERTEV_CHECK(max_leaf >= 1);
    if (spheres.size() > kMaxOctreeSpheres) {
        throw Error(ErrorCode::OverLimit, "an octree over spheres holds at most 2^30 of them");
    }
    PointOctree tree;
    if (spheres.empty()) return tree;
    Bounds3 bounds;
    std::vector<uint32_t> ids(spheres.size());
    for (uint32_t i = 0; i < ids.size(); ++i) {
        PERTEV_CHECK(is_finite(spheres[i].centre) && is_finite(spheres[i].radius) && spheres[i].radius >= 0);
        bounds.extend(spheres[i].centre);
        ids[i] = i;
    }
    PointOctreeBuilder(spheres, max_leaf, tree)
        .build(std::move(ids), bounds.lo, max_component(bounds.size()), kMaxLevels);
    return tree;
}

} // namespace pertev
