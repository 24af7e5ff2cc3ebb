#pragma once

// What a path-traced render is asked for, beside scene and camera.

#include <cstdint>

#include "math/sampler.h"

namespace pertev {

/// Which light paths count. With D = scatterings that are not mirror-like: Path all, Direct those with at most one D
/// (the thesis's local illumination), Indirect the rest (its figure 3.6); Path = Direct + Indirect.
enum class PathLight : uint8_t { Path, Direct, Indirect };

/// How a light is found: next-event estimation and BSDF sampling, weighted by the power heuristic, or one alone. All
/// three converge to one picture (where lights can be hit at all); the single ones are for tests.
enum class LightStrategy : uint8_t { Mis, NeeOnly, BsdfOnly };

/// Probability with which a path goes on, by its throughput's largest channel: that itself, or its fourth root, which
/// ends fewer paths and leaves those that go on with throughputs that differ less. The better default by time to equal
/// error (docs/performance.md). Its power of 5/16, made of square roots and nearly its cube root, is in between.
enum class Roulette : uint8_t { Throughput, NearCubeRoot, FourthRoot };

/// Loop is for the CPU, and for tracers that it can walk by itself (SceneTracer::host_trees); else it is Wavefront.
enum class PathBody : uint8_t { Loop, Wavefront };

/// What a path in flight has in the queues of a wavefront beside what all have. It takes memory there.
struct PathParts {
    bool has_times = false;    // something moves while the shutter is open
    bool has_layers = false;   // light goes to layers of the film too
    bool splits_light = false; // a frame of samples tells kinds of light apart (FilmView::frame)
    bool tells_bounce = false; // a frame tells its first bounce
};

struct PathSettings {
    uint32_t max_depth = 16; // scattering vertices: 0 emission only, 1 direct light
    Roulette roulette = Roulette::FourthRoot;
    uint32_t roulette_depth = 3; // first vertex (counted from 1) at which Russian roulette may end the path
    PathLight light = PathLight::Path;
    LightStrategy strategy = LightStrategy::Mis;
    float clamp = 0; // largest channel of one contribution, W/(sr m2), of light scattered twice or more; 0 = off
    SamplerKind sampler = SamplerKind::Sobol;
    uint32_t seed = 0;

    bool operator==(const PathSettings&) const = default;
};

/// Whether Russian roulette is played at vertex `vertex` of a path, counted from 1.
HD inline bool may_end_by_chance(const PathSettings& settings, uint32_t vertex) {
    return vertex >= settings.roulette_depth;
}

/// What the random numbers of a path are drawn by.
HD inline SampleKey sample_key(const PathSettings& settings, uint32_t pixel, uint32_t sample) {
    return {pixel, sample, settings.seed};
}

} // namespace pertev
