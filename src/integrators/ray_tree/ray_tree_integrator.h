#pragma once

// An integrator whose samples are trees of rays (tree_memory.h): the one file that orders the stages. What differs from
// one to the other is `Algorithm`, a few lines (integrators/cast/cast.h is the shortest):
//   kMostBranches   rays that a vertex sends on, at most
//   kHasShutter     whether its rays have a time
//   shadow_rays     that a vertex may ask for
//   ask_for_light   writes one of them
//   follow          puts what the vertex sends on on the stack, and adds ambient light
//   ambient         its ambient light where none was asked for
//
// Two bodies give the same bytes: on the CPU each thread takes some trees of its own from the camera to the film; else
// every stage runs over all trees in flight, and their rays go through the scene's tracer.
//
// The functions stand in ray_tree_integrator_body.h, which each algorithm's .cpp includes.

#include <cstddef>
#include <cstdint>

#include "device/buffer.h"
#include "device/readback.h"
#include "integrators/integrator.h"
#include "integrators/ray_tree/ray_tree_settings.h"
#include "integrators/ray_tree/tree_memory.h"

namespace pertev {

template <class Algorithm>
class RayTreeIntegrator final : public Integrator {
public:
    /// `queue` outlives the integrator. `in_loop`: on the CPU, where it can walk the scene's trees by itself, threads
    /// take trees of their own. `batch`: most trees in flight else; their memory is kMostTreeBytes at most.
    RayTreeIntegrator(Queue& queue, const RayTreeSettings& settings, bool in_loop, uint32_t batch);

    /// Bytes that begin() takes for so many samples of all pixels together, where the trees are in flight all at once.
    /// `has_times`: something moves while the shutter is open.
    static std::size_t predicted_bytes(const RayTreeSettings& settings, uint64_t samples, uint32_t batch,
                                       bool has_times);

    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;
    /// The loop alone does.
    void abandon_when(const std::atomic<bool>* flag) override { abandon_ = flag; }
    RayCounts rays() const override { return rays_; }
    std::size_t bytes() const override { return memory_.size(); }

    /// Counts from the next begin().
    void set_settings(const RayTreeSettings& settings) { settings_ = settings; }

private:
    const HostTrees* trees_of_loop() const; // null: all at once
    void render_loop(uint32_t first, uint32_t count, const FilmView& film, const HostTrees& trees);
    void render_all_at_once(uint32_t first, uint32_t count, const FilmView& film);
    void give_rounds(uint32_t trees, const FilmView& film);
    void shade(const WorkCount& rays, const FilmView& film, uint32_t round, uint32_t first, bool is_last);

    Queue& queue_;
    RayTreeSettings settings_, picture_settings_; // asked for; with the picture's own ambient light
    bool in_loop_;
    uint32_t batch_;
    PictureView picture_{};
    SceneTracer* tracer_ = nullptr;
    const std::atomic<bool>* abandon_ = nullptr;
    RayCounts rays_;

    Buffer<std::byte> memory_;
    TreesView trees_{}; // of memory_
    Readback<TreeCounts> seen_;
};

// Those that there are.
struct Cast;
struct Whitted;
struct Distributed;
struct Radiosity;
extern template class RayTreeIntegrator<Cast>;
extern template class RayTreeIntegrator<Whitted>;
extern template class RayTreeIntegrator<Distributed>;
extern template class RayTreeIntegrator<Radiosity>;

} // namespace pertev
