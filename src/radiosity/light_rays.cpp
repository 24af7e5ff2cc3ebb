#include "radiosity/light_rays.h"

#include "device_scene/find_hits.h"
#include "math/sampler.h"
#include "shading/power_heuristic.h"

namespace pertev {
namespace {

constexpr uint32_t kRaysAtOnce = 64;

struct QueuedLight {
    Ray ray;
    TriangleId target;
    Rgb irradiance;               // irradiance of lights that are no patches
    PatchCode emitter = kNoPatch; // otherwise the emitter's patch
    float factor = 0;             // form factor of that patch
    uint32_t key = 0;
};

} // namespace

float LightRays::weight_of_light(float light_pdf, float cosine) const {
    if (hemisphere == 0) return 1;
    return power_heuristic(static_cast<float>(count) * light_pdf,
                           static_cast<float>(hemisphere) * pdf_cosine_hemisphere(cosine));
}

float LightRays::weight_of_hemisphere(float light_pdf, float cosine) const {
    if (count == 0 || !(light_pdf > 0)) return 1;
    return power_heuristic(static_cast<float>(hemisphere) * pdf_cosine_hemisphere(cosine),
                           static_cast<float>(count) * light_pdf);
}

PatchPoint point_on_patch(const SceneView& scene, const Patch& patch, Vec2 u) {
    const WorldTriangle triangle = world_triangle(scene, patch, patch.corners.uv_at(sample_uniform_triangle(u)));
    return {triangle.position, triangle.error, normal_of(scene, patch, triangle)};
}

void add_light_rays(const RowScene& scene, const Patch& patch, SampleKey key, const LightRays& rays,
                    FormFactorRow& row) {
    const SceneView& view = scene.scene.view();
    const LightSetView& lights = view.lights;
    if (lights.choice.starts == nullptr) return;
    QueuedLight queued[kRaysAtOnce];
    bool occluded[kRaysAtOnce];
    const float each = 1.0f / static_cast<float>(rays.count);
    for (uint32_t first = 0; first < rays.count; first += kRaysAtOnce) {
        if (scene.is_over()) return;
        uint32_t count = 0;
        for (uint32_t k = first; k < min(rays.count, first + kRaysAtOnce); ++k) {
            const SampleKey of_ray = {key.stream, k, key.seed};
            const Vec2 on_patch = sample_2d(SamplerKind::Sobol, of_ray, kGroupLights);
            const PatchPoint point = point_on_patch(view, patch, on_patch);
            const SampleBits u = sample_bits(SamplerKind::Sobol, of_ray, kGroupLights, Pair::Last);
            LightSample light;
            if (!sample_light(lights, point.position, u, light)) continue;
            const float cosine = dot(light.wi, point.normal);
            if (!(cosine > 0)) continue;
            const bool is_emitter = light.kind() == SourceKind::Triangle;
            if (is_emitter && !rays.finds_emitters) continue;
            QueuedLight& to = queued[count];
            to = {};
            to.key = coin_key(of_ray, 0, true);
            if (is_emitter) {
                const uint32_t side = hit_side(view, light.instance, light.primitive, light.wi);
                Vec3 weights = {1.0f - light.b1 - light.b2, light.b1, light.b2};
                to.emitter = scene.sources.view().find(face_of(view, light.instance, light.primitive, side), weights);
                if (!is_patch(to.emitter)) continue;
                if (is_hole(view, light, to.key)) continue;
                to.factor = rays.weight_of_light(light.pdf, cosine) * each * cosine * kInvPi / light.pdf;
            } else {
                const bool is_sky = light.kind() == SourceKind::Environment;
                const float weight = is_sky && !rays.finds_sky_alone ? rays.weight_of_light(light.pdf, cosine) : 1.0f;
                to.irradiance = (weight * each * cosine / light.pdf) * light.radiance;
            }
            to.ray = ray_to_light(light, point.position, point.error, point.normal);
            to.target = triangle_of(light);
            ++count;
        }
        const auto accept_of = [&](uint32_t i) {
            return AcceptHit{view, {patch.instance, patch.primitive}, queued[i].target, queued[i].key};
        };
        find_occlusions(
            scene.scene.trees(), count, RayOrder::Scattered, [&](uint32_t i) { return queued[i].ray; }, accept_of,
            occluded);
        for (uint32_t i = 0; i < count; ++i) {
            if (occluded[i]) continue;
            if (is_patch(queued[i].emitter)) {
                row.factors.push_back({number_of(queued[i].emitter), queued[i].factor});
            } else {
                row.direct += queued[i].irradiance;
            }
        }
    }
}

} // namespace pertev
