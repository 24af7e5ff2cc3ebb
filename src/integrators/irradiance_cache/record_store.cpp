#include "integrators/irradiance_cache/record_store.h"

#include <algorithm>
#include <span>

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/sink.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"

namespace pertev {

namespace {

/// Builds an octree over the centres, which lie in its leaves, whatever the radii, and finds the least radius in the
/// subtree of each node.
PointOctreeView tree_over_centres(std::span<const Sphere> records, const SpacingMemory& memory) {
    Sphere* const centres = memory.spheres.data();
    for (std::size_t i = 0; i < records.size(); ++i) centres[i] = {records[i].centre, 0};
    const PointOctreeSpace tree = memory.tree();
    const uint32_t count = build_point_octree({centres, records.size()}, tree, nobody());
    for (std::size_t k = 0; k < records.size(); ++k) tree.spheres[k].radius = records[tree.indices[k]].radius;
    float* const least = memory.least_radii.data();
    for (std::size_t i = count; i-- > 0;) { // reverse depth-first order: children come before their parents
        const PointOctreeNode& node = tree.nodes[i];
        float radius = kInfinity;
        for (uint32_t k = node.first; k < node.first + node.count; ++k) radius = min(radius, tree.spheres[k].radius);
        for (std::size_t child = i + 1; child < node.skip; child = tree.nodes[child].skip) {
            radius = min(radius, least[child]);
        }
        least[i] = radius;
    }
    return {tree.nodes.data(), tree.spheres.data(), tree.indices.data(), count};
}

/// The minimum so far of a record's radius and of its neighbours' radii plus distance.
struct Clamped {
    float radius;
    uint32_t by; // index of that neighbour in the tree
};

class Clamp {
public:
    /// `least_radii` are those in the subtree of each node.
    Clamp(const PointOctreeView& tree, const float* least_radii) : tree_(tree), min_(least_radii) {}

    /// Clamps the record with this index in the tree. Neighbours farther away than its radius do not reduce it, nor
    /// does a subtree whose least radius plus distance is not below the minimum so far. `guess` is a likely minimum,
    /// which prunes the search.
    Clamped clamp(uint32_t number, uint32_t guess) const {
        const Sphere& record = tree_.spheres[number];
        const float max_squared = square_of_radius(record.radius);
        Clamped found = {record.radius, number};
        inspect(guess, record, max_squared, found);
        for (uint32_t i = 0; i < tree_.node_count;) {
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

    const PointOctreeView& tree_;
    const float* min_;
};

} // namespace

void SpacingMemory::grow(Queue& host, std::size_t records) {
    constexpr const char* kName = "spacing of irradiance records";
    spheres.grow(host, records, kName);
    least_radii.grow(host, 2 * records, kName);
    nodes.grow(host, 2 * records, kName);
    tree_spheres.grow(host, records, kName);
    indices.grow(host, records, kName);
    work.grow(host, 2 * records, kName);
}

void clamp_by_neighbours(std::span<const Sphere> records, const SpacingMemory& memory, std::span<float> clamped) {
    const PointOctreeView tree = tree_over_centres(records, memory);
    const Clamp clamp(tree, memory.least_radii.data());
    parallel_for_ranges(records.size(), 64, [&](uint64_t begin, uint64_t end) {
        auto guess = static_cast<uint32_t>(begin); // the neighbour that clamps a record often clamps the next one in
                                                   // the tree too
        for (uint64_t i = begin; i < end; ++i) {
            const Clamped found = clamp.clamp(static_cast<uint32_t>(i), guess);
            clamped[tree.indices[i]] = found.radius;
            guess = found.by;
        }
    });
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

void RecordStore::allocate(uint64_t pixels) {
    const std::size_t most = max_records(pixels);
    sites_.grow(queue_, pixels, "sites of the overture");
    records_.grow(queue_, most, "irradiance records");
    reaches_.grow(queue_, most, "irradiance records");
    nodes_.grow(queue_, 2 * most, "octree over irradiance records");
    tree_spheres_.grow(queue_, most, "octree over irradiance records");
    tree_indices_.grow(queue_, most, "octree over irradiance records");
    spheres_.grow(host_, most, "irradiance records");
    luminances_.grow(host_, most, "irradiance records");
    clamped_.grow(host_, most, "irradiance records");
    spacing_.grow(host_, most);
    pixels_ = pixels;
}

uint32_t RecordStore::gather_sites(uint32_t count) {
    std::vector<RecordSite> copy;
    const std::span<RecordSite> sites = on_host(queue_, sites_.data(), count, copy);
    const auto none = std::ranges::remove_if(sites, [](const RecordSite& s) { return s.scatterings == kNoSite; });
    const std::size_t wanted = std::min(sites.size() - none.size(), std::size_t(max_records(pixels_) - count_));
    if (queue_.is_cuda()) sites_.upload(sites.first(wanted));
    return static_cast<uint32_t>(wanted);
}

void RecordStore::take(uint32_t made, float accuracy) {
    accuracy_ = accuracy;
    std::vector<IrradianceRecord> copy;
    for (const IrradianceRecord& record : on_host(queue_, records_.data() + count_, made, copy)) {
        spheres_.data()[count_] = {record.point.position, record.radius};
        luminances_.data()[count_++] = luminance(record.light);
    }
    const std::span<const Sphere> spheres(spheres_.data(), count_);
    const std::span<float> reaches(clamped_.data(), count_);
    clamp_by_neighbours(spheres, spacing_, reaches);
    const std::span<Sphere> reached(spacing_.spheres.data(), count_);
    for (std::size_t i = 0; i < count_; ++i) {
        reaches[i] = accuracy * reaches[i];
        reached[i] = {spheres[i].centre, reaches[i]};
    }
    const PointOctreeSpace tree = spacing_.tree();
    node_count_ = build_point_octree(reached, tree, nobody());
    reaches_.upload(reaches);
    nodes_.upload(tree.nodes.first(node_count_));
    tree_spheres_.upload(tree.spheres.first(count_));
    tree_indices_.upload(tree.indices.first(count_));
}

IrradianceCacheView RecordStore::view() const {
    return {records_.data(),
            reaches_.data(),
            {nodes_.data(), tree_spheres_.data(), tree_indices_.data(), node_count_},
            accuracy_};
}

float RecordStore::mean_luminance() const {
    double sum = 0;
    for (uint32_t i = 0; i < count_; ++i) sum += static_cast<double>(luminances_.data()[i]);
    return count_ == 0 ? 0.0f : static_cast<float>(sum / count_);
}

} // namespace pertev
