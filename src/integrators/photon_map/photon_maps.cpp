#include "integrators/photon_map/photon_maps.h"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "base/error.h"
#include "device/launch.h"
#include "integrators/photon_map/order_photons.h"
#include "tracer/hploc/sort_codes.h"

namespace pertev {

namespace {

/// Maximum number of photons that one kind may store.
uint64_t capacity_of_kind(const PhotonMapSettings& settings, uint32_t max_depth) {
    return uint64_t(settings.photons) * (max_depth > 1 ? max_depth - 1 : 1);
}
/// Returns whether the global map has all light, which final gathering looks up there (Jensen 1996, section 5).
bool global_has_all(const PhotonMapSettings& settings) { return settings.gather == PhotonGather::Final; }
/// Maximum number of photons in both maps together.
uint64_t capacity_of_maps(const PhotonMapSettings& settings, uint32_t max_depth) {
    return (global_has_all(settings) ? 3 : 2) * capacity_of_kind(settings, max_depth);
}
std::size_t max_starts(uint64_t capacity) { return std::bit_ceil(capacity) + 1; }

} // namespace

void PhotonMaps::allocate(const PhotonMapSettings& settings, uint32_t max_depth, bool has_media) {
    const uint64_t of_kind = capacity_of_kind(settings, max_depth), capacity = 2 * of_kind;
    const uint64_t in_maps = capacity_of_maps(settings, max_depth);
    search_ = settings.search;
    max_kept_ = settings.nearest > 0 ? 0xffffffffu : kMaxKept; // the nearest photons are selected from all
    global_has_all_ = global_has_all(settings);
    for (int k = 0; k < 3; ++k) {
        stored_[k].grow(queue_, capacity, "photons in order of arrival");
        ordered_[k].grow(queue_, in_maps, "photons");
    }
    for (int k = 0; k < 2; ++k) {
        keys_[k].grow(queue_, capacity, "numbers of photons");
        order_[k].grow(queue_, capacity, "order of photons");
        starts_[k].grow(queue_, max_starts(k == 0 ? in_maps - of_kind : of_kind), "hash grid over photons");
    }
    if (has_media) starts_[2].grow(queue_, max_starts(of_kind), "hash grid over photons");
    if (queue_.is_cuda()) {
        scratch_.grow(queue_, sort_scratch_bytes(queue_, static_cast<uint32_t>(capacity)),
                      "scratch memory for sorting photons");
    }
    counts_.grow(queue_, 1, "counts of photons");
    if (search_ == PhotonSearch::KdTree) kd_nodes_.grow(queue_, in_maps, "kd-tree over photons");
    if (search_ == PhotonSearch::Octree) {
        octree_nodes_.grow(queue_, 2 * in_maps, "octree over photons");
        octree_spheres_.grow(queue_, in_maps, "octree over photons");
        octree_indices_.grow(queue_, in_maps, "octree over photons");
    }
    capacity_ = capacity;
}

StoredPhotonsView PhotonMaps::clear() {
    counts_.zero();
    return {{stored_[0].data(), stored_[1].data(), stored_[2].data()}, keys_[0].data(), counts_.data()};
}

const PhotonMapsView& PhotonMaps::build(const PhotonRadii& radii, float largest, uint32_t pass, uint32_t seed,
                                        Sink& sink) {
    queue_.copy_to_host(&found_, counts_.data(), sizeof found_);
    PERTEV_CHECK(found_.stored <= capacity_);
    const uint32_t all = found_.stored;
    const PhotonsView stored = {stored_[0].data(), stored_[1].data(), stored_[2].data()};
    launch(queue_, "number photons", all, NumberPhotons{order_[0].data()});
    sort_photons(queue_, scratch_, keys_[0].data(), order_[0].data(), keys_[1].data(), order_[1].data(), all, kKeyBits);
    const uint32_t on_surfaces = all - found_.in_media, other = on_surfaces - found_.caustic; // these come first
    launch(queue_, "order photons", all, OrderPhotons{stored, ordered(), order_[1].data()});
    if (global_has_all_) {
        launch(queue_, "order photons", found_.caustic,
               OrderPhotons{stored, ordered().from(all), order_[1].data() + other});
    }

    PhotonMapsView& maps = view_;
    maps = {};
    maps.global_has_all = global_has_all_;
    maps.global.count = global_has_all_ ? on_surfaces : other;
    maps.global.radius = radii.global;
    maps.global.photons = ordered();
    maps.caustic.count = found_.caustic;
    const uint32_t first_caustic = global_has_all_ ? all : other;
    maps.caustic.radius = radii.caustic;
    maps.caustic.photons = ordered().from(first_caustic);
    in_media_ = {};
    in_media_.count = found_.in_media;
    in_media_.radius = radii.in_media;
    in_media_.photons = ordered().from(on_surfaces);
    PhotonMapView* const each[] = {&maps.global, &maps.caustic, &in_media_};
    for (int k = 0; k < 3; ++k) {
        if (each[k]->count == 0) continue;
        fill_grid(*each[k], stored_[k].data(), starts_[k], largest, pass, seed);
        if (search_ != PhotonSearch::Grid && k < 2) build_trees(*each[k], k == 0 ? 0 : first_caustic, sink);
    }
    return maps;
}

void PhotonMaps::fill_grid(PhotonMapView& map, Float4* points, Buffer<uint32_t>& starts, float largest, uint32_t pass,
                           uint32_t seed) {
    const PhotonCells cells = make_photon_cells(map.radius, largest, map.count);
    const Float4* positions = map.photons.positions;
    launch(queue_, "make buckets", map.count, MakeBuckets{positions, cells, keys_[0].data(), order_[0].data()});
    sort_photons(queue_, scratch_, keys_[0].data(), order_[0].data(), keys_[1].data(), order_[1].data(), map.count,
                 std::max(static_cast<int>(std::bit_width(cells.buckets)) - 1, 1));
    launch(queue_, "find buckets", map.count + 1,
           FindBuckets{keys_[1].data(), map.count, cells.buckets, starts.data()});
    launch(queue_, "keep photons", map.count,
           KeepPhotons{map.photons, keys_[1].data(), order_[1].data(), starts.data(), max_kept_, pass, seed, points});
    map.grid = {cells, points, starts.data(), max_kept_};
}

void PhotonMaps::build_trees(PhotonMapView& map, uint32_t first, Sink& sink) {
    std::vector<Float4> positions(map.count);
    queue_.copy_to_host(positions.data(), map.photons.positions, positions.size() * sizeof(Float4));
    std::vector<uint32_t> kept; // the grid keeps them
    for (uint32_t i = 0; i < map.count; ++i) {
        if (positions[i].w == 0) continue;
        positions[kept.size()] = positions[i];
        kept.push_back(i);
    }
    positions.resize(kept.size());
    if (search_ == PhotonSearch::KdTree) {
        std::vector<Vec3> points(positions.size());
        std::ranges::transform(positions, points.begin(), [](const Float4& p) { return Vec3{p.x, p.y, p.z}; });
        PointKdTree tree = build_point_kd_tree(points, sink);
        for (PointKdNode& node : tree.nodes) node = kd_node(node.position, kept[node.index()], node.axis());
        kd_nodes_.upload_at(first, tree.nodes);
        map.kd_tree = {kd_nodes_.data() + first, static_cast<uint32_t>(tree.nodes.size())};
        return;
    }
    std::vector<Sphere> spheres(positions.size());
    std::ranges::transform(positions, spheres.begin(), [](const Float4& p) { return Sphere{{p.x, p.y, p.z}, 0}; });
    PointOctree tree = build_point_octree(spheres, sink);
    for (uint32_t& index : tree.indices) index = kept[index];
    const std::size_t first_node = 2 * std::size_t(first);
    PERTEV_CHECK(tree.nodes.size() <= 2 * positions.size());
    octree_nodes_.upload_at(first_node, tree.nodes);
    octree_spheres_.upload_at(first, tree.spheres);
    octree_indices_.upload_at(first, tree.indices);
    map.octree = {octree_nodes_.data() + first_node, octree_spheres_.data() + first, octree_indices_.data() + first,
                  static_cast<uint32_t>(tree.nodes.size())};
}

namespace {

constexpr int kDigitBits = 11;

/// Sorts by a radix sort, least significant digit first.
void sort_on_host(uint64_t* keys, uint32_t* order, uint64_t* sorted_keys, uint32_t* sorted_order, uint32_t count,
                  int bits) {
    uint64_t* from_keys = keys;
    uint32_t* from_order = order;
    uint64_t* to_keys = sorted_keys;
    uint32_t* to_order = sorted_order;
    std::vector<uint32_t> starts(1u << kDigitBits);
    for (int shift = 0; shift < bits; shift += kDigitBits) {
        const auto digit = [&](uint64_t key) { return static_cast<uint32_t>(key >> shift) & ((1u << kDigitBits) - 1); };
        std::ranges::fill(starts, 0);
        for (uint32_t i = 0; i < count; ++i) ++starts[digit(from_keys[i])];
        uint32_t sum = 0;
        for (uint32_t& start : starts) sum += std::exchange(start, sum);
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t at = starts[digit(from_keys[i])]++;
            to_keys[at] = from_keys[i];
            to_order[at] = from_order[i];
        }
        std::swap(from_keys, to_keys);
        std::swap(from_order, to_order);
    }
    if (from_keys == sorted_keys) return;
    std::copy_n(from_keys, count, sorted_keys);
    std::copy_n(from_order, count, sorted_order);
}

} // namespace

void sort_photons(Queue& queue, Buffer<std::byte>& scratch, uint64_t* keys, uint32_t* order, uint64_t* sorted_keys,
                  uint32_t* sorted_order, uint32_t count, int bits) {
    if (count == 0) return;
    if (queue.is_cuda()) return sort_codes(queue, scratch, keys, order, sorted_keys, sorted_order, count);
    sort_on_host(keys, order, sorted_keys, sorted_order, count, bits);
}

} // namespace pertev
