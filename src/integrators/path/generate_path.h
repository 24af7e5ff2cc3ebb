#pragma once

// First step of a path: draws the place in the pixel and on the lens.

#include "integrators/path/path_settings.h"
#include "integrators/path/path_state.h"
#include "render/camera_rays.h"

namespace pertev {

HD inline PathState generate_path(const CameraRays& camera, const PathSettings& settings, uint32_t pixel,
                                  uint32_t sample) {
    const SampleKey key = sample_key(settings, pixel, sample);
    const Vec2 in_filter = sample_2d(settings.sampler, key, kGroupCamera);
    const Vec2 on_lens = camera.has_lens() ? sample_2d(settings.sampler, key, kGroupLens) : Vec2{};
    const Ray ray = camera.ray(pixel, in_filter, on_lens);
    PathState path;
    path.origin = ray.origin;
    path.direction = ray.direction;
    path.pixel = pixel;
    path.sample = sample;
    return path;
}

} // namespace pertev
