#include "integrators/kinds/make_integrator.h"

#include "base/limits.h"
#include "integrators/bidirectional/most_joined_depth.h"
#include "integrators/irradiance_cache/irradiance_cache_integrator.h"
#include "integrators/path/path_integrator.h"
#include "integrators/photon_map/photon_map_integrator.h"
#include "integrators/radiosity/radiosity_integrator.h"
#include "integrators/raster/raster_integrator.h"
#include "integrators/ray_tree/ray_tree_integrator.h"
#include "integrators/reyes/reyes_integrator.h"
#include "integrators/subpaths/walks_integrator.h"

namespace pertev {
namespace {

RayTreeSettings tree_settings(const IntegratorSettings& settings) {
    return {.max_depth = settings.path.max_depth,
            .sampler = settings.path.sampler,
            .seed = settings.path.seed,
            .has_ambient = settings.ambient.has_value(),
            .ambient = settings.ambient.value_or(Rgb{0, 0, 0}),
            .radiosity = {}}; // which its integrator adds
}

SubpathSettings walk_settings(const IntegratorSettings& settings) {
    return {.max_depth = settings.path.max_depth,
            .roulette_depth = settings.path.roulette_depth,
            .sampler = settings.path.sampler,
            .seed = settings.path.seed};
}

template <class Algorithm>
std::unique_ptr<Integrator> make_walks(Queue& queue, const IntegratorSettings& settings) {
    return std::make_unique<WalksIntegrator<Algorithm>>(queue, walk_settings(settings), settings.body == PathBody::Loop,
                                                        settings.batch);
}

template <class Algorithm>
void set_walk_settings(Integrator& integrator, const IntegratorSettings& settings) {
    static_cast<WalksIntegrator<Algorithm>&>(integrator).set_settings(walk_settings(settings));
}

RasterSettings raster_settings(const IntegratorSettings& settings) {
    return {.look = settings.look,
            .max_depth = settings.path.max_depth,
            .seed = settings.path.seed,
            .has_ambient = settings.ambient.has_value(),
            .ambient = settings.ambient.value_or(Rgb{0, 0, 0})};
}

bool same_heights(const IntegratorSettings& a, const IntegratorSettings& b) {
    return a.heights == b.heights || (a.heights && b.heights && *a.heights == *b.heights);
}

ReyesSettings reyes_settings(const IntegratorSettings& settings) {
    return {.shading_rate = settings.shading_rate,
            .heights = settings.heights,
            .max_depth = settings.path.max_depth,
            .sampler = settings.path.sampler,
            .seed = settings.path.seed,
            .has_ambient = settings.ambient.has_value(),
            .ambient = settings.ambient.value_or(Rgb{0, 0, 0})};
}

template <class Algorithm>
std::unique_ptr<Integrator> make_ray_tree(Queue& queue, const IntegratorSettings& settings) {
    return std::make_unique<RayTreeIntegrator<Algorithm>>(queue, tree_settings(settings),
                                                          settings.body == PathBody::Loop, settings.batch);
}

template <class Algorithm>
void set_tree_settings(Integrator& integrator, const IntegratorSettings& settings) {
    static_cast<RayTreeIntegrator<Algorithm>&>(integrator).set_settings(tree_settings(settings));
}

} // namespace

bool makes_frames(IntegratorKind kind) { return kind == IntegratorKind::Path || kind == IntegratorKind::Hybrid; }

bool rasterises_camera(IntegratorKind kind) {
    return kind == IntegratorKind::Hybrid || kind == IntegratorKind::Raster || kind == IntegratorKind::Reyes;
}

bool lists_tiles(IntegratorKind kind) { return kind == IntegratorKind::Hybrid; }

bool finds_all_light(IntegratorKind kind) {
    return makes_frames(kind) || kind == IntegratorKind::Bidirectional || kind == IntegratorKind::PhotonMap ||
           kind == IntegratorKind::IrradianceCache;
}

bool has_light_path_layers(IntegratorKind kind) { return makes_frames(kind); }

bool has_shutter(IntegratorKind kind) {
    return kind == IntegratorKind::Path || kind == IntegratorKind::Cast || kind == IntegratorKind::Whitted ||
           kind == IntegratorKind::Distributed;
}

uint32_t most_depth(IntegratorKind kind) {
    switch (kind) {
    case IntegratorKind::Path:
    case IntegratorKind::Hybrid:
    case IntegratorKind::Raster:
    case IntegratorKind::Reyes:
    case IntegratorKind::Light:
    case IntegratorKind::IrradianceCache:
        break;
    case IntegratorKind::Cast:
    case IntegratorKind::Whitted:
    case IntegratorKind::Distributed:
    case IntegratorKind::Radiosity:
        return kMaxTreeDepth;
    case IntegratorKind::Bidirectional:
        return kMostJoinedDepth;
    case IntegratorKind::PhotonMap:
        return kMostPhotonDepth;
    }
    return kMaxPathDepth - 1;
}

bool needs_punctual_lights(IntegratorKind kind) {
    return kind == IntegratorKind::Cast || kind == IntegratorKind::Whitted || kind == IntegratorKind::Raster ||
           kind == IntegratorKind::Reyes;
}

uint32_t samples_at_once(const IntegratorSettings& settings, uint64_t pixels) {
    return settings.integrator == IntegratorKind::Reyes ? ReyesIntegrator::samples_at_once(pixels) : 1;
}

bool same_light(const IntegratorSettings& a, const IntegratorSettings& b) {
    return a.integrator == b.integrator && a.path == b.path && a.ambient == b.ambient && a.look == b.look &&
           a.shading_rate == b.shading_rate && same_heights(a, b) && a.photon_map == b.photon_map &&
           a.irradiance_cache == b.irradiance_cache && a.radiosity == b.radiosity && a.light_paths == b.light_paths &&
           a.irradiance == b.irradiance;
}

std::unique_ptr<Integrator> make_integrator(Queue& queue, const IntegratorSettings& settings) {
    switch (settings.integrator) {
    case IntegratorKind::Path:
    case IntegratorKind::Hybrid:
        break;
    case IntegratorKind::Cast:
        return make_ray_tree<Cast>(queue, settings);
    case IntegratorKind::Whitted:
        return make_ray_tree<Whitted>(queue, settings);
    case IntegratorKind::Distributed:
        return make_ray_tree<Distributed>(queue, settings);
    case IntegratorKind::Raster:
        return std::make_unique<RasterIntegrator>(queue, raster_settings(settings));
    case IntegratorKind::Reyes:
        return std::make_unique<ReyesIntegrator>(queue, reyes_settings(settings));
    case IntegratorKind::Light:
        return make_walks<ParticlesAlone>(queue, settings);
    case IntegratorKind::Bidirectional:
        return make_walks<BothDirections>(queue, settings);
    case IntegratorKind::PhotonMap:
        return std::make_unique<PhotonMapIntegrator>(queue, walk_settings(settings), settings.photon_map,
                                                     settings.body == PathBody::Loop, settings.batch);
    case IntegratorKind::IrradianceCache:
        return std::make_unique<IrradianceCacheIntegrator>(queue, walk_settings(settings), settings.irradiance_cache,
                                                           settings.body == PathBody::Loop, settings.batch);
    case IntegratorKind::Radiosity:
        return std::make_unique<RadiosityIntegrator>(queue, tree_settings(settings), settings.radiosity,
                                                     settings.body == PathBody::Loop, settings.batch);
    }
    auto path = std::make_unique<PathIntegrator>(queue, settings.path, settings.body, settings.batch,
                                                 lists_tiles(settings.integrator));
    path->set_layers(settings.light_paths);
    path->set_meter(settings.irradiance);
    return path;
}

bool change_settings(Integrator& integrator, const IntegratorSettings& from, const IntegratorSettings& to) {
    if (from.integrator != to.integrator || from.body != to.body || from.batch != to.batch) return false;
    switch (to.integrator) {
    case IntegratorKind::Path:
    case IntegratorKind::Hybrid:
        static_cast<PathIntegrator&>(integrator).set_settings(to.path);
        static_cast<PathIntegrator&>(integrator).set_layers(to.light_paths);
        static_cast<PathIntegrator&>(integrator).set_meter(to.irradiance);
        break;
    case IntegratorKind::Cast:
        set_tree_settings<Cast>(integrator, to);
        break;
    case IntegratorKind::Whitted:
        set_tree_settings<Whitted>(integrator, to);
        break;
    case IntegratorKind::Distributed:
        set_tree_settings<Distributed>(integrator, to);
        break;
    case IntegratorKind::Raster:
        static_cast<RasterIntegrator&>(integrator).set_settings(raster_settings(to));
        break;
    case IntegratorKind::Reyes:
        static_cast<ReyesIntegrator&>(integrator).set_settings(reyes_settings(to));
        break;
    case IntegratorKind::Light:
        set_walk_settings<ParticlesAlone>(integrator, to);
        break;
    case IntegratorKind::Bidirectional:
        set_walk_settings<BothDirections>(integrator, to);
        break;
    case IntegratorKind::PhotonMap:
        static_cast<PhotonMapIntegrator&>(integrator).set_settings(walk_settings(to), to.photon_map);
        break;
    case IntegratorKind::IrradianceCache:
        static_cast<IrradianceCacheIntegrator&>(integrator).set_settings(walk_settings(to), to.irradiance_cache);
        break;
    case IntegratorKind::Radiosity:
        static_cast<RadiosityIntegrator&>(integrator).set_settings(tree_settings(to), to.radiosity);
        break;
    }
    return true;
}

std::size_t predicted_bytes(const IntegratorSettings& settings, uint64_t pixels, uint32_t samples, bool on_cuda,
                            bool walks_itself, PathParts parts) {
    if (settings.integrator == IntegratorKind::Raster) return RasterIntegrator::predicted_bytes(pixels);
    if (settings.integrator == IntegratorKind::Reyes) {
        return ReyesIntegrator::predicted_bytes(reyes_settings(settings), pixels, samples);
    }
    const std::size_t tables = settings.light_paths ? LightPathsOnDevice::predicted_bytes(*settings.light_paths) : 0;
    const bool in_loop = walks_itself && settings.body == PathBody::Loop;
    if (settings.integrator == IntegratorKind::PhotonMap) {
        return PhotonMapIntegrator::predicted_bytes(walk_settings(settings), settings.photon_map, pixels,
                                                    settings.batch, in_loop, on_cuda);
    }
    if (settings.integrator == IntegratorKind::IrradianceCache) {
        return IrradianceCacheIntegrator::predicted_bytes(settings.irradiance_cache, pixels, settings.batch, in_loop,
                                                          on_cuda);
    }
    const uint64_t all = pixels * samples;
    if (settings.integrator == IntegratorKind::Radiosity) {
        return RadiosityIntegrator::predicted_bytes(tree_settings(settings), settings.radiosity, all, settings.batch,
                                                    in_loop);
    }
    if (in_loop) return tables;
    switch (settings.integrator) {
    case IntegratorKind::Path:
    case IntegratorKind::Hybrid:
    case IntegratorKind::Raster:
    case IntegratorKind::Reyes:
    case IntegratorKind::PhotonMap:
    case IntegratorKind::IrradianceCache:
    case IntegratorKind::Radiosity:
        break;
    case IntegratorKind::Cast:
        return RayTreeIntegrator<Cast>::predicted_bytes(tree_settings(settings), all, settings.batch, parts.has_times);
    case IntegratorKind::Whitted:
        return RayTreeIntegrator<Whitted>::predicted_bytes(tree_settings(settings), all, settings.batch,
                                                           parts.has_times);
    case IntegratorKind::Distributed:
        return RayTreeIntegrator<Distributed>::predicted_bytes(tree_settings(settings), all, settings.batch,
                                                               parts.has_times);
    case IntegratorKind::Light:
        return WalksIntegrator<ParticlesAlone>::predicted_bytes(walk_settings(settings), all, settings.batch);
    case IntegratorKind::Bidirectional:
        return WalksIntegrator<BothDirections>::predicted_bytes(walk_settings(settings), all, settings.batch);
    }
    parts.has_layers = settings.light_paths != nullptr;
    return tables + PathIntegrator::wavefront_bytes(all, settings.batch, on_cuda, settings.path.max_depth, parts);
}

} // namespace pertev
