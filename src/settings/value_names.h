#pragma once

// Names of the values of settings, on the command line, in metadata, and wherever else a setting is text.
// base/value_names.h has name_of, value_named and names_of for each. Names of auxiliary layers are in
// render/film_channels.h, those of tone maps in image/tone_map_image.h, those of an integrator's own values beside its
// settings, those of integrators in integrators/kinds/make_integrator.h; of these Path stands for each of kPathLights.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/value_names.h"
#include "denoise/reconstruction_settings.h"
#include "image/tone_map_image.h"
#include "image/write_image.h"
#include "radiosity/radiosity_settings.h"
#include "restir/restir_settings.h"
#include "settings/camera_choice.h"
#include "settings/render_settings.h"

namespace pertev {

inline constexpr ValueName<PathLight> kPathLights[] = {
    {PathLight::Path, "path"}, {PathLight::Direct, "direct"}, {PathLight::Indirect, "indirect"}};
inline constexpr ValueName<SamplerKind> kSamplers[] = {{SamplerKind::Sobol, "sobol"},
                                                       {SamplerKind::Independent, "independent"}};
inline constexpr ValueName<PixelFilter> kPixelFilters[] = {{PixelFilter::Box, "box"},
                                                           {PixelFilter::Tent, "tent"},
                                                           {PixelFilter::Gaussian, "gaussian"},
                                                           {PixelFilter::BlackmanHarris, "blackman-harris"}};
inline constexpr ValueName<MipMaps> kMipMapPictures[] = {
    {MipMaps::Frames, "frames"}, {MipMaps::On, "on"}, {MipMaps::Off, "off"}};
inline constexpr ValueName<LightStrategy> kLightStrategies[] = {
    {LightStrategy::Mis, "mis"}, {LightStrategy::NeeOnly, "nee"}, {LightStrategy::BsdfOnly, "bsdf"}};
inline constexpr ValueName<LightSelection> kLightSelections[] = {
    {LightSelection::Auto, "auto"}, {LightSelection::Tree, "tree"}, {LightSelection::Power, "power"}};
inline constexpr ValueName<RestirLight> kRestirLights[] = {
    {RestirLight::Off, "off"}, {RestirLight::Direct, "di"}, {RestirLight::Indirect, "gi"}};
inline constexpr ValueName<LayersAt> kLayerPlaces[] = {{LayersAt::Samples, "samples"}, {LayersAt::Centre, "centre"}};
inline constexpr ValueName<LutInput> kLutInputs[] = {{LutInput::Display, "display"}, {LutInput::Light, "light"}};
inline constexpr ValueName<ExrColors> kExrColors[] = {{ExrColors::Float, "float"}, {ExrColors::Half, "half"}};
inline constexpr ValueName<Denoise> kDenoisers[] = {
    {Denoise::None, "none"}, {Denoise::Svgf, "svgf"}, {Denoise::Oidn, "oidn"}};
inline constexpr ValueName<FrameDenoiser> kFrameDenoisers[] = {{FrameDenoiser::Svgf, "svgf"},
                                                               {FrameDenoiser::Oidn, "oidn"}};
/// Names of projections. A camera that measures irradiance (Projection::Cosine) cannot be selected.
inline constexpr ValueName<Projection> kProjections[] = {{Projection::Perspective, "perspective"},
                                                         {Projection::Orthographic, "orthographic"}};

inline constexpr ValueName<PoseConvention> kPoseConventions[] = {
    {PoseConvention::OpenGl, "opengl"}, {PoseConvention::OpenCv, "opencv"}, {PoseConvention::Blender, "blender"}};
inline constexpr ValueName<LensModel> kLensModels[] = {{LensModel::OpenCv, "opencv"},
                                                       {LensModel::Fisheye, "fisheye"},
                                                       {LensModel::Equirectangular, "equirectangular"},
                                                       {LensModel::Cube, "cube"}};

constexpr const auto& names_of_all(PathLight) { return kPathLights; }
constexpr const auto& names_of_all(SamplerKind) { return kSamplers; }
constexpr const auto& names_of_all(PixelFilter) { return kPixelFilters; }
constexpr const auto& names_of_all(MipMaps) { return kMipMapPictures; }
constexpr const auto& names_of_all(LightStrategy) { return kLightStrategies; }
constexpr const auto& names_of_all(LightSelection) { return kLightSelections; }
constexpr const auto& names_of_all(RestirLight) { return kRestirLights; }
constexpr const auto& names_of_all(LayersAt) { return kLayerPlaces; }
constexpr const auto& names_of_all(LutInput) { return kLutInputs; }
constexpr const auto& names_of_all(ExrColors) { return kExrColors; }
constexpr const auto& names_of_all(Denoise) { return kDenoisers; }
constexpr const auto& names_of_all(FrameDenoiser) { return kFrameDenoisers; }
constexpr const auto& names_of_all(Projection) { return kProjections; }
constexpr const auto& names_of_all(PoseConvention) { return kPoseConventions; }
constexpr const auto& names_of_all(LensModel) { return kLensModels; }

/// Returns the integrator's name; for the path integrator the name of the part of the light that it renders.
std::string_view integrator_name(const RenderSettings& settings);
/// Sets the integrator by its name. Returns false and does nothing if there is none.
bool set_integrator(RenderSettings& settings, std::string_view name);
/// Returns the names of the integrators whose bits are set.
std::vector<std::string> integrator_names(uint32_t kinds = ~0u);
/// Returns "`integrator=path`, direct, indirect".
std::string list_of(const std::vector<std::string>& integrators);
/// Returns the bits of the integrators for which `has` returns true.
uint32_t integrators_that(bool (*has)(IntegratorKind));

} // namespace pertev
