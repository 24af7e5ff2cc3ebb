#pragma once

// Second stage: each signal's mean over the frames that saw the same place, and that of its square.
//
// Sources: Schied et al. 2017 (above), section 4.1; NVIDIA, "Fast Denoising with Self-Stabilizing Recurrent Blurs",
// GDC 2020 (a second mean over few frames, against which the long one is held).

#include "denoise/reproject.h"
#include "render/tiled_pixel.h"

namespace pertev {

struct AccumulateSignals {
    NoisyFrameView frame;
    SignalsView signals; // of this frame's samples
    SceneView scene;
    PreviousScene scene_before;
    FrameCameras cameras;
    HistoryView now, before;
    uint32_t longest; // frames of a mean
    bool limit_fireflies;
    bool has_history;                   // false at a cut
    static constexpr float kRecent = 4; // frames of the recent mean

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = tiled_pixel(i, cameras.width, cameras.height);
        const uint32_t object = now.object[pixel];
        if (object == kNoHit) return forget(pixel);
        const Vec2 centre = {static_cast<float>(pixel % cameras.width) + 0.5f,
                             static_cast<float>(pixel / cameras.width) + 0.5f};
        Taps taps = {}, mirrored = {};
        if (has_history) {
            const Float4 normal = now.normal[pixel];
            const Reprojection at = reproject_surface(cameras, scene, scene_before, centre, frame.place[pixel]);
            taps = find_taps(before, cameras, at.pixel, max(at.depth, 1e-20f), vec3_of(normal), object);
            const float alpha = frame.albedo[pixel].w;
            if (alpha < kMirrors) {
                const float distance = frame.gloss[pixel].w;
                const Reprojection behind = reproject_virtual(cameras, centre, normal.w, min(distance, 1e6f));
                mirrored = find_taps(before, cameras, behind.pixel, 0, vec3_of(normal), object);
            }
        }
        const Float4 diffuse = limited(signals.diffuse, pixel), gloss = limited(signals.gloss, pixel);
        Float4 recent = {diffuse.x, diffuse.y, diffuse.z, luminance(rgb_of(gloss))};
        Vec2 squares = {square(luminance(rgb_of(diffuse))), square(recent.w)};
        const Taps& of_gloss = mirrored.sum > kEnoughWeight ? mirrored : taps;
        if (taps.sum > kEnoughWeight) {
            const Float4 mean = mean_of_taps(taps, cameras, before.diffuse);
            const float frames = min(mean.w + 1.0f, static_cast<float>(longest));
            now.diffuse[pixel] = with_w(lerp(rgb_of(mean), rgb_of(diffuse), 1.0f / frames), frames);
            const Float4 recently = mean_of_taps(taps, cameras, before.recent);
            const float share = 1.0f / min(frames, kRecent);
            recent = {lerp(recently.x, recent.x, share), lerp(recently.y, recent.y, share),
                      lerp(recently.z, recent.z, share), lerp(recently.w, recent.w, share)};
            squares.x = lerp(mean_of_taps(taps, cameras, before.squares).x, squares.x, 1.0f / frames);
        } else {
            now.diffuse[pixel] = with_w(rgb_of(diffuse), 1);
        }
        if (of_gloss.sum > kEnoughWeight) {
            const Float4 mean = mean_of_taps(of_gloss, cameras, before.gloss);
            const float frames = min(mean.w + 1.0f, static_cast<float>(longest));
            now.gloss[pixel] = with_w(lerp(rgb_of(mean), rgb_of(gloss), 1.0f / frames), frames);
            squares.y = lerp(mean_of_taps(of_gloss, cameras, before.squares).y, squares.y, 1.0f / frames);
        } else {
            now.gloss[pixel] = with_w(rgb_of(gloss), 1);
        }
        now.squares[pixel] = squares;
        now.recent[pixel] = recent;
    }

private:
    static constexpr float kFirefly = 64;
    static constexpr float kMirrors = 0.09f; // GGX width under which reflections move by themselves

    HD void forget(uint32_t pixel) const {
        now.diffuse[pixel] = now.gloss[pixel] = now.recent[pixel] = {0, 0, 0, 0};
        now.squares[pixel] = {0, 0};
    }

    /// The sample, no brighter than kFirefly times the brightest of its eight neighbours. Of one sample a pixel most
    /// see no light at all, so that less than this would take much of what is real.
    HD Float4 limited(const Float4* signal, uint32_t pixel) const {
        const Float4 own = signal[pixel];
        if (!limit_fireflies) return own;
        const int width = static_cast<int>(cameras.width), height = static_cast<int>(cameras.height);
        const int x = static_cast<int>(pixel % cameras.width), y = static_cast<int>(pixel / cameras.width);
        float brightest = 0;
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                if ((dx == 0 && dy == 0) || x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
                brightest = max(brightest, luminance(rgb_of(signal[(y + dy) * width + x + dx])));
            }
        }
        const float light = luminance(rgb_of(own)), most = kFirefly * brightest;
        if (!(light > most) || !(brightest > 0)) return own;
        return with_w((most / light) * rgb_of(own), 0);
    }
};

} // namespace pertev
