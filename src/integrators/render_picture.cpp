#include "integrators/render_picture.h"

#include <algorithm>

#include "base/stopwatch.h"
#include "render/filter_table.h"
#include "render/hidden_back_share.h"
#include "render/scene_on_device.h"

namespace pertev {
namespace {

/// Samples of the next pass: aims at a third of a second, so that progress moves and Ctrl-C is heard, at no cost that
/// shows. Never past the time that is left.
uint32_t next_pass(const RenderSettings& settings, uint32_t done, double seconds) {
    const uint32_t left = settings.samples - done;
    if (settings.pass_samples > 0) return std::min(left, settings.pass_samples);
    if (done == 0) return 1;
    const double a_sample = std::max(seconds / done, 1e-9);
    double budget = 1.0 / 3;
    if (settings.time_limit_s > 0) budget = std::min(budget, settings.time_limit_s - seconds);
    return std::min(left, static_cast<uint32_t>(std::clamp(budget / a_sample, 1.0, 65536.0)));
}

IntegratorSettings integrator_of(const RenderSettings& settings) {
    return {.path = settings.path, .body = settings.body, .batch = settings.batch};
}

TracerChoice tracers_of(const RenderSettings& settings, bool on_cuda) {
    return settings.tracers.value_or(default_tracers(on_cuda));
}

} // namespace

std::size_t predicted_bytes(const PreparedScene& prepared, const RenderSettings& settings, bool on_cuda) {
    const std::size_t film = Film::predicted_bytes(settings.width, settings.height, settings.aovs);
    const TracerChoice tracers = tracers_of(settings, on_cuda);
    const std::size_t structures = on_cuda ? prepared.structures->device_bytes(tracers) : 0;
    return predicted_bytes(prepared) + structures + film +
           predicted_bytes(integrator_of(settings), uint64_t(settings.width) * settings.height, settings.samples,
                           can_walk_on_host(tracers, on_cuda));
}

RenderResult render_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                            const RenderSettings& settings,
                            const std::function<bool(const RenderProgress&)>& keep_going) {
    RenderResult result;
    Stopwatch watch;
    const SceneOnDevice scene(queue, prepared);
    Film film(queue, settings.width, settings.height, settings.aovs);
    FilterTable filter(queue);
    const PictureView picture = {scene.view(),
                                 make_camera_rays(camera, filter.set(settings.filter, filter_radius_of(settings)),
                                                  settings.width, settings.height, prepared.centre),
                                 settings.transparent};
    const std::unique_ptr<Integrator> renderer = make_integrator(queue, integrator_of(settings));
    SceneTracer tracer(queue, *prepared.structures, tracers_of(settings, queue.is_cuda()));
    tracer.set_surfaces(scene.view());
    if (settings.time_kinds) tracer.time_kinds();
    renderer->begin(picture, tracer, settings.samples);
    result.hidden_back_share = hidden_back_share(queue, tracer, picture);
    queue.wait();
    result.upload_seconds = watch.seconds();

    watch.restart();
    while (result.samples < settings.samples) {
        const uint32_t count = next_pass(settings, result.samples, watch.seconds());
        renderer->render(result.samples, count, film);
        result.samples += count;
        const double seconds = watch.seconds();
        if (result.first_pixel_seconds == 0) result.first_pixel_seconds = seconds;
        const RenderProgress progress{result.samples, settings.samples, seconds, renderer->rays()};
        if (keep_going && !keep_going(progress)) break;
        if (settings.time_limit_s > 0 && seconds >= settings.time_limit_s) break;
    }
    result.render_seconds = watch.seconds();
    result.rays = renderer->rays();
    result.kind_seconds = tracer.seconds();
    result.invalid_samples = film.invalid_samples();
    result.picture = film.picture(result.samples, settings.transparent);
    result.layers = film.layers(result.samples);
    result.ids = film.ids();
    result.device_peak_bytes = queue.peak_bytes();
    return result;
}

} // namespace pertev
