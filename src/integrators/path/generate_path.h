#pragma once

// First step of a path: draws the place in the pixel and on the lens.

#include "integrators/path/path_settings.h"
#include "integrators/path/path_state.h"
#include "render/camera_view.h"
#include "render/pixel_filter.h"

namespace pertev {

struct PathCamera {
    CameraView view;
    PixelFilterView filter;
    uint32_t width; // pixels
};

HD inline PathState generate_path(const PathCamera& camera, const PathSettings& settings, uint32_t pixel,
                                  uint32_t sample) {
    const SampleKey key = {pixel, sample, settings.seed};
    const Vec2 offset = sample_filter(camera.filter, sample_2d(settings.sampler, key, kGroupCamera));
    const Vec2 lens = camera.view.aperture_radius > 0 ? sample_2d(settings.sampler, key, kGroupLens) : Vec2{};
    const uint32_t row = pixel / camera.width;
    const Vec2 place = {static_cast<float>(pixel % camera.width) + 0.5f + offset.x,
                        static_cast<float>(row) + 0.5f + offset.y};
    const Ray ray = make_camera_ray(camera.view, place, lens);
    PathState path;
    path.origin = ray.origin;
    path.direction = ray.direction;
    path.pixel = pixel;
    path.sample = sample;
    return path;
}

} // namespace pertev
