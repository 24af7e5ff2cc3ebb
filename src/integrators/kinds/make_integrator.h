#pragma once

// Every integrator there is, and the settings of each: this file and its .cpp alone know them all.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "base/limits.h"
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
inline constexpr IntegratorKind kLastIntegrator = IntegratorKind::Radiosity;

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

/// Describes a kind of integrator to code that does not know it. The table of all rows is in make_integrator.cpp. A new
/// integrator is a folder, a kind above, and a row.
struct IntegratorDescriptor {
    IntegratorKind value;
    std::string_view name; // as text (base/value_names.h)
    /// Whether its samples can be taken apart for frames that are reconstructed (FilmView::frame), for pictures that
    /// are denoised, and for ReSTIR.
    bool makes_frames = false;
    /// Whether it tells light paths apart and can show irradiance: IntegratorSettings::light_paths and irradiance.
    bool has_light_path_layers = false;
    /// Whether its mean is all light that there is, in the end, so that another one of these has the same, or nearly.
    bool finds_all_light = false;
    /// Whether what the camera sees is found by rasterisation; why_no_raster (render/raster/pinhole.h) says which
    /// cameras it cannot have.
    bool rasterises_camera = false;
    /// Whether its rays have a time, so that what moves while a shutter is open is blurred.
    bool has_shutter = false;
    /// Whether point, spot and directional lights alone light surfaces.
    bool needs_punctual_lights = false;
    /// The largest PathSettings::max_depth.
    uint32_t most_depth = kMaxPathDepth - 1;
    /// Returns how many samples of each pixel together take hardly longer than one.
    uint32_t (*samples_at_once)(uint64_t pixels) = [](uint64_t) { return 1u; };
    std::unique_ptr<Integrator> (*make)(Queue&, const IntegratorSettings&) = nullptr;
    void (*change)(Integrator&, const IntegratorSettings&) = nullptr; // gives new settings to what `make` has made
};

/// Returns the table, in the order of the kinds.
std::span<const IntegratorDescriptor> integrators();
const IntegratorDescriptor& describe(IntegratorKind kind);
/// Makes the names known to base/value_names.h.
inline std::span<const IntegratorDescriptor> names_of_all(IntegratorKind) { return integrators(); }

inline bool makes_frames(IntegratorKind kind) { return describe(kind).makes_frames; }
inline bool has_light_path_layers(IntegratorKind kind) { return describe(kind).has_light_path_layers; }
inline bool finds_all_light(IntegratorKind kind) { return describe(kind).finds_all_light; }
inline bool rasterises_camera(IntegratorKind kind) { return describe(kind).rasterises_camera; }
inline bool has_shutter(IntegratorKind kind) { return describe(kind).has_shutter; }
inline bool needs_punctual_lights(IntegratorKind kind) { return describe(kind).needs_punctual_lights; }
inline uint32_t most_depth(IntegratorKind kind) { return describe(kind).most_depth; }
inline uint32_t samples_at_once(const IntegratorSettings& settings, uint64_t pixels) {
    return describe(settings.integrator).samples_at_once(pixels);
}

/// Whether both give the same samples.
bool same_light(const IntegratorSettings& a, const IntegratorSettings& b);

/// `queue` outlives it.
std::unique_ptr<Integrator> make_integrator(Queue& queue, const IntegratorSettings& settings);

/// Gives `integrator`, which has the settings `from`, the settings `to`, and lets it keep its memory; begin() must come
/// next. False, and nothing done, where that takes another integrator.
bool change_settings(Integrator& integrator, const IntegratorSettings& from, const IntegratorSettings& to);

/// Predicts by a dry run how many bytes of the device's memory the integrator takes for work of this size. On the CPU
/// that includes what it takes besides of the host's memory.
std::size_t predicted_bytes(const IntegratorSettings& settings, const WorkSize& size, bool on_cuda);

} // namespace pertev
