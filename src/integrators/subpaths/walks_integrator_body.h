#pragma once

// The functions of WalksIntegrator: included by the .cpp of each algorithm, and by nothing else.

#include <algorithm>
#include <atomic>

#include "base/error.h"
#include "base/parallel_for.h"
#include "integrators/subpaths/run_walks.h"
#include "integrators/subpaths/walks_integrator.h"

namespace pertev {
namespace walks {

inline constexpr std::size_t kMostBytes = std::size_t(1) << 30; // of a device
inline constexpr std::size_t kLoopBytes = std::size_t(1) << 18; // of a thread: what its cache holds
inline constexpr uint64_t kLoopPixels = 256;                    // at least, that a thread takes at once

/// As many as fit into `bytes`, at most `most` and at least 32.
template <class Algorithm>
WalkRoom room_within(const SubpathSettings& settings, std::size_t bytes, uint64_t most) {
    const std::size_t each = bytes_of(Algorithm::room(settings, 32)) / 32;
    const uint64_t fit = std::max<std::size_t>(bytes / each, 32);
    return Algorithm::room(settings, static_cast<uint32_t>(std::min<uint64_t>(most, fit)));
}

inline WorldSphere sphere_round(const Bounds3& bounds) {
    if (bounds.is_empty()) return {};
    return {bounds.centre(), 0.51f * length(bounds.size())}; // half the diagonal, and what rounding may take of it
}

} // namespace walks

template <class Algorithm>
WalksIntegrator<Algorithm>::WalksIntegrator(Queue& queue, const SubpathSettings& settings, bool in_loop, uint32_t batch)
    : queue_(queue), settings_(settings), in_loop_(in_loop), batch_(batch), seen_(queue) {}

template <class Algorithm>
std::size_t WalksIntegrator<Algorithm>::predicted_bytes(const SubpathSettings& settings, uint64_t samples,
                                                        uint32_t batch) {
    return bytes_of(walks::room_within<Algorithm>(settings, walks::kMostBytes, std::min<uint64_t>(samples, batch)));
}

template <class Algorithm>
const HostTrees* WalksIntegrator<Algorithm>::trees_of_loop() const {
    return in_loop_ ? tracer_->host_trees() : nullptr;
}

template <class Algorithm>
void WalksIntegrator<Algorithm>::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    picture_ = picture;
    tracer_ = &tracer;
    rays_ = {};
    picture_settings_ = settings_;
    if (trees_of_loop() != nullptr) return;
    const uint64_t all = uint64_t(picture.camera.width) * picture.camera.height * samples;
    const WalkRoom room = walks::room_within<Algorithm>(settings_, walks::kMostBytes, std::min<uint64_t>(all, batch_));
    if (memory_.size() < bytes_of(room)) {
        memory_ = {}; // before there is more
        memory_ = {queue_, bytes_of(room), "light paths"};
    }
    lay_out(walks_, memory_.data(), room);
}

template <class Algorithm>
WalkJob WalksIntegrator<Algorithm>::make_job(const FilmView& film) const {
    WalkJob job = {};
    job.scene = {picture_, picture_settings_, walks::sphere_round(tracer_->bounds()), Algorithm::kIsJoined};
    job.film = film;
    return job;
}

template <class Algorithm>
void WalksIntegrator<Algorithm>::render(uint32_t first, uint32_t count, const FilmView& film) {
    PERTEV_CHECK(!film.frame.is_there());
    if (const HostTrees* trees = trees_of_loop()) {
        render_loop(first, count, film, *trees);
    } else {
        render_all_at_once(first, count, film);
    }
}

template <class Algorithm>
void WalksIntegrator<Algorithm>::render_loop(uint32_t first, uint32_t count, const FilmView& film,
                                             const HostTrees& trees) {
    const uint64_t pixels = uint64_t(picture_.camera.width) * picture_.camera.height;
    const WalkRoom room = walks::room_within<Algorithm>(picture_settings_, walks::kLoopBytes, 256);
    std::atomic<uint64_t> bounces{0}, connections{0};
    parallel_for_ranges(pixels, walks::kLoopPixels, [&](uint64_t begin, uint64_t end) {
        if (abandon_ != nullptr && *abandon_) return;
        std::vector<Float4> memory(bytes_of(room) / sizeof(Float4) + 1);
        WalkJob job = make_job(film);
        lay_out(job.walks, reinterpret_cast<std::byte*>(memory.data()), room);
        *job.walks.counts = {};
        job.samples = {static_cast<uint32_t>(begin), static_cast<uint32_t>(end - begin), first, count};
        WalksInThread way(trees, room);
        const uint64_t all = job.samples.count();
        for (job.first = 0; job.first < all; job.first += room.walks) {
            job.count = static_cast<uint32_t>(std::min<uint64_t>(room.walks, all - job.first));
            Algorithm::render(way, job);
        }
        bounces += job.walks.counts->bounces;
        connections += job.walks.counts->all_asked;
    });
    rays_ = rays_ + RayCounts{pixels * count, bounces, connections};
}

template <class Algorithm>
void WalksIntegrator<Algorithm>::render_all_at_once(uint32_t first, uint32_t count, const FilmView& film) {
    const uint32_t pixels = picture_.camera.width * picture_.camera.height;
    WalkJob job = make_job(film);
    job.walks = walks_;
    job.samples = {0, pixels, first, count};
    const uint64_t all = job.samples.count();
    queue_.zero(walks_.counts, sizeof(WalkCounts));
    WalksOnDevice way(queue_, *tracer_, seen_);
    for (job.first = 0; job.first < all; job.first += walks_.room.walks) {
        job.count = static_cast<uint32_t>(std::min<uint64_t>(walks_.room.walks, all - job.first));
        Algorithm::render(way, job);
    }
    way.begin_rounds(0);
    WalkCounts counts;
    queue_.copy_to_host(&counts, walks_.counts, sizeof counts);
    rays_ = rays_ + RayCounts{all, counts.bounces, counts.all_asked};
}

} // namespace pertev
