#include "integrators/photon_map/photon_map_integrator.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include "base/error.h"
#include "base/parallel_for.h"
#include "integrators/photon_map/find_targets.h"
#include "integrators/photon_map/run_photon_map.h"

namespace pertev {
namespace {

constexpr std::size_t kMostBytes = std::size_t(1) << 30; // of a device
constexpr std::size_t kLoopBytes = std::size_t(1) << 18; // of a thread: what its cache holds
constexpr uint32_t kLoopWalks = 256;                     // at most, of a thread
constexpr uint64_t kLoopRange = 256;                     // walks at least, that a thread takes at once
constexpr uint32_t kLeastWalks = 32;

WalkRoom room_of(uint32_t walks) { return {walks, 0, 1}; }
/// `in_loop`: of a thread of the CPU's, which has other look-ups to do when this one is long.
GatherRoom gather_room(uint32_t walks, const PhotonMapSettings& map, bool in_loop) {
    return {walks, map.nearest, !in_loop && map.search == PhotonSearch::Grid && map.nearest == 0};
}
std::size_t bytes_in_flight(uint32_t walks, const PhotonMapSettings& map, bool in_loop) {
    return bytes_of(room_of(walks)) + bytes_of(gather_room(walks, map, in_loop));
}
uint32_t walks_within(const PhotonMapSettings& map, bool in_loop, std::size_t bytes, uint64_t most) {
    const std::size_t each = bytes_in_flight(kLeastWalks, map, in_loop) / kLeastWalks;
    return static_cast<uint32_t>(std::min<uint64_t>(most, std::max<uint64_t>(bytes / each, kLeastWalks)));
}
/// Of the camera's or of photons, whichever are more.
uint64_t most_walks(const PhotonMapSettings& map, uint64_t pixels, uint32_t batch) {
    return std::min<uint64_t>(std::max<uint64_t>(pixels, 2 * uint64_t(map.photons)), batch);
}
void lay_out_both(WalksView& walks, GatherView& gather, std::byte* memory, uint32_t count, const PhotonMapSettings& map,
                  bool in_loop) {
    lay_out(walks, memory, room_of(count));
    lay_out(gather, memory + bytes_of(room_of(count)), gather_room(count, map, in_loop));
}

WorldSphere sphere_round(const Bounds3& bounds) {
    if (bounds.is_empty()) return {};
    return {bounds.centre(), 0.51f * length(bounds.size())}; // half the diagonal, and what rounding may take of it
}

} // namespace

PhotonMapIntegrator::PhotonMapIntegrator(Queue& queue, const SubpathSettings& settings, const PhotonMapSettings& map,
                                         bool in_loop, uint32_t batch)
    : queue_(queue), settings_(settings), map_settings_(map), in_loop_(in_loop), batch_(batch), maps_(queue),
      seen_(queue) {}

std::size_t PhotonMapIntegrator::predicted_bytes(const SubpathSettings& settings, const PhotonMapSettings& map,
                                                 uint64_t pixels, uint32_t batch, bool in_loop, bool on_cuda) {
    std::size_t bytes = PhotonMaps::predicted_bytes(map, settings.max_depth, on_cuda) + kMostTargets * sizeof(Float4);
    if (!in_loop)
        bytes += bytes_in_flight(walks_within(map, false, kMostBytes, most_walks(map, pixels, batch)), map, false);
    return bytes;
}

std::size_t PhotonMapIntegrator::bytes() const {
    return memory_.size() + maps_.bytes() + targets_.size() * sizeof(Float4);
}

const HostTrees* PhotonMapIntegrator::trees_of_loop() const { return in_loop_ ? tracer_->host_trees() : nullptr; }

void PhotonMapIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t) {
    picture_ = picture;
    tracer_ = &tracer;
    rays_ = {};
    picture_settings_ = settings_;
    picture_map_ = map_settings_;
    PERTEV_CHECK(has_room_for_photons(picture_map_.photons, picture_settings_.max_depth));
    world_ = sphere_round(tracer.bounds());
    global_radius_ = picture_map_.radius > 0 ? picture_map_.radius : kRadiusOfScene * world_.radius;
    caustic_radius_ = picture_map_.caustic_radius > 0 ? picture_map_.caustic_radius : kCausticRadius * global_radius_;
    maps_.make_room(picture_map_, picture_settings_.max_depth);
    find_targets();
    if (trees_of_loop() != nullptr) return;
    const uint64_t pixels = uint64_t(picture.camera.width) * picture.camera.height;
    walks_in_flight_ = walks_within(picture_map_, false, kMostBytes, most_walks(picture_map_, pixels, batch_));
    const std::size_t bytes = bytes_in_flight(walks_in_flight_, picture_map_, false);
    if (memory_.size() < bytes) {
        memory_ = {}; // before there is more
        memory_ = {queue_, bytes, "walks of photon mapping"};
    }
    lay_out_both(walks_, gather_, memory_.data(), walks_in_flight_, picture_map_, false);
}

void PhotonMapIntegrator::find_targets() {
    if (targets_.size() == 0) targets_ = {queue_, kMostTargets, "targets of photons"};
    const SceneView& scene = picture_.scene;
    target_count_ = 0;
    if (scene.known != MaterialsKnown::Nothing || !(world_.radius > 0)) return;
    std::vector<Float4> spheres = {{world_.centre.x, world_.centre.y, world_.centre.z, world_.radius}};
    if (scene.first_triangle != nullptr) {
        Buffer<SpecularBounds> bounds(queue_, 1, "bounds of mirrors and glass");
        bounds.fill(hploc::kNothing);
        for (const bool in_cells : {false, true}) {
            launch(queue_, "find mirrors and glass", static_cast<uint32_t>(scene.triangle_count),
                   FindSpecular{scene, bounds.data(), in_cells});
        }
        std::vector<SpecularBounds> copy;
        spheres = choose_targets(bounds.read(copy).front());
    }
    target_count_ = static_cast<uint32_t>(spheres.size());
    targets_.upload(spheres);
}

PhotonJob PhotonMapIntegrator::make_job(uint32_t pass, const FilmView& film) {
    PhotonJob job = {};
    job.walk.scene = {picture_, picture_settings_, world_, false};
    job.walk.film = film;
    job.walk.samples = {0, picture_.camera.width * picture_.camera.height, pass, 1};
    job.pass = {pass, picture_map_.photons, {targets_.data(), target_count_}, maps_.clear(), film.invalid, energy_};
    job.how = picture_map_.gather;
    job.search = picture_map_.search;
    return job;
}

void PhotonMapIntegrator::render(uint32_t first, uint32_t count, const FilmView& film) {
    PERTEV_CHECK(!film.frame.is_there());
    for (uint32_t pass = first; pass < first + count && !is_abandoned(); ++pass) render_pass(pass, film);
}

void PhotonMapIntegrator::render_pass(uint32_t pass, const FilmView& film) {
    PhotonJob job = make_job(pass, film);
    const uint64_t pixels = job.walk.samples.pixels;
    // Light that is scattered once is found by shadow rays alone.
    const uint64_t kinds = picture_settings_.max_depth < 2 ? 0 : target_count_ > 0 ? 2 : 1;
    run(job, kinds * picture_map_.photons, true);
    const float shrunk = radius_of_pass(pass), largest = length(world_.centre) + world_.radius;
    job.near = max(shrunk * global_radius_, kLeastPhotonRadius);
    job.maps =
        maps_.build(job.near, max(shrunk * caustic_radius_, kLeastPhotonRadius), largest, pass, picture_settings_.seed);
    run(job, pixels, false);
    rays_.camera += pixels;
}

void PhotonMapIntegrator::run(const PhotonJob& job, uint64_t walks, bool are_photons) {
    if (walks == 0) return;
    if (const HostTrees* trees = trees_of_loop()) {
        in_loop(*trees, job, walks, are_photons);
    } else {
        all_at_once(job, walks, are_photons);
    }
}

void PhotonMapIntegrator::in_loop(const HostTrees& trees, const PhotonJob& job, uint64_t walks, bool are_photons) {
    const uint32_t at_once = walks_within(picture_map_, true, kLoopBytes, kLoopWalks);
    std::atomic<uint64_t> bounces{0}, connections{0};
    parallel_for_ranges(walks, kLoopRange, [&](uint64_t begin, uint64_t end) {
        if (is_abandoned()) return;
        std::vector<Float4> memory(bytes_in_flight(at_once, picture_map_, true) / sizeof(Float4) + 1);
        PhotonJob part = job;
        lay_out_both(part.walk.walks, part.gather, reinterpret_cast<std::byte*>(memory.data()), at_once, picture_map_,
                     true);
        *part.walk.walks.counts = {};
        WalksInThread way(trees, room_of(at_once));
        for (part.walk.first = begin; part.walk.first < end; part.walk.first += at_once) {
            part.walk.count = static_cast<uint32_t>(std::min<uint64_t>(at_once, end - part.walk.first));
            run_walks_of(way, part, are_photons);
        }
        bounces += part.walk.walks.counts->bounces;
        connections += part.walk.walks.counts->all_asked;
    });
    rays_ = rays_ + RayCounts{0, bounces, connections};
}

void PhotonMapIntegrator::all_at_once(const PhotonJob& job, uint64_t walks, bool are_photons) {
    PhotonJob part = job;
    part.walk.walks = walks_;
    part.gather = gather_;
    queue_.zero(walks_.counts, sizeof(WalkCounts));
    WalksOnDevice way(queue_, *tracer_, seen_);
    for (part.walk.first = 0; part.walk.first < walks; part.walk.first += walks_in_flight_) {
        part.walk.count = static_cast<uint32_t>(std::min<uint64_t>(walks_in_flight_, walks - part.walk.first));
        run_walks_of(way, part, are_photons);
    }
    way.begin_rounds(0);
    WalkCounts counts;
    queue_.copy_to_host(&counts, walks_.counts, sizeof counts);
    rays_ = rays_ + RayCounts{0, counts.bounces, counts.all_asked};
}

} // namespace pertev
