#pragma once

// First stage after a picture's samples: rounds exact sums (denoise/exact_sums.h) to the floats that filters read.

#include "denoise/mirror_sums.h"

namespace pertev {

/// The stage that rounds the exact sums of light for the filters.
struct FinishSums {
    PictureSums sums;
    MirrorSums mirrors; // may be empty

    HD void operator()(uint32_t pixel) const {
        const ExactSums& exact = sums.exact;
        const auto light = [&](uint32_t array) { return SampleSums::Light::get(exact, array, pixel); };
        const auto color = [&](uint32_t array) { return SampleSums::Color::get(exact, array, pixel); };
        const auto signal = [&](uint32_t array) { return static_cast<float>(LightSum::get(exact, array, pixel)); };
        const auto squares = [&](uint32_t array) { return static_cast<float>(SquareSum::get(exact, array, pixel)); };
        sums.diffuse[pixel] =
            with_w(light(SampleSums::kDiffuse), static_cast<float>(exact.at(SampleSums::kOwnCount, pixel)));
        sums.gloss[pixel] = with_w(light(SampleSums::kGloss), 0);
        sums.diffuse_share[pixel] = with_w(color(SampleSums::kDiffuseShare), signal(SampleSums::kSignals));
        sums.gloss_share[pixel] =
            with_w(color(SampleSums::kGlossShare), signal(SampleSums::kSignals + LightSum::kArrays));
        sums.squares[pixel] = {squares(SampleSums::kSquares), squares(SampleSums::kSquares + SquareSum::kArrays)};
        if (!mirrors.is_there()) return;
        static_assert(MirrorSums::kBranches == SampleSums::kMirrorBranches);
        float of_branches[MirrorSums::kBranches];
        for (int k = 0; k < MirrorSums::kBranches; ++k) {
            const uint32_t array = PictureSums::of_branch(k);
            mirrors.branches[k].light[pixel] = with_w(light(array), signal(array + SampleSums::kMirrorSignal));
            of_branches[k] = squares(array + SampleSums::kMirrorSquare);
        }
        mirrors.squares[pixel] = {of_branches[0], of_branches[1]};
    }
};

} // namespace pertev
