#pragma once

// Second stage: temporal mean of each signal and of its square, over the frames that saw the same surface point.
//
// Sources: Schied et al. 2017 (reconstruction.h), section 4.1; NVIDIA, "Fast Denoising with Self-Stabilizing Recurrent
// Blurs", GDC 2020 (a second mean over few frames, to which the long one is clamped).

#include "denoise/reproject.h"
#include "denoise/temporal_gradients_view.h"
#include "render/row_band.h"

namespace pertev {

/// The stage that accumulates the signals over frames. `kFollows` means that light may have changed since the previous
/// frame; code for that would slow down the other case.
template <bool kFollows>
struct AccumulateSignals {
    NoisyFrameView frame;
    SignalsView signals; // signals of this frame's samples
    SceneView scene;
    PreviousScene scene_before;
    FrameCameras cameras;
    HistoryView now, before;
    TemporalGradientsView change; // change of light since the previous frame
    Vec2* was_at;                 // pixel of the previous frame that showed the same; not written at a cut
    uint32_t longest;             // maximum number of frames of a mean
    bool clamp_fireflies;
    bool has_gloss;                       // false: that signal is black everywhere and neither read nor written
    bool has_history;                     // false at a cut
    RowBand band = {};                    // the rows to be made
    static constexpr float kRecent = 4;   // frames of the recent mean
    static constexpr uint32_t kReach = 1; // rows beside a pixel's whose samples it reads

    HD void operator()(uint32_t i) const {
        const PixelPosition at = tiled_in_band(i, cameras.width, band);
        const uint32_t pixel = at.y * cameras.width + at.x;
        const Float4 guide = now.guide[pixel];
        const uint32_t object = object_of(guide);
        const Vec2 centre = {static_cast<float>(at.x) + 0.5f, static_cast<float>(at.y) + 0.5f};
        if (object == kNoHit) {
            const FrameCameras straight = with_straight_lenses(cameras);
            if (!has_history) return forget(pixel, 0);
            was_at[pixel] = reproject_far(straight.now, straight.before, centre);
            return forget(pixel, frames_of_background(was_at[pixel]));
        }
        Taps taps = {}, mirrored = {};
        LightStep step;
        float longest_diffuse = static_cast<float>(longest), longest_gloss = longest_diffuse;
        if (has_history) {
            const Vec3 normal = normal_of(guide);
            const Reprojection then =
                reproject_surface(with_straight_lenses(cameras), scene, scene_before, centre, frame.hit[pixel]);
            was_at[pixel] = then.pixel;
            taps = find_taps(before, cameras, then.pixel, max(then.depth, 1e-20f), normal, kMinNormalCosine, object);
            if constexpr (kFollows) {
                step = light_step(change, then.pixel, normal, object);
                longest_diffuse =
                    frames_in_change(longest_diffuse, fused_luminance(step.was), fused_luminance(step.is));
                longest_gloss = frames_in_change(longest_gloss, step.gloss_was, step.gloss_is);
            }
            if (has_gloss && alpha_of(guide) < kMirrors) {
                const float distance = min(frame.gloss[pixel].w, 1e6f);
                const Reprojection behind = reproject_virtual(cameras, centre, depth_of(guide), distance);
                mirrored = find_taps(before, cameras, behind.pixel, 0, normal, kFlat, object);
            }
            if (has_gloss && !(mirrored.sum > kEnoughWeight)) {
                const float frames = frames_of_lobe(cameras, scene, alpha_of(guide), frame.hit[pixel]);
                longest_gloss = min(longest_gloss, max(frames, 1.0f));
            }
        }
        const Float4 diffuse = limited(signals.diffuse, at);
        const bool is_known = diffuse.w >= 0;
        Float4 recent = is_known ? diffuse : Float4{kUnknownSignal, 0, 0, 0};
        recent.w = 0;
        Vec2 squares = {square(fused_luminance(rgb_of(diffuse))), 0};
        if (has_gloss) {
            const Float4 gloss = limited(signals.gloss, at);
            recent.w = fused_luminance(rgb_of(gloss));
            squares.y = square(recent.w);
            const Taps& of_gloss = mirrored.sum > kEnoughWeight ? mirrored : taps;
            Float4 mean = mean_of_taps(of_gloss, cameras, before.gloss);
            float ratio = 1;
            if constexpr (kFollows) {
                const float light = fused_luminance(rgb_of(mean));
                ratio = ratio_of(light, followed(light, step.gloss_was, step.gloss_is));
                mean = with_w(ratio * rgb_of(mean), mean.w);
            }
            mean = accumulated(of_gloss, mean, gloss, longest_gloss);
            now.gloss[pixel] = mean;
            if (mean.w > 1) {
                squares.y =
                    lerp(square(ratio) * mean_of_taps(of_gloss, cameras, before.squares).y, squares.y, 1.0f / mean.w);
            }
        }
        // A sample of a black surface, or history of one, says nothing.
        const Taps known = taps_of_known(taps, cameras, before.diffuse);
        Float4 mean = mean_of_taps(known, cameras, before.diffuse);
        float ratio = 1;
        if constexpr (kFollows) {
            const float light = fused_luminance(rgb_of(mean));
            mean = with_w(followed(rgb_of(mean), step.was, step.is), mean.w);
            ratio = ratio_of(light, fused_luminance(rgb_of(mean)));
        }
        if (is_known) {
            mean = accumulated(known, mean, diffuse, longest_diffuse);
        } else {
            mean = known.sum > kEnoughWeight ? with_w(rgb_of(mean), min(mean.w, longest_diffuse)) : Float4{0, 0, 0, 0};
        }
        now.diffuse[pixel] = mean;
        if (is_known ? mean.w > 1 : mean.w > 0) {
            squares.x = lerp(square(ratio) * mean_of_taps(known, cameras, before.squares).x, squares.x,
                             is_known ? 1.0f / mean.w : 0.0f);
            Float4 recently = mean_of_taps(known, cameras, before.recent);
            if constexpr (kFollows) {
                recently = with_w(followed(rgb_of(recently), step.was, step.is),
                                  followed(recently.w, step.gloss_was, step.gloss_is));
            }
            const float share = 1.0f / min(mean.w, kRecent), of_diffuse = is_known ? share : 0.0f;
            recent = {lerp(recently.x, recent.x, of_diffuse), lerp(recently.y, recent.y, of_diffuse),
                      lerp(recently.z, recent.z, of_diffuse), lerp(recently.w, recent.w, share)};
        }
        now.squares[pixel] = squares;
        now.recent[pixel] = recent;
    }

private:
    static constexpr float kFirefly = 64;
    static constexpr float kMirrors = 0.09f; // GGX width below which reflections are reprojected separately
    /// Minimum cosine of normals of a flat mirror. Curved mirrors do not show objects at their distance.
    static constexpr float kFlat = 0.9999f;

    /// Restarts the means of a pixel where `frames` have seen the background.
    HD void forget(uint32_t pixel, float frames) const {
        now.recent[pixel] = {0, 0, 0, 0};
        now.diffuse[pixel] = {0, 0, 0, frames};
        if (has_gloss) now.gloss[pixel] = {0, 0, 0, 0};
        now.squares[pixel] = {0, 0};
    }

    /// Number of frames, with this one, that have seen the background around this pixel of the previous frame. Those
    /// beside it count too, because an emitter smaller than a pixel hides the background only in some frames.
    HD float frames_of_background(Vec2 at) const {
        const int width = static_cast<int>(cameras.width), height = static_cast<int>(cameras.height);
        if (!(at.x >= 0 && at.y >= 0 && at.x < static_cast<float>(width) && at.y < static_cast<float>(height)))
            return 1;
        const int x = to_int(at.x, 0, width - 1), y = to_int(at.y, 0, height - 1);
        float most = 0;
        for (int k = 0; k < 9; ++k) {
            const int tap = held(y, k / 3 - 1, height) * width + held(x, k % 3 - 1, width);
            if (object_of(before.guide[tap]) == kNoHit) most = max(most, before.diffuse[tap].w);
        }
        return min(most + 1.0f, static_cast<float>(longest));
    }

    HD static float ratio_of(float was, float is) { return was > 1e-12f ? is / was : 1.0f; }

    /// Updates `mean`, which the taps hold, by this frame's sample; its w is the number of frames.
    HD Float4 accumulated(const Taps& taps, Float4 mean, Float4 sample, float max_frames) const {
        if (!(taps.sum > kEnoughWeight)) return with_w(rgb_of(sample), 1);
        const float frames = min(mean.w + 1.0f, max_frames);
        return with_w(lerp(rgb_of(mean), rgb_of(sample), 1.0f / frames), frames);
    }

    /// Clamps the sample to kFirefly times the brightest of its eight neighbours. With one sample per pixel most see
    /// no light at all, so a lower limit would remove much real light.
    HD Float4 limited(const Float4* signal, PixelPosition at) const {
        const int width = static_cast<int>(cameras.width), height = static_cast<int>(cameras.height);
        const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
        const Float4 own = signal[y * width + x];
        if (!clamp_fireflies) return own;
        // At an edge of the picture the neighbour on the other side replaces the missing one.
        const int columns[3] = {held(x, x > 0 ? -1 : 1, width), x, held(x, x + 1 < width ? 1 : -1, width)};
        const int rows[3] = {held(y, y > 0 ? -1 : 1, height), y, held(y, y + 1 < height ? 1 : -1, height)};
        float brightest = 0;
        for (int k = 0; k < 9; ++k) {
            if (k == 4) continue;
            brightest = max(brightest, fused_luminance(rgb_of(signal[rows[k / 3] * width + columns[k % 3]])));
        }
        const float light = fused_luminance(rgb_of(own)), most = kFirefly * brightest;
        if (!(light > most) || !(brightest > 0)) return own;
        return with_w((most / light) * rgb_of(own), 0);
    }
};

} // namespace pertev
