#pragma once

// Settings of a path-traced render besides scene and camera.

#include <cstdint>

#include "math/sampler.h"
#include "shading/light_selection.h"

namespace pertev {

/// The light paths that count. With D for a scattering that is not mirror-like: Path means all, Direct those with at
/// most one D (the thesis's local illumination), Indirect the rest (its figure 3.6); Path = Direct + Indirect.
enum class PathLight : uint8_t { Path, Direct, Indirect };

/// Strategy to sample lights: next-event estimation (NEE) and BSDF sampling combined by the power heuristic, or one
/// alone. All three converge to one picture where lights can be hit. NEE alone, for equal samples noisier near lights
/// and on glossy surfaces, needs no last ray (PathJob::ends_by_nee): with a depth of 1 a sample of a diffuse surface is
/// a camera ray and a shadow ray.
enum class LightStrategy : uint8_t { Mis, NeeOnly, BsdfOnly };

/// Survival probability of Russian roulette as a function of the throughput's largest channel: that itself, or its
/// fourth root, which ends fewer paths and leaves less variation in their throughputs. The default is the best by
/// time to equal error (docs/performance.md). The power of 5/16, computed from square roots and nearly the cube root,
/// is in between.
enum class Roulette : uint8_t { Throughput, NearCubeRoot, FourthRoot };

/// Schedule of the path tracer. Loop is for the CPU and for tracers whose trees it can traverse directly
/// (SceneTracer::host_trees); otherwise Wavefront is used.
enum class PathBody : uint8_t { Loop, Wavefront };

/// The pictures that use coarser levels of textures, by the width of what a ray stands for: real-time frames
/// (settings_of_frames), all or none.
enum class MipMaps : uint8_t { Frames, On, Off };

/// Optional parts of a path in flight in the queues of a wavefront, which take memory there.
struct PathParts {
    bool has_times = false;      // something moves while the shutter is open
    bool has_layers = false;     // the film has layers of light paths
    bool splits_light = false;   // a frame of samples separates kinds of light (FilmView::frame)
    bool records_bounce = false; // a frame stores its first bounce
    bool has_interiors = false;  // solids lie in each other
    bool has_thin_walls = false; // WorkSize::has_thin_walls
    bool has_normals = false;    // lights are selected by a tree
};

struct PathSettings {
    uint32_t max_depth = 16; // scattering vertices: 0 emission only, 1 direct light
    Roulette roulette = Roulette::FourthRoot;
    uint32_t roulette_depth = 3; // first vertex (counted from 1) at which Russian roulette may end the path
    PathLight light = PathLight::Path;
    LightStrategy strategy = LightStrategy::Mis;
    float clamp = 0; // limit of the largest channel of a contribution that was scattered at least twice, W/(sr m2);
                     // 0: off
    SamplerKind sampler = SamplerKind::Sobol;
    uint32_t seed = 0;
    MipMaps mip_maps = MipMaps::Frames;
    LightSelection light_choice = LightSelection::Power;

    bool operator==(const PathSettings&) const = default;
};

/// Returns whether Russian roulette is applied at vertex `vertex` of a path, counted from 1.
HD inline bool may_end_by_chance(const PathSettings& settings, uint32_t vertex) {
    return vertex >= settings.roulette_depth;
}

/// Key of the random numbers of a path.
HD inline SampleKey sample_key(const PathSettings& settings, uint32_t pixel, uint32_t sample) {
    return {pixel, sample, settings.seed};
}

} // namespace pertev
