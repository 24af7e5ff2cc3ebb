#pragma once

// Listeners for a frame of samples (render/noisy_frame_view.h): the G-buffer of the first hit, the part of the light
// that its diffuse lobes scatter, and the data of the path's first bounce for ReSTIR.

#include "integrators/path/medium.h"
#include "integrators/path/mirror_chain.h"

namespace pertev {

/// Stores the first hit in the G-buffer, and the sample.
class FrameSurface : public PathListener<FrameSurface> {
public:
    HD explicit FrameSurface(const PathJob& job) : film_(job.film), axis_(job.picture.camera.axis) {}

    HD void missed(const PathState& path) {
        if (path.depth != 0) return;
        const NoisyFrameView& frame = film_.frame;
        frame.hit[path.pixel] = {float_of(kNoHit), float_of(kNoHit), 0, 0};
        frame.normal[path.pixel] = {0, 0, 0, kFarAway};
        frame.albedo[path.pixel] = {0, 0, 0, 1};
        frame.gloss[path.pixel] = {0, 0, 0, kFarAway};
    }
    HD void vertex(const PathState& path, const Hit& hit, Surface& surface) {
        if (path.depth == 0) store(path, hit, surface);
        if (path.depth == 1) store_reflected(path, hit);
    }
    static uint32_t depth_of_lanes(const PathJob&) { return 1; }
    void vertex_in_lanes(const PathState& path, const Hit& hit) {
        if (path.depth == 1) store_reflected(path, hit);
    }
    HD void emitted(const PathState& path, Rgb light) {
        if (path.depth == 0) film_.frame.emission[path.pixel] = {light.r, light.g, light.b, transmittance_};
    }
    HD void ended(uint32_t pixel, Rgb radiance, const PathData&) const { store_sample(film_, pixel, radiance, {}); }

private:
    HD void store_reflected(const PathState& path, const Hit& hit) const { film_.frame.gloss[path.pixel].w = hit.t; }
    HD void store(const PathState& path, const Hit& hit, const Surface& surface) {
        const NoisyFrameView& frame = film_.frame;
        const Vec3 normal = surface.frame.normal;
        const float cosine = dot(normal, path.direction);
        const Vec3 seen = cosine > 0 ? -normal : normal;
        const Gloss gloss = surface.bsdf.gloss(abs(cosine));
        frame.hit[path.pixel] = {float_of(hit.instance), float_of(hit.primitive), hit.u, hit.v};
        frame.normal[path.pixel] = {seen.x, seen.y, seen.z, dot(surface.position - path.origin, axis_)};
        frame.albedo[path.pixel] = {surface.albedo.r, surface.albedo.g, surface.albedo.b, gloss.alpha};
        frame.gloss[path.pixel] = {gloss.reflectance.r, gloss.reflectance.g, gloss.reflectance.b, kFarAway};
        transmittance_ = gloss.transmittance;
    }

    const FilmView& film_;
    const Vec3& axis_;
    float transmittance_ = 1; // transmittance of Gloss
};

/// Separates the part of a path's radiance that diffuse lobes of its first vertex scatter, if a frame splits light.
class LightSplit : public PathListener<LightSplit> {
public:
    struct PathData {
        Float4 diffuse; // rgb; w: bits of the share of diffuse lobes in what the first vertex scattered, ten per
                        // colour
    };
    struct ShadowData {
        Rgb diffuse; // part of the contribution
    };

    HD explicit LightSplit(const PathJob& job) : frame_(job.film.frame) {}

    static uint32_t depth_of_lanes(const PathJob& job) { return job.film.frame.splits_light() ? 1 : 0; }
    /// Lanes do not tell what a surface emits towards the path.
    bool may_be_in_lanes(const SceneView& scene, const PathState&, const Hit& hit) const {
        return !frame_.splits_light() ||
               !(max_component(scene.materials[scene.instances[hit.instance].material].emission) > 0);
    }
    void shadow_in_lanes(const PathData& kept, const ShadowRay& shadow, ShadowData& shadow_data) const {
        if (frame_.splits_light()) shadow_data.diffuse = unpacked(bits_of(kept.diffuse.w)) * shadow.contribution;
    }
    HD void begins(const PathState&) { kept_ = {}; }
    HD void restore(const PathData& kept) {
        kept_ = kept;
        first_ = unpacked(bits_of(kept.diffuse.w));
    }
    /// Leaves out light that the camera ray itself hits, because it is not scattered.
    HD void emitted(const PathState&, Rgb light) {
        if (!frame_.splits_light()) return;
        const Rgb more = first_ * light;
        kept_.diffuse = {kept_.diffuse.x + more.r, kept_.diffuse.y + more.g, kept_.diffuse.z + more.b, kept_.diffuse.w};
    }
    HD void direct(const PathState& path, const SurfaceVertex& at, Vec3 wi, const ShadowRay& shadow) {
        if (!frame_.splits_light()) return;
        shadow_data_.diffuse = (path.depth == 0 ? at.surface.diffuse_share(at.wo, wi) : first_) * shadow.contribution;
    }
    /// Light that a medium scatters before the first surface is not that of a diffuse lobe.
    HD void direct(const PathState&, const MediumVertex&, Vec3, const ShadowRay& shadow) {
        if (frame_.splits_light()) shadow_data_.diffuse = first_ * shadow.contribution;
    }
    HD void scattered(const PathState&, const MediumVertex&, const BsdfSample&) {}
    /// The drawn lobe does not matter: other lobes scatter light that way too, and light of glossy ones depends on
    /// the view.
    HD void scattered(const PathState& path, const SurfaceVertex& at, const BsdfSample&) {
        if (!frame_.splits_light() || path.depth != 1) return;
        first_ = path.bsdf_pdf > 0 ? at.surface.diffuse_share(at.wo, path.direction) : Rgb{0, 0, 0};
    }
    HD void save(PathData& kept) const {
        kept = {{kept_.diffuse.x, kept_.diffuse.y, kept_.diffuse.z, float_of(packed(first_))}};
    }
    HD void save_shadow_data(ShadowData& shadow_data) const { shadow_data = shadow_data_; }

    HD void arrived(PathData& kept, const ShadowData& shadow_data, Rgb) const {
        Float4& d = kept.diffuse;
        d = {d.x + shadow_data.diffuse.r, d.y + shadow_data.diffuse.g, d.z + shadow_data.diffuse.b, d.w};
    }
    HD void ended(uint32_t pixel, Rgb, const PathData& kept) const {
        if (frame_.splits_light()) frame_.diffuse[pixel] = {kept.diffuse.x, kept.diffuse.y, kept.diffuse.z, 0};
    }

    HD static void load(const ListenerQueues& queues, uint32_t i, PathData& kept) {
        if (queues.diffuse != nullptr) kept.diffuse = queues.diffuse[i];
    }
    HD static void load_next(const ListenerQueues& queues, uint32_t i, PathData& kept) {
        if (queues.next_diffuse != nullptr) kept.diffuse = queues.next_diffuse[i];
    }
    HD static void store_next(const ListenerQueues& queues, uint32_t i, const PathData& kept) {
        if (queues.next_diffuse != nullptr) queues.next_diffuse[i] = kept.diffuse;
    }
    HD static void load_shadow_data(const ListenerQueues& queues, uint32_t i, ShadowData& shadow_data) {
        if (queues.shadow_diffuse == nullptr) return;
        const Float4 d = queues.shadow_diffuse[i];
        shadow_data.diffuse = {d.x, d.y, d.z};
    }
    HD static void store_shadow_data(const ListenerQueues& queues, uint32_t i, const ShadowData& shadow_data) {
        if (queues.shadow_diffuse == nullptr) return;
        queues.shadow_diffuse[i] = {shadow_data.diffuse.r, shadow_data.diffuse.g, shadow_data.diffuse.b, 0};
    }

private:
    static constexpr uint32_t kMaxCode = 1023;
    HD static uint32_t part(float share) {
        return static_cast<uint32_t>(to_int(fma(share, static_cast<float>(kMaxCode), 0.5f), 0, kMaxCode));
    }
    HD static uint32_t packed(Rgb share) { return part(share.r) | part(share.g) << 10 | part(share.b) << 20; }
    HD static Rgb unpacked(uint32_t bits) {
        constexpr float kInv = 1.0f / static_cast<float>(kMaxCode);
        return kInv * Rgb{static_cast<float>(bits & kMaxCode), static_cast<float>(bits >> 10 & kMaxCode),
                          static_cast<float>(bits >> 20 & kMaxCode)};
    }

    const NoisyFrameView& frame_;
    PathData kept_ = {};
    ShadowData shadow_data_ = {};
    Rgb first_ = {0, 0, 0}; // share of diffuse lobes in what the first vertex scattered
};

/// Stores the data of the first bounce for ReSTIR (FirstBounceView), if the frame has room for it.
class FirstBounce : public PathListener<FirstBounce> {
public:
    struct ShadowData {
        Rgb diffuse; // part of the contribution that passes through diffuse lobes of the second vertex
        uint32_t pixel;
    };

    HD explicit FirstBounce(const PathJob& job) : frame_(job.film.frame) {}

    static uint32_t depth_of_lanes(const PathJob& job) {
        const FirstBounceView& first = job.film.frame.first_bounce;
        return first.leaves_direct_light() || first.records_bounce() ? kNoLaneDepth : 0;
    }
    HD void begins(const PathState& path) {
        if (leaves()) left().light[path.pixel] = {};
        if (records()) begin_bounce(path, {}, false);
    }
    HD bool removes_emission(const PathState& path, const EmitterPoint& point, float light_pdf) {
        if (!leaves() || path.depth != 1 || !(light_pdf > 0)) return false;
        left().light[path.pixel] = point;
        return true;
    }
    HD void emitted(const PathState& path, Rgb light) {
        if (!records() || path.depth <= 1) return;
        // Equals the growth of the sample's radiance, which for split light contains only this vertex.
        const Rgb more = frame_.splits_light() ? light : (path.radiance + light) - path.radiance;
        left().add_diffuse(path.pixel, continuation_share(path.pixel) * more);
    }
    HD bool samples_direct(const PathState& path, const Hit& hit, const Surface& surface) {
        // Beneath coat or sheen, the light that leaves in one direction does not determine the light in another.
        is_bounce_ = records() && path.depth == 1 && path.bsdf_pdf > 0 && !surface.bsdf.is_stacked;
        if (is_bounce_) begin_bounce(path, hit, true);
        return !(leaves() && path.depth == 0);
    }
    HD void direct(const PathState& path, const SurfaceVertex& at, Vec3 wi, const ShadowRay& shadow) {
        if (!records()) return;
        const Rgb share = is_bounce_ ? at.surface.diffuse_share(at.wo, wi) : continuation_share(path.pixel);
        shadow_data_ = {share * shadow.contribution, path.pixel};
    }
    HD void scattered(const PathState& path, const SurfaceVertex& at, const BsdfSample&) {
        if (!is_bounce_ || !(path.bsdf_pdf > 0)) return; // light of a delta lobe cannot be shared
        const Rgb share = at.surface.diffuse_share(at.wo, path.direction);
        left().continuation_weight[path.pixel] = {share.r, share.g, share.b, 0};
    }
    HD void direct(const PathState& path, const MediumVertex&, Vec3, const ShadowRay& shadow) {
        if (records()) shadow_data_ = {continuation_share(path.pixel) * shadow.contribution, path.pixel};
    }
    HD void scattered(const PathState&, const MediumVertex&, const BsdfSample&) {}
    HD void save_shadow_data(ShadowData& shadow_data) const { shadow_data = shadow_data_; }

    HD void arrived(PathData&, const ShadowData& shadow_data, Rgb) const {
        if (records()) left().add_diffuse(shadow_data.pixel, shadow_data.diffuse);
    }

    HD static void load_shadow_data(const ListenerQueues& queues, uint32_t i, ShadowData& shadow_data) {
        if (queues.shadow_bounce == nullptr) return;
        const Float4 diffuse = queues.shadow_bounce[i];
        shadow_data = {{diffuse.x, diffuse.y, diffuse.z}, bits_of(diffuse.w)};
    }
    HD static void store_shadow_data(const ListenerQueues& queues, uint32_t i, const ShadowData& shadow_data) {
        if (queues.shadow_bounce == nullptr) return;
        queues.shadow_bounce[i] = {shadow_data.diffuse.r, shadow_data.diffuse.g, shadow_data.diffuse.b,
                                   float_of(shadow_data.pixel)};
    }

private:
    HD const FirstBounceView& left() const { return frame_.first_bounce; }
    HD bool leaves() const { return left().leaves_direct_light(); }
    HD bool records() const { return left().records_bounce(); }
    /// Stores the point that the first bounce hit before light is added there; none if it cannot be shared.
    HD void begin_bounce(const PathState& path, const Hit& hit, bool is_shared) const {
        left().hit[path.pixel] = {float_of(is_shared ? hit.instance : kNoHit), float_of(hit.primitive), hit.u, hit.v};
        left().throughput_and_pdf[path.pixel] = {path.throughput.r, path.throughput.g, path.throughput.b,
                                                 path.bsdf_pdf};
        left().diffuse_contribution[path.pixel] = left().continuation_weight[path.pixel] = {0, 0, 0, 0};
    }
    HD Rgb continuation_share(uint32_t pixel) const {
        const Float4 share = left().continuation_weight[pixel];
        return {share.x, share.y, share.z};
    }

    const NoisyFrameView& frame_;
    bool is_bounce_ = false;
    ShadowData shadow_data_ = {};
};

/// Listeners for frames. The types with Plain are for scenes with diffuse lobes only, those with Reuse leave light to
/// ReSTIR.
using FrameListeners = Listeners<FrameSurface, LightSplit, MirrorChain>;
using PlainFrameListeners = Listeners<FrameSurface>;
using ReuseListeners = Listeners<FrameSurface, LightSplit, MirrorChain, FirstBounce>;
using PlainReuseListeners = Listeners<FrameSurface, FirstBounce>;

} // namespace pertev
