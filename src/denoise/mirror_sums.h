#pragma once

// The light that comes to a picture's pixels by mirrors and smooth glass (render/mirror_chain_view.h). It has signals
// of its own: one for what the first surface reflects and one for what it lets through, each guided by the surface at
// the chain's end and divided by its colour. So a texture or an edge seen in a mirror is as sharp as one seen directly,
// emitters seen there have no noise, and the light is smooth. Light of other turns than the guide's, such as
// reflections within glass, stays in the gloss signal of the first surface.

#include "denoise/picture_sums.h"
#include "render/mirror_chain_view.h"

namespace pertev {

/// One branch: light that the first surface reflects, or that it transmits.
struct MirrorBranch {
    Float4* end; // end and normal of the ray through the pixel's centre, as in MirrorChainView; no turns: none
    Float4* normal;
    Float4* light; // sum over samples of the light from the chain's end, and of the luminance of the signal, which
                   // FinishSums makes of the exact ones
    Float4* color; // sum over features of the colour that this is divided by
    Float4* edge;  // sum of the colour of features beyond an edge of the mirror's picture; bits of a pixel beside it
                   // whose guide shows them, kNoHit: none

    HD uint32_t turns(uint32_t pixel) const { return bits_of(normal[pixel].w); }
};
struct MirrorSums {
    static constexpr int kBranches = 2, kArrays = 5; // numbers of branches, and of their arrays of Float4
    MirrorBranch branches[kBranches];
    Float4*
        seen; // sum over features of emission at the end of both branches; number of features on the guide's surface
    Vec2* squares; // sums over samples of squares of the luminances of both signals, as `light`

    HD bool is_there() const { return seen != nullptr; }
    /// Mean colour of a branch.
    HD Rgb color(int branch, uint32_t pixel) const {
        const float count = seen[pixel].w;
        return count > 0 ? (1.0f / count) * rgb_of(branches[branch].color[pixel]) : Rgb{0, 0, 0};
    }
};

/// The branch of a chain with at least one turn: 0 reflection, 1 transmission.
HD inline int branch_of(uint32_t turns) {
    uint32_t first = turns;
    while (first > 3) first >>= 1;
    return static_cast<int>(first & 1);
}

/// Returns whether the chain of a sample of `pixel` has the turns of the guide of pixel `by` and ends on its surface.
HD inline bool is_guided(const MirrorBranch& guide, uint32_t by, const MirrorChainView& chain, uint32_t pixel) {
    const Float4 own = guide.normal[by], normal = chain.normal[pixel];
    if (bits_of(own.w) != bits_of(normal.w)) return false;
    const Float4 there = guide.end[by], end = chain.end[pixel];
    if (bits_of(there.w) != bits_of(end.w)) return false;
    if (bits_of(end.w) == kNoHit) return true;
    const Vec3 apart = vec3_of(end) - vec3_of(there);
    constexpr float kFlat = 0.1f; // share of the distance
    return dot(vec3_of(own), vec3_of(normal)) > 0.5f &&
           square(dot(vec3_of(own), apart)) <= square(kFlat) * length_squared(apart) + 1e-12f;
}

/// Takes light of a sample on the guide's surface, which was not scattered by diffuse lobes there, to its branch in
/// `exact`. Returns the rest.
HD inline Rgb take_mirrored(const MirrorSums& sums, const ExactSums& exact, const MirrorChainView& chain,
                            uint32_t pixel, Rgb gloss) {
    if (!sums.is_there() || !chain.is_there()) return gloss;
    const uint32_t turns = bits_of(chain.normal[pixel].w);
    if (turns < 2) return gloss;
    const int k = branch_of(turns);
    const MirrorBranch& branch = sums.branches[k];
    if (!is_guided(branch, pixel, chain, pixel)) {
        const uint32_t edge = bits_of(branch.edge[pixel].w);
        const bool is_beside = edge != kNoHit && is_guided(branch, edge, chain, pixel);
        return is_beside ? Rgb{0, 0, 0} : gloss; // the light is that of the pixel beside
    }
    const Rgb more = gloss - rgb_of(chain.seen[pixel]);
    const Rgb light = {max(more.r, 0.0f), max(more.g, 0.0f), max(more.b, 0.0f)};
    const float signal = luminance(rgb_of(diffuse_signal(light, sums.color(k, pixel))));
    const uint32_t array = PictureSums::of_branch(k);
    SampleSums::Light::add(exact, array, pixel, light);
    LightSum::add(exact, array + SampleSums::kMirrorSignal, pixel, signal);
    SquareSum::add(exact, array + SampleSums::kMirrorSquare, pixel, square(signal));
    return {0, 0, 0};
}

} // namespace pertev
