#include "integrators/irradiance_cache/record_store.h"

#include <algorithm>
#include <span>

#include "base/error.h"
#include "base/parallel_for.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"

namespace pertev {

namespace {

/// Builds an octree over the centres, which lie in its leaves, whatever the radii.
PointOctree tree_over_centres(std::span<const Sphere> records) {
    std::vector<Sphere> centres(records.begin(), records.end());
    for (Sphere& centre : centres) centre.radius = 0;
    PointOctree tree = build_point_octree(centres);
    for (std::size_t k = 0; k < tree.spheres.size(); ++k) tree.spheres[k].radius = records[tree.indices[k]].radius;
    return tree;
}

/// Returns the least radius in the subtree of each node.
std::vector<float> min_radii(const PointOctree& tree) {
    std::vector<float> least(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) { // reverse depth-first order: children come before their
                                                        // parents
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

/// The minimum so far of a record's radius and of its neighbours' radii plus distance.
struct Clamped {
    float radius;
    uint32_t by; // index of that neighbour in the tree
};

class Clamp {
public:
    explicit Clamp(const PointOctree& tree) : tree_(tree), min_(min_radii(tree)) {}

    /// Clamps the record with this index in the tree. Neighbours farther away than its radius do not reduce it, nor
    /// does a subtree whose least radius plus distance is not below the minimum so far. `guess` is a likely minimum,
    /// which prunes the search.
    Clamped clamp(uint32_t number, uint32_t guess) const {
        const Sphere& record = tree_.spheres[number];
        const float max_squared = square_of_radius(record.radius);
        Clamped found = {record.radius, number};
        inspect(guess, record, max_squared, found);
        for (uint32_t i = 0; i < tree_.nodes.size();) {
            const PointOctreeNode& node = tree_.nodes[i];
            const float near_squared = squared_distance_to_box(node.lo, node.hi, record.centre);
            if (near_squared > max_squared || min_[i] + sqrt(near_squared) >= found.radius) {
                i = node.skip;
                continue;
            }
            for (uint32_t k = node.first; k < node.first + node.count; ++k) inspect(k, record, max_squared, found);
            ++i;
        }
        return found;
    }

private:
    void inspect(uint32_t k, const Sphere& record, float max_squared, Clamped& found) const {
        const float distance_squared = squared_distance(tree_.spheres[k].centre, record.centre);
        if (distance_squared > max_squared) return;
        const float radius = tree_.spheres[k].radius + sqrt(distance_squared);
        if (radius < found.radius) found = {radius, k};
    }

    const PointOctree& tree_;
    std::vector<float> min_;
};

} // namespace

std::vector<float> clamp_by_neighbours(std::span<const Sphere> records) {
    const PointOctree tree = tree_over_centres(records);
    const Clamp clamp(tree);
    std::vector<float> clamped(records.size());
    parallel_for_ranges(records.size(), 64, [&](uint64_t begin, uint64_t end) {
        auto guess = static_cast<uint32_t>(begin); // the neighbour that clamps a record often clamps the next one in
                                                   // the tree too
        for (uint64_t i = begin; i < end; ++i) {
            const Clamped found = clamp.clamp(static_cast<uint32_t>(i), guess);
            clamped[tree.indices[i]] = found.radius;
            guess = found.by;
        }
    });
    return clamped;
}

namespace {

/// Host access to elements [0, count) at `data`: in place, or through `copy` if the device has its own memory.
template <class T>
std::span<T> on_host(Queue& queue, T* data, std::size_t count, std::vector<T>& copy) {
    if (!queue.is_cuda()) return {data, count};
    copy.resize(count);
    queue.copy_to_host(copy.data(), data, count * sizeof(T));
    return copy;
}

} // namespace

std::size_t RecordStore::max_host_bytes(uint64_t pixels) {
    const uint64_t most = max_records(pixels);
    return most * (2 * sizeof(Sphere) + 2 * sizeof(float)) + max_octree_bytes(most);
}

void RecordStore::allocate(uint64_t pixels) {
    const std::size_t most = max_records(pixels);
    sites_.grow(queue_, pixels, "sites of the overture");
    records_.grow(queue_, most, "irradiance records");
    reaches_.grow(queue_, most, "irradiance records");
    nodes_.grow(queue_, 2 * most, "octree over irradiance records");
    tree_spheres_.grow(queue_, most, "octree over irradiance records");
    tree_indices_.grow(queue_, most, "octree over irradiance records");
    pixels_ = pixels;
}

void RecordStore::clear() {
    spheres_.clear();
    luminances_.clear();
    spheres_.reserve(max_records(pixels_));
    luminances_.reserve(max_records(pixels_));
    node_count_ = 0;
}

uint32_t RecordStore::gather_sites(uint32_t count) {
    std::vector<RecordSite> copy;
    const std::span<RecordSite> sites = on_host(queue_, sites_.data(), count, copy);
    const auto none = std::ranges::remove_if(sites, [](const RecordSite& s) { return s.scatterings == kNoSite; });
    const std::size_t wanted = std::min(sites.size() - none.size(), max_records(pixels_) - spheres_.size());
    if (queue_.is_cuda()) sites_.upload(sites.first(wanted));
    return static_cast<uint32_t>(wanted);
}

void RecordStore::take(uint32_t made, float accuracy) {
    accuracy_ = accuracy;
    std::vector<IrradianceRecord> copy;
    for (const IrradianceRecord& record : on_host(queue_, records_.data() + count(), made, copy)) {
        spheres_.push_back({record.point.position, record.radius});
        luminances_.push_back(luminance(record.light));
    }
    std::vector<float> reaches = clamp_by_neighbours(spheres_);
    std::vector<Sphere> reached = spheres_;
    for (std::size_t i = 0; i < reached.size(); ++i) {
        reaches[i] = accuracy * reaches[i];
        reached[i].radius = reaches[i];
    }
    const PointOctree tree = build_point_octree(reached);
    PERTEV_CHECK(tree.nodes.size() <= nodes_.size());
    const std::size_t of_each = (spheres_.capacity() + reached.capacity()) * sizeof(Sphere) +
                                (luminances_.capacity() + reaches.capacity()) * sizeof(float);
    host_bytes_ = std::max(host_bytes_, of_each + max_octree_bytes(reached.size()));
    reaches_.upload(reaches);
    nodes_.upload(tree.nodes);
    tree_spheres_.upload(tree.spheres);
    tree_indices_.upload(tree.indices);
    node_count_ = static_cast<uint32_t>(tree.nodes.size());
}

IrradianceCacheView RecordStore::view() const {
    return {records_.data(),
            reaches_.data(),
            {nodes_.data(), tree_spheres_.data(), tree_indices_.data(), node_count_},
            accuracy_};
}

float RecordStore::mean_luminance() const {
    double sum = 0;
    for (const float luminance : luminances_) sum += static_cast<double>(luminance);
    return luminances_.empty() ? 0.0f : static_cast<float>(sum / static_cast<double>(luminances_.size()));
}

} // namespace pertev
