#include "session/opening/picture_settings.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "base/error.h"
#include "image/write_exr.h"
#include "render/light_paths/light_path_layers.h"
#include "render/panorama.h"
#include "render/sample_layers/matte_target.h"
#include "session/check_integrator.h"
#include "session/crop.h"
#include "session/height_maps.h"
#include "session/opening/choose_camera.h"
#include "session/opening/light_groups.h"
#include "session/sample_range.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

/// Returns whether the picture's own channels or another layer have this name in files.
bool is_layer_of_files(const std::string& name) {
    return name == "noisy" || name.starts_with(kObjectMattes) || name.starts_with(kMaterialMattes) ||
           std::ranges::count(sample_layer_names(), name) > 0 ||
           std::ranges::any_of(kAovTable, [&](const AovGroup& group) { return name == group.layer; });
}

/// Returns the layers of light paths without a scene, after the checks that need none.
LightPathLayers light_paths(const PictureOptions& options) {
    LightPathLayers layers;
    for (const std::string& text : options.lpe) layers.expressions.push_back(parse_light_path(text));
    for (const std::string& text : options.light_groups) layers.expressions.push_back(parse_light_group(text));
    check_layers(layers.expressions);
    for (const LightPathExpression& expression : layers.expressions) {
        if (!is_layer_of_files(expression.name)) continue;
        const bool is_group = &expression - layers.expressions.data() >= std::ssize(options.lpe);
        throw Error(ErrorCode::BadInput, is_group ? "light_group" : "lpe", expression.name,
                    "files have another layer of this name");
    }
    return layers;
}

std::vector<HeightMapText> height_maps(const PictureOptions& options) {
    std::vector<HeightMapText> maps;
    for (const std::string& text : options.displacement) maps.push_back(parse_height_map(text));
    return maps;
}

} // namespace

RenderSettings light_settings(const PictureOptions& options) {
    RenderSettings settings = options.render;
    for (const std::string& name : options.aovs) { // names have been checked
        if (const auto layer = sample_layer_named(name)) {
            settings.sample_layers |= *layer;
        } else {
            settings.aovs |= *aov_named(name);
        }
    }
    settings.irradiance = options.false_color == "illuminance";
    if (!options.lpe.empty() || !options.light_groups.empty())
        settings.light_paths = std::make_shared<const LightPathLayers>(light_paths(options));
    settings.light_groups = options.light_groups;
    check_integrator(settings);
    height_maps(options);
    return settings;
}

void set_size(const PictureOptions& options, const Scene& scene, RenderSettings& settings) {
    const CameraChoice& camera = options.scene.camera;
    if (const auto& size = options.size ? options.size : camera.intrinsics_size) {
        settings.width = size->width, settings.height = size->height;
    } else {
        set_default_size(settings, scene_camera(camera.camera, scene));
        if (camera.lens && is_panorama(*camera.lens)) {
            const Vec2 half = panorama_half_size(*camera.lens);
            settings.width = static_cast<uint32_t>(to_int(half.x / half.y + 0.5f, 1, 6)) * settings.height;
        }
    }
    set_crop(options, settings);
}

RenderSettings render_settings(const PictureOptions& options, const Scene& scene) {
    RenderSettings settings = light_settings(options);
    if (settings.light_paths) {
        check_light_groups(options.light_groups, scene);
        settings.light_paths =
            std::make_shared<const LightPathLayers>(bind_to_scene(settings.light_paths->expressions, scene));
    }
    if ((settings.sample_layers & (kLayerObjects | kLayerMaterials)) != 0)
        settings.mattes = std::make_shared<const MatteNames>(scene);
    settings.heights = read_height_maps(height_maps(options), scene);
    set_size(options, scene, settings);
    const SampleRange range = sample_range(options);
    settings.first_sample = range.first, settings.samples = range.end;
    std::tie(settings.first_row, settings.end_row) = row_range(options);
    if (settings.end_row > settings.height) {
        throw Error(ErrorCode::BadInput, "rows", options.rows,
                    fmt::format("the picture has the rows 0 to {}", settings.height - 1));
    }
    const std::size_t of_ids = (settings.aovs & kAovIds) != 0 ? 3 : 0;
    check_exr_row(settings.window().width, film_channel_count(settings.aovs) + of_ids +
                                               3 * light_layers_of(settings).size() +
                                               sample_layer_channels(settings.sample_layers));
    return settings;
}

} // namespace pertev
