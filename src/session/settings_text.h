#pragma once

// The names of settings' values, as they stand on the command line, in metadata, and wherever else a setting is text.
// Those of auxiliary layers are in render/film_channels.h.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "denoise/reconstruction_settings.h"
#include "radiosity/radiosity_settings.h"
#include "restir/restir_settings.h"
#include "session/render_settings.h"

namespace pertev {

/// The integrator, "path" by name of the part of the light that it shows: "path", "direct" or "indirect"; "hybrid",
/// "cast", "whitted", "distributed", "raster", "reyes", "light", "bidirectional", "photon_map",
/// "irradiance_cache", "radiosity".
std::string_view integrator_name(const RenderSettings& settings);
/// False, and nothing done, where there is no such integrator.
bool set_integrator(RenderSettings& settings, std::string_view name);
std::vector<std::string> integrator_names();

/// Of `integrator=raster`: "flat", "gouraud" or "phong".
std::string_view name_of(RasterShading shading);
std::optional<RasterShading> shading_named(std::string_view name);
std::vector<std::string> shading_names();

/// Of `integrator=photon_map`: "direct" or "final"; "grid", "kd-tree" or "octree".
std::string_view name_of(PhotonGather gather);
std::optional<PhotonGather> gather_named(std::string_view name);
std::vector<std::string> gather_names();
std::string_view name_of(PhotonSearch search);
std::optional<PhotonSearch> photon_search_named(std::string_view name);
std::vector<std::string> photon_search_names();

/// Of radiosity, whose values have their names in radiosity/radiosity_settings.h.
std::optional<FormFactors> form_factors_named(std::string_view name);
std::vector<std::string> form_factor_names();
std::optional<RadiositySolver> solver_named(std::string_view name);
std::vector<std::string> solver_names();

std::string_view name_of(SamplerKind sampler);
std::optional<SamplerKind> sampler_named(std::string_view name);
std::vector<std::string> sampler_names();

std::string_view name_of(PixelFilter filter);
std::optional<PixelFilter> filter_named(std::string_view name);
std::vector<std::string> filter_names();

/// "off", "di" or "gi": of ReSTIR.
std::string_view name_of(RestirLight light);
std::optional<RestirLight> restir_named(std::string_view name);
std::vector<std::string> restir_names();
std::string_view name_of(Denoise denoise);
std::optional<Denoise> denoise_named(std::string_view name);
std::vector<std::string> denoise_names();

/// All that makes the bytes of a frame in real time, beside the picture's own settings, as a JSON object.
std::string json_of(const ReconstructionSettings& settings, const RestirSettings& restir);

/// Of image/tone_map_image.h, which has name_of and tone_map_named.
std::vector<std::string> tone_map_names();

} // namespace pertev
