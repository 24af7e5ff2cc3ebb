#include "radiosity/corner_table.h"

#include <algorithm>
#include <bit>
#include <tuple>

#include "base/parallel_for.h"
#include "math/double_vec3.h"
#include "math/random.h"

namespace pertev {
namespace {

constexpr uint32_t kDirections = 17;      // along an edge of a cube; normals of one of its cells are one sheet
constexpr uint64_t kCornersOfBucket = 64; // about

std::tuple<float, float, float> key_of(Vec3 position) { return {position.x, position.y, position.z}; }

uint32_t direction_of(Vec3 normal) {
    const Vec3 size = abs(normal);
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    const float largest = component(size, axis);
    const auto cell = [&](int other) {
        const float at = 0.5f + 0.5f * component(normal, other) / largest;
        return at > 0 ? min(static_cast<uint32_t>(at * kDirections), kDirections - 1) : 0u;
    };
    const uint32_t u = cell((axis + 1) % 3), v = cell((axis + 2) % 3);
    const uint32_t face = 2 * static_cast<uint32_t>(axis) + (component(normal, axis) < 0 ? 1u : 0u);
    return (face * kDirections + v) * kDirections + u;
}

/// Position between the corners of a triangle. On an edge its bits are the same for all triangles of the edge: the
/// third term is 0, a product depends only on the vertex and its weight, and the sum of two does not depend on their
/// order.
Vec3 position_between(const Vec3 (&corner)[3], double u, double v) {
    const double w = 1 - u - v;
    const auto between = [&](float a, float b, float c) {
        const double sum = (w * static_cast<double>(a) + u * static_cast<double>(b)) + v * static_cast<double>(c);
        return static_cast<float>(sum) + 0.0f; // never -0
    };
    return {between(corner[0].x, corner[1].x, corner[2].x), between(corner[0].y, corner[1].y, corner[2].y),
            between(corner[0].z, corner[1].z, corner[2].z)};
}

} // namespace

CornerTable::CornerTable(const SceneView& scene, const PatchTree& tree, std::span<const Rgb> irradiance)
    : tree_(tree), vertices_(scene), normals_(tree.patches.size()), sheet_of_(3 * tree.patches.size()) {
    parallel_for(normals_.size(), 256, [&](uint64_t i) {
        const Patch& patch = tree.patches[i];
        normals_[i] = pertev::normal_of(scene, patch, world_triangle(scene, patch, patch.corners.middle()));
    });
    const uint64_t count = std::bit_ceil(sheet_of_.size() / kCornersOfBucket + 1);
    first_corner_.assign(count + 1, 0);
    first_sheet_.assign(count + 1, 0);
    std::vector<Corner> corners = corners_by_bucket();
    std::vector<std::vector<CornerSheet>> made(count);
    parallel_for(count, 4, [&](uint64_t bucket) {
        const std::span<Corner> here = {corners.data() + first_corner_[bucket],
                                        first_corner_[bucket + 1] - first_corner_[bucket]};
        std::ranges::sort(here, [](const Corner& a, const Corner& b) {
            return std::tuple(key_of(a.position), a.direction, a.id) <
                   std::tuple(key_of(b.position), b.direction, b.id);
        });
        made[bucket] = sheets_of(here, irradiance);
    });
    for (std::size_t i = 0; i < count; ++i) {
        first_sheet_[i + 1] = first_sheet_[i] + static_cast<uint32_t>(made[i].size());
    }
    sheets_.resize(first_sheet_[count]);
    parallel_for(count, 4, [&](uint64_t bucket) {
        std::ranges::copy(made[bucket], sheets_.begin() + first_sheet_[bucket]);
        made[bucket] = {};
        for (uint32_t i = first_corner_[bucket]; i < first_corner_[bucket + 1]; ++i) {
            sheet_of_[corners[i].id] += first_sheet_[bucket];
        }
    });
}

std::vector<CornerTable::Corner> CornerTable::corners_by_bucket() {
    std::vector<Corner> corners(sheet_of_.size()), sorted(sheet_of_.size());
    std::vector<uint32_t>& bucket = sheet_of_; // until the sheets are known
    parallel_for(normals_.size(), 256, [&](uint64_t i) {
        for (uint32_t k = 0; k < 3; ++k) {
            const Vec2 at = tree_.patches[i].corners.at[k];
            const auto id = static_cast<uint32_t>(3 * i + k);
            const Vec3 position =
                position_of(static_cast<uint32_t>(i), static_cast<double>(at.x), static_cast<double>(at.y));
            corners[id] = {position, direction_of(normals_[i]), id};
            bucket[id] = static_cast<uint32_t>(bucket_of(position));
        }
    });
    for (const uint32_t i : bucket) ++first_corner_[i + 1];
    for (std::size_t i = 1; i < first_corner_.size(); ++i) first_corner_[i] += first_corner_[i - 1];
    std::vector<uint32_t> next(first_corner_.begin(), first_corner_.end() - 1);
    for (std::size_t id = 0; id < corners.size(); ++id) sorted[next[bucket[id]]++] = corners[id];
    return sorted;
}

/// Sheets of a bucket's corners, in order; sheet_of_ gets indices within the bucket.
std::vector<CornerSheet> CornerTable::sheets_of(std::span<const Corner> corners, std::span<const Rgb> irradiance) {
    std::vector<CornerSheet> sheets;
    const Corner* before = nullptr;
    for (const Corner& corner : corners) {
        const uint32_t patch = corner.id / 3;
        if (before == nullptr || before->position != corner.position || before->direction != corner.direction) {
            sheets.push_back({.position = corner.position});
        }
        before = &corner;
        CornerSheet& sheet = sheets.back();
        const auto area = static_cast<double>(tree_.patches[patch].area);
        const Rgb light = irradiance[patch];
        sheet.normal += normals_[patch];
        sheet.areas += area;
        sheet.light[0] += area * static_cast<double>(light.r);
        sheet.light[1] += area * static_cast<double>(light.g);
        sheet.light[2] += area * static_cast<double>(light.b);
        sheet_of_[corner.id] = static_cast<uint32_t>(sheets.size() - 1);
    }
    for (CornerSheet& sheet : sheets) sheet.normal = normalize(sheet.normal);
    return sheets;
}

std::size_t CornerTable::bucket_of(Vec3 position) const {
    const uint32_t x = std::bit_cast<uint32_t>(position.x), y = std::bit_cast<uint32_t>(position.y),
                   z = std::bit_cast<uint32_t>(position.z);
    return hash_word(hash_words(x, y, z).x) & (buckets() - 1);
}

std::span<CornerSheet> CornerTable::at(Vec3 position) {
    const std::size_t bucket = bucket_of(position);
    const std::span<CornerSheet> here = {sheets_.data() + first_sheet_[bucket],
                                         first_sheet_[bucket + 1] - first_sheet_[bucket]};
    const auto range =
        std::ranges::equal_range(here, key_of(position), {}, [](const CornerSheet& s) { return key_of(s.position); });
    return {range.begin(), range.end()};
}

std::size_t CornerTable::max_bytes(uint64_t patches) {
    return patches * (3 * (2 * sizeof(Corner) + sizeof(uint32_t) + 2 * sizeof(CornerSheet)) + sizeof(Vec3)) +
           patches * sizeof(uint32_t);
}

Vec3 CornerTable::position_of(uint32_t patch, double u, double v) const {
    Vec3 corner[3];
    vertices_.corners(tree_.patches[patch].instance, tree_.patches[patch].primitive, corner);
    return position_between(corner, u, v);
}

void CornerTable::for_each_position(const std::function<void(std::span<CornerSheet>)>& body) {
    parallel_for(buckets(), 16, [&](uint64_t bucket) {
        for (uint32_t first = first_sheet_[bucket]; first < first_sheet_[bucket + 1];) {
            uint32_t end = first + 1;
            while (end < first_sheet_[bucket + 1] && sheets_[end].position == sheets_[first].position) ++end;
            body({sheets_.data() + first, end - first});
            first = end;
        }
    });
}

} // namespace pertev
