// The part of SessionFrames that answers picks.

#include <algorithm>

#include "apps/viewer/session_frames.h"
#include "apps/viewer/steering.h"
#include "device_scene/ray_queue.h"
#include "render/film_channels.h"
#include "scene/scene_origin.h"

namespace pertev {

std::optional<PickedPoint> SessionFrames::pick(const Camera& camera, float x, float y) {
    const RenderSettings& now = session_.settings();
    const float aspect = static_cast<float>(now.width) / static_cast<float>(now.height);
    RenderSettings settings = now;
    settings.width = settings.height = 1;
    settings.samples = 1;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0;
    settings.path.max_depth = 0;
    const RenderResult seen = session_.render_separately(camera_through(camera, aspect, x, y), settings);
    if (seen.ids.empty() || seen.ids.front().instance == kNoHit) return std::nullopt;
    std::optional<Rgb> light;
    if (shows_film_ && session_.camera() == camera) {
        const Image film = session_.picture();
        const auto pixel_at = [](float share, uint32_t side) {
            return std::min(static_cast<uint32_t>(share * static_cast<float>(side)), side - 1);
        };
        const float* const values = film.at(pixel_at(x, film.width), pixel_at(y, film.height));
        light = {values[0], values[1], values[2]};
    }
    PickedPoint picked = {.instance = seen.ids.front().instance,
                          .primitive = seen.ids.front().primitive,
                          .material = seen.ids.front().material};
    const auto values = [&](const char* name) { return layer_named(seen, name).pixels.data(); };
    const float *albedo = values("albedo"), *normal = values("normal"), *position = values("position");
    picked.albedo = {albedo[0], albedo[1], albedo[2]};
    picked.normal = {normal[0], normal[1], normal[2]};
    const Scene& scene = scene_.scene();
    picked.position = {position[0], position[1], position[2]};
    if (!scene.is_far) picked.position = in_scene(scene, to_double(picked.position));
    picked.distance = values("depth")[0];
    picked.light = light;
    return picked;
}

} // namespace pertev
