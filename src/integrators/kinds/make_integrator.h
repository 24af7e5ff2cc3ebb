#pragma once

// Every integrator there is, and the settings of each: this file and its .cpp alone know them all.

#include <cstdint>
#include <memory>
#include <optional>

#include "integrators/integrator.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/path/path_settings.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "integrators/radiosity/radiosity_look.h"
#include "integrators/raster/raster_settings.h"
#include "integrators/reyes/reyes_settings.h"
#include "math/rgb.h"
#include "render/light_paths/light_path_layers.h"

namespace pertev {

enum class IntegratorKind : uint8_t {
    Path,
    Hybrid,          // path's samples, with what the camera sees found by rasterisation (render/raster/camera_raster.h)
    Cast,            // integrators/cast/cast.h
    Whitted,         // integrators/whitted/whitted.h
    Distributed,     // integrators/distributed/distributed.h
    Raster,          // integrators/raster/raster_integrator.h
    Reyes,           // integrators/reyes/reyes_integrator.h
    Light,           // integrators/light/light.h
    Bidirectional,   // integrators/bidirectional/bidirectional.h
    PhotonMap,       // integrators/photon_map/photon_map_integrator.h
    IrradianceCache, // integrators/irradiance_cache/irradiance_cache_integrator.h
    Radiosity,       // integrators/radiosity/radiosity_integrator.h
};

struct IntegratorSettings {
    IntegratorKind integrator = IntegratorKind::Path;
    PathSettings path; // of which all integrators have max_depth, sampler and seed

    // Of Cast, Whitted, Raster and Reyes: radiance from all around that diffuse surfaces reflect, W/(sr m2). None: all
    // but Cast take the mean of the environment.
    std::optional<Rgb> ambient;
    RasterLook look;                           // of Raster
    float shading_rate = 1;                    // of Reyes: no edge of a micropolygon is longer, pixels
    std::shared_ptr<const HeightMaps> heights; // of Reyes: what displaces surfaces; null: nothing
    PhotonMapSettings photon_map;              // of PhotonMap
    IrradianceCacheSettings irradiance_cache;  // of IrradianceCache
    RadiosityLook radiosity;                   // of Radiosity

    // Of Path and Hybrid: layers of the film beside the picture, each of some light paths alone. Null: none.
    std::shared_ptr<const LightPathLayers> light_paths;
    // Of Path and Hybrid: in place of radiance, W/m2 on the side that the camera sees; 0 where it sees none.
    bool irradiance = false;

    // How the device does it: the light stays the same.
    PathBody body = PathBody::Loop; // CUDA always takes Wavefront
    uint32_t batch = 5u << 19;      // most paths in flight of wavefronts, 228 bytes and more each; or other samples
};

/// Whether its samples can be taken apart for frames that are reconstructed (FilmView::frame), for pictures that are
/// denoised, and for ReSTIR.
bool makes_frames(IntegratorKind kind);
/// Whether what the camera sees is found by rasterisation; why_no_raster (render/raster/pinhole.h) says which cameras
/// it cannot have.
bool rasterises_camera(IntegratorKind kind);
/// Whether that is done by a CameraRaster, whose memory comes on top of predicted_bytes().
bool lists_tiles(IntegratorKind kind);
/// Whether its mean is all light that there is, in the end, so that another one of these has the same, or nearly.
bool finds_all_light(IntegratorKind kind);
/// Whether it tells light paths apart and can show irradiance: IntegratorSettings::light_paths and irradiance.
bool has_light_path_layers(IntegratorKind kind);
/// Whether its rays have a time, so that what moves while a shutter is open is blurred.
bool has_shutter(IntegratorKind kind);
/// The largest PathSettings::max_depth.
uint32_t most_depth(IntegratorKind kind);
/// Whether point, spot and directional lights alone light surfaces.
bool needs_punctual_lights(IntegratorKind kind);

/// Samples of each pixel that together take hardly longer than one.
uint32_t samples_at_once(const IntegratorSettings& settings, uint64_t pixels);

/// Whether both give the same samples.
bool same_light(const IntegratorSettings& a, const IntegratorSettings& b);

/// `queue` outlives it.
std::unique_ptr<Integrator> make_integrator(Queue& queue, const IntegratorSettings& settings);

/// Gives `integrator`, which has the settings `from`, the settings `to`, and lets it keep its memory; begin() must come
/// next. False, and nothing done, where that takes another integrator.
bool change_settings(Integrator& integrator, const IntegratorSettings& from, const IntegratorSettings& to);

/// Bytes of the device's memory that it takes for `samples` of each of `pixels`. `walks_itself`: its tracers are such
/// that a loop may walk them ray by ray (can_walk_on_host). `parts`: what its paths have beside; that they have layers
/// the settings say. Of other integrators has_times counts alone.
std::size_t predicted_bytes(const IntegratorSettings& settings, uint64_t pixels, uint32_t samples, bool on_cuda,
                            bool walks_itself, PathParts parts = {});

} // namespace pertev
