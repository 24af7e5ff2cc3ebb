#pragma once

// All integrators and their settings; only this file and its .cpp know them all.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/limits.h"
#include "base/shared_value.h"
#include "integrators/integrator.h"
#include "integrators/path/path_settings.h"
#include "math/rgb.h"

namespace pertev {

// Settings of one integrator stand in its own folder, and only code that reads them includes them.
struct HeightMap;               // integrators/reyes/reyes_settings.h
struct IrradianceCacheSettings; // integrators/irradiance_cache/irradiance_cache_settings.h
struct LightPathLayers;         // render/light_paths/light_path_layers.h
struct PhotonMapSettings;       // integrators/photon_map/photon_map_settings.h
struct RadiosityDisplay;        // integrators/radiosity/radiosity_display_settings.h
struct RasterDisplay;           // integrators/raster/raster_settings.h

enum class IntegratorKind : uint8_t {
    Path,
    Hybrid,          // path's samples, with primary visibility by rasterization (render/raster/camera_raster.h)
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
    PathSettings path; // max_depth, sampler and seed apply to all integrators

    // For Cast, Whitted, Raster and Reyes: radiance from all directions that diffuse surfaces reflect, W/(sr m2).
    // Without a value, all but Cast use the mean of the environment.
    std::optional<Rgb> ambient;
    SharedValue<RasterDisplay> display;                    // for Raster
    float shading_rate = 1;                                // for Reyes: maximum length of a micropolygon's edge, pixels
    std::shared_ptr<const std::vector<HeightMap>> heights; // for Reyes: displacement; null: none
    SharedValue<PhotonMapSettings> photon_map;             // for PhotonMap
    SharedValue<IrradianceCacheSettings> irradiance_cache; // for IrradianceCache
    SharedValue<RadiosityDisplay> radiosity;               // for Radiosity

    // For Path and Hybrid: additional film layers, each of selected light paths. Null: none.
    std::shared_ptr<const LightPathLayers> light_paths;
    // For Path and Hybrid: renders irradiance, W/m2, on the visible side in place of radiance; 0 if no surface is
    // visible.
    bool irradiance = false;

    // How the device renders; this does not change the light.
    PathBody body = PathBody::Loop; // CUDA always uses Wavefront
    uint32_t batch = 5u << 19;      // maximum number of paths in flight of wavefronts, at least 228 bytes each; or of
                                    // other samples
};

/// Names, for messages, what takes most of an integrator's memory and what makes that less.
struct MemoryUse {
    std::string what, less;
};

/// Describes a kind of integrator to code that does not know it. The table of all rows is in make_integrator.cpp. A new
/// integrator is a folder, a kind above, and a row.
struct IntegratorDescriptor {
    IntegratorKind value;
    std::string_view name; // name as text (base/value_names.h)
    /// The light that the integrator finds, as light-path expressions (docs/transport.md): "all" if it finds all
    /// without bias. `light_if_not_diffuse` is for scenes that are not all diffuse, `light_with_caustics` for scenes in
    /// which point lights shine on mirrors or clear glass; empty if they do not differ.
    std::string_view light, light_if_not_diffuse = "", light_with_caustics = "";
    /// Light or sharpness that pictures lack in the scenes of `light_with_caustics`; empty if they are no references at
    /// all.
    std::string_view lacks = "";
    /// Names of the settings that only this integrator has, and others that name them too, between spaces.
    std::string_view settings = "";
    /// True if its samples can be separated for frames that are reconstructed (FilmView::frame), for denoised pictures
    /// and for ReSTIR.
    bool makes_frames = false;
    /// True if it supports light-path layers and irradiance: IntegratorSettings::light_paths and irradiance.
    bool has_light_path_layers = false;
    /// True if its mean converges to all light, so that such integrators agree, at least approximately.
    bool finds_all_light = false;
    /// True if it rasterizes primary visibility, which excludes the cameras of why_no_raster (render/raster/pinhole.h).
    bool rasterises_camera = false;
    /// True if its rays have a time, so that motion while a shutter is open is blurred.
    bool has_shutter = false;
    /// True if it renders a batch of pictures (PictureView::batch) as one.
    bool renders_batches = false;
    /// True if only point, spot and directional lights illuminate surfaces.
    bool needs_punctual_lights = false;
    /// True if it replaces an ambient light that was not given by the environment's mean.
    bool has_mean_ambient = false;
    /// True if it renders nothing in a scene without any light.
    bool needs_any_light = false;
    /// True if it refracts at each solid as in a vacuum, although solids lie in each other (SceneView::nesting), unless
    /// the scene has media that it knows.
    bool ignores_nesting = false;
    /// True if media absorb and scatter its light (SceneView::has_media).
    bool has_media = false;
    /// True if its next-event estimation selects one light of many (PathSettings::light_choice).
    bool selects_lights = false;
    /// True if the scene's light is solved before the first sample (radiosity/).
    bool is_solved = false;
    /// True if it makes irradiance records before the first sample, which parts of a picture may share
    /// (IrradianceCacheSettings::shared).
    bool makes_records = false;
    /// The largest PathSettings::max_depth.
    uint32_t max_depth = kMaxPathDepth - 1;
    /// Returns how many samples per pixel together take hardly longer than one.
    uint32_t (*samples_at_once)(uint64_t pixels) = [](uint64_t) { return 1u; };
    /// Throws Error(OverLimit) if the settings do not fit together.
    void (*check)(const IntegratorSettings&) = [](const IntegratorSettings&) {};
    /// Returns what takes most memory, for messages; null if the integrator's own memory never matters.
    MemoryUse (*memory)(const IntegratorSettings&, const WorkSize&) = nullptr;
    std::unique_ptr<Integrator> (*make)(Queue&, const IntegratorSettings&) = nullptr;
    void (*change)(Integrator&, const IntegratorSettings&) = nullptr; // applies new settings to the integrator of
                                                                      // `make`
};

/// Returns the table, in the order of the kinds.
std::span<const IntegratorDescriptor> integrators();
const IntegratorDescriptor& describe(IntegratorKind kind);
/// Registers the names with base/value_names.h.
inline std::span<const IntegratorDescriptor> names_of_all(IntegratorKind) { return integrators(); }

inline bool makes_frames(IntegratorKind kind) { return describe(kind).makes_frames; }
inline bool has_light_path_layers(IntegratorKind kind) { return describe(kind).has_light_path_layers; }
inline bool finds_all_light(IntegratorKind kind) { return describe(kind).finds_all_light; }
inline bool rasterises_camera(IntegratorKind kind) { return describe(kind).rasterises_camera; }
inline bool has_shutter(IntegratorKind kind) { return describe(kind).has_shutter; }
inline bool needs_punctual_lights(IntegratorKind kind) { return describe(kind).needs_punctual_lights; }
inline bool has_media(IntegratorKind kind) { return describe(kind).has_media; }
inline bool selects_lights(IntegratorKind kind) { return describe(kind).selects_lights; }
inline bool is_solved(IntegratorKind kind) { return describe(kind).is_solved; }
inline bool makes_records(IntegratorKind kind) { return describe(kind).makes_records; }
inline uint32_t max_depth(IntegratorKind kind) { return describe(kind).max_depth; }
inline uint32_t samples_at_once(const IntegratorSettings& settings, uint64_t pixels) {
    return describe(settings.integrator).samples_at_once(pixels);
}

/// Returns whether the integrator selects lights by a tree, which holds `lights`.
inline bool uses_light_tree(const IntegratorSettings& settings, uint32_t lights, bool has_times) {
    return selects_lights(settings.integrator) && uses_light_tree(settings.path.light_choice, lights, has_times);
}

/// Returns whether the integrator has code that selects lights by a tree in scenes with media, for frames or for
/// pictures with the layers of the settings.
bool has_tree_in_media(const IntegratorSettings& settings, bool of_frames);

/// Returns whether the settings `a` and `b` give the same samples.
bool same_light(const IntegratorSettings& a, const IntegratorSettings& b);

/// Makes the integrator of the settings; `queue` outlives it.
std::unique_ptr<Integrator> make_integrator(Queue& queue, const IntegratorSettings& settings);

/// Changes the settings of `integrator` from `from` to `to` and keeps its memory; begin() must follow. Returns false
/// and does nothing if that needs another integrator.
bool change_settings(Integrator& integrator, const IntegratorSettings& from, const IntegratorSettings& to);

/// Predicts by a dry run the device memory, in bytes, that the integrator needs for work of this size. On the CPU
/// that includes its additional host memory.
std::size_t predicted_bytes(const IntegratorSettings& settings, const WorkSize& size, bool on_cuda);

} // namespace pertev
