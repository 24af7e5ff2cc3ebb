#pragma once

// First step of a path: draws the position in the pixel and on the lens. Where a frame aims at a point, the ray goes
// there instead of through its pixel.

#include "integrators/path/path_settings.h"
#include "integrators/path/path_state.h"
#include "math/float4.h"
#include "render/batch_view.h"

namespace pertev {

/// Starts a path; `ray` and `time` come from CameraRays for the sample.
HD inline PathState begin_path(const CameraRays& camera, uint32_t pixel, uint32_t sample, const Ray& ray, float time) {
    PathState path;
    path.origin = ray.origin;
    path.direction = ray.direction;
    path.pixel = pixel;
    path.sample = sample;
    path.time = time;
    path.interior = camera.interior;
    path.bsdf_pdf = camera.pdf_of_surface(ray.direction);
    return path;
}

/// The camera ray of a pixel, which is `ray` unless it is aimed (NoisyFrameView::aims).
HD inline Ray aimed_ray(const CameraRays& camera, const Float4* aims, uint32_t pixel, const Ray& ray) {
    if (aims == nullptr) return ray;
    const Float4 aim = aims[pixel];
    return aim.w != 0 ? camera.ray_to(ray, {aim.x, aim.y, aim.z}) : ray;
}

HD inline PathState generate_path(const CameraRays& camera, const PathSettings& settings, const Float4* aims,
                                  uint32_t pixel, uint32_t sample) {
    const SampleKey key = sample_key(settings, pixel, sample);
    return begin_path(camera, pixel, sample, aimed_ray(camera, aims, pixel, camera.ray(pixel, settings.sampler, key)),
                      camera.time(settings.sampler, key));
}

/// Starts a path of one picture of a batch; `pixel` is that of the tall picture.
HD inline PathState generate_path(const BatchView& batch, SamplerKind sampler, uint32_t pixel, uint32_t sample) {
    const BatchView::PixelOfPicture at = batch.pixel_of(pixel);
    const CameraRays& camera = batch.cameras[at.picture];
    const SampleKey key = {at.pixel, sample, batch.seeds[at.picture]};
    return begin_path(camera, pixel, sample, camera.ray(at.pixel, sampler, key), camera.time(sampler, key));
}

} // namespace pertev
