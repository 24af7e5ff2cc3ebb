#pragma once

// A light meter: pictures of a camera with Projection::Cosine are the radiance of a white diffuse surface that stands
// at the camera and faces along its -z; pi times that is the irradiance there. No such surface is in the scene. Paths
// begin where its bounces would, and this is its next-event estimation: one light a sample, lights without extent
// included, weighted against what the paths find as at every other vertex (integrators/path/path_vertex.h).

#include <cstdint>

#include "device_scene/ray_queue.h"
#include "device_scene/surface.h"
#include "integrators/path/path_settings.h"
#include "integrators/path/path_state.h"
#include "render/film_view.h"
#include "render/picture_view.h"
#include "shading/power_heuristic.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// Samples of pixels that go to the tracer together.
struct MeterSamples {
    uint32_t pixels, first_sample;
    PixelWindow window; // which pixels of the picture they are
};

struct MeterQueueView {
    Ray* rays;
    Uint2* targets;
    uint32_t* keys;       // then what the ray met
    Float4* contribution; // rgb, bits of the pixel

    RayQueueView query() const { return {.rays = rays, .targets = targets, .keys = keys}; }
};

/// What reaches the meter from one point of one light, if nothing stands between; black where nothing does.
HD inline ShadowRay draw_meter_light(const PictureView& picture, const PathSettings& settings, uint32_t pixel,
                                     uint32_t sample) {
    const SceneView& scene = picture.scene;
    const Vec3 point = picture.camera.view.world_from_camera.translation, normal = picture.camera.axis;
    ShadowRay shadow;
    shadow.origin = point;
    shadow.direction = normal;
    shadow.contribution = {0, 0, 0};
    LightSample light;
    const SampleBits u = sample_bits(settings.sampler, sample_key(settings, pixel, sample), kGroupLens);
    if (settings.strategy == LightStrategy::BsdfOnly || !sample_light(scene.lights, point, u, light)) return shadow;
    const float pdf = pdf_cosine_hemisphere(dot(normal, light.wi));
    if (!(pdf > 0)) return shadow;
    const uint32_t key = coin_key({pixel, sample, settings.seed}, 0, true);
    if (light.instance != kNoLight && scene.any_alpha != 0 &&
        !AcceptHit{scene, {}, {}, key}.passes_alpha(light.instance, light.primitive, light.b1, light.b2)) {
        return shadow; // a hole in the light
    }
    const bool is_weighted = !light.is_delta && settings.strategy == LightStrategy::Mis;
    const float weight = is_weighted ? power_heuristic(light.pdf, pdf) : 1.0f;
    const Ray ray = ray_to_light(light, point, {0, 0, 0}, normal);
    shadow.origin = ray.origin;
    shadow.direction = ray.direction;
    shadow.t_max = ray.t_max;
    shadow.target = {light.instance, light.primitive};
    shadow.contribution = (pdf * (weight / light.pdf)) * light.radiance; // of albedo 1 the BSDF's value is its density
    return shadow;
}

struct DrawMeterLights {
    PictureView picture;
    PathSettings settings;
    MeterSamples samples;
    MeterQueueView queue;

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = samples.window.pixel_at(i % samples.pixels);
        const uint32_t sample = samples.first_sample + i / samples.pixels;
        const ShadowRay shadow = draw_meter_light(picture, settings, pixel, sample);
        store_ray(queue.rays + i, {shadow.origin, 0.0f, shadow.direction, shadow.t_max});
        queue.targets[i] = {shadow.target.instance, shadow.target.primitive};
        queue.keys[i] = coin_key({pixel, sample, settings.seed}, 0, true);
        const Rgb c = shadow.contribution;
        queue.contribution[i] = {c.r, c.g, c.b, float_of(pixel)};
    }
};

struct AddMeterLights {
    MeterQueueView queue;
    FilmView film;

    HD void operator()(uint32_t i) const {
        const Float4 c = queue.contribution[i];
        if (queue.keys[i] == kNoHit) add_radiance(film, bits_of(c.w), {c.x, c.y, c.z});
    }
};

/// Adds to samples [first, first + count) of each pixel what lights send to the meter. Returns the rays that it took.
/// Throws Error(OutOfMemory, DeviceFault).
uint64_t add_meter_lights(Queue& queue, SceneTracer& tracer, const PictureView& picture, const PathSettings& settings,
                          uint32_t first, uint32_t count, const FilmView& film);

} // namespace pertev
