#include "integrators/render_picture.h"

#include <algorithm>

#include "base/stopwatch.h"
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

uint32_t batch_of(const RenderSettings& settings) {
    const uint64_t paths = uint64_t(settings.width) * settings.height * settings.samples;
    return static_cast<uint32_t>(std::min<uint64_t>(settings.batch, paths));
}

} // namespace

std::size_t predicted_bytes(const PreparedScene& prepared, const RenderSettings& settings, bool on_cuda) {
    const std::size_t film = Film::predicted_bytes(settings.width, settings.height, settings.aovs);
    const bool wavefront = on_cuda || settings.body == PathBody::Wavefront;
    return predicted_bytes(prepared) + film + (wavefront ? PathRenderer::kBytesPerPath * batch_of(settings) : 0);
}

RenderResult render_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                            const RenderSettings& settings,
                            const std::function<bool(const RenderProgress&)>& keep_going) {
    RenderResult result;
    Stopwatch watch;
    const SceneOnDevice scene(queue, prepared);
    Film film(queue, settings.width, settings.height, settings.aovs);
    const PathBody body = queue.is_cuda() ? PathBody::Wavefront : settings.body;
    PathSettings path = settings.path;
    path.hide_background = settings.transparent;
    PathRenderer renderer(queue, scene.view(), camera, settings.filter, filter_radius_of(settings), path,
                          settings.width, settings.height, body, batch_of(settings));
    if (settings.stage_seconds != nullptr) renderer.time_stages(*settings.stage_seconds);
    result.hidden_back_share = renderer.hidden_back_share();
    queue.wait();
    result.upload_seconds = watch.seconds();

    watch.restart();
    while (result.samples < settings.samples) {
        const uint32_t count = next_pass(settings, result.samples, watch.seconds());
        renderer.render(result.samples, count, film);
        result.samples += count;
        const double seconds = watch.seconds();
        if (result.first_pixel_seconds == 0) result.first_pixel_seconds = seconds;
        const RenderProgress progress{result.samples, settings.samples, seconds, renderer.rays()};
        if (keep_going && !keep_going(progress)) break;
        if (settings.time_limit_s > 0 && seconds >= settings.time_limit_s) break;
    }
    result.render_seconds = watch.seconds();
    result.rays = renderer.rays();
    result.invalid_samples = film.invalid_samples();
    result.picture = film.picture(result.samples, settings.transparent);
    result.layers = film.layers(result.samples);
    result.ids = film.ids();
    result.device_peak_bytes = queue.peak_bytes();
    return result;
}

} // namespace pertev
