#include "integrators/irradiance_cache/record_store.h"

#include <algorithm>
#include <span>

#include "accel/octree/octree_memory.h"
#include "base/error.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/irradiance_cache/space_records.h"

namespace pertev {
namespace {

/// Elements [0, count) at `data`: where they lie, or in `copy` where the device has memory of its own.
template <class T>
std::span<T> on_host(Queue& queue, T* data, std::size_t count, std::vector<T>& copy) {
    if (!queue.is_cuda()) return {data, count};
    copy.resize(count);
    queue.copy_to_host(copy.data(), data, count * sizeof(T));
    return copy;
}

} // namespace

std::size_t RecordStore::most_host_bytes(uint64_t pixels) {
    const uint64_t most = most_records(pixels);
    return most * (2 * sizeof(Sphere) + 2 * sizeof(float)) + most_octree_bytes(most);
}

void RecordStore::make_room(uint64_t pixels) {
    const std::size_t most = most_records(pixels);
    sites_.grow(queue_, pixels, "places of the overture");
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
    spheres_.reserve(most_records(pixels_));
    luminances_.reserve(most_records(pixels_));
    node_count_ = 0;
}

uint32_t RecordStore::gather_sites(uint32_t count) {
    std::vector<RecordSite> copy;
    const std::span<RecordSite> sites = on_host(queue_, sites_.data(), count, copy);
    const auto none = std::ranges::remove_if(sites, [](const RecordSite& s) { return s.scatterings == kNoSite; });
    const std::size_t wanted = std::min(sites.size() - none.size(), most_records(pixels_) - spheres_.size());
    if (queue_.is_cuda()) sites_.upload(sites.first(wanted));
    return static_cast<uint32_t>(wanted);
}

void RecordStore::take(uint32_t made, float accuracy) {
    accuracy_ = accuracy;
    std::vector<IrradianceRecord> copy;
    for (const IrradianceRecord& record : on_host(queue_, records_.data() + count(), made, copy)) {
        spheres_.push_back({record.place.position, record.radius});
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
    host_bytes_ = std::max(host_bytes_, of_each + most_octree_bytes(reached.size()));
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
