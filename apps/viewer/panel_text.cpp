#include "apps/viewer/panel_text.h"

#include <cmath>

#include <fmt/format.h>

#include "apps/viewer/file_name.h"
#include "apps/viewer/panel_phrases.h"
#include "base/json_text.h"
#include "scene/scene_origin.h"
#include "session/position_text.h"

namespace pertev {
namespace {

std::string json_of(const SettingValue& value) {
    if (const double* number = std::get_if<double>(&value)) return json_number(*number);
    return json_string(std::get<std::string>(value));
}

constexpr const char* kGroups[] = {"Picture", "Light", "Frames", "Camera", "Ray tracing (same picture)"};
constexpr const char* kKinds[] = {"choice", "number", "whole"}; // names of ViewSetting::Kind

void append(std::string& list, const std::string& item) {
    if (!list.empty()) list += ',';
    list += item;
}

std::string settings_json() {
    std::string list;
    for (const ViewSetting& setting : view_settings()) {
        std::string choices;
        for (const std::string& choice : setting.choices) append(choices, json_string(choice));
        append(
            list,
            fmt::format(
                R"({{"name":"{}","label":{},"group":{},"hint":{},"kind":"{}","choices":[{}],"low":{},"high":{},"step":{}}})",
                setting.name, json_string(setting.label), json_string(kGroups[static_cast<std::size_t>(setting.group)]),
                json_string(setting.hint), kKinds[static_cast<std::size_t>(setting.kind)], choices,
                json_number(setting.low), json_number(setting.high), json_number(setting.step)));
    }
    return list;
}

/// A row of the panel's numbers: its group, its label and its text, which is empty if it does not apply now.
struct NumberRow {
    const char* group;
    const char* label;
    std::string (*describe)(const ViewState&, const ViewNumbers&);
};

/// Returns the rate of one kind of rays. `kind_s` is their time; 0 if it was not measured, when the frame's total time
/// is used.
std::string rays_per_second(uint64_t rays, double kind_s, const ViewNumbers& numbers) {
    const double seconds = kind_s > 0 ? kind_s : numbers.frame->render_s;
    if (rays == 0 || !(seconds > 0)) return "";
    return fmt::format("{:.1f} Mrays/s{}", static_cast<double>(rays) / seconds * 1e-6, kind_s > 0 ? "" : " on average");
}

constexpr NumberRow kRows[] = {
    {"Now", "samples",
     [](const ViewState& v, const ViewNumbers& n) {
         return fmt::format("{} of {}", n.frame->samples, v.options.render.samples);
     }},
    {"Now", "size",
     [](const ViewState&, const ViewNumbers& n) {
         return fmt::format("{} x {}", n.frame->image.width, n.frame->image.height);
     }},
    {"Now", "film hash", [](const ViewState&, const ViewNumbers& n) { return n.frame->hash; }},
    {"Now", "exposed by",
     [](const ViewState&, const ViewNumbers& n) { return fmt::format("{:+.2f} stops", n.frame->exposure_stops); }},
    {"Now", "flags for this picture", [](const ViewState&, const ViewNumbers& n) { return n.picture_flags; }},
    {"Now", "scene", [](const ViewState&, const ViewNumbers& n) { return n.why_still; }},
    {"Now", "colours", [](const ViewState&, const ViewNumbers& n) { return n.frame->caption; }},
    {"Frames", "rendered",
     [](const ViewState&, const ViewNumbers& n) {
         return n.frames_per_second > 0 ? fmt::format("{:.1f} per second", n.frames_per_second) : "";
     }},
    {"Frames", "screen of the steering viewer",
     [](const ViewState& v, const ViewNumbers&) {
         return v.screen_rate > 0 ? fmt::format("{:.0f} per second", v.screen_rate) : "";
     }},
    {"Frames", "frame rate of automatic size",
     [](const ViewState&, const ViewNumbers& n) {
         if (n.frame->kept_rate == 0) return std::string();
         return fmt::format("{:.0f} per second{}", n.frame->kept_rate,
                            n.frame->keeps_rate ? "" : ", not reached at the smallest size");
     }},
    {"Rays", "camera",
     [](const ViewState&, const ViewNumbers& n) {
         return rays_per_second(n.frame->rays.camera, n.frame->kind_seconds.camera, n);
     }},
    {"Rays", "bounce",
     [](const ViewState&, const ViewNumbers& n) {
         return rays_per_second(n.frame->rays.bounce, n.frame->kind_seconds.bounce, n);
     }},
    {"Rays", "shadow",
     [](const ViewState&, const ViewNumbers& n) {
         return rays_per_second(n.frame->rays.shadow, n.frame->kind_seconds.shadow, n);
     }},
};

std::string row_json(const char* group, const std::string& label, const std::string& value) {
    return fmt::format("[{},{},{}]", json_string(group), json_string(label), json_string(value));
}

std::string rows_json(const ViewState& view, const ViewNumbers& numbers) {
    std::string rows;
    if (numbers.made_share < 1) {
        append(rows, row_json("Now", "precomputed share", fmt::format("{:.0f} %", 100 * numbers.made_share)));
    }
    if (numbers.frame == nullptr) return rows;
    for (const NumberRow& row : kRows) {
        const std::string value = row.describe(view, numbers);
        if (!value.empty()) append(rows, row_json(row.group, row.label, value));
    }
    for (const auto& [stage, milliseconds] : numbers.frame->stages) {
        append(rows, row_json("Stages", stage, fmt::format("{:.1f} ms", milliseconds)));
    }
    append(rows, row_json("Stages", "pack",
                          fmt::format("{:.1f} ms, {} KiB", numbers.pack_ms, (numbers.packed_bytes + 1023) / 1024)));
    append(rows, row_json("Stages", "packed by", numbers.encoder));
    return rows;
}

/// A vector as JSON. It has all digits, because positions may be far from the origin.
std::string json_of(DoubleVec3 v) {
    const auto number = [](double x) { return std::isfinite(x) ? fmt::format("{}", x) : "null"; };
    return fmt::format("[{},{},{}]", number(v.x), number(v.y), number(v.z));
}

std::string clock_json(const SceneClock& clock) {
    return fmt::format(R"({{"at":{},"end":{},"on":{},"loops":{},"speed":{}}})", clock.time_s.value_or(0),
                       json_number(clock.end_s), clock.plays, clock.loops, json_number(clock.speed));
}

/// The camera path's keys in the format of formats/read_camera_path.h.
std::string keys_json(const CameraPath* path) {
    std::string list;
    if (path == nullptr) return list;
    for (const CameraKey& key : path->keys) {
        append(list, fmt::format(R"({{"time":{},"eye":{},"target":{},"up":{},"fov":{}}})", json_number(key.time_s),
                                 json_of(key.eye), json_of(key.target), json_of(to_double(key.up)),
                                 json_number(static_cast<double>(key.fov_deg))));
    }
    return list;
}

} // namespace

std::string welcome_text(const ViewerStart& start) {
    std::string cameras;
    for (std::size_t i = 0; i < start.scene->cameras.size(); ++i) {
        const std::string& name = start.scene->cameras[i].name;
        append(cameras, json_string(name.empty() ? fmt::format("camera {}", i) : name));
    }
    const std::string name = file_name(start.record.scene.scene);
    std::string about = row_json("Scene", "file", name);
    append(about, row_json("Scene", "rendered by", start.record.device));
    for (const auto& [label, value] : start.about) append(about, row_json("Scene", label, value));
    const SceneSource& scene = start.record.scene;
    for (const auto& [label, list] : {std::pair{"added by default", &scene.made_up}, {"left out", &scene.left_out}}) {
        for (const std::string& text : *list)
            append(about, row_json("Scene", label, without_folders(panel_phrase(text), scene.scene)));
    }
    return fmt::format(
        R"({{"type":"welcome","scene":{},"device":{},"width":{},"height":{},"cameras":[{}],"about":[{}],"settings":[{}]}})",
        json_string(name), json_string(start.record.device), start.view.options.render.width,
        start.view.options.render.height, cameras, about, settings_json());
}

std::string state_text(const ViewState& view, const ViewNumbers& numbers) {
    std::string values;
    for (const ViewSetting& setting : view_settings()) {
        append(values, fmt::format(R"("{}":{})", setting.name, json_of(setting.get(view))));
    }
    const uint32_t samples = numbers.frame != nullptr ? numbers.frame->samples : 0;
    return fmt::format(
        R"({{"type":"state","phase":"{}","samples":{},"spp":{},"hash":"{}","reference":{},"flags":{},"input":{},"steerer":{},"clock":{},"keys":[{}],"values":{{{}}},"rows":[{}]}})",
        numbers.phase, samples, view.options.render.samples, numbers.frame != nullptr ? numbers.frame->hash : "",
        numbers.frame != nullptr && numbers.frame->is_reference, json_string(numbers.flags), numbers.input,
        numbers.steerer, clock_json(numbers.clock), keys_json(numbers.path), values, rows_json(view, numbers));
}

std::string notice_text(const char* kind, const std::string& text) {
    return fmt::format(R"({{"type":"notice","kind":"{}","text":{}}})", kind, json_string(text));
}

std::string picked_text(const Scene& scene, const PickedPoint* point, float x, float y) {
    const std::string position =
        fmt::format(R"("x":{},"y":{})", json_number(static_cast<double>(x)), json_number(static_cast<double>(y)));
    if (point == nullptr || point->instance >= scene.instances.size()) {
        return fmt::format(R"({{"type":"picked",{},"rows":[]}})", position);
    }
    const Instance& instance = scene.instances[point->instance];
    const auto named = [](const std::string& name, uint32_t number) {
        return name.empty() ? fmt::format("number {}", number) : fmt::format("{} (number {})", name, number);
    };
    const auto text = [](Vec3 v) { return fmt::format("{:.4g}, {:.4g}, {:.4g}", v.x, v.y, v.z); };
    std::string rows;
    const auto row = [&](const char* label, const std::string& value) {
        append(rows, row_json("Picked", label, value));
    };
    row("instance", named(instance.name, point->instance));
    row("mesh", named(scene.meshes[instance.mesh].name, instance.mesh));
    if (point->material < scene.materials.size()) {
        row("material", named(scene.materials[point->material].name, point->material));
    }
    row("triangle", fmt::format("{}", point->primitive));
    row("distance", fmt::format("{:.4g} m", point->distance));
    row("position",
        scene.origin_in_file == DoubleVec3{0, 0, 0} ? text(point->position) : position_text(scene, point->position, 4));
    row("normal", text(point->normal));
    if (point->light) {
        row("light", fmt::format("{:.3g}, {:.3g}, {:.3g}", point->light->r, point->light->g, point->light->b));
    }
    row("albedo", fmt::format("{:.3g}, {:.3g}, {:.3g}", point->albedo.r, point->albedo.g, point->albedo.b));
    return fmt::format(R"({{"type":"picked",{},"position":{},"rows":[{}]}})", position,
                       json_of(in_file(scene, point->position)), rows);
}

} // namespace pertev
