#include "session/survey/default_light.h"

#include <algorithm>

#include <fmt/format.h>

#include "math/portable_math.h"
#include "session/survey/aisle.h"
#include "session/survey/made_up_sky.h"
#include "session/survey/surroundings.h"
#include "session/survey/weak_light.h"

namespace pertev {
namespace {

/// Returns whether any pixel of an emission texture is above 0.
bool has_light(const TextureImage& image) {
    const std::vector<uint8_t>& bytes = image.rgba8.pixels;
    for (std::size_t i = 0; i < bytes.size(); i += 4) {
        if ((bytes[i] | bytes[i + 1] | bytes[i + 2]) != 0) return true;
    }
    const std::vector<float>& floats = image.rgba_float.pixels;
    for (std::size_t i = 0; i < floats.size(); i += 4) {
        if (max(floats[i], max(floats[i + 1], floats[i + 2])) > 0) return true;
    }
    return false;
}

enum class OwnLight {
    Enough,   // an environment, or unlit surfaces only, which need no light
    Punctual, // only lights without extent
    Glowing,  // only emissive surfaces
    None,
};

/// Returns whether an animation that plays raises a light's intensity above 0 at some time.
bool brightens_a_light(const Animation& animation) {
    return std::ranges::any_of(animation.channels, [](const AnimationChannel& channel) {
        return channel.part == AnimatedPart::LightIntensity &&
               std::ranges::any_of(channel.values, [](float value) { return value > 0; });
    });
}

OwnLight own_light(const Scene& scene) {
    if (scene.environment) return OwnLight::Enough;
    const bool is_lit =
        std::ranges::any_of(scene.lights, [](const Light& light) { return max_component(light.intensity) > 0; });
    if (is_lit || std::ranges::any_of(scene.animations, brightens_a_light)) return OwnLight::Punctual;
    std::vector<bool> is_used(scene.materials.size());
    for (const Instance& instance : scene.instances)
        is_used[instance.material] = true; // hidden or not, because it may appear
                                           // later
    bool is_all_unlit = true;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        if (!is_used[i]) continue;
        if (material.is_emitter() &&
            (!material.emission_texture.has_image() ||
             has_light(scene.images[static_cast<std::size_t>(material.emission_texture.image)]))) {
            return OwnLight::Glowing;
        }
        is_all_unlit = is_all_unlit && material.is_unlit();
    }
    return is_all_unlit ? OwnLight::Enough : OwnLight::None;
}

void add_emitters(Scene& scene, const Surroundings& room) {
    const Aisle aisle = find_aisle(scene, room);
    constexpr int count = 5;
    for (int i = 0; i < count; ++i) {
        const float at = ((static_cast<float>(i) + 0.5f) / count - 0.5f) * 0.9f * aisle.length;
        const Vec3 below = aisle.middle + at * aisle.along;
        const float up = distance_along(scene, below, {0, 1, 0}, 0.5f * aisle.height);
        Light emitter;
        emitter.name = fmt::format("default emitter {}", i);
        emitter.position = below + Vec3{0, 0.6f * up, 0};
        // About 1 W/(sr m2) from a white floor below one.
        emitter.intensity = (kPi * square(0.6f * up)) * Rgb{1.0f, 0.93f, 0.82f};
        scene.lights.push_back(std::move(emitter));
    }
}

} // namespace

bool lacks_light(const Scene& scene) { return own_light(scene) == OwnLight::None; }

DefaultLight add_default_light(Scene& scene, SceneUse use, Sink& sink, Surroundings* seen) {
    const OwnLight own = own_light(scene);
    const bool may_be_weak = use == SceneUse::Picture && (own == OwnLight::Glowing || own == OwnLight::Punctual);
    const bool is_weak =
        may_be_weak && (own == OwnLight::Glowing ? is_light_too_weak(scene, sink) : lights_nothing_seen(scene, sink));
    if (own != OwnLight::None && !is_weak) return DefaultLight::None;
    const char* why = !is_weak                    ? "the scene has no light"
                      : own == OwnLight::Punctual ? "no light of the scene reaches a visible surface"
                                                  : "the emitters light too little of the scene";
    sink.check();
    const Surroundings around = survey_surroundings(scene);
    if (seen != nullptr) *seen = around;
    if (around.is_dark) {
        add_emitters(scene, around);
        sink.make_up(fmt::format("{}, which is a closed room: a row of emitters is added", why));
        return DefaultLight::Emitters;
    }
    // Through the openings of a room, the clear sky's narrow sun shows more than soft boxes do.
    const bool is_thing = around.kind == SurroundingsKind::Object && use != SceneUse::Benchmark;
    scene.environment = is_thing ? make_studio() : make_clear_sky();
    sink.make_up(fmt::format("{}: a sky is added{}", why, is_weak ? " (`environment=0,0,0`: none)" : ""));
    return DefaultLight::Sky;
}

} // namespace pertev
