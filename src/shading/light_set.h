#pragma once

// All lights of a scene behind one interface: emissive triangles (any number), point, spot and directional lights,
// and the environment, sampled by power. sample_light samples a light and a direction to it for a context, the
// receiver. pdf_light_hit and find_environment return that density for a direction found otherwise, which multiple
// importance sampling needs (Veach 1997, section 9.2). A class that all three take as a parameter, ChosenByPower,
// selects the light and defines its probability; ChosenByTree (shading/chosen_by_tree.h) is another such class.
//
// A pair of numbers determines everything, and near pairs give near points: x selects the source (an emissive
// instance, a punctual light, the environment) and y the instance's triangle, both by cdfs with guide tables; the
// rest of x and y selects the point on the triangle. For the environment y selects the row and the rest of x the
// column.
//
// Order of sources: emissive instances, punctual lights, the environment; instances, their triangles and punctual
// lights are sorted along Hilbert's curve, so that evenly spread numbers are evenly spread in space. A light's number
// is independent of that: emissive triangles by instance and primitive, then punctual lights in their order, then the
// environment. A triangle emits from its front, or from both faces if its material says so (scene/material.h);
// triangles of unlit materials are no lights.

#include <cstdint>
#include <type_traits>

#include "base/host_device.h"
#include "base/limits.h"
#include "math/rgb.h"
#include "math/rigid_motion.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "scene/texture.h"
#include "shading/environment_light.h"
#include "shading/guided_cdf.h"
#include "shading/light_tree/light_tree_view.h"
#include "shading/lobes/coat_absorption.h"
#include "shading/lobes/schlick_lobe.h"
#include "shading/punctual_light.h"
#include "shading/shading_variant.h"
#include "shading/texture_lookup.h"

namespace pertev {

inline constexpr uint32_t kNoLight = 0xffffffffu;

struct EmissiveTriangle {
    Vec3 a, ab, ac;     // first vertex and the edges from it, metres, translated world
    Vec2 uv0, uv1, uv2; // texture coordinates of the set that the emission texture uses
    uint32_t instance : 30 = 0;
    uint32_t is_mirrored : 1 = 0; // cross(ab, ac) points out of the back
    uint32_t is_two_sided : 1 = 0;
    uint32_t primitive = 0, material = 0; // ids in the scene, as `instance` is
    float pmf = 0;                        // probability that sample_light selects it

    HD Vec3 middle() const { return a + (1.0f / 3.0f) * (ab + ac); }
    /// Returns whether the triangle emits against `wi`, a direction towards it. `normal` is cross(ab, ac).
    HD bool emits_against(Vec3 wi, Vec3 normal) const {
        return is_two_sided != 0 || (dot(normal, wi) < 0) == (is_mirrored == 0);
    }
};

/// An emissive instance: its triangles and the table that selects one of them.
struct Emitter {
    uint32_t first_triangle = 0, triangle_count = 0;
    uint32_t first_start = 0, first_guide = 0, guide_bits = 0; // table in LightSetView::triangle_starts, _guides
};
static_assert(kMaxInstances <= 1u << 30, "EmissiveTriangle::instance has 30 bits");

/// Emission of a material: emission times the texture, beneath its coat.
struct SurfaceEmission {
    Rgb emission; // W/(sr m2); 0 for materials that are no lights
    TextureRef texture;
    float coat_weight = 0, coat_roughness = 0, coat_f0 = 0;
    Rgb coat_color = {1, 1, 1};
    // kNoImage if their coordinates differ from those of `texture`:
    TextureRef coat_texture = {}, coat_roughness_texture = {}, coat_color_texture = {};
};

/// Kinds of light that are sampled, found and emitted in different ways.
enum class SourceKind : uint8_t { Triangle, Punctual, Environment };

struct LightSetView {
    GuidedCdfView choice; // over all sources; empty if there are none
    const Emitter* emitters = nullptr;
    const EmissiveTriangle* triangles = nullptr;
    const uint32_t* triangle_order = nullptr;  // [triangles] for each emitter: its primitives in the order of its
                                               // table
    const uint32_t* triangle_starts = nullptr; // tables of the emitters: [triangles + emitters]
    const uint32_t* triangle_guides = nullptr;
    const PunctualLight* punctual = nullptr;
    LightTreeView tree; // over triangles and, numbered after them, punctual lights with a position
    uint32_t emitter_count = 0, triangle_count = 0, punctual_count = 0;
    uint32_t near_count = 0;                    // sources with a position, which come first
    uint32_t environment_source = kNoLight;     // index of the environment among the sources
    const uint32_t* first_light = nullptr;      // [instances] light number of primitive 0, or kNoLight
    const SurfaceEmission* emissions = nullptr; // [materials]
    const TextureImageView* images = nullptr;   // [images of the scene]
    const float* linear_from_srgb = nullptr;    // [256]
    EnvironmentView environment;                // if there is one
    GoniometricTablesView goniometric;          // tables of punctual lights

    HD bool has_environment() const { return environment_source != kNoLight; }
    HD bool has_lights() const { return choice.starts != nullptr; }
    HD SourceKind kind_of(uint32_t source) const {
        if (source < emitter_count) return SourceKind::Triangle;
        return source != environment_source ? SourceKind::Punctual : SourceKind::Environment;
    }
    HD GuidedCdfView triangles_of(uint32_t source) const {
        const Emitter& emitter = emitters[source];
        return {triangle_starts + emitter.first_start, triangle_guides + emitter.first_guide, emitter.triangle_count,
                emitter.guide_bits};
    }
};

/// The receiver of light: a point of a surface, or of space. Members that the sampling does not use cost nothing.
struct LightContext {
    Vec3 point;  // metres, translated world
    Vec3 normal; // unit, shading normal on the side of the scattered light; zero if light may come from all sides
    float time;  // time of the ray while the shutter is open

    HD LightContext(Vec3 at, float at_time = kAtRest) : point(at), normal{0, 0, 0}, time(at_time) {}
    HD LightContext(Vec3 at, Vec3 shading_normal, bool is_translucent, float at_time)
        : point(at), normal(is_translucent ? Vec3{0, 0, 0} : shading_normal), time(at_time) {}
};

struct LightSample {
    Vec3 wi;               // unit, towards the light
    float distance = 0;    // metres; kInfinity for the environment and directional lights
    Vec3 light_point;      // metres; for triangles, point and spot lights
    Vec3 light_normal;     // unit geometric normal of a triangle, on either side, or zero
    Rgb radiance;          // arrives along wi: W/(sr m2); delta lights: W/m2 on a surface that faces them
    float pdf = 0;         // 1/sr, including the probability of the light; delta lights: that probability
    bool is_delta = false; // no other sampling of directions can hit this light
    uint32_t instance = kNoLight, primitive = kNoLight; // ids of a triangle, or kNoLight and a punctual light's
                                                        // number
    float b1 = 0, b2 = 0;                               // weights of its second and third vertex

    HD SourceKind kind() const {
        if (is_delta) return SourceKind::Punctual;
        return instance != kNoLight ? SourceKind::Triangle : SourceKind::Environment;
    }
};

/// Light number of a triangle of the scene, or kNoLight.
HD inline uint32_t light_of(const LightSetView& view, uint32_t instance, uint32_t primitive) {
    const uint32_t first = view.triangle_count == 0 ? kNoLight : view.first_light[instance];
    return first == kNoLight ? kNoLight : first + primitive;
}

/// Radiance that material `material` emits at `uv` (in the set that its emission texture uses), beneath any coat.
template <EmitterVariant kEmitters = EmitterVariant::Coated>
HD inline Rgb surface_emission(const LightSetView& view, uint32_t material, Vec2 uv) {
    const SurfaceEmission& surface = view.emissions[material];
    if (kEmitters == EmitterVariant::Plain || surface.texture.image == kNoImage) return surface.emission;
    const Vec4 texel = lookup_texture(view.images, surface.texture, uv, view.linear_from_srgb);
    return surface.emission * Rgb{texel.x, texel.y, texel.z};
}

/// Transmittance of an emitter's coat at `cosine` to the geometric normal, which every sampling of emitters knows.
HD_CALL inline Rgb coat_transmittance(const LightSetView& view, const SurfaceEmission& surface, Vec2 uv, float cosine) {
    const auto textured = [&](float factor, const TextureRef& ref) {
        if (ref.image == kNoImage) return factor;
        return clamp(factor * lookup_texture_channel(view.images, ref, uv, view.linear_from_srgb), 0.0f, 1.0f);
    };
    const float roughness = textured(surface.coat_roughness, surface.coat_roughness_texture);
    const SchlickLobe coat = {grey(0), 0, square(roughness), surface.coat_f0};
    const float albedo = coat.albedo_at(min(cosine, 1.0f), coat.make_average()).coat;
    const float weight = textured(surface.coat_weight, surface.coat_texture), passed = 1.0f - weight * albedo;
    Rgb color = surface.coat_color;
    if (const TextureRef& ref = surface.coat_color_texture; ref.has_image()) {
        const Vec4 texel = lookup_texture(view.images, ref, uv, view.linear_from_srgb);
        color = color * Rgb{texel.x, texel.y, texel.z};
    }
    if (color == Rgb{1, 1, 1}) return grey(passed);
    const float length = length_in_coat(min(cosine, 1.0f), surface.coat_f0);
    return passed * coat_tint(color, weight, 0.5f * length, albedo);
}

/// Radiance that leaves a surface of `material` at `uv` along or against the unit `direction`; `normal` is the
/// geometric one, of any length.
template <EmitterVariant kEmitters>
HD inline Rgb emitted_radiance(const LightSetView& view, uint32_t material, Vec2 uv, [[maybe_unused]] Vec3 normal,
                               [[maybe_unused]] Vec3 direction) {
    const Rgb radiance = surface_emission<kEmitters>(view, material, uv);
    if constexpr (kEmitters == EmitterVariant::Coated) {
        const SurfaceEmission& surface = view.emissions[material];
        if (surface.coat_weight > 0) {
            return coat_transmittance(view, surface, uv, abs(dot(normalize(normal), direction))) * radiance;
        }
    }
    return radiance;
}

/// Solid-angle density of a uniformly sampled point on a triangle, 1/sr. `wi` is unit and leads from the receiver to
/// the point, at the squared distance `distance_squared`; `normal` is cross(ab, ac). Not finite if `wi` lies in the
/// plane of the triangle.
template <class T = float>
HD inline T triangle_pdf(Vec3Of<T> normal, Vec3Of<T> wi, T distance_squared) {
    return 2.0f * distance_squared / abs(dot(normal, wi));
}

/// Sets `sample` to the point `b` (weights of the second and third vertex) on triangle light `light`, as sample_light
/// does for `from_point` if it selects the light with probability `pmf`. Returns false if nothing arrives.
template <EmitterVariant kEmitters>
HD inline bool triangle_light_at(const LightSetView& view, uint32_t light, float pmf, Vec3 from_point, Vec2 b,
                                 LightSample& sample) {
    const EmissiveTriangle& triangle = view.triangles[light];
    const Vec3 point = triangle.a + (b.x * triangle.ab + b.y * triangle.ac);
    const Vec3 to_light = point - from_point;
    const float distance_squared = length_squared(to_light), distance = sqrt(distance_squared);
    const Vec3 wi = to_light / distance;
    const Vec3 normal = cross(triangle.ab, triangle.ac);
    if (!triangle.emits_against(wi, normal)) return false; // the triangle's dark back
    const float pdf = pmf * triangle_pdf(normal, wi, distance_squared);
    if (!(pdf > 0) || !is_finite(pdf)) return false; // edge-on, or the receiver lies on the light
    const Vec2 uv = (1.0f - b.x - b.y) * triangle.uv0 + b.x * triangle.uv1 + b.y * triangle.uv2;
    const Rgb radiance = emitted_radiance<kEmitters>(view, triangle.material, uv, normal, wi);
    if (is_black(radiance)) return false;
    sample = {wi,  distance, point, normalize(normal), radiance, pdf, false, triangle.instance, triangle.primitive,
              b.x, b.y};
    return true;
}

/// Samples the punctual light `number`, as sample_light does for `from_point` if it selects it with probability `pmf`.
/// Returns false if nothing arrives. Tables of goniometric lights count for coated emitters' look alone, which all
/// scenes with such a light have; for others the light is a point.
template <EmitterVariant kEmitters>
HD inline bool sample_punctual_light(const LightSetView& view, uint32_t number, float pmf, Vec3 from_point,
                                     LightSample& sample) {
    const PunctualLight& light = view.punctual[number];
    PunctualArrival arrival;
    if (!find_punctual_light(light, from_point, arrival)) return false;
    if constexpr (kEmitters == EmitterVariant::Coated) {
        if (!apply_table(light, view.goniometric, -arrival.wi, arrival.irradiance)) return false;
    }
    sample = {};
    sample.wi = arrival.wi;
    sample.distance = arrival.distance;
    sample.light_point = light.position;
    sample.radiance = arrival.irradiance;
    sample.pdf = pmf;
    sample.is_delta = true;
    return pmf > 0;
}

/// Positions of emitters for sample_light, all at rest.
struct EmittersAtRest {};

/// A light that is selected by its power.
struct LightDraw {
    SourceKind kind;
    uint32_t light = 0;       // light number of a triangle
    CdfDraw source, triangle; // the latter for a triangle

    /// A point of the triangle, by the rest of both numbers: weights of its second and third vertex.
    HD Vec2 weights() const { return sample_uniform_triangle(Vec2{rest_of(source), rest_of(triangle)}); }
};

/// Selects a light by its power by `u`. There are lights.
HD inline LightDraw select_light(const LightSetView& view, SampleBits u) {
    const uint32_t more = bits_behind(u);
    LightDraw draw;
    draw.source = draw_ordered(view.choice, u.x, more);
    draw.kind = view.kind_of(draw.source.index);
    if (draw.kind == SourceKind::Triangle) {
        draw.triangle = draw_ordered(view.triangles_of(draw.source.index), u.y, more);
        const uint32_t first = view.emitters[draw.source.index].first_triangle;
        draw.light = first + view.triangle_order[first + draw.triangle.index];
    }
    return draw;
}

/// Selects a light by its power by `u` and returns the result of the function of `to` for its kind. Each function
/// gets the probability of the light, and the rest of `u`. Returns false if there are no lights.
///   triangle(light, point, pmf)   point: weights of its second and third vertex
///   punctual(number, pmf)         number: in LightSetView::punctual
///   environment(pmf, rest)
template <class ToKind>
HD INLINE_ON_DEVICE bool draw_light(const LightSetView& view, SampleBits u, const ToKind& to) {
    if (!view.has_lights()) return false;
    const LightDraw draw = select_light(view, u);
    switch (draw.kind) {
    case SourceKind::Triangle:
        return to.triangle(draw.light, draw.weights(), view.triangles[draw.light].pmf);
    case SourceKind::Punctual:
        return to.punctual(draw.source.index - view.emitter_count, cdf_pmf(draw.source.owned));
    case SourceKind::Environment:
        break;
    }
    return to.environment(cdf_pmf(draw.source.owned), SampleBits{number_of_rest(draw.source), u.y});
}

/// Selects lights by their power, independently of the context. `draw` is draw_light for a context. The other
/// functions return the probability that it selects a triangle light, or the environment, exactly as `draw` passes it
/// on.
struct ChosenByPower {
    static constexpr bool kReadsNormal = false; // whether it uses the normal of the context
    template <class ToKind>
    HD INLINE_ON_DEVICE static bool draw(const LightSetView& view, const LightContext&, SampleBits u,
                                         const ToKind& to) {
        return draw_light(view, u, to);
    }
    HD static float pmf_of_triangle(const LightSetView& view, const LightContext&, uint32_t light) {
        return view.triangles[light].pmf;
    }
    HD static float pmf_of_environment(const LightSetView& view, const LightContext&) {
        return cdf_pmf(view.choice, view.environment_source);
    }
};

/// The functions with which sample_light computes a context's sample for each kind of light.
template <EmitterVariant kEmitters, class Emitters>
struct SampleOfKind {
    const LightSetView& view;
    const LightContext& context;
    const Emitters& emitters;
    LightSample& sample;

    HD bool triangle(uint32_t light, Vec2 b, float pmf) const {
        if constexpr (std::is_same_v<Emitters, EmittersAtRest>) {
            return triangle_light_at<kEmitters>(view, light, pmf, context.point, b, sample);
        } else {
            const auto motion = emitters(view.triangles[light].instance);
            const Vec3 from_point = motion.move_back(context.point);
            if (!triangle_light_at<kEmitters>(view, light, pmf, from_point, b, sample)) return false;
            sample.wi = motion.rotate(sample.wi);
            sample.light_point = motion.move(sample.light_point);
            sample.light_normal = motion.rotate(sample.light_normal);
            return true;
        }
    }
    HD bool punctual(uint32_t number, float pmf) const {
        const bool arrives = sample_punctual_light<kEmitters>(view, number, pmf, context.point, sample);
        sample.primitive = number;
        return arrives;
    }
    HD bool environment(float pmf, SampleBits rest) const {
        EnvironmentSample from_environment;
        if (!sample_environment(view.environment, rest, from_environment)) return false;
        sample = {};
        sample.wi = from_environment.wi;
        sample.distance = kInfinity;
        sample.radiance = from_environment.radiance;
        sample.pdf = pmf * from_environment.pdf;
        return sample.pdf > 0;
    }
};

/// Samples a light and a direction to it by `u`. Returns false if nothing arrives: no lights, the dark back or a dark
/// spot of a triangle, outside a cone, edge-on; that sample counts as 0. Occlusion and alpha are up to the caller: if
/// the triangle's material is not opaque, radiance times alpha at (instance, primitive, b1, b2) arrives. `emitters`
/// returns the rigid motion of an instance's emitter at the context's time (math/rigid_motion.h).
template <EmitterVariant kEmitters = EmitterVariant::Coated, class Choice = ChosenByPower,
          class Emitters = EmittersAtRest>
HD inline bool sample_light(const LightSetView& view, const LightContext& context, SampleBits u, LightSample& sample,
                            const Emitters& emitters = {}) {
    return Choice::draw(view, context, u, SampleOfKind<kEmitters, Emitters>{view, context, emitters, sample});
}

/// Density with which sample_light samples, for `context`, the direction to `hit_point` on triangle light `light`,
/// 1/sr. It equals LightSample::pdf exactly if hit_point is the sampled light_point, and is 0 if that cannot be
/// sampled, for example from behind a triangle that emits only from its front.
template <class Choice = ChosenByPower, class Emitters = EmittersAtRest>
HD inline float pdf_light_hit(const LightSetView& view, uint32_t light, const LightContext& context, Vec3 hit_point,
                              const Emitters& emitters = {}) {
    const EmissiveTriangle& triangle = view.triangles[light];
    Vec3 from_point = context.point;
    if constexpr (!std::is_same_v<Emitters, EmittersAtRest>) {
        const auto motion = emitters(triangle.instance);
        from_point = motion.move_back(from_point);
        hit_point = motion.move_back(hit_point);
    }
    const Vec3 to_light = hit_point - from_point;
    const float distance_squared = length_squared(to_light);
    const Vec3 wi = to_light / sqrt(distance_squared);
    const Vec3 normal = cross(triangle.ab, triangle.ac);
    if (!triangle.emits_against(wi, normal)) return 0;
    const float pdf = triangle_pdf(normal, wi, distance_squared) * Choice::pmf_of_triangle(view, context, light);
    return is_finite(pdf) ? pdf : 0.0f;
}

/// Environment light of direction `wi`, with the density with which sample_light samples it for `context`, 1/sr.
template <class Choice = ChosenByPower>
HD inline EnvironmentHit find_environment(const LightSetView& view, const LightContext& context, Vec3 wi,
                                          bool wants_pdf) {
    if (!view.has_environment()) return {{0, 0, 0}, 0};
    EnvironmentHit hit = find_environment(view.environment, wi, wants_pdf && view.has_lights());
    if (hit.pdf > 0) hit.pdf = Choice::pmf_of_environment(view, context) * hit.pdf;
    return hit;
}

/// Density with which sample_light samples the environment's direction `wi` for `context`, 1/sr; 0 without an
/// environment.
HD inline float pdf_environment(const LightSetView& view, const LightContext& context, Vec3 wi) {
    return find_environment(view, context, wi, true).pdf;
}

} // namespace pertev
