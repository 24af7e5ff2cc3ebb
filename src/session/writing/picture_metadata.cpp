#include "session/writing/picture_metadata.h"

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
#include "session/survey/ground.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

using MetadataValue = ExrMetadata::value_type::second_type;

std::string comma_separated(Vec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

std::string comma_separated(DoubleVec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

/// A position in the coordinates of the file, with enough digits to convert back to the same bits.
std::string position_in_file(Vec3 p, DoubleVec3 origin) {
    return origin == DoubleVec3{0, 0, 0} ? comma_separated(p) : comma_separated(origin + to_double(p));
}

void append(ExrMetadata& metadata, const ExrMetadata& more) {
    metadata.insert(metadata.end(), more.begin(), more.end());
}

ExrMetadata environment_metadata(const SceneSource& source) {
    const std::string not_asked_for = source.has_environment ? "made up" : "none";
    return {{"pertev.environment", source.environment.empty() ? not_asked_for : source.environment},
            {"pertev.environment_scale", source.environment_scale},
            {"pertev.environment_rotation", source.environment_rotation_deg}};
}

std::string names_as_json(const std::set<uint32_t>& ids, const std::vector<std::string>& names) {
    std::string text;
    for (const uint32_t id : ids) {
        if (id >= names.size()) continue; // nothing was hit
        text += fmt::format("{}\"{}\":{}", text.empty() ? "{" : ",", id, json_string(names[id]));
    }
    return text.empty() ? "{}" : text + "}";
}

/// A whole number is stored as text if it need not fit an int32_t.
MetadataValue metadata_value(const PictureOptions& options, const Setting& setting) {
    const std::string text = texts_of(options, setting).front();
    const bool is_text = setting.high > double(INT32_MAX);
    return std::visit(
        [&]<class Field>(Field field) -> MetadataValue {
            if constexpr (std::is_same_v<Field, bool*>)
                return static_cast<int32_t>(*field);
            else if constexpr (std::is_same_v<Field, float*>)
                return *field;
            else if constexpr (std::is_same_v<Field, uint32_t*>)
                return is_text ? MetadataValue(text) : static_cast<int32_t>(*field);
            else
                return text;
        },
        setting.field(const_cast<PictureOptions&>(options)));
}

} // namespace

ExrMetadata recorded_settings(const PictureOptions& options, std::span<const Setting> settings) {
    ExrMetadata metadata;
    const PictureOptions defaults;
    for (const Setting& setting : settings) {
        const std::vector<std::string> texts = texts_of(options, setting);
        const bool is_used = setting.recorded != Recorded::WhereUsed || has_setting(options.render.integrator, setting);
        const bool is_default = texts == texts_of(defaults, setting);
        if (setting.recorded == Recorded::No || texts.empty() || !is_used) continue;
        if (setting.recorded == Recorded::Changed && is_default) continue;
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
    std::string emitters;
    for (const std::string& emitter : options.emitters) emitters += (emitters.empty() ? "" : "\n") + emitter;
    return {.scene = options.scene,
            .environment = environment_text(options),
            .environment_scale = options.environment_scale,
            .environment_rotation_deg = options.environment_rotation_deg,
            .up_axis = options.up_axis,
            .unit = options.unit,
            .emitters = emitters,
            .has_environment = scene.environment.has_value(),
            .has_ground = has_ground(scene),
            .two_sided_lights = options.two_sided_lights,
            .show_back_faces = options.show_back_faces,
            .animation = clip_choice(scene.clips),
            .file_scene = file_scene_choice(scene),
            .position_origin = scene.is_far ? std::optional(scene.origin_in_file) : std::nullopt};
}

CameraSource source_of(const CameraChoice& choice, const Camera& camera, DoubleVec3 origin) {
    return {.camera = camera,
            .name = choice.camera,
            .target = choice.target,
            .up = choice.up,
            .fov_deg = choice.fov_deg.value_or(0),
            .origin = origin};
}

ExrMetadata camera_metadata(const CameraSource& source) {
    const Camera& camera = source.camera;
    const Transform& from = camera.world_from_camera;
    const Vec3 eye = from.translation;
    const Vec3 target =
        source.target ? to_float(*source.target - source.origin) : eye - camera.focus_distance * column(from, 2);
    Vec3 up = source.up.value_or(column(from, 1));
    for (const Vec3 unsaid : {Vec3{0, 0, -1}, Vec3{0, 1, 0}}) {
        if (!source.up && look_at(eye, target, unsaid) == from) up = unsaid;
    }
    const std::string matrix =
        fmt::format("{} {} {} {}", comma_separated(column(from, 0)), comma_separated(column(from, 1)),
                    comma_separated(column(from, 2)), position_in_file(eye, source.origin));
    const std::string looked_at =
        source.target ? comma_separated(*source.target) : position_in_file(target, source.origin);
    ExrMetadata metadata = {{"pertev.camera", source.name},
                            {"pertev.world_from_camera", matrix},
                            {"pertev.eye", position_in_file(eye, source.origin)},
                            {"pertev.target", looked_at},
                            {"pertev.up", comma_separated(up)},
                            {"pertev.aperture", camera.aperture_radius}};
    if (camera.aperture_radius > 0) metadata.emplace_back("pertev.focus", camera.focus_distance);
    metadata.emplace_back("pertev.projection", std::string(name_of(camera.projection)));
    const ViewSize view = view_size(camera);
    const bool has_stated = view.setting == "fov" && source.fov_deg > 0;
    metadata.emplace_back(fmt::format("pertev.{}", view.setting), has_stated ? source.fov_deg : view.value);
    return metadata;
}

ExrMetadata settings_metadata(const PictureRecord& record) {
    const SceneSource& scene = record.scene;
    const RenderSettings& settings = record.settings;
    ExrMetadata metadata = {{"pertev.version", fmt::format("{} {}", version(), git_commit())},
                            {"pertev.scene", scene.scene},
                            {"pertev.filter_radius", filter_radius_of(settings)},
                            {"pertev.two_sided_lights", static_cast<int32_t>(scene.two_sided_lights)},
                            {"pertev.show_back_faces", static_cast<int32_t>(scene.show_back_faces)}};
    PictureOptions options;
    options.render = settings;
    append(metadata, recorded_settings(options, all_settings()));
    if (settings.light_paths) {
        std::string lines;
        for (const LightPathExpression& layer : settings.light_paths->expressions) {
            lines += fmt::format("{}{}={}", lines.empty() ? "" : "\n", layer.name, layer.text);
        }
        metadata.emplace_back("pertev.lpe", lines);
    }
    if (settings.integrator == IntegratorKind::Reyes) {
        std::set<std::string> heights; // several materials if a name matches more than one
        if (settings.heights) {
            for (const HeightMap& map : *settings.heights) heights.insert(map.text);
        }
        if (!heights.empty()) metadata.emplace_back("pertev.displacement", fmt::format("{}", fmt::join(heights, "\n")));
    }
    if (settings.integrator == IntegratorKind::Radiosity && settings.radiosity->solution) {
        const RadiositySolution& solution = *settings.radiosity->solution;
        append(metadata, {{"pertev.radiosity", solution.made},
                          {"pertev.radiosity_hash", solution.hash().hex()},
                          {"pertev.flat_patches", static_cast<int32_t>(settings.radiosity->is_flat)}});
    }
    if (record.frame) {
        append(metadata, {{"pertev.reconstruction", json_of(record.frame->reconstruction, record.frame->restir)},
                          {"pertev.frame", static_cast<int32_t>(record.frame->number)},
                          {"pertev.first_frame", static_cast<int32_t>(record.frame->cut)}});
    }
    if (!scene.animation.empty()) metadata.emplace_back("pertev.animation", scene.animation);
    if (!scene.file_scene.empty()) metadata.emplace_back("pertev.file_scene", scene.file_scene);
    if (scene.time_s) metadata.emplace_back("pertev.time", *scene.time_s);
    if (scene.shutter) {
        metadata.emplace_back("pertev.shutter", fmt::format("{},{}", scene.shutter->open_s, scene.shutter->close_s));
    }
    append(metadata, camera_metadata(record.camera));
    if (scene.position_origin) metadata.emplace_back("pertev.position_origin", comma_separated(*scene.position_origin));
    append(metadata, environment_metadata(scene));
    if (!scene.up_axis.empty()) metadata.emplace_back("pertev.up_axis", scene.up_axis);
    if (!scene.unit.empty()) metadata.emplace_back("pertev.unit", scene.unit);
    if (scene.has_ground) metadata.emplace_back("pertev.ground", std::string("on"));
    if (!scene.emitters.empty()) metadata.emplace_back("pertev.lamp", scene.emitters);
    if (settings.irradiance) metadata.emplace_back("pertev.quantity", std::string("irradiance"));
    if (record.display && record.display->false_colors) {
        metadata.emplace_back("pertev.false_color", record.display->false_colors->quantity);
    } else if (record.display) {
        append(metadata, {{"pertev.tone_map", std::string(name_of(record.display->tone_map))},
                          {"pertev.exposure", record.display->exposure_stops}});
    }
    return metadata;
}

ExrMetadata picture_metadata(const PictureRecord& record, const RenderStats& stats, const std::string& hash) {
    ExrMetadata metadata = settings_metadata(record);
    append(metadata, {{"pertev.spp", static_cast<int32_t>(stats.samples)},
                      {"pertev.device", record.device},
                      {"pertev.hash", hash},
                      {"pertev.made_up", json_strings(record.scene.made_up)},
                      {"pertev.left_out", json_strings(record.scene.left_out)},
                      {"pertev.invalid_samples", static_cast<double>(stats.invalid_samples)},
                      {"pertev.load_seconds", record.scene.load_seconds},
                      {"pertev.build_seconds", record.scene.build_seconds},
                      {"pertev.render_seconds", stats.render_seconds},
                      {"pertev.rays", static_cast<double>(stats.rays.total())}});
    const SceneSource& scene = record.scene;
    for (const auto& [name, text] : {std::pair("pertev.scene_hash", &scene.hash),
                                     {"pertev.settings", &scene.settings},
                                     {"pertev.by_scene", &scene.by_scene},
                                     {"pertev.by_settings", &scene.by_settings},
                                     {"pertev.by_flags", &scene.by_flags}}) {
        if (!text->empty()) metadata.emplace_back(name, *text);
    }
    return metadata;
}

} // namespace pertev
