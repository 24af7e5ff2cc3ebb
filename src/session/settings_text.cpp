#include "session/settings_text.h"

#include <fmt/format.h>

#include "base/json_text.h"
#include "image/tone_map_image.h"

namespace pertev {
namespace {

// A switch names each value, so that the compiler tells of one that was forgotten; these list them.
constexpr PathLight kLights[] = {PathLight::Path, PathLight::Direct, PathLight::Indirect};
constexpr IntegratorKind kIntegrators[] = {
    IntegratorKind::Hybrid,   IntegratorKind::Cast, // beside Path
    IntegratorKind::Whitted,  IntegratorKind::Distributed,   IntegratorKind::Raster,    IntegratorKind::Reyes,
    IntegratorKind::Light,    IntegratorKind::Bidirectional, IntegratorKind::PhotonMap, IntegratorKind::IrradianceCache,
    IntegratorKind::Radiosity};
constexpr PhotonGather kGathers[] = {PhotonGather::Direct, PhotonGather::Final};
constexpr PhotonSearch kSearches[] = {PhotonSearch::Grid, PhotonSearch::KdTree, PhotonSearch::Octree};
constexpr FormFactors kFormFactors[] = {FormFactors::Rays, FormFactors::Hemicube};
constexpr RadiositySolver kSolvers[] = {RadiositySolver::Southwell, RadiositySolver::GaussSeidel,
                                        RadiositySolver::Matrix, RadiositySolver::Hierarchical};
constexpr RasterShading kShadings[] = {RasterShading::Flat, RasterShading::Gouraud, RasterShading::Phong};
constexpr SamplerKind kSamplers[] = {SamplerKind::Sobol, SamplerKind::Independent};
constexpr PixelFilter kFilters[] = {PixelFilter::Box, PixelFilter::Tent, PixelFilter::Gaussian,
                                    PixelFilter::BlackmanHarris};
constexpr RestirLight kRestirLights[] = {RestirLight::Off, RestirLight::Direct, RestirLight::Indirect};
constexpr Denoise kDenoisers[] = {Denoise::None, Denoise::Svgf};
constexpr ToneMap kToneMaps[] = {ToneMap::Srgb, ToneMap::Agx, ToneMap::Aces, ToneMap::Neutral};

std::string_view name_of(PathLight light) {
    switch (light) {
    case PathLight::Path:
        return "path";
    case PathLight::Direct:
        return "direct";
    case PathLight::Indirect:
        return "indirect";
    }
    return "";
}

std::string_view name_of(IntegratorKind integrator) {
    switch (integrator) {
    case IntegratorKind::Path:
        return "path";
    case IntegratorKind::Hybrid:
        return "hybrid";
    case IntegratorKind::Cast:
        return "cast";
    case IntegratorKind::Whitted:
        return "whitted";
    case IntegratorKind::Distributed:
        return "distributed";
    case IntegratorKind::Raster:
        return "raster";
    case IntegratorKind::Reyes:
        return "reyes";
    case IntegratorKind::Light:
        return "light";
    case IntegratorKind::Bidirectional:
        return "bidirectional";
    case IntegratorKind::PhotonMap:
        return "photon_map";
    case IntegratorKind::IrradianceCache:
        return "irradiance_cache";
    case IntegratorKind::Radiosity:
        return "radiosity";
    }
    return "";
}

template <class T, std::size_t kCount>
std::optional<T> value_named(const T (&values)[kCount], std::string_view name) {
    for (const T value : values) {
        if (name_of(value) == name) return value;
    }
    return std::nullopt;
}

template <class T, std::size_t kCount>
std::vector<std::string> names_of(const T (&values)[kCount]) {
    std::vector<std::string> names;
    for (const T value : values) names.emplace_back(name_of(value));
    return names;
}

} // namespace

std::string_view integrator_name(const RenderSettings& settings) {
    switch (settings.integrator) {
    case IntegratorKind::Path:
        return name_of(settings.path.light);
    case IntegratorKind::Hybrid:
    case IntegratorKind::Cast:
    case IntegratorKind::Whitted:
    case IntegratorKind::Distributed:
    case IntegratorKind::Raster:
    case IntegratorKind::Reyes:
    case IntegratorKind::Light:
    case IntegratorKind::Bidirectional:
    case IntegratorKind::PhotonMap:
    case IntegratorKind::IrradianceCache:
    case IntegratorKind::Radiosity:
        break;
    }
    return name_of(settings.integrator);
}

bool set_integrator(RenderSettings& settings, std::string_view name) {
    if (const std::optional<PathLight> light = value_named(kLights, name)) {
        settings.integrator = IntegratorKind::Path;
        settings.path.light = *light;
        return true;
    }
    const std::optional<IntegratorKind> kind = value_named(kIntegrators, name);
    if (!kind) return false;
    settings.integrator = *kind;
    settings.path.light = PathLight::Path;
    return true;
}

std::vector<std::string> integrator_names() {
    std::vector<std::string> names = names_of(kLights);
    for (std::string& name : names_of(kIntegrators)) names.push_back(std::move(name));
    return names;
}

std::string_view name_of(RasterShading shading) {
    switch (shading) {
    case RasterShading::Flat:
        return "flat";
    case RasterShading::Gouraud:
        return "gouraud";
    case RasterShading::Phong:
        return "phong";
    }
    return "";
}

std::optional<RasterShading> shading_named(std::string_view name) { return value_named(kShadings, name); }
std::vector<std::string> shading_names() { return names_of(kShadings); }

std::string_view name_of(PhotonGather gather) {
    switch (gather) {
    case PhotonGather::Direct:
        return "direct";
    case PhotonGather::Final:
        return "final";
    }
    return "";
}
std::optional<PhotonGather> gather_named(std::string_view name) { return value_named(kGathers, name); }
std::vector<std::string> gather_names() { return names_of(kGathers); }

std::string_view name_of(PhotonSearch search) {
    switch (search) {
    case PhotonSearch::Grid:
        return "grid";
    case PhotonSearch::KdTree:
        return "kd-tree";
    case PhotonSearch::Octree:
        return "octree";
    }
    return "";
}
std::optional<PhotonSearch> photon_search_named(std::string_view name) { return value_named(kSearches, name); }
std::vector<std::string> photon_search_names() { return names_of(kSearches); }

std::optional<FormFactors> form_factors_named(std::string_view name) { return value_named(kFormFactors, name); }
std::vector<std::string> form_factor_names() { return names_of(kFormFactors); }
std::optional<RadiositySolver> solver_named(std::string_view name) { return value_named(kSolvers, name); }
std::vector<std::string> solver_names() { return names_of(kSolvers); }

std::string_view name_of(SamplerKind sampler) {
    switch (sampler) {
    case SamplerKind::Sobol:
        return "sobol";
    case SamplerKind::SpaceTime: // of frames alone
        return "space-time";
    case SamplerKind::Independent:
        return "independent";
    }
    return "";
}

std::optional<SamplerKind> sampler_named(std::string_view name) { return value_named(kSamplers, name); }
std::vector<std::string> sampler_names() { return names_of(kSamplers); }

std::string_view name_of(PixelFilter filter) {
    switch (filter) {
    case PixelFilter::Box:
        return "box";
    case PixelFilter::Tent:
        return "tent";
    case PixelFilter::Gaussian:
        return "gaussian";
    case PixelFilter::BlackmanHarris:
        return "blackman-harris";
    }
    return "";
}

std::optional<PixelFilter> filter_named(std::string_view name) { return value_named(kFilters, name); }
std::vector<std::string> filter_names() { return names_of(kFilters); }

std::string_view name_of(RestirLight light) {
    switch (light) {
    case RestirLight::Off:
        return "off";
    case RestirLight::Direct:
        return "di";
    case RestirLight::Indirect:
        return "gi";
    }
    return "";
}
std::optional<RestirLight> restir_named(std::string_view name) { return value_named(kRestirLights, name); }
std::vector<std::string> restir_names() { return names_of(kRestirLights); }

std::string_view name_of(Denoise denoise) {
    switch (denoise) {
    case Denoise::None:
        return "none";
    case Denoise::Svgf:
        return "svgf";
    }
    return "";
}

std::optional<Denoise> denoise_named(std::string_view name) { return value_named(kDenoisers, name); }
std::vector<std::string> denoise_names() { return names_of(kDenoisers); }

std::string json_of(const ReconstructionSettings& settings, const RestirSettings& restir) {
    return fmt::format(
        R"({{"history":{},"passes":{},"limit_fireflies":{},"limit_history":{},"follow_light":{},"anti_alias":{},"resolution_scale":{},"sample_order":{},"restir":{},"restir_history":{}}})",
        settings.history, settings.passes, settings.limit_fireflies, settings.limit_history, settings.follow_light,
        settings.anti_alias, json_number(static_cast<double>(settings.resolution_scale)), settings.orders_samples,
        json_string(name_of(restir.light)), restir.history);
}

std::vector<std::string> tone_map_names() { return names_of(kToneMaps); }

} // namespace pertev
