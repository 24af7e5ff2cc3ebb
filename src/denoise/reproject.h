#pragma once

// Reprojection to the previous frame, and lookup of its data.
//
// Sources: Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017, section 4.1 (bilinear taps, each tested
// by depth, normal and object); Stachowiak and Uludag, "Stochastic Screen-Space Reflections", SIGGRAPH 2015 (a
// reflection moves as the virtual object behind the mirror does).

#include "denoise/reconstruction_view.h"

namespace pertev {

/// Minimum weight of matching taps; below it they are not used.
inline constexpr float kEnoughWeight = 0.01f;

/// Reprojects a reflection seen at the pixel's centre: the virtual point `distance` metres behind the surface.
HD inline Reprojection reproject_virtual(const FrameCameras& frames, Vec2 centre, float depth, float distance) {
    const FrameCameras cameras = with_straight_lenses(frames);
    const Ray ray = make_camera_ray(cameras.now, centre, {0, 0});
    const Transform& m = cameras.now.world_from_camera;
    const float along = depth / -dot(transform_transposed(m, ray.direction), Vec3{0, 0, 1}); // metres along the ray
    const ProjectedPoint then = project_point(cameras.before, ray.origin + (along + distance) * ray.direction);
    return {then.pixel, then.depth};
}

/// Returns the number of frames in which a camera with constant motion passes half a lobe of width `alpha` at a hit;
/// meanwhile the reflection that it sees there changes.
HD inline float frames_of_lobe(const FrameCameras& cameras, const SceneView& scene, float alpha, Float4 hit) {
    const float turn = view_turn(cameras.now, cameras.before, point_at(scene.instances, scene.meshes, hit));
    return turn < 0 ? kInfinity : 0.5f * alpha / max(turn, 1e-6f);
}

/// Up to four pixels of the previous frame around a position, with their weights; the sum is 0 if none matches.
struct Taps {
    uint32_t first;   // upper left pixel, which need not match
    float weights[4]; // weights of `first`, its right neighbour, the two below; they add up to 1 if there is enough
                      // weight
    float sum;        // sum of weights before the division
};

/// Finds the taps that have seen `object` at about this depth with about this normal; if none has, it uses the nearest
/// matching pixel around, because along an edge a pixel sees one side or the other. `depth` <= 0 accepts any depth.
HD inline Taps find_taps(const HistoryView& before, const FrameCameras& cameras, Vec2 pixel, float depth, Vec3 normal,
                         float min_cosine, uint32_t object) {
    Taps taps = {0, {0, 0, 0, 0}, 0};
    const int w = static_cast<int>(cameras.width), h = static_cast<int>(cameras.height);
    const float x = pixel.x - 0.5f, y = pixel.y - 0.5f;
    if (!(x > -1 && y > -1 && x < static_cast<float>(w) && y < static_cast<float>(h))) return taps;
    const auto fits = [&](int px, int py) {
        if (px < 0 || py < 0 || px >= w || py >= h) return false;
        const Float4 then = before.guide[py * w + px];
        if (!may_be_same(object_of(then), object)) return false;
        if (!(dot(normal_of(then), normal) > min_cosine)) return false;
        return !(depth > 0) || is_similar_depth(depth_of(then), depth);
    };
    const float left = floor(x), top = floor(y), in_x = x - left, in_y = y - top;
    const int column = to_int(left, -1, w), row = to_int(top, -1, h);
    taps.first = static_cast<uint32_t>(row * w + column);
    for (int k = 0; k < 4; ++k) {
        if (!fits(column + (k & 1), row + (k >> 1))) continue;
        const float weight = ((k & 1) != 0 ? in_x : 1.0f - in_x) * ((k >> 1) != 0 ? in_y : 1.0f - in_y);
        taps.weights[k] = weight;
        taps.sum += weight;
    }
    if (taps.sum > kEnoughWeight) {
        const float inv = 1.0f / taps.sum;
        for (float& weight : taps.weights) weight *= inv;
        return taps;
    }
    const int near_x = column + (in_x < 0.5f ? 0 : 1), near_y = row + (in_y < 0.5f ? 0 : 1);
    for (int k = 0; k < 8; ++k) { // the four neighbours, then the corners
        const int dx = k < 4 ? (k == 0) - (k == 1) : 2 * (k & 1) - 1, dy = k < 4 ? (k == 2) - (k == 3) : (k & 2) - 1;
        if (!fits(near_x + dx, near_y + dy)) continue;
        return {static_cast<uint32_t>((near_y + dy) * w + near_x + dx), {1, 0, 0, 0}, 1};
    }
    return taps;
}

/// Pixel of tap k.
HD inline uint32_t tap_pixel(const Taps& taps, const FrameCameras& cameras, int k) {
    return taps.first + static_cast<uint32_t>(k & 1) + static_cast<uint32_t>(k >> 1) * cameras.width;
}

/// Returns the taps whose value has a positive w; unchanged if all have.
HD inline Taps taps_of_known(Taps taps, const FrameCameras& cameras, const Float4* values) {
    float sum = 0;
    for (int k = 0; k < 4; ++k) {
        if (!(taps.weights[k] > 0)) continue;
        if (!(values[tap_pixel(taps, cameras, k)].w > 0)) taps.weights[k] = 0;
        sum += taps.weights[k];
    }
    if (!(sum > 0)) {
        taps.sum = 0;
    } else if (sum < 0.999f) {
        taps.sum *= sum;
        for (float& weight : taps.weights) weight *= 1.0f / sum;
    }
    return taps;
}

/// Mean of `values` over the taps, at least one of which matches.
HD inline Float4 mean_of_taps(const Taps& taps, const FrameCameras& cameras, const Float4* values) {
    Float4 mean = {0, 0, 0, 0};
    for (int k = 0; k < 4; ++k) {
        if (!(taps.weights[k] > 0)) continue;
        const Float4 value = values[tap_pixel(taps, cameras, k)];
        const float weight = taps.weights[k];
        mean = {fma(weight, value.x, mean.x), fma(weight, value.y, mean.y), fma(weight, value.z, mean.z),
                fma(weight, value.w, mean.w)};
    }
    return mean;
}
HD inline Vec2 mean_of_taps(const Taps& taps, const FrameCameras& cameras, const Vec2* values) {
    Vec2 mean = {0, 0};
    for (int k = 0; k < 4; ++k) {
        if (taps.weights[k] > 0) mean = mean + taps.weights[k] * values[tap_pixel(taps, cameras, k)];
    }
    return mean;
}

} // namespace pertev
