#pragma once

// Joint upsampling: a picture from light that was reconstructed at a lower resolution. Each pixel takes the light of
// surrounding coarse pixels that show its surface, and multiplies it by its own colours. Thus edges and textures have
// full resolution, and only light between edges is coarse.
//
// Source: Kopf, Cohen, Lischinski, Uyttendaele, "Joint Bilateral Upsampling", SIGGRAPH 2007; here the weights depend
// on position in the picture, object, normal and plane.

#include "denoise/reproject.h"
#include "denoise/shown_color.h"

namespace pertev {

/// Light at the lower resolution, and its surfaces.
struct CoarseLight {
    SignalsView signals;
    const Float4* guide; // guide of HistoryView
    CameraView camera;
    uint32_t width, height; // pixels
    bool has_gloss;         // false: that signal is black everywhere
};

struct UpsamplePicture {
    NoisyFrameView features; // G-buffer at the picture's resolution; its only light is emission
    CoarseLight coarse;
    CameraView camera;
    uint32_t width, height; // size of the picture
    SceneView scene;
    PreviousScene scene_before;
    CameraView camera_before;
    Vec2* was_at;                         // see AccumulateSignals, for the picture's pixels
    Float4* picture;                      // see ComposePicture
    bool has_history;                     // false at a cut
    static constexpr uint32_t kReach = 3; // rows of the light beside those where a pixel lies

    HD void operator()(uint32_t pixel) const {
        const Float4 light = features.light[pixel], normal = features.normal[pixel];
        const uint32_t own = bits_of(features.hit[pixel].x);
        if (has_history) was_at[pixel] = position_before(pixel, own);
        Rgb seen = light.w != 0 ? rgb_of(features.emission[pixel]) : Rgb{0, 0, 0};
        if (own != kNoHit) {
            const Light at = light_at(pixel, own, normal);
            seen += at.diffuse * diffuse_divisor(features, pixel);
            if (coarse.has_gloss) seen += at.gloss * gloss_divisor(features, pixel);
        }
        picture[pixel] = with_w(shown_color(seen), normal.w);
    }

private:
    struct Light {
        Rgb diffuse, gloss;
        float known = 0; // weight of taps whose diffuse signal is known
    };
    static constexpr int kTaps = 4; // per side

    HD Vec2 position_before(uint32_t pixel, uint32_t own) const {
        const FrameCameras cameras = with_straight_lenses({camera, camera_before, width, height});
        const Vec2 centre = {static_cast<float>(pixel % width) + 0.5f, static_cast<float>(pixel / width) + 0.5f};
        if (own == kNoHit) return reproject_far(cameras.now, cameras.before, centre);
        return reproject_surface(cameras, scene, scene_before, centre, features.hit[pixel]).pixel;
    }

    HD Light light_at(uint32_t pixel, uint32_t own, Float4 normal) const {
        const Vec2 centre = {static_cast<float>(pixel % width) + 0.5f, static_cast<float>(pixel / width) + 0.5f};
        const Vec3 point = unproject_point(camera, centre, normal.w);
        const Vec3 n = transform_transposed(camera.world_from_camera, vec3_of(normal));
        const float inv_size = 1.0f / max(pixel_size(coarse.camera, abs(normal.w)), 1e-20f);
        const float x = centre.x * camera.inv_width / coarse.camera.inv_width - 0.5f,
                    y = centre.y * camera.inv_height / coarse.camera.inv_height - 0.5f;
        const int w = static_cast<int>(coarse.width), h = static_cast<int>(coarse.height);
        const int left = to_int(floor(x), 0, w) - 1, top = to_int(floor(y), 0, h) - 1;
        Light sum = {{0, 0, 0}, {0, 0, 0}}, any = sum;
        float weights = 0, of_any = 0;
        for (int k = 0; k < kTaps * kTaps; ++k) {
            const int px = left + k % kTaps, py = top + k / kTaps;
            if (px < 0 || py < 0 || px >= w || py >= h) continue;
            const uint32_t tap = static_cast<uint32_t>(py * w + px);
            const Float4 its = coarse.guide[tap];
            if (object_of(its) == kNoHit) continue;
            const Vec2 there = {static_cast<float>(px), static_cast<float>(py)};
            const float near = fade(abs(there.x - x)) * fade(abs(there.y - y));
            add(any, of_any, tap, near);
            if (instance_of(object_of(its)) != own) continue;
            const Vec3 at = unproject_point(coarse.camera, {there.x + 0.5f, there.y + 0.5f}, depth_of(its));
            const float off = abs(dot(n, at - point)) * inv_size;
            const float bend = max(dot(normal_of(its), vec3_of(normal)), 0.0f);
            const float alike = square(square(bend)) * square(square(bend)) / (1.0f + square(square(off)));
            add(sum, weights, tap, near * alike);
        }
        if (!(weights > 1e-4f)) { // no surrounding pixel shows the surface, so their light is the best estimate
            sum = any;
            weights = of_any;
        }
        if (!(weights > 0)) return {{0, 0, 0}, {0, 0, 0}};
        return {(sum.known > 0 ? 1.0f / sum.known : 0.0f) * sum.diffuse, (1.0f / weights) * sum.gloss};
    }

    HD void add(Light& sum, float& weights, uint32_t tap, float weight) const {
        if (const Float4 diffuse = coarse.signals.diffuse[tap]; !(diffuse.w < 0)) {
            sum.diffuse += weight * rgb_of(diffuse);
            sum.known += weight;
        }
        if (coarse.has_gloss) sum.gloss += weight * rgb_of(coarse.signals.gloss[tap]);
        weights += weight;
    }

    /// Weight of a tap at this distance in coarse pixels: nearly a tent over one pixel, with a small tail over two.
    HD static float fade(float distance) { return max(1.0f - distance, 0.0f) + 0.01f * max(2.0f - distance, 0.0f); }
};

} // namespace pertev
