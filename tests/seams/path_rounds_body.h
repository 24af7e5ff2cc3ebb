#pragma once

// The body of PathRounds::render, included only by the .cu file that instantiates it with its stages, like that of
// launch (device/launch_body.h). Elsewhere a compiler could inline it, and its launches have no body there.

#include "device/launch.h"
#include "tests/seams/path_rounds.h"

namespace pertev::test {

template <Features kFeatures, class Listener, class Job>
void PathRounds<kFeatures, Listener, Job>::render(const Job& job, SceneTracer& tracer, uint32_t first, uint32_t end) {
    const uint32_t count = job.film.window.count();
    const uint32_t p = pixels_;
    Uint2* const ids = triangles_.data();
    const RoundsView<Listener> view = {.paths = paths_.data(),
                                       .continuation = {rays_.data(), ids, ids + p},
                                       .shadows = {rays_.data() + p, ids + 2 * p, ids + 3 * p},
                                       .hits = {records_.data(), instances_.data()},
                                       .occlusions = {nullptr, instances_.data() + p}};
    for (uint32_t sample = first; sample < end; ++sample) {
        launch(queue_, "begin_round", count, BeginRound<Listener, Job>{job, view, sample});
        for (uint32_t depth = 0; depth <= job.settings.max_depth; ++depth) {
            const RayKind kind = depth == 0 ? RayKind::Camera : RayKind::Bounce;
            tracer.find_hits(kind, view.continuation.query(), count, view.hits);
            launch(queue_, "shade_round", count, ShadeRound<kFeatures, Listener, Job>{job, view});
            tracer.find_occlusions(view.shadows.query(), count, view.occlusions);
            launch(queue_, "add_round_light", count, AddRoundLight<Listener, Job>{job, view});
        }
        launch(queue_, "end_rounds", count, EndRounds<Listener, Job>{job, view});
    }
    queue_.wait();
}

} // namespace pertev::test
