#pragma once

// An integrator whose samples are a walk from the lights and one from the camera each. What it does with them is
// `Algorithm` (integrators/light/light.h, bidirectional/bidirectional.h), a few lines:
//   kIsJoined  whether walks from both sides are joined
//   room       what so many walks need
//   render     the stages in their order, written once for both bodies
//
// Two bodies give the same bytes: on the CPU each thread takes some walks of its own from the lights to the film; else
// every stage runs over all walks in flight, and their rays go through the scene's tracer.
//
// The functions stand in walks_integrator_body.h, which each algorithm's .cpp includes.

#include <cstddef>
#include <cstdint>

#include "device/buffer.h"
#include "device/readback.h"
#include "integrators/integrator.h"
#include "integrators/subpaths/subpath_settings.h"
#include "integrators/subpaths/walk_memory.h"

namespace pertev {

struct WalkJob;

template <class Algorithm>
class WalksIntegrator final : public Integrator {
public:
    /// `queue` outlives the integrator. `in_loop`: on the CPU, where it can walk the scene's trees by itself, threads
    /// take walks of their own. `batch`: most samples in flight else; their memory is 1 GiB at most.
    WalksIntegrator(Queue& queue, const SubpathSettings& settings, bool in_loop, uint32_t batch);

    /// Bytes that begin() takes for so many samples of all pixels together, where the walks are in flight all at once.
    static std::size_t predicted_bytes(const SubpathSettings& settings, uint64_t samples, uint32_t batch);

    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;
    /// The loop alone does.
    void abandon_when(const std::atomic<bool>* flag) override { abandon_ = flag; }
    RayCounts rays() const override { return rays_; }
    std::size_t bytes() const override { return memory_.size(); }

    /// Counts from the next begin().
    void set_settings(const SubpathSettings& settings) { settings_ = settings; }

private:
    const HostTrees* trees_of_loop() const; // null: all at once
    WalkJob make_job(const FilmView& film) const;
    void render_loop(uint32_t first, uint32_t count, const FilmView& film, const HostTrees& trees);
    void render_all_at_once(uint32_t first, uint32_t count, const FilmView& film);

    Queue& queue_;
    SubpathSettings settings_, picture_settings_; // asked for; of the picture begun
    bool in_loop_;
    uint32_t batch_;
    PictureView picture_{};
    SceneTracer* tracer_ = nullptr;
    const std::atomic<bool>* abandon_ = nullptr;
    RayCounts rays_;

    Buffer<std::byte> memory_;
    WalksView walks_{}; // of memory_
    Readback<WalkCounts> seen_;
};

// Those that there are.
struct ParticlesAlone;
struct BothDirections;
extern template class WalksIntegrator<ParticlesAlone>;
extern template class WalksIntegrator<BothDirections>;

} // namespace pertev
