#pragma once

// A listener for films: auxiliary layers of the first hit, and the samples of pixels.

#include "integrators/path/path_listener.h"
#include "render/first_hit.h"

namespace pertev {

class FirstHitLayers : public PathListener<FirstHitLayers> {
public:
    HD explicit FirstHitLayers(const PathJob& job) : job_(job) {}

    HD void missed(const PathState& path) {
        if (path.depth == 0) add_no_first_hit(job_.film, path.pixel, path.sample);
    }
    HD void vertex(const PathState& path, const Hit& hit, Surface& surface) {
        if (path.depth != 0) return;
        add_first_hit(job_.film, path.pixel, path.sample, {path.origin, path.direction}, hit, surface, job_.picture,
                      path.time);
    }
    static uint32_t depth_of_lanes(const PathJob& job) { return job.film.aovs == 0 ? 0 : 1; }
    void vertex_in_lanes(const PathState& path, const Hit& hit) {
        if (path.depth == 0) add_first_hit(job_.film, path.pixel, path.sample, hit, job_.picture);
    }
    HD void ended(uint32_t pixel, Rgb radiance, const PathData&) const { add_radiance(job_.film, pixel, radiance); }

private:
    const PathJob& job_;
};

using FilmListeners = Listeners<FirstHitLayers>;

} // namespace pertev
