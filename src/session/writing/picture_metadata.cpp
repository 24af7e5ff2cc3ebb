#include "session/writing/picture_metadata.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json_text.h"
#include "base/version.h"
#include "formats/files/file_choices.h"
#include "image/tone_map_image.h"
#include "integrators/radiosity/radiosity_display_settings.h"
#include "integrators/reyes/reyes_settings.h"
#include "render/light_paths/light_path_layers.h"
#include "session/degrees.h"
#include "session/position_text.h"
#include "session/survey/ground.h"
#include "settings/settings_file.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

using MetadataValue = ExrMetadata::value_type::second_type;

std::string comma_separated(DoubleVec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

void append(ExrMetadata& metadata, const ExrMetadata& more) {
    metadata.insert(metadata.end(), more.begin(), more.end());
}

std::string names_as_json(const std::set<uint32_t>& ids, const std::vector<std::string>& names) {
    std::string text;
    for (const uint32_t id : ids) {
        if (id >= names.size()) continue; // nothing was hit
        text += fmt::format("{}\"{}\":{}", text.empty() ? "{" : ",", id, json_string(names[id]));
    }
    return text.empty() ? "{}" : text + "}";
}

/// A whole number is stored as text if it need not fit an int32_t, and a list as lines.
MetadataValue metadata_value(const PictureOptions& options, const Setting& setting) {
    const std::string text = fmt::format("{}", fmt::join(texts_of(options, setting), "\n"));
    const bool is_text = setting.high > double(INT32_MAX);
    return read_field(options, setting, [&]<class Field>(Field field) -> MetadataValue {
        if constexpr (std::is_same_v<Field, bool*>)
            return static_cast<int32_t>(*field);
        else if constexpr (std::is_same_v<Field, float*>)
            return *field;
        else if constexpr (std::is_same_v<Field, std::optional<float>*> ||
                           std::is_same_v<Field, std::optional<double>*>)
            return field->value();
        else if constexpr (std::is_same_v<Field, uint32_t*>)
            return is_text ? MetadataValue(text) : static_cast<int32_t>(*field);
        else
            return text;
    });
}

/// Returns the settings of cameras, or all others.
std::vector<Setting> rows_of(bool camera) {
    std::vector<Setting> rows = all_settings();
    std::erase_if(rows, [&](const Setting& row) { return (row.group == SettingGroup::Camera) != camera; });
    return rows;
}

/// Returns the options that would give this picture, without its camera: those that were given, and what was chosen in
/// place of others.
PictureOptions used_options(const PictureRecord& record) {
    const RenderSettings& settings = record.settings;
    PictureOptions used;
    used.render = settings;
    used.render.filter_radius = filter_radius_of(settings);
    used.scene = record.scene;
    if (used.scene.environment.empty() && used.scene.sun_sky.empty())
        used.scene.environment = record.scene.has_environment ? "made up" : "none";
    used.time_s = record.scene.time_s;
    if (const auto& shutter = record.scene.shutter) {
        used.shutter = fmt::format("{},{}", shutter->open_s, shutter->close_s);
    }
    if (const auto& crop = settings.crop)
        used.crop = {double(crop->x), double(crop->y), double(crop->width), double(crop->height)};
    if (settings.light_paths) {
        const std::span all(settings.light_paths->expressions);
        for (const LightPathExpression& layer : all.first(all.size() - settings.light_groups.size()))
            used.lpe.push_back(fmt::format("{}={}", layer.name, layer.text));
        used.light_groups = settings.light_groups;
    }
    if (settings.heights) {
        std::set<std::string> heights; // several materials if a name matches more than one
        for (const HeightMap& map : *settings.heights) heights.insert(map.text);
        used.displacement.assign(heights.begin(), heights.end());
    }
    used.radiosity.flat_patches = settings.radiosity->is_flat;
    if (!record.display) return used;
    if (record.display->false_colors) {
        used.false_color = record.display->false_colors->quantity;
    } else {
        used.tone_map = record.display->tone_map;
    }
    used.lut = record.display->lut_file, used.lut_input = record.display->lut_input;
    return used;
}

} // namespace

ExrMetadata recorded_settings(const PictureOptions& options, std::span<const Setting> settings) {
    ExrMetadata metadata;
    const PictureOptions defaults;
    for (const Setting& setting : settings) {
        const std::vector<std::string> texts = texts_of(options, setting);
        const Recorded recorded = setting.recorded;
        const bool is_of_some = recorded == Recorded::WhereUsed || recorded == Recorded::AsUsed;
        if (recorded == Recorded::No || texts.empty()) continue;
        if (is_of_some && !has_setting(options.render.integrator, setting)) continue;
        if (recorded == Recorded::AsUsed && texts.front().empty()) continue;
        if (recorded == Recorded::Changed && texts == texts_of(defaults, setting)) continue;
        metadata.emplace_back(fmt::format("pertev.{}", setting.name), metadata_value(options, setting));
    }
    return metadata;
}

void name_ids(const Scene& scene, SceneSource& source) {
    source.instances.clear(), source.materials.clear();
    for (const Instance& instance : scene.instances) source.instances.push_back(instance.name);
    for (const Material& material : scene.materials) source.materials.push_back(material.name);
}

ExrMetadata id_metadata(const SceneSource& source, std::span<const PixelIds> ids) {
    if (ids.empty() || source.instances.empty()) return {};
    std::set<uint32_t> instances, materials;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (i > 0 && ids[i].instance == ids[i - 1].instance && ids[i].material == ids[i - 1].material) continue;
        instances.insert(ids[i].instance);
        materials.insert(ids[i].material);
    }
    return {{"pertev.instances", names_as_json(instances, source.instances)},
            {"pertev.materials", names_as_json(materials, source.materials)}};
}

SceneSource source_of(const SceneOptions& options, const Scene& scene) {
    SceneSource source;
    static_cast<SceneOptions&>(source) = options;
    source.environment = environment_text(options);
    source.ground = has_ground(scene) ? "on" : "";
    source.animation = clip_choice(scene.clips);
    source.file_scene = file_scene_choice(scene);
    source.variant = material_variant_choice(scene);
    source.has_environment = scene.environment.has_value();
    if (scene.is_far) source.position_origin = scene.origin_in_file;
    return source;
}

CameraSource source_of(const CameraChoice& choice, const Camera& camera, DoubleVec3 origin) {
    return {.camera = camera,
            .name = choice.camera,
            .target = choice.eye_offset == 0 ? choice.target : std::nullopt, // an eye looks beside the target
            .up = choice.up,
            .fov_deg = choice.fov_deg.value_or(0),
            .origin = origin};
}

CameraChoice choice_of(const CameraSource& source) {
    const Camera& camera = source.camera;
    const Transform& from = camera.world_from_camera;
    const Vec3 eye = from.translation;
    const Vec3 target =
        source.target ? to_float(*source.target - source.origin) : eye - camera.focus_distance * column(from, 2);
    CameraChoice choice;
    choice.camera = source.name;
    choice.eye = stated_position(eye, source.origin);
    choice.target = source.target.value_or(stated_position(target, source.origin));
    choice.up = source.up.value_or(column(from, 1));
    for (const Vec3 default_up : {Vec3{0, 0, -1}, Vec3{0, 1, 0}}) {
        if (!source.up && look_at(eye, target, default_up) == from) choice.up = default_up;
    }
    state_lens(camera, choice);
    if (choice.fov_deg && source.fov_deg > 0) choice.fov_deg = source.fov_deg;
    return choice;
}

ExrMetadata camera_metadata(const CameraSource& source) {
    PictureOptions options;
    options.scene.camera = choice_of(source);
    ExrMetadata metadata = recorded_settings(options, rows_of(true));
    const Transform& from = source.camera.world_from_camera;
    if (options.scene.camera.fov_deg) metadata.emplace_back("pertev.fov_y", source.camera.fov_y);
    const auto text = [](Vec3 axis) { return fmt::format("{},{},{}", axis.x, axis.y, axis.z); };
    metadata.emplace_back("pertev.world_from_camera",
                          fmt::format("{} {} {} {}", text(column(from, 0)), text(column(from, 1)),
                                      text(column(from, 2)), comma_separated(*options.scene.camera.eye)));
    return metadata;
}

ExrMetadata settings_metadata(const PictureRecord& record) {
    const SceneSource& scene = record.scene;
    const RenderSettings& settings = record.settings;
    ExrMetadata metadata = recorded_settings(used_options(record), rows_of(false));
    append(metadata,
           {{"pertev.version", fmt::format("{} {}", version(), git_commit())}, {"pertev.scene", scene.scene}});
    if (scene.position_origin) metadata.emplace_back("pertev.position_origin", comma_separated(*scene.position_origin));
    if (is_solved(settings.integrator) && settings.radiosity->solution) {
        const RadiositySolution& solution = *settings.radiosity->solution;
        append(metadata, {{"pertev.radiosity", solution.made}, {"pertev.radiosity_hash", solution.hash().hex()}});
    }
    if (record.frame) {
        metadata.emplace_back(
            "pertev.reconstruction",
            reconstruction_json({record.frame->reconstruction, record.frame->restir}, settings.frame_depth));
    } else if (settings.has_history()) {
        metadata.emplace_back("pertev.history", static_cast<int32_t>(settings.history));
    }
    if (record.in_sequence) {
        append(metadata, {{"pertev.frame", static_cast<int32_t>(record.in_sequence->number)},
                          {"pertev.first_frame", static_cast<int32_t>(record.in_sequence->cut)}});
    }
    if (settings.irradiance) metadata.emplace_back("pertev.quantity", std::string("irradiance"));
    if (record.display && !record.display->false_colors) { // metered or given
        metadata.emplace_back("pertev.exposure", record.display->exposure_stops);
    }
    append(metadata, camera_metadata(record.camera)); // last, because time moves it
    return metadata;
}

namespace {

/// Returns the texts in alphabetical order, equal ones once.
std::vector<std::string> each_once(const std::vector<std::string>& texts) {
    const std::set<std::string> unique(texts.begin(), texts.end());
    return {unique.begin(), unique.end()};
}

ExrPlace place_of(const RenderSettings& settings) {
    if (!settings.crop) return {};
    return {settings.crop->x, settings.crop->y, settings.width, settings.height};
}

} // namespace

NumberFormats number_formats(const PictureOptions& options) { return {options.exr_colors, options.png_bits == "16"}; }

void Display::read_lut() {
    if (!lut_file.empty()) lut = std::make_shared<const CubeLut>(CubeLut::read(lut_file));
}

std::optional<float> Display::metered_stops(ToneMap curve) const {
    const auto found = std::ranges::find(metered, curve, &std::pair<ToneMap, float>::first);
    return found == metered.end() ? std::nullopt : std::optional(found->second);
}

PictureFacts facts_of(const PictureRecord& record, std::span<const PixelIds> ids) {
    PictureRecord not_shown = record;
    not_shown.display.reset();
    PictureFacts facts = {.settings = settings_metadata(not_shown),
                          .shown = settings_metadata(record),
                          .origin = {},
                          .display = record.display,
                          .transparent = record.settings.transparent,
                          .numbers = record.numbers,
                          .place = place_of(record.settings),
                          .objects = {},
                          .matte_materials = {}};
    if (const auto& mattes = record.settings.mattes)
        facts.objects = each_once(mattes->objects), facts.matte_materials = each_once(mattes->materials);
    std::erase_if(facts.shown, [&](const auto& entry) {
        return std::ranges::find(facts.settings, entry.first, &ExrMetadata::value_type::first) != facts.settings.end();
    });
    const SceneSource& scene = record.scene;
    facts.origin = {{"pertev.device", record.device},
                    {"pertev.made_up", json_strings(scene.made_up)},
                    {"pertev.left_out", json_strings(scene.left_out)},
                    {"pertev.load_seconds", scene.load_seconds},
                    {"pertev.build_seconds", scene.build_seconds}};
    for (const auto& [name, text] : {std::pair("pertev.scene_hash", &scene.hash),
                                     {"pertev.settings", &scene.settings},
                                     {"pertev.by_default", &scene.by_default},
                                     {"pertev.by_scene", &scene.by_scene},
                                     {"pertev.by_settings", &scene.by_settings},
                                     {"pertev.by_caller", &scene.by_caller}}) {
        if (!text->empty()) facts.origin.emplace_back(name, *text);
    }
    append(facts.origin, id_metadata(scene, ids));
    return facts;
}

ExrMetadata display_metadata(const Display& display) {
    PictureRecord shown;
    shown.display = display;
    return facts_of(shown, {}).shown;
}

ExrMetadata picture_metadata(const PictureFacts& facts, const RenderStats& stats, const std::string& hash) {
    ExrMetadata metadata = facts.settings;
    append(metadata, facts.shown);
    append(metadata, {{"pertev.spp", static_cast<int32_t>(stats.samples)},
                      {"pertev.hash", hash},
                      {"pertev.invalid_samples", static_cast<double>(stats.invalid_samples)},
                      {"pertev.render_seconds", stats.render_seconds},
                      {"pertev.rays", static_cast<double>(stats.rays.total())}});
    append(metadata, facts.origin);
    return metadata;
}

} // namespace pertev
