#pragma once

// Last stage: temporal mean of pictures, each sampled at other positions within the pixels. History is clamped to the
// colours around the pixel. An emitter smaller than a pixel is hit in some frames only, so while nothing but the camera
// moves its light stays within the limits for as long as its share of the pixel needs; otherwise it would be cut off
// in all frames but these.
//
// Sources: Karis, "High Quality Temporal Supersampling", SIGGRAPH 2014 (colours in YCoCg); Salvi, "An Excursion in
// Temporal Supersampling", GDC 2016 (limits by mean and deviation).

#include "denoise/shown_color.h"
#include "image/tone_map.h"
#include "render/row_band.h"

namespace pertev {

/// The temporal means of light, which have as many frames as a surface has been visible in under the same light.
struct SteadyLight {
    const Float4* means;    // diffuse of the frame's HistoryView
    const Float4* guide;    // guide of that
    uint32_t width, height; // pixels; they may be fewer than the picture's
    uint32_t frames;        // number of frames from which on light is steady
    bool may_change = true; // false: the scene is that of the previous frame, so the light is, too

    /// Returns whether the light around a pixel of the picture is steady. A single surface suffices, because an emitter
    /// smaller than a pixel hides others in some frames, but not one with another contact.
    HD bool is_around(PixelPosition at, uint32_t picture_width, uint32_t picture_height) const {
        if (!may_change) return true;
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int x = static_cast<int>(at.x * width / picture_width),
                  y = static_cast<int>(at.y * height / picture_height);
        const uint32_t own = object_of(guide[y * w + x]);
        for (int k = 0; k < 9; ++k) {
            const int tap = held(y, k / 3 - 1, h) * w + held(x, k % 3 - 1, w);
            if (means[tap].w >= static_cast<float>(frames) && !differ_in_contact(own, object_of(guide[tap])))
                return true;
        }
        return false;
    }

    /// Number of frames of the mean at a pixel of the picture; 0 if the contact there is unknown.
    HD float frames_of_contact(PixelPosition at, uint32_t picture_width, uint32_t picture_height) const {
        const uint32_t pixel = at.y * height / picture_height * width + at.x * width / picture_width;
        return knows_contact(object_of(guide[pixel])) ? max(means[pixel].w, 1.0f) : 0.0f;
    }
};

/// A shown pixel keeps this in the bits of its w.
struct ShownMemory {
    uint32_t frames_at_rest; // frames in which the pixel and those beside it have been at rest under steady light
    float emitted;           // luma of the brightest emitter seen there lately, less by a share in each frame

    HD static ShownMemory unpack(float w) { return {bits_of(w) & kFrames, float_of(bits_of(w) & ~kFrames)}; }
    HD float pack() const { return float_of((bits_of(emitted) & ~kFrames) | min(frames_at_rest, kFrames)); }

private:
    static constexpr uint32_t kFrames = 0xffff; // the other bits are the upper half of a float
};

struct AntiAlias {
    const Float4* picture;  // output of ComposePicture
    const Float4* emission; // NoisyFrameView::emission of the picture
    const Vec2* was_at;     // output of AccumulateSignals
    const Float4* before;   // `shown` of the previous frame's HistoryView
    Float4* shown;          // w: ShownMemory
    uint32_t width, height;
    bool has_history;
    SteadyLight steady;
    RowBand band = {};                    // the rows to be made
    static constexpr uint32_t kReach = 1; // rows beside a pixel's that it reads
    // Weight of the current frame, and the number of standard deviations of the surrounding colours by which history
    // may differ from their mean: without motion, the increment per pixel of motion, and the limit. Each frame with
    // motion samples the previous one between its pixels, which blurs, and highlights do not move as surfaces do.
    static constexpr float kNew = 0.1f, kNewPerPixel = 0.1f, kNewAtMost = 0.4f;
    static constexpr float kAtRest = 0.01f; // pixels
    static constexpr float kDeviations = 1, kDeviationsPerPixel = -0.25f, kDeviationsAtLeast = 0.5f;
    // After each frame this share of an emitter's light is left as a limit. One that fills a tenth of a pixel, whose
    // mean has a tenth of its light, is thus kept for 22 frames, in which it is hit twice on average.
    static constexpr float kEmittedKept = 0.9f;

    HD void operator()(uint32_t i) const {
        const PixelPosition at = tiled_in_band(i, width, band);
        const uint32_t pixel = at.y * width + at.x;
        const Rgb own = rgb_of(picture[pixel]);
        const float emitted = shown_color(rgb_of(emission[pixel])).r;
        ShownMemory memory = {0, emitted <= own.r ? emitted : max(own.r, 0.0f)}; // an invalid sample has no emission
        const Rgb color = has_history ? with_history(at, own, memory) : own;
        shown[pixel] = with_w(color, memory.pack());
    }

private:
    struct Colors {
        Rgb mean, deviation;
        PixelPosition nearest; // pixel of least depth, because edges move with the foreground
    };

    HD Rgb with_history(PixelPosition at, Rgb own, ShownMemory& memory) const {
        const Colors around = neighbourhood(at);
        const PixelPosition nearest = around.nearest;
        const Vec2 moved = was_at[nearest.y * width + nearest.x];
        const Vec2 then = {moved.x + static_cast<float>(static_cast<int>(at.x) - static_cast<int>(nearest.x)),
                           moved.y + static_cast<float>(static_cast<int>(at.y) - static_cast<int>(nearest.y))};
        if (!(then.x >= 0 && then.y >= 0 && then.x < static_cast<float>(width) && then.y < static_cast<float>(height)))
            return own;
        float emitted = 0;
        const Rgb old = sample(then, emitted);
        // A moving emitter would leave a trail.
        if (!steady.may_change) memory.emitted = max(memory.emitted, kEmittedKept * emitted);
        const float x_moved = then.x - (static_cast<float>(at.x) + 0.5f),
                    y_moved = then.y - (static_cast<float>(at.y) + 0.5f);
        const float pixels_moved = sqrt(square(x_moved) + square(y_moved));
        // At rest a history is right, even if this frame's samples have missed what is smaller than a pixel.
        if (pixels_moved < kAtRest) {
            if (steady.is_around(at, width, height)) {
                const uint32_t frames = ShownMemory::unpack(before[at.y * width + at.x].w).frames_at_rest;
                memory.frames_at_rest = min(frames + 1, steady.frames);
            }
            if (memory.frames_at_rest >= steady.frames) return lerp(old, own, kNew);
        }
        const float deviations = max(fma(kDeviationsPerPixel, pixels_moved, kDeviations), kDeviationsAtLeast);
        // Where contacts are known, a gap as thin as a pixel must not fade: its colour is within the limits, and no
        // mean has more frames than that of its light.
        const float frames_of_light = steady.frames_of_contact(at, width, height);
        const Rgb kept = frames_of_light > 0 ? own : around.mean, tolerance = deviations * around.deviation;
        const float brightest = steady.may_change ? kept.r : max(kept.r, memory.emitted),
                    luma = within(old.r, brightest, around.mean.r, tolerance.r);
        // Light of an emitter beyond the colours around may have any hue.
        const float beyond = steady.may_change ? 0.0f : 2.0f * max(luma - around.mean.r - tolerance.r, 0.0f);
        const Rgb limited = {luma, within(old.g, kept.g, around.mean.g, tolerance.g + beyond),
                             within(old.b, kept.b, around.mean.b, tolerance.b + beyond)};
        const float weight = min(fma(kNewPerPixel, pixels_moved, kNew), kNewAtMost);
        return lerp(limited, own, max(weight, frames_of_light > 0 ? 1.0f / (frames_of_light + 1.0f) : 0.0f));
    }

    HD Colors neighbourhood(PixelPosition at) const {
        Rgb sum = {0, 0, 0}, squares = {0, 0, 0};
        float least = kInfinity;
        Colors colors = {{}, {}, at};
        for (int k = 0; k < 9; ++k) {
            const int x = held(static_cast<int>(at.x), k % 3 - 1, static_cast<int>(width)),
                      y = held(static_cast<int>(at.y), k / 3 - 1, static_cast<int>(height));
            const Float4 there = picture[y * static_cast<int>(width) + x];
            const Rgb c = rgb_of(there);
            sum += c;
            squares = {fma(c.r, c.r, squares.r), fma(c.g, c.g, squares.g), fma(c.b, c.b, squares.b)};
            if (there.w < least) {
                least = there.w;
                colors.nearest = {static_cast<uint32_t>(x), static_cast<uint32_t>(y)};
            }
        }
        colors.mean = (1.0f / 9.0f) * sum;
        const Rgb spread = (1.0f / 9.0f) * squares - colors.mean * colors.mean;
        colors.deviation = {safe_sqrt(spread.r), safe_sqrt(spread.g), safe_sqrt(spread.b)};
        return colors;
    }

    /// Samples the previously shown picture with Catmull-Rom splines (Jimenez, "Filmic SMAA", SIGGRAPH 2016), which
    /// blur less than linear interpolation. `emitted` becomes the most that the four pixels around have (ShownMemory).
    HD Rgb sample(Vec2 position, float& emitted) const {
        const float x = position.x - 0.5f, y = position.y - 0.5f, left = floor(x), top = floor(y);
        const Weights wx = spline(x - left), wy = spline(y - top);
        const int w = static_cast<int>(width), h = static_cast<int>(height);
        const int column = to_int(left, -1, w), row = to_int(top, -1, h);
        int columns[4];
        for (int k = 0; k < 4; ++k) columns[k] = held(column, k - 1, w);
        Rgb sum = {0, 0, 0};
        for (int j = 0; j < 4; ++j) {
            const Float4* const line = before + held(row, j - 1, h) * w;
            Rgb of_line = {0, 0, 0};
            for (int k = 0; k < 4; ++k) {
                const Float4 there = line[columns[k]];
                of_line = add_scaled(of_line, wx.of[k], rgb_of(there));
                const bool is_around = (j == 1 || j == 2) && (k == 1 || k == 2);
                if (is_around) emitted = max(emitted, ShownMemory::unpack(there.w).emitted);
            }
            sum = add_scaled(sum, wy.of[j], of_line);
        }
        return sum;
    }
    struct Weights {
        float of[4];
    };
    HD static Weights spline(float t) {
        const float t2 = t * t, t3 = t2 * t;
        return {{0.5f * (2.0f * t2 - t3 - t), 0.5f * (3.0f * t3 - 5.0f * t2 + 2.0f), 0.5f * (4.0f * t2 - 3.0f * t3 + t),
                 0.5f * (t3 - t2)}};
    }

    HD static float within(float x, float kept, float mean, float deviation) {
        return clamp(x, min(kept, mean - deviation), max(kept, mean + deviation));
    }
};

/// The stage that computes the bytes of a reconstructed picture for a display, with one call per pixel.
struct ShowPicture {
    const Float4* picture; // shown_color
    ToneMap kind;
    float scale;     // factor for the light before tone mapping
    uint8_t* pixels; // [pixels * 4]

    HD void operator()(uint32_t i) const {
        tone_map_pixel(light_of_shown(rgb_of(picture[i])), 1.0f, kind, scale, pixels + 4 * uint64_t(i));
    }
};

} // namespace pertev
