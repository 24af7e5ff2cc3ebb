#pragma once

// An integrator whose samples are ray trees (tree_memory.h). `Algorithm` defines one in a few lines
// (integrators/cast/cast.h is the shortest):
//   kMaxBranches   maximum number of continuation rays per vertex
//   kHasShutter     whether its rays have a time
//   kSelectsLights  whether it samples one of all lights
//   shadow_rays     number of shadow rays that a vertex may need
//   sample_direct_light   writes one of them
//   follow          pushes the vertex's continuation rays on the stack, and adds ambient light
//   ambient         its default ambient light
// The .cpp of each algorithm instantiates it.

#include "integrators/ray_tree/ray_tree_settings.h"
#include "integrators/ray_tree/run_trees.h"

namespace pertev {

template <class Algorithm>
class RayTreeIntegrator : public TwoSchedules<RayTreeSettings, TreeJob> {
public:
    using TwoSchedules::TwoSchedules;

    void reserve(const WorkSize& size) override;
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;

private:
    static TreeCapacity capacity_for(const RayTreeSettings& settings, const WorkSize& size, std::size_t bytes,
                                     uint64_t most) {
        // A stack holds the current ray and, for each vertex above it, all branches but the current one.
        const uint32_t entries =
            Algorithm::kMaxBranches > 1 ? 1 + (Algorithm::kMaxBranches - 1) * settings.max_depth : 1;
        const bool has_normals = uses_light_tree<Algorithm>(settings, size.tree_lights, size.has_times);
        return capacity_within(bytes, most, [&](uint32_t trees) {
            return TreeCapacity{trees, entries, size.has_times, size.has_interiors, has_normals};
        });
    }
};

template <class Algorithm>
void RayTreeIntegrator<Algorithm>::reserve(const WorkSize& size) {
    if (uses_loop(size)) return;
    allocate_capacity(capacity_for(settings_, size, kMaxBytes, std::min<uint64_t>(size.all(), batch_)), "ray trees");
}

template <class Algorithm>
void RayTreeIntegrator<Algorithm>::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    TwoSchedules::begin(picture, tracer, samples);
    if (settings_.has_ambient) return;
    const LightSetView& lights = picture.scene.lights;
    picture_settings_.ambient = Algorithm::ambient(lights.has_environment() ? &lights.environment : nullptr);
}

template <class Algorithm>
void RayTreeIntegrator<Algorithm>::render(uint32_t first, uint32_t count, const FilmView& film) {
    check_sums(film);
    constexpr std::size_t kLoopBytes = std::size_t(1) << 19; // per thread, so that it fits the cache
    constexpr uint64_t kMaxInLoop = 128;
    const WorkSize size = size_of(picture_, *tracer_, count);
    const BeginOrder samples = {film.window, first, count};
    run_stages({.picture = picture_, .settings = picture_settings_, .film = film, .samples = samples}, 0,
               samples.count(), capacity_for(picture_settings_, size, kLoopBytes, kMaxInLoop), count,
               [this](auto& schedule, const TreeJob& part) {
                   if (!is_abandoned()) run_trees<Algorithm>(schedule, part);
               });
    rays_.camera += samples.count();
}

// Explicit instantiations.
struct Cast;
struct Whitted;
struct Distributed;
struct Radiosity;
extern template class RayTreeIntegrator<Cast>;
extern template class RayTreeIntegrator<Whitted>;
extern template class RayTreeIntegrator<Distributed>;
extern template class RayTreeIntegrator<Radiosity>;

} // namespace pertev
