#pragma once

// A place that light comes from, kept apart from whoever it shines on: a point of an emissive triangle, a punctual
// light, a direction of the environment. 16 bytes. It moves with its instance. Densities of places are counted in
// weights of a triangle's corners, in solid angle of the environment, and one by one of punctual lights; `measure`
// turns them into what sampling by solid angle counts in (Bitterli et al. 2020 use areas; weights of corners stay what
// they are when a lamp is stretched).

#include <cstdint>

#include "base/host_device.h"
#include "math/float4.h"
#include "shading/light_set.h"

namespace pertev {

struct alignas(16) LightPlace {
    uint32_t instance = kNoLight; // of a triangle, or one of the numbers below; kNoLight: nowhere
    uint32_t index = 0;           // primitive; of a punctual light its number; of the environment x of the direction
    float u = 0, v = 0;           // weights of the triangle's second and third vertex; y and z of the direction

    HD bool is_there() const { return instance != kNoLight; }
    HD SourceKind kind() const;
};
inline constexpr uint32_t kInEnvironment = 0xfffffffeu, kPunctualPlace = 0xfffffffdu;
HD inline SourceKind LightPlace::kind() const {
    if (instance == kInEnvironment) return SourceKind::Environment;
    return instance == kPunctualPlace ? SourceKind::Punctual : SourceKind::Triangle;
}
static_assert(kMaxInstances < kPunctualPlace);

HD inline LightPlace place_in_environment(Vec3 direction) {
    return {kInEnvironment, bits_of(direction.x), direction.y, direction.z};
}
/// Of what sample_light gave.
HD inline LightPlace place_of(const LightSample& sample) {
    if (sample.instance != kNoLight) return {sample.instance, sample.primitive, sample.b1, sample.b2};
    if (sample.is_delta) return {kPunctualPlace, sample.primitive, 0, 0};
    return place_in_environment(sample.wi);
}

/// What arrives at `context` of the light at `place`: as sample_light gives it, but for the pdf of punctual lights,
/// which is 1. `measure` is the solid angle of the place over its own measure, 1/sr times that. False where nothing
/// arrives; occlusion is the caller's, and so is alpha.
HD inline bool find_light(const LightSetView& view, const LightPlace& place, const LightContext& context,
                          LightSample& sample, float& measure) {
    measure = 1;
    if (!place.is_there()) return false;
    switch (place.kind()) {
    case SourceKind::Environment: {
        sample = {};
        sample.wi = {float_of(place.index), place.u, place.v};
        const EnvironmentHit hit = find_environment(view, context, sample.wi, true);
        if (!(hit.pdf > 0)) return false;
        sample.pdf = hit.pdf;
        sample.distance = kInfinity;
        sample.radiance = hit.radiance;
        return true;
    }
    case SourceKind::Punctual: {
        if (place.index >= view.punctual_count) return false; // another scene than it was drawn in
        const bool arrives = sample_punctual_light(view.punctual[place.index], 1.0f, context.point, sample);
        sample.primitive = place.index;
        return arrives;
    }
    case SourceKind::Triangle:
        break;
    }
    const uint32_t light = light_of(view, place.instance, place.index);
    if (light == kNoLight) return false;
    const float pmf = ChosenByPower::pmf_of_triangle(view, context, light);
    if (!triangle_light_at<true>(view, light, pmf, context.point, {place.u, place.v}, sample)) return false;
    measure = 2.0f * pmf / sample.pdf; // a triangle of weights has the area 1/2
    return true;
}

} // namespace pertev
