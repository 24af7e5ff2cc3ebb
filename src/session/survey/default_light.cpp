#include "session/survey/default_light.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/parallel_for.h"
#include "math/portable_math.h"
#include "session/survey/aisle.h"
#include "session/survey/surroundings.h"

namespace pertev {
namespace {

constexpr uint32_t kSkyWidth = 256, kSkyHeight = 128;

bool is_lamp(const Material& material) {
    // What glows by a texture is a display or a badge, not what the rest is to be seen by.
    return material.is_lamp() && !material.emission_texture.has_image();
}

bool needs_light(const Scene& scene) {
    if (scene.environment) return false;
    const bool is_lit = std::any_of(scene.lights.begin(), scene.lights.end(),
                                    [](const Light& light) { return max_component(light.intensity) > 0; });
    if (is_lit) return false;
    bool is_all_unlit = true; // what is unlit is seen without light, and gives none to the rest
    for (const Instance& instance : scene.instances) {
        const Material& material = scene.materials[instance.material];
        if (is_lamp(material)) return false; // hidden or not: it may come
        is_all_unlit = is_all_unlit && material.kind == MaterialKind::Unlit;
    }
    return !is_all_unlit;
}

/// Radiance from the unit direction d, W/(sr m2).
Rgb sky(Vec3 d) {
    const Rgb zenith = {0.32f, 0.46f, 0.72f}, horizon = {0.84f, 0.89f, 0.95f}, ground = {0.30f, 0.28f, 0.26f};
    const float up = d.y > 0 ? d.y : 0.0f;
    Rgb colour = lerp(horizon, zenith, up * (2 - up));
    // The ground rises into the horizon within a few degrees: a hard edge would show in every mirror.
    if (d.y < 0) colour = lerp(horizon, ground, min(-8 * d.y, 1.0f));
    // A lobe cos^64, in squarings: soft shadows, and few samples find it.
    const Vec3 sun = normalize({-0.45f, 0.72f, 0.53f});
    float lobe = max(dot(d, sun), 0.0f);
    for (int i = 0; i < 6; ++i) lobe = lobe * lobe;
    return colour + (32.0f * lobe) * Rgb{1.0f, 0.92f, 0.78f};
}

Environment make_sky() {
    Environment environment;
    Image& image = environment.image;
    image = {.width = kSkyWidth, .height = kSkyHeight, .channels = 3, .pixels = {}};
    image.pixels.resize(std::size_t(kSkyWidth) * kSkyHeight * 3);
    parallel_for(kSkyHeight, 8, [&](uint64_t y) {
        const float theta = kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(kSkyHeight);
        for (uint32_t x = 0; x < kSkyWidth; ++x) {
            const float phi = kTwoPi * ((static_cast<float>(x) + 0.5f) / static_cast<float>(kSkyWidth) - 0.5f);
            const Rgb c = sky({sin(theta) * sin(phi), cos(theta), -(sin(theta) * cos(phi))});
            float* pixel = image.at(x, static_cast<uint32_t>(y));
            pixel[0] = c.r, pixel[1] = c.g, pixel[2] = c.b;
        }
    });
    return environment;
}

void add_lamps(Scene& scene, const Surroundings& room) {
    const Aisle aisle = find_aisle(scene, room);
    constexpr int count = 5;
    for (int i = 0; i < count; ++i) {
        const float at = ((static_cast<float>(i) + 0.5f) / count - 0.5f) * 0.9f * aisle.length;
        const Vec3 below = aisle.middle + at * aisle.along;
        const float up = distance_along(scene, below, {0, 1, 0}, 0.5f * aisle.height);
        Light lamp;
        lamp.name = fmt::format("default lamp {}", i);
        lamp.position = below + Vec3{0, 0.6f * up, 0};
        // About 1 W/(sr m2) off a white floor below one.
        lamp.intensity = (kPi * square(0.6f * up)) * Rgb{1.0f, 0.93f, 0.82f};
        scene.lights.push_back(std::move(lamp));
    }
}

} // namespace

DefaultLight add_default_light(Scene& scene, Messages& messages) {
    if (!needs_light(scene)) return DefaultLight::None;
    const Surroundings around = look_around(scene);
    if (around.is_dark) {
        add_lamps(scene, around);
        messages.make_up("no light in the scene, a closed room: it gets a row of lamps");
        return DefaultLight::Lamps;
    }
    scene.environment = make_sky();
    messages.make_up("no light in the scene: it gets a sky");
    return DefaultLight::Sky;
}

} // namespace pertev
