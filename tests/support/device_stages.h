#pragma once

// Stages that call the renderer's host-device functions and store the bits of their results. A test compares these on
// the CPU and in CUDA, so that results of CPU tests also hold on the GPU.

#include "base/parallel_for.h"
#include "math/sampler.h"
#include "scene/deform_vertices.h"
#include "shading/bsdf.h"
#include "shading/light_set.h"
#include "tests/support/portable_math_digest.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"

namespace pertev::test {

/// Folds the bits of one more number into a running hash.
HD inline uint32_t fold(uint32_t hash, uint32_t bits) { return hash_word(hash ^ bits) + 0x9e3779b9u; }
HD inline uint32_t fold(uint32_t hash, float x) { return fold(hash, bits_of(x)); }
HD inline uint32_t fold(uint32_t hash, Vec3 v) { return fold(fold(fold(hash, v.x), v.y), v.z); }
HD inline uint32_t fold(uint32_t hash, Rgb c) { return fold(fold(fold(hash, c.r), c.g), c.b); }

HD inline Vec3 random_direction(uint32_t i, uint32_t seed) {
    const Hash3 h = hash_words(i, seed, 17);
    return sample_uniform_sphere({unit_interval(h.x), unit_interval(h.y)});
}

struct DrawSamples {
    SamplerKind kind;
    uint32_t* out;

    HD void operator()(uint32_t i) const {
        const SampleKey key = {i % 4099, i / 4099, i % 7};
        const Vec2 u = sample_2d(kind, key, i % 61);
        const Vec2 v = sample_2d(kind, key, i % 61, Pair::Last);
        out[i] = fold(fold(fold(fold(fold(1, u.x), u.y), v.x), v.y), sample_1d(kind, key, i % 61 + 1, i % 4));
    }
};

/// Samples and evaluates BSDF i % count for random directions.
struct ScatterRandomly {
    const Bsdf* bsdfs;
    uint32_t count;
    uint32_t* out;

    HD void operator()(uint32_t i) const {
        const Bsdf bsdf = bsdfs[i % count];
        const Vec3 wo = random_direction(i, 1), other = random_direction(i, 2);
        const Hash3 h = hash_words(i, 3, 5);
        const BsdfSample sample = bsdf.sample(wo, unit_interval(h.x), {unit_interval(h.y), unit_interval(h.z)});
        const BsdfValue value = bsdf.evaluate(wo, other);
        uint32_t hash = fold(fold(1, sample.wi), sample.weight);
        hash = fold(fold(hash, sample.pdf), (sample.is_delta() ? 1u : 0u) + (sample.is_transmission ? 2u : 0u));
        out[i] = fold(fold(hash, value.f), value.pdf);
    }
};

/// Draws a light from a random point within `extent` metres of the origin.
struct DrawLights {
    LightSetView lights;
    float extent;
    uint32_t* out;

    HD void operator()(uint32_t i) const {
        const Hash4 h = hash_words(i, 11, 13, 17);
        const Vec3 from = extent * random_direction(i, 4);
        LightSample sample;
        if (!sample_light(lights, from, {h.x, h.y}, sample)) {
            out[i] = 0;
            return;
        }
        const uint32_t hash = fold(fold(fold(1, sample.wi), sample.radiance), sample.pdf);
        const Vec3 towards = random_direction(i, 6);
        out[i] = fold(fold(fold(hash, sample.light_point), sample.distance), pdf_environment(lights, from, towards));
    }
};

/// The shears of rays whose directions have components of any sign and size: down to 2^-110 of the largest, 0, equally
/// large and denormal ones. Each index has 256 rays.
struct ShearRays {
    uint32_t* out;

    HD void operator()(uint32_t i) const {
        uint32_t hash = 1;
        for (uint32_t k = 0; k < 256; ++k) {
            const Hash4 h = hash_words(i, k, 23, 29);
            // Makes numbers from 23 random bits. The largest is within [2^-39, 2^40].
            const auto number = [](uint32_t bits, int least, int greatest) {
                const int exponent = least + static_cast<int>((bits >> 24) % static_cast<uint32_t>(greatest - least));
                if (exponent < -126) return float_of((bits & 0x80000000u) | (bits & 0x7fffffu) >> (-126 - exponent));
                return float_of((bits & 0x807fffffu) | static_cast<uint32_t>(exponent + 127) << 23);
            };
            const float largest = number(h.x, -39, 40);
            const int top = static_cast<int>(bits_of(largest) >> 23 & 0xffu) - 127;
            const auto other = [&](uint32_t bits, uint32_t kind) {
                if (kind == 0) return float_of(bits & 0x80000000u);
                const float size = min(abs(number(bits, top - 110, top + 1)), abs(largest));
                return (bits & 0x80000000u) != 0 ? -size : size;
            };
            Vec3 d = {largest, other(h.y, h.w & 7u), other(h.z, h.w >> 3 & 7u)};
            if (k % 3 == 1) d = {d.y, d.x, d.z};
            if (k % 3 == 2) d = {d.z, d.y, d.x};
            const RayShear shear = make_ray_shear(d);
            hash = fold(fold(fold(hash, shear.sx), shear.sy), shear.sz);
        }
        out[i] = hash;
    }
};

/// Deforms a vertex.
struct DeformAndFold {
    DeformVertices deform;
    uint32_t* out;

    HD void operator()(uint32_t i) const {
        deform(i);
        const Vec4 t = deform.tangents[i];
        const uint32_t hash = fold(fold(fold(1, deform.positions[i]), deform.normals[i]), Vec3{t.x, t.y, t.z});
        out[i] = fold(hash, t.w);
    }
};

/// Folds `per_index` inputs of one portable function from first + i * per_index on.
struct EvaluateMath {
    int function;
    uint32_t first, per_index;
    uint32_t* out;

    HD void operator()(uint32_t i) const {
        uint32_t hash = 1;
        for (uint32_t k = 0; k < per_index; ++k) {
            hash = fold(hash, portable_math_value(function, first + i * per_index + k));
        }
        out[i] = hash;
    }
};

/// Stores the number of CPU threads that run the stage; 0 on a GPU.
struct CountThreads {
    int* count;

    HD void operator()(uint32_t) const {
#if PERTEV_ON_DEVICE
        *count = 0;
#else
        *count = thread_count();
#endif
    }
};

} // namespace pertev::test
