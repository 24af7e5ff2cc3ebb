#include "integrators/irradiance_cache/space_records.h"

#include "base/parallel_for.h"

namespace pertev {
namespace {

/// An octree over the centres, which lie in its leaves, however far records reach; with their radii.
PointOctree tree_over_centres(std::span<const Sphere> records) {
    std::vector<Sphere> centres(records.begin(), records.end());
    for (Sphere& centre : centres) centre.radius = 0;
    PointOctree tree = build_point_octree(centres);
    for (std::size_t k = 0; k < tree.spheres.size(); ++k) tree.spheres[k].radius = records[tree.indices[k]].radius;
    return tree;
}

/// Of each node the least radius in its subtree.
std::vector<float> least_radii(const PointOctree& tree) {
    std::vector<float> least(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) { // depth first: a node's children come after it
        const PointOctreeNode& node = tree.nodes[i];
        float radius = kInfinity;
        for (uint32_t k = node.first; k < node.first + node.count; ++k) radius = min(radius, tree.spheres[k].radius);
        for (std::size_t child = i + 1; child < node.skip; child = tree.nodes[child].skip) {
            radius = min(radius, least[child]);
        }
        least[i] = radius;
    }
    return least;
}

/// The least radius of one record and those of its neighbours plus the way there, so far.
struct Clamped {
    float radius;
    uint32_t by; // number of that neighbour in the tree
};

class Clamp {
public:
    explicit Clamp(const PointOctree& tree) : tree_(tree), least_(least_radii(tree)) {}

    /// Of the record of that number in the tree. What is as far as its radius makes it no smaller, nor does a subtree
    /// whose least radius and the way to it are no less than what was found. `guess`: a neighbour that may be the one
    /// looked for, so that little is left to look at.
    Clamped clamp(uint32_t number, uint32_t guess) const {
        const Sphere& record = tree_.spheres[number];
        const float most_squared = square_of_radius(record.radius);
        Clamped found = {record.radius, number};
        look_at(guess, record, most_squared, found);
        for (uint32_t i = 0; i < tree_.nodes.size();) {
            const PointOctreeNode& node = tree_.nodes[i];
            const float near_squared = squared_distance_to_box(node.lo, node.hi, record.centre);
            if (near_squared > most_squared || least_[i] + sqrt(near_squared) >= found.radius) {
                i = node.skip;
                continue;
            }
            for (uint32_t k = node.first; k < node.first + node.count; ++k) look_at(k, record, most_squared, found);
            ++i;
        }
        return found;
    }

private:
    void look_at(uint32_t k, const Sphere& record, float most_squared, Clamped& found) const {
        const float distance_squared = squared_distance(tree_.spheres[k].centre, record.centre);
        if (distance_squared > most_squared) return;
        const float radius = tree_.spheres[k].radius + sqrt(distance_squared);
        if (radius < found.radius) found = {radius, k};
    }

    const PointOctree& tree_;
    std::vector<float> least_;
};

} // namespace

std::vector<float> clamp_by_neighbours(std::span<const Sphere> records) {
    const PointOctree tree = tree_over_centres(records);
    const Clamp clamp(tree);
    std::vector<float> clamped(records.size());
    parallel_for_ranges(records.size(), 64, [&](uint64_t begin, uint64_t end) {
        auto guess = static_cast<uint32_t>(begin); // who clamps a record often clamps the next one in the tree
        for (uint64_t i = begin; i < end; ++i) {
            const Clamped found = clamp.clamp(static_cast<uint32_t>(i), guess);
            clamped[tree.indices[i]] = found.radius;
            guess = found.by;
        }
    });
    return clamped;
}

} // namespace pertev
