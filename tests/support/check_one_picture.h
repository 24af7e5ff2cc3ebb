#pragma once

// Checks the one-picture law for one integrator, with the mixed scene or another one.

#include <doctest/doctest.h>

#include <algorithm>

#include "base/parallel_for.h"
#include "session/session.h"
#include "session/session_bytes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stop_after.h"

namespace pertev::test {

/// The camera of the mixed scene, with a lens.
inline Camera camera_with_lens() {
    Camera camera = mixed_scene_camera();
    camera.aperture_radius = 0.05f;
    camera.focus_distance = 6;
    return camera;
}

struct CheckedPicture {
    Hash128 hash;
    RayCounts rays;
};

inline CheckedPicture checked_picture(Queue& queue, const Scene& scene, const RenderSettings& settings) {
    const RenderResult result = render(queue, scene, camera_with_lens(), settings);
    CHECK(result.invalid_samples == 0);
    return {render_hash(result), result.rays};
}

/// Returns the hash of the layers of the first surface.
inline Hash128 hash_of_layers(Queue& queue, const Scene& scene, const RenderSettings& settings,
                              const Camera& camera = camera_with_lens()) {
    RenderResult result = render(queue, scene, camera, settings);
    std::ranges::fill(result.picture.pixels, 0.0f);
    return render_hash(result);
}

inline void check_same(const CheckedPicture& a, const CheckedPicture& b) {
    CHECK(a.hash == b.hash);
    CHECK(a.rays.camera == b.rays.camera);
    CHECK(a.rays.bounce == b.rays.bounce);
    CHECK(a.rays.shadow == b.rays.shadow);
}

/// Checks that renders by 1 and 5 threads, in other passes, by all stages with few samples in flight and with all, and
/// with --device cuda on the GPU have the same bytes and rays, and that another seed gives another picture. Returns the
/// result of the CPU's loop.
inline CheckedPicture check_one_picture(const Scene& scene, RenderSettings settings) {
    Queue queue = Queue::make_cpu();
    const CheckedPicture reference = checked_picture(queue, scene, settings);
    Queue one = Queue::make_cpu(Threads(1)), five = Queue::make_cpu(Threads(5));
    check_same(checked_picture(one, scene, settings), reference);
    settings.pass_samples = 3;
    check_same(checked_picture(five, scene, settings), reference);
    settings.body = PathBody::Wavefront;
    for (const uint32_t batch : {333u, 1u << 20}) { // less than a picture, and all samples
        settings.batch = batch;
        check_same(checked_picture(queue, scene, settings), reference);
        if (!cuda_requested()) continue;
        Queue gpu = make_cuda_queue();
        check_same(checked_picture(gpu, scene, settings), reference);
    }
    settings.path.seed = 1;
    CHECK(checked_picture(queue, scene, settings).hash != reference.hash);
    return reference;
}

/// Checks that a session has the picture of a fresh one after it was abandoned, interrupted after its first pass (as by
/// Ctrl-C), ended by the time limit after another and resumed, with passes of one sample, two samples or more.
inline void check_goes_on(Session& session, Queue& queue, const Scene& scene, const RenderSettings& settings,
                          const Camera& camera = camera_with_lens()) {
    session.set_settings(settings);
    if (!queue.is_cuda()) CHECK(session.render(settings.samples, StopAfter(0)) == 0);
    ProgressSink until_first([](const Progress& now) { return now.samples_done == 0; });
    CHECK(session.render(settings.samples, until_first) == 1);
    RenderSettings short_of_time = settings;
    short_of_time.time_limit_s = 1e-9;
    session.set_settings(short_of_time);
    CHECK(session.render(settings.samples - 1) == 1);
    session.set_settings(settings);
    CHECK(session.render(settings.samples - 2) == settings.samples - 2);
    CHECK(render_hash(session.result()) == render_hash(render(queue, scene, camera, settings)));
}

/// Checks that a picture takes the predicted memory. `sorts` means that it sorts on a GPU, where only CUB on the device
/// knows how much it takes. `on_host` are predicted bytes on the CPU that no queue allocates.
inline void check_predicted_bytes(const PreparedScene& prepared, const RenderSettings& settings, bool sorts = false,
                                  std::size_t on_host = 0) {
    Queue queue = requested_queue();
    Session session(queue, prepared, camera_with_lens(), settings);
    session.render(settings.samples);
    const std::size_t beside = queue.is_cuda() ? 0 : on_host;
    const std::size_t predicted = predicted_bytes(prepared, settings, queue.is_cuda()) - beside;
    const std::size_t sorting = sorts && queue.is_cuda() ? predicted / 10 : 0;
    CHECK(queue.allocated_bytes() + sorting >= predicted);
    CHECK(queue.allocated_bytes() <= predicted + 4096 + sorting); // the filter's table, the scene's view
}

} // namespace pertev::test
