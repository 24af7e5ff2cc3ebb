#include "settings/render_settings.h"

#include <algorithm>

#include "base/error.h"
#include "render/light_paths/light_path_layers.h"

namespace pertev {

TracerChoice tracers_of(const RenderSettings& settings, bool on_cuda, bool deforms) {
    if (settings.tracers) return *settings.tracers;
    const TracerChoice choice = default_tracers(on_cuda);
    return on_cuda && deforms ? same_for_all(choice.bounce) : choice;
}

PrepareOptions prepare_options(const RenderSettings& settings, bool on_cuda) {
    PrepareOptions options;
    options.tracers = tracers_of(settings, on_cuda);
    return options;
}

void set_default_size(RenderSettings& settings, const Camera* own) {
    settings.width = 1280, settings.height = 720;
    if (own == nullptr || !(own->aspect > 0)) return;
    settings.width = static_cast<uint32_t>(to_int(720 * own->aspect + 0.5f, 1, 8192));
}

std::vector<std::string> light_layers_of(const RenderSettings& settings) {
    std::vector<std::string> names;
    if (!settings.light_paths) return names;
    for (const LightPathExpression& expression : settings.light_paths->expressions) names.push_back(expression.name);
    return names;
}

RenderSettings settings_of_frames(RenderSettings settings) {
    settings.path.roulette_depth = std::min(settings.path.roulette_depth, 2u);
    if (settings.path.roulette == Roulette::FourthRoot) settings.path.roulette = Roulette::NearCubeRoot;
    if (settings.path.mip_maps == MipMaps::Frames) settings.path.mip_maps = MipMaps::On;
    if (settings.frame_depth) settings.path.max_depth = std::min(settings.path.max_depth, *settings.frame_depth);
    return settings;
}

const Image& layer_named(const RenderResult& result, std::string_view name) {
    const auto layer = std::ranges::find(result.layers, name, &FilmLayer::name);
    PERTEV_CHECK(layer != result.layers.end());
    return layer->image;
}

bool same_picture(const RenderSettings& a, const RenderSettings& b) {
    return a.width == b.width && a.height == b.height && a.crop == b.crop && a.filter == b.filter &&
           filter_radius_of(a) == filter_radius_of(b) && a.aovs == b.aovs && a.layers_at == b.layers_at &&
           a.sample_layers == b.sample_layers && a.transparent == b.transparent && a.denoise == b.denoise &&
           a.first_sample == b.first_sample && a.first_row == b.first_row && a.end_row == b.end_row &&
           a.history == b.history && same_light(a, b);
}

} // namespace pertev
