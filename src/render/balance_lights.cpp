#include "render/balance_lights.h"

#include <algorithm>
#include <cmath>

#include "base/parallel_for.h"
#include "trace/trace_any.h"

namespace pertev {
namespace {

constexpr uint32_t kPoints = 2048, kDrawsPerPoint = 32, kCandidates = 16;

struct SurfacePoint {
    Vec3 position, normal; // metres, translated world; unit normal, zero for a triangle without area
};

/// Triangles of all instances that are not hidden, with consecutive numbers.
class PlacedTriangles {
public:
    PlacedTriangles(const Scene& scene, Vec3 centre) : scene_(scene), centre_(centre) {
        for (const Instance& instance : scene.instances) {
            const uint64_t own = instance.is_hidden ? 0 : scene.meshes[instance.mesh].triangle_count();
            ends_.push_back(count() + own);
        }
    }
    uint64_t count() const { return ends_.empty() ? 0 : ends_.back(); }

    struct Corners {
        Vec3 a, b, c;
    };
    Corners corners(uint64_t number) const {
        const auto i = static_cast<std::size_t>(std::ranges::upper_bound(ends_, number) - ends_.begin());
        const Instance& instance = scene_.instances[i];
        const Mesh& mesh = scene_.meshes[instance.mesh];
        const uint32_t* index = mesh.indices.data() + 3 * (number - (i == 0 ? 0 : ends_[i - 1]));
        const Transform world_from_local = moved_to(instance.world_from_local, centre_);
        const auto world = [&](uint32_t v) { return transform_point(world_from_local, mesh.positions[v]); };
        return {world(index[0]), world(index[1]), world(index[2])};
    }

private:
    const Scene& scene_;
    Vec3 centre_;
    std::vector<uint64_t> ends_;
};

/// Draws a surface point. Every second one lies on a uniformly drawn triangle, which favours detail; the others on
/// one drawn by area among several.
SurfacePoint draw_point(const PlacedTriangles& triangles, uint32_t i) {
    const uint32_t candidates = i % 2 == 0 ? 1 : kCandidates;
    SurfacePoint point;
    float sum = 0;
    for (uint32_t k = 0; k < candidates; ++k) {
        const Hash4 h = hash_words(i, k, 0x6c696768u, 0x7473u);
        const uint64_t number = (uint64_t(h.x) << 32 | h.y) % triangles.count();
        const auto [a, b, c] = triangles.corners(number);
        const Vec3 across = cross(b - a, c - a);
        const float area = length(across);
        if (!(area > 0) || !is_finite(area)) continue;
        sum += area;
        if (!(unit_interval(h.z) * sum <= area)) continue; // keeps the k-th with probability area / sum
        const Vec2 u = sample_uniform_triangle(Vec2{unit_interval(h.w), unit_interval(hash_word(h.w))});
        point = {a + (u.x * (b - a) + u.y * (c - a)), across / area};
    }
    return point;
}

/// Mean and mean square of the light at a point per sample, if only one kind of light were sampled.
struct KindMoments {
    double near_mean = 0, far_mean = 0, near_square = 0, far_square = 0;
};

KindMoments moments_at(const SurfacePoint& point, uint32_t i, float offset, const LightSetView& lights,
                       const SceneBvhView& bvh) {
    KindMoments moments;
    const auto accept_all = [](uint32_t, uint32_t, float, float) { return true; };
    for (uint32_t k = 0; k < kDrawsPerPoint; ++k) {
        const Hash3 h = hash_words(i, k, 0x73686172u);
        const Vec3 normal = k % 2 == 0 ? point.normal : -point.normal;
        const Vec3 origin = point.position + offset * normal;
        LightSample sample;
        if (!sample_light(lights, origin, {h.x, h.y}, sample)) continue;
        const float cosine = dot(sample.wi, normal);
        if (!(cosine > 0)) continue;
        const bool is_far = !(sample.distance < kInfinity);
        const float reach = is_far ? kInfinity : sample.distance - offset;
        if (trace_any(bvh, Ray{origin, 0.0f, sample.wi, reach}, accept_all)) continue;
        // Removes the probability of the kind, which leaves the estimate of that kind alone.
        constexpr double share = kEvenShare;
        const double value = static_cast<double>(cosine * luminance(sample.radiance) / sample.pdf) * share;
        (is_far ? moments.far_mean : moments.near_mean) += value / (share * kDrawsPerPoint);
        (is_far ? moments.far_square : moments.near_square) += value * value / (share * kDrawsPerPoint);
    }
    return moments;
}

SceneBvhView view_on_host(const PreparedScene& prepared, std::vector<BvhView>& meshes) {
    const auto& parts = prepared.trees.parts;
    for (std::size_t part = 1; part < parts.size(); ++part) meshes.push_back(view_of(*parts[part]));
    const Tlas& top = prepared.tlas;
    return {view_of(*parts.front()),
            top.nodes.data(),
            top.instances.data(),
            meshes.data(),
            top.root,
            top.reach,
            top.growth};
}

} // namespace

void balance_lights(PreparedScene& prepared, const float* linear_from_srgb) {
    LightSetData& data = prepared.lights;
    const PlacedTriangles triangles(*prepared.scene, prepared.centre);
    if (!data.has_both_kinds() || triangles.count() == 0) return;
    const std::vector<TextureImageView> images = views_of_images(*prepared.scene);
    std::vector<BvhView> meshes;
    const SceneBvhView bvh = view_on_host(prepared, meshes);
    const LightSetView lights = view_of(data, images.data(), linear_from_srgb);
    const float offset = 0x1p-16f * max_component(bounds_of(*prepared.scene).size());

    std::vector<KindMoments> moments(kPoints);
    parallel_for(kPoints, 16, [&](uint64_t i) {
        const auto number = static_cast<uint32_t>(i);
        const SurfacePoint point = draw_point(triangles, number);
        if (dot(point.normal, point.normal) > 0) {
            moments[i] = moments_at(point, number, offset, lights, bvh);
        }
    });
    // Relative variance for a share q of far samples: sum over points of (near / (1 - q) + far / q) / mean^2.
    double average = 0, near_sum = 0, far_sum = 0;
    for (const KindMoments& m : moments) average += (m.near_mean + m.far_mean) / kPoints;
    for (const KindMoments& m : moments) {
        const double mean = m.near_mean + m.far_mean;
        const double weight = 1 / (mean * mean + 0.01 * average * average);
        if (!(average > 0)) continue;
        near_sum += weight * m.near_square;
        far_sum += weight * m.far_square;
    }
    const double near = std::sqrt(near_sum), far = std::sqrt(far_sum);
    const double share = near + far > 0 ? far / (near + far) : kEvenShare;
    share_draws(data, std::clamp(share, kMinShare, 1 - kMinShare));
}

} // namespace pertev
