#pragma once

// Last stage: the mean of pictures over time, each of which has seen other places within the pixels. What has come from
// the frame before is held within the colours about the pixel.
//
// Sources: Karis, "High Quality Temporal Supersampling", SIGGRAPH 2014 (weights by 1 / (1 + luminance), colours in
// YCoCg); Salvi, "An Excursion in Temporal Supersampling", GDC 2016 (limits by mean and deviation).

#include "denoise/reproject.h"
#include "image/tone_map.h"
#include "render/tiled_pixel.h"

namespace pertev {

struct AntiAlias {
    NoisyFrameView frame;
    const Float4* picture; // ComposePicture's
    SceneView scene;
    PreviousScene scene_before;
    FrameCameras cameras;
    HistoryView now, before;
    bool has_history;
    static constexpr float kNew = 0.1f; // share of the present frame

    HD void operator()(uint32_t i) const {
        const uint32_t pixel = tiled_pixel(i, cameras.width, cameras.height);
        const Rgb own = rgb_of(picture[pixel]);
        now.shown[pixel] = with_w(has_history ? with_history(pixel, own) : own, 0);
    }

private:
    struct Colors {
        Rgb mean, deviation; // of YCoCg of compressed colours
        uint32_t nearest;    // pixel of least depth: edges move with what is before
    };

    HD Rgb with_history(uint32_t pixel, Rgb own) const {
        const Colors around = look_around(pixel);
        const Vec2 centre = {static_cast<float>(pixel % cameras.width) + 0.5f,
                             static_cast<float>(pixel / cameras.width) + 0.5f};
        const uint32_t from = around.nearest;
        const Vec2 of_nearest = {static_cast<float>(from % cameras.width) + 0.5f,
                                 static_cast<float>(from / cameras.width) + 0.5f};
        const Vec2 moved = now.object[from] == kNoHit
                               ? reproject_sky(cameras, of_nearest)
                               : reproject_surface(cameras, scene, scene_before, of_nearest, frame.place[from]).pixel;
        const Vec2 then = centre + (moved - of_nearest);
        const float width = static_cast<float>(cameras.width), height = static_cast<float>(cameras.height);
        if (!(then.x >= 0 && then.y >= 0 && then.x < width && then.y < height)) return own;
        const Rgb old = to_ycocg(sample(then));
        const Rgb held = {within(old.r, around.mean.r, around.deviation.r),
                          within(old.g, around.mean.g, around.deviation.g),
                          within(old.b, around.mean.b, around.deviation.b)};
        return expand(from_ycocg(lerp(held, to_ycocg(compress(own)), kNew)));
    }

    HD Colors look_around(uint32_t pixel) const {
        const int w = static_cast<int>(cameras.width), h = static_cast<int>(cameras.height);
        const int x = static_cast<int>(pixel % cameras.width), y = static_cast<int>(pixel / cameras.width);
        Rgb sum = {0, 0, 0}, squares = {0, 0, 0};
        float count = 0, least = kInfinity;
        Colors colors = {{}, {}, pixel};
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                if (x + dx < 0 || y + dy < 0 || x + dx >= w || y + dy >= h) continue;
                const uint32_t at = static_cast<uint32_t>((y + dy) * w + x + dx);
                const Float4 there = picture[at];
                const Rgb c = to_ycocg(compress(rgb_of(there)));
                sum += c;
                squares += c * c;
                count += 1;
                if (there.w < least) {
                    least = there.w;
                    colors.nearest = at;
                }
            }
        }
        colors.mean = (1.0f / count) * sum;
        const Rgb spread = (1.0f / count) * squares - colors.mean * colors.mean;
        colors.deviation = {safe_sqrt(spread.r), safe_sqrt(spread.g), safe_sqrt(spread.b)};
        return colors;
    }

    /// Of the picture shown before, compressed: light beside a lamp would fall below nothing else. By Catmull-Rom
    /// splines without their corners (Jimenez, "Filmic SMAA", SIGGRAPH 2016), which blurs less than straight lines;
    /// never negative.
    HD Rgb sample(Vec2 place) const {
        const float x = place.x - 0.5f, y = place.y - 0.5f, left = floor(x), top = floor(y);
        const Weights wx = spline(x - left), wy = spline(y - top);
        const int column = to_int(left, 0, static_cast<int>(cameras.width)),
                  row = to_int(top, 0, static_cast<int>(cameras.height));
        Rgb sum = {0, 0, 0};
        for (int j = 0; j < 4; ++j) {
            Rgb line = {0, 0, 0};
            for (int k = 0; k < 4; ++k) line += wx.of[k] * compressed_at(column + k - 1, row + j - 1);
            sum += wy.of[j] * line;
        }
        return {max(sum.r, 0.0f), max(sum.g, 0.0f), max(sum.b, 0.0f)};
    }
    HD Rgb compressed_at(int x, int y) const {
        const int px = clamp(x, 0, static_cast<int>(cameras.width) - 1),
                  py = clamp(y, 0, static_cast<int>(cameras.height) - 1);
        return compress(rgb_of(before.shown[py * static_cast<int>(cameras.width) + px]));
    }
    struct Weights {
        float of[4];
    };
    HD static Weights spline(float t) {
        const float t2 = t * t, t3 = t2 * t;
        return {{0.5f * (2.0f * t2 - t3 - t), 0.5f * (3.0f * t3 - 5.0f * t2 + 2.0f), 0.5f * (4.0f * t2 - 3.0f * t3 + t),
                 0.5f * (t3 - t2)}};
    }

    HD static float within(float x, float mean, float deviation) {
        return clamp(x, mean - deviation, mean + deviation);
    }
    /// Bright colours count less, so that one of them does not stand for a pixel's edge.
    HD static Rgb compress(Rgb c) { return (1.0f / (1.0f + luminance(c))) * c; }
    HD static Rgb expand(Rgb c) { return (1.0f / max(1.0f - luminance(c), 1e-4f)) * c; }
    HD static Rgb to_ycocg(Rgb c) {
        return {0.25f * c.r + 0.5f * c.g + 0.25f * c.b, 0.5f * (c.r - c.b), 0.5f * c.g - 0.25f * (c.r + c.b)};
    }
    HD static Rgb from_ycocg(Rgb c) {
        const float low = c.r - c.b;
        return {max(low + c.g, 0.0f), max(c.r + c.b, 0.0f), max(low - c.g, 0.0f)};
    }
};

/// What a display shows of a reconstructed picture.
struct ShowPicture {
    const Float4* picture;
    ToneMap kind;
    float scale;     // of light, before it is tone-mapped
    uint8_t* pixels; // [pixels * 4]

    HD void operator()(uint32_t i) const {
        tone_map_pixel(rgb_of(picture[i]), 1.0f, kind, scale, pixels + 4 * uint64_t(i));
    }
};

} // namespace pertev
