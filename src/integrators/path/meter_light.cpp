#include "integrators/path/meter_light.h"

#include <algorithm>

#include "device/buffer.h"
#include "device/launch.h"

namespace pertev {

uint64_t add_meter_lights(Queue& queue, SceneTracer& tracer, const PictureView& picture, const PathSettings& settings,
                          uint32_t first, uint32_t count, const FilmView& film) {
    if (picture.scene.lights.choice.starts == nullptr) return 0; // there are no lights
    constexpr uint32_t kMaxRays = 1u << 18;                      // rays at once
    const uint32_t pixels = film.window.count();
    const uint32_t samples_at_once = std::clamp(kMaxRays / pixels, 1u, count);
    const uint32_t most = pixels * samples_at_once;
    const Buffer<Ray> rays(queue, most, "a meter's rays");
    const Buffer<Uint2> targets(queue, most, "a meter's rays");
    const Buffer<uint32_t> keys(queue, most, "a meter's rays");
    const Buffer<Float4> contribution(queue, most, "a meter's rays");
    const bool has_walls = picture.scene.thin_walls.is_there();
    const MeterQueueView view = {rays.data(), targets.data(), keys.data(), contribution.data()};
    for (uint32_t done = 0; done < count;) {
        const uint32_t now = std::min(samples_at_once, count - done);
        const BeginOrder samples_now = {film.window, first + done, now};
        launch(queue, "draw_meter_lights", pixels * now, DrawMeterLights{picture, settings, samples_now, view});
        tracer.find_occlusions(view.query(has_walls), pixels * now, {nullptr, keys.data()});
        launch(queue, "add_meter_lights", pixels * now, AddMeterLights{view, film});
        done += now;
    }
    queue.wait(); // the buffers must outlive queued work
    return uint64_t(pixels) * count;
}

} // namespace pertev
