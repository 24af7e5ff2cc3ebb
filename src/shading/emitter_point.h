#pragma once

// A sample point on a light, independent of the receiver: a point on an emissive triangle, a punctual light, or a
// direction of the environment. 16 bytes. It moves with its instance. Densities of sample points are measured in
// barycentric weights for triangles, in solid angle for the environment, and as probabilities for punctual lights;
// `measure` converts them to the solid angles of light sampling (Bitterli et al. 2020 use areas; barycentric weights
// do not change if an emitter is stretched).

#include <cstdint>

#include "base/host_device.h"
#include "math/float4.h"
#include "shading/light_set.h"

namespace pertev {

struct alignas(16) EmitterPoint {
    uint32_t instance = kNoLight; // instance of a triangle, or one of the numbers below; kNoLight: none
    uint32_t index = 0;           // primitive; number of a punctual light; x of an environment direction
    float u = 0, v = 0;           // weights of the triangle's second and third vertex; y and z of an environment
                                  // direction

    HD bool is_there() const { return instance != kNoLight; }
    HD SourceKind kind() const;
};
inline constexpr uint32_t kInEnvironment = 0xfffffffeu, kPunctualPoint = 0xfffffffdu;
HD inline SourceKind EmitterPoint::kind() const {
    if (instance == kInEnvironment) return SourceKind::Environment;
    return instance == kPunctualPoint ? SourceKind::Punctual : SourceKind::Triangle;
}
static_assert(kMaxInstances < kPunctualPoint);

HD inline EmitterPoint environment_point(Vec3 direction) {
    return {kInEnvironment, bits_of(direction.x), direction.y, direction.z};
}
/// Sample point of a result of sample_light.
HD inline EmitterPoint point_of(const LightSample& sample) {
    switch (sample.kind()) {
    case SourceKind::Triangle:
        return {sample.instance, sample.primitive, sample.b1, sample.b2};
    case SourceKind::Punctual:
        return {kPunctualPoint, sample.primitive, 0, 0};
    case SourceKind::Environment:
        break;
    }
    return environment_point(sample.wi);
}

HD inline Vec3 environment_direction(const EmitterPoint& point) { return {float_of(point.index), point.u, point.v}; }

/// Finds the light that arrives at `context` from a `point` outside the environment; results are those of find_light().
template <EmitterVariant kEmitters>
HD inline bool find_local_light(const LightSetView& view, const EmitterPoint& point, const LightContext& context,
                                LightSample& sample, float& measure) {
    measure = 1;
    switch (point.kind()) {
    case SourceKind::Punctual: {
        if (point.index >= view.punctual_count) return false; // from another scene
        const bool arrives = sample_punctual_light<kEmitters>(view, point.index, 1.0f, context.point, sample);
        sample.primitive = point.index;
        return arrives;
    }
    case SourceKind::Triangle:
    case SourceKind::Environment: // excluded by the caller
        break;
    }
    const uint32_t light = light_of(view, point.instance, point.index);
    if (light == kNoLight) return false;
    const float pmf = ChosenByPower::pmf_of_triangle(view, context, light);
    if (!triangle_light_at<kEmitters>(view, light, pmf, context.point, {point.u, point.v}, sample)) return false;
    measure = 2.0f * pmf / sample.pdf; // in weights, a triangle has the area 1/2
    return true;
}

/// Light that arrives at `context` from `point`, as sample_light returns it, except for the pdf of punctual lights,
/// which is 1. `measure` is the ratio of the point's solid angle to its own measure. Returns false if nothing arrives;
/// occlusion and alpha are up to the caller.
template <EmitterVariant kEmitters = EmitterVariant::Coated>
HD inline bool find_light(const LightSetView& view, const EmitterPoint& point, const LightContext& context,
                          LightSample& sample, float& measure) {
    if (!point.is_there()) return false;
    switch (point.kind()) {
    case SourceKind::Triangle:
    case SourceKind::Punctual:
        return find_local_light<kEmitters>(view, point, context, sample, measure);
    case SourceKind::Environment:
        break;
    }
    measure = 1;
    sample = {};
    sample.wi = environment_direction(point);
    const EnvironmentHit hit = find_environment(view, context, sample.wi, true);
    if (!(hit.pdf > 0)) return false;
    sample.pdf = hit.pdf;
    sample.distance = kInfinity;
    sample.radiance = hit.radiance;
    return true;
}

/// Density with which sample_light samples, for `context`, the point that find_light has found, 1/sr; `found` is its
/// light. Lights without size are out of reach.
template <class Choice>
HD inline float pdf_of_found(const LightSetView& view, const EmitterPoint& point, const LightContext& context,
                             const LightSample& found) {
    switch (point.kind()) {
    case SourceKind::Punctual:
    case SourceKind::Environment:
        return found.pdf;
    case SourceKind::Triangle:
        break;
    }
    const uint32_t light = light_of(view, point.instance, point.index);
    return pdf_light_hit<Choice>(view, light, context, found.light_point);
}

/// Direction and end of a shadow ray from `from` to `point`, whose light is known to arrive somewhere: find_light
/// without textures, coats and the environment's image. Returns false if nothing can arrive.
HD inline bool find_light_end(const LightSetView& view, const EmitterPoint& point, Vec3 from, LightSample& sample) {
    if (!point.is_there()) return false;
    switch (point.kind()) {
    case SourceKind::Environment:
        sample = {};
        sample.wi = environment_direction(point);
        sample.distance = kInfinity;
        return view.has_environment();
    case SourceKind::Triangle:
    case SourceKind::Punctual:
        break;
    }
    float measure;
    return find_local_light<EmitterVariant::Plain>(view, point, from, sample, measure);
}

} // namespace pertev
