#pragma once

// AbsorbingBlock is a test medium in a block of space. It absorbs each colour separately, and scatters isotropically
// if `kScatters`.
//
// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 14.2.

#include "integrators/path/film_listener.h"
#include "tests/seams/path_rounds.h"

namespace pertev::test {

inline constexpr Vec3 kBlockLow = {-1, 2, -1}, kBlockHigh = {1, 2.5f, 1}; // metres
inline constexpr Rgb kBlockAbsorbs = {0.5f, 1, 2};                        // 1/m
inline constexpr float kBlockScatters = 3;                                // 1/m

/// A scattering point in the medium, with the functions of SurfaceVertex.
struct BlockVertex {
    Vec3 point;

    HD bool scatters_by_delta_alone() const { return false; }
    HD LightContext light_context(float time) const { return {point, time}; }
    HD BsdfValue evaluate(Vec3) const { return {grey(pdf_uniform_sphere()), pdf_uniform_sphere()}; }
    HD bool draws_lobe() const { return false; }
    HD BsdfSample sample(float, Vec2 u) const {
        return make_bsdf_sample(sample_uniform_sphere(u), evaluate({}), LobeClass::Diffuse);
    }
    HD Vec3 origin_towards(Vec3) const { return point; }
    HD Ray ray_to(const LightSample& light, float) const {
        if (!(light.distance < kInfinity)) return {point, 0, light.wi, kInfinity};
        return {point, 0, light.light_point - point, 1};
    }
    HD bool stays(Vec3) const { return true; }
    HD TriangleId triangle() const { return {}; }
};

template <bool kScatters>
struct AbsorbingBlock {
    static constexpr bool kIsVacuum = false;
    HD static bool is_in(const SceneView&) { return true; }
    using Vertex = BlockVertex;

    HD explicit AbsorbingBlock(const SceneView&) {}

    HD bool scatters(const PathJob& job, PathState& path, const Hit& hit, Vertex& vertex) const {
        const float distance = hit.instance == kNoHit ? kInfinity : hit.t;
        const Part part = part_within(path.origin, path.direction, distance);
        if constexpr (kScatters) {
            const SampleKey key = sample_key(job.settings, path.pixel, path.sample);
            const float u = sample_1d(job.settings.sampler, key, vertex_group(path.depth, kGroupChoices), 3);
            const float way = -log(u) / kBlockScatters;
            if (way < part.length) {
                vertex = {path.origin + (part.begin + way) * path.direction};
                path.throughput = path.throughput * absorbed(way);
                return true;
            }
        }
        path.throughput = path.throughput * absorbed(part.length);
        return false;
    }
    HD Rgb transmittance(InteriorList, const Ray& ray) const {
        const float size = length(ray.direction);
        const float way = part_within(ray.origin, ray.direction / size, ray.t_max * size).length;
        return (kScatters ? exp(-kBlockScatters * way) : 1.0f) * absorbed(way);
    }

private:
    struct Part {
        float begin, length; // metres
    };
    /// The part of a ray inside the block. The ray has a unit direction and is at most `distance` metres long.
    HD static Part part_within(Vec3 origin, Vec3 direction, float distance) {
        float begin = 0, end = distance;
        for (int axis = 0; axis < 3; ++axis) {
            const float d = component(direction, axis), o = component(origin, axis);
            const float low = (component(kBlockLow, axis) - o) / d, high = (component(kBlockHigh, axis) - o) / d;
            if (d == 0) {
                if (o < component(kBlockLow, axis) || o > component(kBlockHigh, axis)) return {0, 0};
            } else {
                begin = max(begin, min(low, high));
                end = min(end, max(low, high));
            }
        }
        return {begin, max(end - begin, 0.0f)};
    }
    HD static Rgb absorbed(float way) {
        return {exp(-kBlockAbsorbs.r * way), exp(-kBlockAbsorbs.g * way), exp(-kBlockAbsorbs.b * way)};
    }
};

/// The features of code that supports the block. The product has no such code.
inline constexpr Features kAbsorbing = 1u << 30, kScattering = 1u << 29;

template <Features kBlock>
using BlockRounds = PathRounds<kPlainDiffuse | kBlock, FilmListeners>;

} // namespace pertev::test

namespace pertev {
template <>
struct Medium<kPlainDiffuse | test::kAbsorbing> : test::AbsorbingBlock<false> {
    using AbsorbingBlock::AbsorbingBlock;
};
template <>
struct Medium<kPlainDiffuse | test::kScattering> : test::AbsorbingBlock<true> {
    using AbsorbingBlock::AbsorbingBlock;
};

extern template class test::PathRounds<kPlainDiffuse | test::kAbsorbing, FilmListeners>; // seam_stages.cu
extern template class test::PathRounds<kPlainDiffuse | test::kScattering, FilmListeners>;
} // namespace pertev
