#pragma once

// Stages that find the guides and the colours of what mirrors show (denoise/mirror_sums.h).

#include "denoise/gather_samples.h"

namespace pertev {

/// The stage that clears the guides and sums.
struct BeginMirrors {
    MirrorSums mirrors;

    HD void operator()(uint32_t pixel) const {
        constexpr Float4 kZero = {0, 0, 0, 0};
        for (const MirrorBranch& branch : mirrors.branches) {
            branch.end[pixel] = branch.normal[pixel] = branch.color[pixel] = kZero;
            branch.edge[pixel] = {0, 0, 0, float_of(kNoHit)};
        }
        mirrors.seen[pixel] = kZero;
    }
};

/// The stage that takes the chain of the ray through a pixel's centre as guide of its branch.
struct GuideMirrors {
    MirrorChainView chain;
    MirrorSums mirrors;

    HD void operator()(uint32_t pixel) const {
        const uint32_t turns = bits_of(chain.normal[pixel].w);
        if (turns < 2) return;
        const MirrorBranch& branch = mirrors.branches[branch_of(turns)];
        branch.end[pixel] = chain.end[pixel];
        branch.normal[pixel] = chain.normal[pixel];
    }
};

/// The stage that sums what a pixel's camera rays meet in mirrors.
struct GatherMirrors {
    SampledSurfaces samples;
    MirrorSums mirrors;

    HD void operator()(uint32_t pixel) const {
        const MirrorChainView& chain = samples.frame.mirrors;
        const SampledSurfaces::Found found = samples.found(pixel);
        if (found.object == kNoHit || !samples.shows_own(pixel, found)) return;
        if (!(chain.lobe > 0)) mirrors.seen[pixel].w += 1; // once for both lobes
        if (!(samples.frame.light[pixel].w != 0)) return;  // the sample is not finite
        const uint32_t turns = bits_of(chain.normal[pixel].w);
        if (turns < 2) return;
        const MirrorBranch& branch = mirrors.branches[branch_of(turns)];
        const float share = chain.color[pixel].w;
        const Rgb color = share * rgb_of(chain.color[pixel]), seen = share * rgb_of(chain.seen[pixel]);
        if (is_guided(branch, pixel, chain, pixel)) {
            SampledSurfaces::add(branch.color[pixel], color);
        } else {
            uint32_t edge = bits_of(branch.edge[pixel].w);
            if (edge == kNoHit) branch.edge[pixel].w = float_of(edge = pixel_beside(branch, pixel));
            if (edge == kNoHit || !is_guided(branch, edge, chain, pixel)) return;
            SampledSurfaces::add(branch.edge[pixel], color);
        }
        SampledSurfaces::add(mirrors.seen[pixel], seen);
    }

private:
    /// The nearest pixel around whose guide shows where the sample's chain ends.
    HD uint32_t pixel_beside(const MirrorBranch& branch, uint32_t pixel) const {
        return nearest_around(pixel, samples.width, samples.height,
                              [&](uint32_t there) { return is_guided(branch, there, samples.frame.mirrors, pixel); });
    }
};

} // namespace pertev
