// Form factors by rays: they start at points all over the patch with cosine-distributed directions, so that the share
// of rays that hit another patch is its form factor, with occlusion. Light of emitters and sky is also sampled by rays
// to points on lights, and both are combined by MIS (Veach 1997, section 9.2): an emitter that few rays of the
// hemisphere meet would be noise.
//
// Source: Malley, "A Shading Method for Computer Generated Images", 1988: directions by the cosine are points of a disk
// (Nusselt's analog); Wallace, Elmquist, Haines, "A Ray Tracing Algorithm for Progressive Radiosity", SIGGRAPH 1989.

#include "device_scene/find_hits.h"
#include "math/sampler.h"
#include "radiosity/light_rays.h"
#include "radiosity/row_maker.h"

namespace pertev {
namespace {

constexpr uint32_t kRowRaysAtOnce = 128;

class RayRows final : public RowMaker {
public:
    RayRows(const RowScene& scene, const RadiositySettings& settings) : scene_(scene), seed_(settings.seed) {
        rays_ = {.count = max(settings.rays / 4, kMinPatchRays),
                 .hemisphere = settings.rays,
                 .finds_emitters = true,
                 .finds_sky_alone = false};
        if (scene.scene.view().lights.choice.starts == nullptr) rays_.count = 0;
    }

    void make(const Patch& patch, uint32_t number, FormFactorRow& row) override {
        row.clear();
        const SampleKey key = {number, 0, seed_};
        const float each = 1.0f / static_cast<float>(rays_.hemisphere);
        double emitters = 0, others = 0; // others: patches without light of their own, the sky, and where light ends
        for (uint32_t first = 0; first < rays_.hemisphere; first += kRowRaysAtOnce) {
            if (scene_.is_over()) return;
            const uint32_t count = min(rays_.hemisphere - first, kRowRaysAtOnce);
            send(patch, key, first, count);
            for (uint32_t i = 0; i < count; ++i) others += add(i, each, row);
        }
        if (rays_.count > 0) add_light_rays(scene_, patch, key, rays_, row);
        row.sort();
        for (const FormFactor& factor : row.factors) {
            if (is_emitter(factor.patch)) emitters += static_cast<double>(factor.factor);
        }
        close(emitters, others, row);
    }

private:
    bool is_emitter(uint32_t patch) const { return !is_black(scene_.sources.patches[patch].exitance); }

    void send(const Patch& patch, SampleKey key, uint32_t first, uint32_t count) {
        const SceneView& view = scene_.scene.view();
        for (uint32_t i = 0; i < count; ++i) {
            const SampleKey of_ray = {key.stream, first + i, key.seed};
            const Vec2 on_patch = sample_2d(SamplerKind::Sobol, of_ray, kGroupHemisphere);
            const Vec2 direction = sample_2d(SamplerKind::Sobol, of_ray, kGroupHemisphere, Pair::Last);
            const PatchPoint point = point_on_patch(view, patch, on_patch);
            const Vec3 local = sample_cosine_hemisphere(direction);
            Ray& ray = sent_[i];
            ray.direction = normalize(make_frame(point.normal).to_world(local));
            ray.origin = offset_ray_origin(point.position, point.error, point.normal, ray.direction);
            ray.t_min = 0;
            ray.t_max = kInfinity;
            cosines_[i] = local.z;
            keys_[i] = coin_key(of_ray, 0, false);
        }
        const auto accept_of = [&](uint32_t i) {
            return AcceptHit{view, {patch.instance, patch.primitive}, {}, keys_[i]};
        };
        find_hits(
            scene_.scene.trees(), count, RayOrder::Scattered, [&](uint32_t i) { return sent_[i]; }, accept_of, hits_);
    }

    /// Adds ray i to the row. Returns the part of it, in [0, 1], that meets something other than an emitter.
    double add(uint32_t i, float each, FormFactorRow& row) const {
        const SceneView& view = scene_.scene.view();
        const LightSetView& lights = view.lights;
        const Hit& hit = hits_[i];
        const Ray& ray = sent_[i];
        if (hit.instance == kNoHit) {
            if (lights.has_environment()) {
                const float weight =
                    rays_.weight_of_hemisphere(pdf_environment(lights, ray.origin, ray.direction), cosines_[i]);
                row.direct += (weight * each * kPi) * environment_radiance(lights.environment, ray.direction);
            }
            return static_cast<double>(each);
        }
        const uint32_t side = hit_side(view, hit.instance, hit.primitive, ray.direction);
        Vec3 weights = {1.0f - hit.u - hit.v, hit.u, hit.v};
        const PatchCode hit_patch =
            scene_.sources.view().find(face_of(view, hit.instance, hit.primitive, side), weights);
        if (!is_patch(hit_patch)) return static_cast<double>(each);
        const uint32_t patch = number_of(hit_patch);
        if (!is_emitter(patch)) {
            row.factors.push_back({patch, each});
            return static_cast<double>(each);
        }
        const uint32_t light = light_of(lights, hit.instance, hit.primitive);
        const float light_pdf =
            light != kNoLight ? pdf_light_hit(lights, light, ray.origin, ray.origin + hit.t * ray.direction) : 0.0f;
        row.factors.push_back({patch, rays_.weight_of_hemisphere(light_pdf, cosines_[i]) * each});
        return 0;
    }

    /// Scales a row so that all form factors of a patch, with those of the sky and of surfaces that absorb all light,
    /// add up to 1. The sum for emitters is more accurate than that for the rest, so only the rest is scaled.
    void close(double emitters, double others, FormFactorRow& row) const {
        const double of_emitters = others > 0 && emitters <= 1 ? 1 : 1 / emitters;
        const double of_others = others > 0 ? std::max(0.0, 1 - emitters) / others : 0;
        for (FormFactor& factor : row.factors) {
            const double scale = is_emitter(factor.patch) ? of_emitters : of_others;
            factor.factor = static_cast<float>(scale * static_cast<double>(factor.factor));
        }
    }

    RowScene scene_;
    uint32_t seed_;
    LightRays rays_;
    Ray sent_[kRowRaysAtOnce];
    float cosines_[kRowRaysAtOnce];
    uint32_t keys_[kRowRaysAtOnce];
    Hit hits_[kRowRaysAtOnce];
};

} // namespace

std::unique_ptr<RowMaker> make_ray_rows(const RowScene& scene, const RadiositySettings& settings) {
    return std::make_unique<RayRows>(scene, settings);
}

} // namespace pertev
