#pragma once

// An integrator whose samples consist of a light subpath and a camera subpath. `Algorithm` defines in a few lines how
// they are used (integrators/light/light.h, bidirectional/bidirectional.h):
//   kIsConnected  whether the subpaths connect
//   room       sizes for a number of subpaths
//   render     the stages in order, written once for both schedules
// The .cpp of each algorithm instantiates it.

#include "integrators/subpaths/run_subpaths.h"
#include "integrators/subpaths/subpath_settings.h"

namespace pertev {

template <class Algorithm>
class SubpathIntegrator final : public TwoSchedules<SubpathSettings, SubpathJob> {
public:
    using TwoSchedules::TwoSchedules;

    void reserve(const WorkSize& size) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;

private:
    static SubpathCapacity capacity_for(const SubpathSettings& settings, const WorkSize& size, std::size_t bytes,
                                        uint64_t most) {
        return capacity_within(bytes, most, [&](uint32_t subpaths) {
            SubpathCapacity capacity = Algorithm::capacity(settings, subpaths);
            capacity.has_interiors = size.has_interiors && size.has_media;
            capacity.has_normals =
                Algorithm::kIsConnected && uses_light_tree(settings.light_choice, size.tree_lights, size.has_times);
            return capacity;
        });
    }
};

template <class Algorithm>
void SubpathIntegrator<Algorithm>::reserve(const WorkSize& size) {
    if (uses_loop(size)) return;
    allocate_capacity(capacity_for(settings_, size, kMaxBytes, std::min<uint64_t>(size.all(), batch_)), "light paths");
}

template <class Algorithm>
void SubpathIntegrator<Algorithm>::render(uint32_t first, uint32_t count, const FilmView& film) {
    check_sums(film);
    constexpr std::size_t kLoopBytes = std::size_t(1) << 18; // per thread, so that it fits the cache
    SubpathJob job = {};
    job.scene = {picture_, picture_settings_, sphere_round(tracer_->bounds()), Algorithm::kIsConnected};
    job.film = film;
    const WorkSize size = size_of(picture_, *tracer_, count);
    const SubpathCapacity loop_capacity = capacity_for(picture_settings_, size, kLoopBytes, kLoopCount);
    const auto run = [&](const PixelWindow& window, const auto& stages) {
        job.samples = {window, first, count};
        run_stages(job, 0, job.samples.count(), loop_capacity, count, [&](auto& schedule, const SubpathJob& part) {
            if (!is_abandoned()) stages(schedule, part);
        });
    };
    run(film.window, [](auto& schedule, const SubpathJob& part) { Algorithm::render(schedule, part); });
    rays_.camera += job.samples.count();
    // Particles of the pixels around the window may be seen in it.
    for (const PixelWindow& window : windows_around(film.window, picture_.camera.height)) {
        run(window,
            [](auto& schedule, const SubpathJob& part) { run_particles<Algorithm::kIsConnected>(schedule, part); });
    }
}

// Explicit instantiations.
struct ParticlesAlone;
struct BothDirections;
extern template class SubpathIntegrator<ParticlesAlone>;
extern template class SubpathIntegrator<BothDirections>;

} // namespace pertev
