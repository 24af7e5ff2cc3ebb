#pragma once

// A light meter: a camera with Projection::Cosine renders the radiance of a white diffuse surface at the camera that
// faces along its -z; pi times that is the irradiance. No such surface is in the scene. Paths begin as its bounces
// would, and this is its next-event estimation: one light per sample, including lights without extent, with the MIS
// weights of any other vertex (integrators/path/path_vertex.h).

#include <cstdint>

#include "device_scene/media_along_ray.h"
#include "device_scene/ray_queue.h"
#include "device_scene/surface.h"
#include "device_scene/thin_walls.h"
#include "integrators/path/path_settings.h"
#include "integrators/path/path_state.h"
#include "render/begin_order.h"
#include "render/film_view.h"
#include "render/picture_view.h"
#include "shading/power_heuristic.h"
#include "tracer/scene_tracer.h"

namespace pertev {

struct MeterQueueView {
    Ray* rays;
    Uint2* targets;
    uint32_t* keys;       // keys, and after tracing the results
    Float4* contribution; // rgb, bits of the pixel

    RayQueueView query(bool passes_thin_walls) const {
        return {.rays = rays, .targets = targets, .keys = keys, .passes_thin_walls = passes_thin_walls};
    }
};

/// Light that reaches the meter from one point of one light without occlusion, through media and thin walls; black if
/// there is none.
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
    if (is_hole(scene, light, key)) return shadow;
    const bool is_weighted = !light.is_delta && settings.strategy == LightStrategy::Mis;
    const float weight = is_weighted ? power_heuristic(light.pdf, pdf) : 1.0f;
    const Ray ray = ray_to_light(light, point, {0, 0, 0}, normal);
    shadow.origin = ray.origin;
    shadow.direction = ray.direction;
    shadow.t_max = ray.t_max;
    shadow.target = {light.instance, light.primitive};
    shadow.contribution = (pdf * (weight / light.pdf)) * light.radiance; // for albedo 1 the BSDF's value equals its
                                                                         // density
    if (scene.thin_walls.is_there()) {
        const PassedWalls walls = pass_thin_walls(scene, ray);
        const bool is_too_deep = walls.count > settings.max_depth;
        shadow.contribution = is_too_deep ? Rgb{0, 0, 0} : walls.transmittance * shadow.contribution;
    }
    if (scene.has_media != 0) {
        shadow.contribution = transmittance_of_media(scene, picture.camera.interior, ray) * shadow.contribution;
    }
    return shadow;
}

struct DrawMeterLights {
    PictureView picture;
    PathSettings settings;
    BeginOrder samples; // traced together
    MeterQueueView queue;

    HD void operator()(uint32_t i) const {
        const auto [pixel, sample] = samples.at(i);
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

/// Adds direct light at the meter to samples [first, first + count) of each pixel. Returns the number of rays. Throws
/// Error(OutOfMemory, DeviceFault).
uint64_t add_meter_lights(Queue& queue, SceneTracer& tracer, const PictureView& picture, const PathSettings& settings,
                          uint32_t first, uint32_t count, const FilmView& film);

} // namespace pertev
