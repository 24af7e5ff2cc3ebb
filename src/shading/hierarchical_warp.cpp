#include "shading/hierarchical_warp.h"

#include <algorithm>

#include "base/parallel_for.h"

namespace pertev {
namespace {

struct TexelRange {
    int lo = 0, hi = 0; // both inclusive
};

/// Texels that lookups between coordinates lo and hi (|lo|, |hi| <= 64) may read, and one more at each end for
/// rounding of coordinates. It is the whole axis if the range crosses an edge that does not clamp.
TexelRange texels_between(float lo, float hi, Wrap wrap, uint32_t size) {
    const int n = static_cast<int>(size);
    const int first = static_cast<int>(floor(lo * static_cast<float>(size) - 0.5f)) - 1;
    const int last = static_cast<int>(floor(hi * static_cast<float>(size) - 0.5f)) + 2;
    if (wrap == Wrap::ClampToEdge) return {std::clamp(first, 0, n - 1), std::clamp(last, 0, n - 1)};
    const auto tile_of = [&](int texel) { return texel >= 0 ? texel / n : -((-texel - 1) / n) - 1; };
    const int tile = tile_of(first);
    if (tile_of(last) != tile) return {0, n - 1};
    const TexelRange range = {first - tile * n, last - tile * n};
    const bool is_mirrored = wrap == Wrap::MirroredRepeat && (tile & 1) != 0;
    return is_mirrored ? TexelRange{n - 1 - range.hi, n - 1 - range.lo} : range;
}

/// Centroids of 16 equal parts of a triangle, as weights of the second and third vertex.
std::vector<Vec2> centroids_of_parts() {
    std::vector<Vec2> centroids;
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; i + j < 4; ++j) {
            const float x = static_cast<float>(i), y = static_cast<float>(j);
            centroids.push_back({(x + 1.0f / 3.0f) / 4.0f, (y + 1.0f / 3.0f) / 4.0f});
            if (i + j < 3) centroids.push_back({(x + 2.0f / 3.0f) / 4.0f, (y + 2.0f / 3.0f) / 4.0f});
        }
    }
    return centroids;
}

} // namespace

HierarchicalWarp::HierarchicalWarp(const TextureImageView& image, bool is_srgb, const float* linear_from_srgb) {
    levels_.push_back({image.width, image.height, std::vector<float>(std::size_t(image.width) * image.height)});
    parallel_for(image.height, 16, [&](uint64_t y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const Vec4 texel = load_texel(image, x, static_cast<uint32_t>(y), is_srgb, linear_from_srgb);
            const float sum = max(texel.x, 0.0f) + max(texel.y, 0.0f) + max(texel.z, 0.0f);
            levels_[0].cells[y * image.width + x] = clamp(sum / 3.0f, 0.0f, 0x1.fffffep127f);
        }
    });
    while (levels_.back().cells.size() > 1) {
        const Level& fine = levels_.back();
        Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
        coarse.cells.resize(std::size_t(coarse.width) * coarse.height);
        parallel_for(coarse.height, 16, [&](uint64_t y) {
            for (uint32_t x = 0; x < coarse.width; ++x) {
                float sum = 0; // the last row or column of an odd size counts twice
                for (const uint64_t row : {2 * y, std::min<uint64_t>(2 * y + 1, fine.height - 1)}) {
                    const float* cells = fine.cells.data() + row * fine.width;
                    sum += 0.25f * cells[2 * x] + 0.25f * cells[std::min(2 * x + 1, fine.width - 1)];
                }
                coarse.cells[y * coarse.width + x] = sum;
            }
        });
        levels_.push_back(std::move(coarse));
    }
}

double HierarchicalWarp::mean_over_triangle(const TextureRef& ref, Vec2 uv0, Vec2 uv1, Vec2 uv2) const {
    const Vec2 p0 = transform_uv(ref, uv0), p1 = transform_uv(ref, uv1), p2 = transform_uv(ref, uv2);
    const Vec2 lo = {min(p0.x, min(p1.x, p2.x)), min(p0.y, min(p1.y, p2.y))};
    const Vec2 hi = {max(p0.x, max(p1.x, p2.x)), max(p0.y, max(p1.y, p2.y))};
    // Farther out, rounding of coordinates moves lookups by more than a texel.
    const auto is_near = [](Vec2 p) { return abs(p.x) <= 64.0f && abs(p.y) <= 64.0f; };
    if (!is_near(p0) || !is_near(p1) || !is_near(p2)) return static_cast<double>(levels_.back().cells[0]);

    const uint32_t width = levels_[0].width, height = levels_[0].height;
    const TexelRange x = texels_between(lo.x, hi.x, ref.wrap_s, width);
    const TexelRange y = texels_between(lo.y, hi.y, ref.wrap_t, height);
    std::size_t k = 0; // the level at which the range is about 4 cells wide
    while ((std::max(x.hi - x.lo, y.hi - y.lo) >> k) > 4 && k + 1 < levels_.size()) ++k;
    const Level& level = levels_[k];
    const auto cell = [&](std::size_t cx, std::size_t cy) {
        return static_cast<double>(level.cells[cy * level.width + cx]);
    };

    double around = 0;
    std::size_t count = 0;
    for (auto cy = static_cast<std::size_t>(y.lo) >> k; cy <= static_cast<std::size_t>(y.hi) >> k; ++cy) {
        for (auto cx = static_cast<std::size_t>(x.lo) >> k; cx <= static_cast<std::size_t>(x.hi) >> k; ++cx) {
            around += cell(cx, cy);
            ++count;
        }
    }
    if (!(around > 0)) return 0;

    static const std::vector<Vec2> centroids = centroids_of_parts();
    double inside = 0;
    for (const Vec2 b : centroids) {
        const Vec2 p = (1.0f - b.x - b.y) * p0 + b.x * p1 + b.y * p2;
        inside += cell(nearest_texel(p.x, ref.wrap_s, width) >> k, nearest_texel(p.y, ref.wrap_t, height) >> k);
    }
    // It is never far below the surroundings, because the triangle may touch them between the centroids.
    return std::max(inside / static_cast<double>(centroids.size()), around / static_cast<double>(16 * count));
}

} // namespace pertev
