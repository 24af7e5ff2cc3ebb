#include "apps/viewer/layer_colors.h"

#include <algorithm>
#include <vector>

#include "device_scene/ray_queue.h"
#include "image/srgb.h"
#include "lab/heat_map.h"
#include "math/random.h"

namespace pertev {
namespace {

/// Returns a picture of which color(i) returns the three bytes of pixel i.
template <class Color>
Rgba8Image paint(uint32_t width, uint32_t height, const Color& color) {
    Rgba8Image shown = {width, height, std::vector<uint8_t>(std::size_t(width) * height * 4, 255)};
    for (std::size_t i = 0; i < std::size_t(width) * height; ++i) {
        const FalseColor c = color(i);
        shown.pixels[4 * i] = c.r;
        shown.pixels[4 * i + 1] = c.g;
        shown.pixels[4 * i + 2] = c.b;
    }
    return shown;
}

uint32_t id_of(const PixelIds& ids, IdKind kind) {
    switch (kind) {
    case IdKind::Instance:
        return ids.instance;
    case IdKind::Primitive:
        return ids.primitive;
    case IdKind::Material:
        return ids.material;
    }
    return kNoHit;
}

} // namespace

namespace {

/// Value that one in two hundred exceeds; 0 for an empty list.
float nearly_largest(std::vector<float> values) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() - 1 - values.size() / 200);
    std::ranges::nth_element(values, at);
    return *at;
}

} // namespace

Rgba8Image show_motion(const Image& motion, float& most) {
    std::vector<float> sizes;
    for (const float x : motion.pixels) sizes.push_back(is_finite(x) ? abs(x) : 0);
    most = max(nearly_largest(std::move(sizes)), 1.0f);
    const auto shade = [&](float x) { return to_byte(0.5f + 0.5f * clamp(is_finite(x) ? x / most : 0, -1.0f, 1.0f)); };
    return paint(motion.width, motion.height, [&](std::size_t i) {
        const float right = motion.pixels[2 * i], down = motion.pixels[2 * i + 1];
        return FalseColor{shade(right), shade(down), shade(-0.5f * (right + down))};
    });
}

Rgba8Image show_deviation(const Image& deviation, float& most) {
    std::vector<float> known;
    for (const float d : deviation.pixels) {
        if (d < 1000) known.push_back(d);
    }
    most = max(nearly_largest(std::move(known)), 1e-6f);
    return paint(deviation.width, deviation.height,
                 [&](std::size_t i) { return false_color(deviation.pixels[i] / most); });
}

Rgba8Image show_albedo(const Image& albedo) {
    return paint(albedo.width, albedo.height, [&](std::size_t i) {
        const float* p = &albedo.pixels[3 * i];
        return FalseColor{to_byte(srgb_encode(p[0])), to_byte(srgb_encode(p[1])), to_byte(srgb_encode(p[2]))};
    });
}

Rgba8Image show_normal(const Image& normal) {
    return paint(normal.width, normal.height, [&](std::size_t i) {
        const float* p = &normal.pixels[3 * i];
        if (p[0] == 0 && p[1] == 0 && p[2] == 0) return FalseColor{0, 0, 0};
        return FalseColor{to_byte(0.5f + 0.5f * p[0]), to_byte(0.5f + 0.5f * p[1]), to_byte(0.5f + 0.5f * p[2])};
    });
}

Rgba8Image show_depth(const Image& depth) {
    float nearest = kInfinity, farthest = 0;
    for (const float d : depth.pixels) {
        if (!(d > 0) || !is_finite(d)) continue;
        nearest = min(nearest, d);
        farthest = max(farthest, d);
    }
    const float range = log(max(farthest / nearest, 1.0001f));
    return paint(depth.width, depth.height, [&](std::size_t i) {
        const float d = depth.pixels[i];
        return d > 0 && is_finite(d) ? false_color(1 - 0.92f * log(d / nearest) / range) : FalseColor{0, 0, 0};
    });
}

Rgba8Image show_ids(std::span<const PixelIds> ids, uint32_t width, uint32_t height, IdKind kind) {
    return paint(width, height, [&](std::size_t i) {
        if (ids[i].instance == kNoHit) return FalseColor{0, 0, 0};
        const uint32_t word = hash_words(id_of(ids[i], kind) + 1, 0, 0, 0).x;
        const auto light = [](uint32_t byte) { return static_cast<uint8_t>(56 + (byte & 255) * 3 / 4); };
        return FalseColor{light(word), light(word >> 8), light(word >> 16)};
    });
}

Rgba8Image show_work(std::span<const RayWork> work, uint32_t width, uint32_t height, WorkKind kind, uint32_t& most) {
    std::vector<uint32_t> counts;
    counts.reserve(work.size());
    for (const RayWork& ray : work) counts.push_back(kind == WorkKind::Nodes ? ray.nodes : ray.triangles);
    most = max(scale_end(counts), 1u);
    return paint(width, height,
                 [&](std::size_t i) { return false_color(static_cast<float>(counts[i]) / static_cast<float>(most)); });
}

} // namespace pertev
