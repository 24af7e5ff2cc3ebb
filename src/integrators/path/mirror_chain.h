#pragma once

// The listener that stores the chain of mirrors at which a frame's sample begins, if the frame has room for it.

#include "integrators/path/path_listener.h"
#include "render/mirror_chain_view.h"

namespace pertev {

class MirrorChain : public PathListener<MirrorChain> {
public:
    HD explicit MirrorChain(const PathJob& job) : chain_(job.film.frame.mirrors) {}

    static uint32_t depth_of_lanes(const PathJob&) { return 0; }
    bool may_be_in_lanes(const SceneView&, const PathState& path, const Hit&) const { return !follows(path); }
    HD void missed(const PathState& path) {
        if (follows(path)) store(path, path.direction, kNoHit, {0, 0, 0}, {0, 0, 0});
    }
    HD void vertex(const PathState& path, const Hit& hit, Surface& surface) {
        if (!follows(path)) return;
        const Vec3 normal = surface.frame.normal;
        const float cosine = dot(normal, path.direction);
        Rgb color = {0, 0, 0};
        if (path.depth > 0) {
            const Gloss gloss = surface.bsdf.gloss(abs(cosine));
            color = path.throughput * (gloss.transmittance * surface.albedo + gloss.reflectance);
        }
        store(path, surface.position, hit.instance, cosine > 0 ? -normal : normal, color);
    }
    HD void emitted(const PathState& path, Rgb light) {
        if (!follows(path) || path.depth == 0) return;
        const Float4 seen = chain_.seen[path.pixel];
        chain_.seen[path.pixel] = {seen.x + light.r, seen.y + light.g, seen.z + light.b, 0};
    }
    HD float chosen_lobe(const PathState& path, float drawn) const {
        if (!chain_.is_guide()) return drawn;
        return path.depth == 0 ? chain_.lobe : 0.5f;
    }
    template <class Vertex>
    HD void scattered(const PathState& path, const Vertex&, const BsdfSample& sample) {
        if (!follows(path)) return;
        Float4 &normal = chain_.normal[path.pixel], &color = chain_.color[path.pixel];
        const uint32_t turns = bits_of(normal.w);
        if (turns < kMostTurns) normal.w = float_of(turns << 1 | (sample.is_transmission ? 1u : 0u));
        // A surface with a single lobe has been followed by the lowest number already.
        const bool is_again = path.depth == 1 && chain_.lobe > 0 && !(sample.pdf < 1);
        color.w = is_again ? 0.0f : color.w * sample.pdf;
    }
    HD bool goes_on(const PathState& path) const { return !chain_.is_guide() || path.rough_depth == 0; }

private:
    static constexpr uint32_t kMostTurns = 1u << 22;

    HD bool follows(const PathState& path) const { return chain_.is_there() && path.rough_depth == 0; }
    HD void store(const PathState& path, Vec3 position, uint32_t instance, Vec3 normal, Rgb color) const {
        const uint32_t pixel = path.pixel;
        const bool begins = path.depth == 0;
        chain_.end[pixel] = {position.x, position.y, position.z, float_of(instance)};
        chain_.normal[pixel] = {normal.x, normal.y, normal.z, begins ? float_of(1) : chain_.normal[pixel].w};
        chain_.color[pixel] = {color.r, color.g, color.b, begins ? 1.0f : chain_.color[pixel].w};
        if (begins) chain_.seen[pixel] = {0, 0, 0, 0};
    }

    const MirrorChainView& chain_;
};

} // namespace pertev
