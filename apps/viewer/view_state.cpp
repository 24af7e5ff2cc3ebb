#include "apps/viewer/view_state.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <type_traits>

#include <fmt/format.h>

#include "apps/viewer/panel_phrases.h"
#include "apps/viewer/steering.h"
#include "apps/viewer/window_shape.h"
#include "base/error.h"
#include "denoise/oidn/oidn_library.h"
#include "render/film_channels.h"
#include "session/check_integrator.h"
#include "session/degrees.h"
#include "settings/parse_values.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

using Kind = ViewSetting::Kind;

constexpr const char* kLayers[] = {"picture",   "albedo",      "normal",          "depth",  "instances", "triangles",
                                   "materials", "heat: nodes", "heat: triangles", "motion", "deviation"};

constexpr const char* kScaleNames[] = {"automatic", "1", "1/2", "1/4", "1/8"};
constexpr float kScaleValues[] = {0, 1, 0.5f, 0.25f, 0.125f};
constexpr double kMinShown = 1e-6; // minimum of settings that must be above 0

float number_of(const SettingValue& value) { return static_cast<float>(std::get<double>(value)); }
const std::string& text_of(const SettingValue& value) { return std::get<std::string>(value); }

template <class Names>
std::vector<std::string> strings(const Names& names) {
    return {std::begin(names), std::end(names)};
}

/// The combination shown in the panel: that of camera rays. A change applies to all kinds of ray.
Combination shown_combination(const ViewState& state) {
    return state.options.render.tracers.value_or(default_tracers(state.on_cuda)).camera;
}

std::string set_combination(ViewState& state, const Combination& combination) {
    const TracerChoice choice = same_for_all(combination);
    try {
        check_choice(choice, state.on_cuda);
    } catch (const Error& error) {
        return panel_phrase(error.remark());
    }
    state.options.render.tracers = choice;
    return {};
}

bool is_cells(TraversalKind traversal) { return traversal == TraversalKind::Kd || traversal == TraversalKind::Octree; }

/// A structure implies a traversal that supports it if the present one does not.
std::string set_structure(ViewState& state, const std::string& name) {
    Combination wanted = shown_combination(state);
    wanted.structure = *value_named<StructureKind>(name);
    if (why_not(wanted.structure, wanted.traversal)) {
        const bool is_tree = builder_of(wanted.structure).has_value();
        wanted = {.structure = wanted.structure,
                  .traversal = is_tree                                     ? TraversalKind::WhileWhile
                               : wanted.structure == StructureKind::Octree ? TraversalKind::Octree
                                                                           : TraversalKind::Kd};
    }
    return set_combination(state, wanted);
}

/// A traversal implies a structure that it supports if the present one is unsupported.
std::string set_traversal(ViewState& state, const std::string& name) {
    const Combination now = shown_combination(state);
    Combination wanted = {.structure = now.structure, .traversal = *value_named<TraversalKind>(name)};
    if (why_not(wanted.structure, wanted.traversal)) {
        wanted.structure = wanted.traversal == TraversalKind::Kd       ? StructureKind::KdSah
                           : wanted.traversal == TraversalKind::Octree ? StructureKind::Octree
                                                                       : StructureKind::Binned;
    }
    if (!is_cells(wanted.traversal)) wanted.options = {};
    return set_combination(state, wanted);
}

std::string set_rta(ViewState& state, const std::string& name) {
    Combination wanted = shown_combination(state);
    wanted.options = rta_named(name, wanted.options).value();
    return set_combination(state, wanted);
}

/// Some layers need frames, which not every integrator makes.
std::string why_no_layer(ShownLayer layer, const RenderSettings& settings) {
    if (!is_of_frames(layer) || makes_frames(settings.integrator)) return {};
    return fmt::format("{} is a layer of reconstructed frames, which {} does not make", name_of(layer),
                       integrator_name(settings));
}

/// Returns a text about an unsupported feature of the integrator, or an empty one.
std::string why_no_picture(const RenderSettings& settings, const Camera& camera) {
    try {
        check_integrator(settings);
        check_camera(settings, camera);
    } catch (const Error& error) {
        return panel_phrase(error.remark());
    }
    return {};
}

std::string why_no_integrator(const ViewState& state) {
    for (const auto& [kind, why_dark] : state.dark) {
        if (kind == state.options.render.integrator) return why_dark;
    }
    const std::string why_not = why_no_picture(state.options.render, state.lens);
    return why_not.empty() ? why_no_layer(state.layer, state.options.render) : why_not;
}

/// Returns the options with the view's own values.
PictureOptions options_of(const ViewState& state) {
    PictureOptions options = state.options;
    options.tone_map = state.display.tone_map;
    CameraChoice& lens = options.scene.camera;
    lens.fov_deg = degrees_for(state.lens.fov_y);
    lens.aperture = state.lens.aperture_radius;
    lens.focus = state.lens.focus_distance;
    return options;
}

/// Sets an option of pictures. Returns why nothing was changed; empty on success.
std::string set_option(ViewState& state, const Setting& setting, const std::string& text) {
    const PictureOptions before = options_of(state);
    ViewState wanted = state;
    wanted.options = before;
    set_value(wanted.options, setting, std::span(&text, 1));
    wanted.display.tone_map = *wanted.options.tone_map;
    const CameraChoice& lens = wanted.options.scene.camera;
    if (lens.fov_deg != before.scene.camera.fov_deg) wanted.lens.fov_y = *lens.fov_deg * kRadiansPerDegree;
    wanted.lens.aperture_radius = *lens.aperture;
    wanted.lens.focus_distance = *lens.focus;
    RenderSettings& picture = wanted.options.render;
    if (integrator_name(picture) != integrator_name(before.render)) {
        if (std::string why_not = why_no_integrator(wanted); !why_not.empty()) return why_not;
    }
    if (picture.path.max_depth != before.render.path.max_depth) {
        picture.path.max_depth = std::min(picture.path.max_depth, max_depth(picture.integrator));
        picture.frame_depth = picture.path.max_depth;
    }
    if (rasterises_camera(picture.integrator)) wanted.lens.aperture_radius = 0;
    state = wanted;
    return {};
}

/// A setting of rays. The panel sets it for all kinds of ray, together with what it needs.
struct RaySetting {
    std::string_view name;
    std::string_view (*get)(const Combination&);
    std::string (*set)(ViewState&, const std::string&);
};
constexpr RaySetting kRaySettings[] = {
    {"structure", [](const Combination& c) { return name_of(c.structure); }, set_structure},
    {"traversal", [](const Combination& c) { return name_of(c.traversal); }, set_traversal},
    {"rta", [](const Combination& c) -> std::string_view { return name_of_rta(c.options); }, set_rta},
};

/// Makes the row of a setting of pictures.
ViewSetting row_of(const Setting& setting) {
    PictureOptions any;
    const SettingField field = setting.field(any);
    ViewSetting row;
    row.name = setting.name, row.label = setting.panel.label, row.group = setting.panel.group;
    row.choices = is_switch(setting) ? std::vector<std::string>{"false", "true"} : choices_of(setting);
    const bool is_choice = !row.choices.empty(), is_whole = std::holds_alternative<uint32_t*>(field) ||
                                                            std::holds_alternative<std::optional<uint32_t>*>(field);
    row.kind = is_choice ? Kind::Choice : is_whole ? Kind::Whole : Kind::Number;
    row.low = setting.above ? setting.low + kMinShown : setting.low;
    row.high = setting.high, row.step = setting.panel.step;
    if (const auto* of_rays = std::ranges::find(kRaySettings, std::string_view(setting.name), &RaySetting::name);
        of_rays != std::end(kRaySettings)) {
        row.hint = setting.sentence; // the rest is about flags
        row.get = [of_rays](const ViewState& s) {
            return SettingValue(std::string(of_rays->get(shown_combination(s))));
        };
        row.set = [of_rays](ViewState& s, const SettingValue& v) { return of_rays->set(s, text_of(v)); };
        return row;
    }
    row.hint = *setting.more != '\0' ? setting.more : setting.sentence;
    row.get = [&setting, is_choice](const ViewState& s) -> SettingValue {
        const std::vector<std::string> texts = texts_of(options_of(s), setting);
        const std::string text = texts.empty() ? "" : texts.front();
        return is_choice ? SettingValue(text) : SettingValue(static_cast<double>(number_in(text).value_or(0)));
    };
    row.set = [&setting, is_choice](ViewState& s, const SettingValue& v) {
        return set_option(s, setting, is_choice ? text_of(v) : fmt::format("{}", std::get<double>(v)));
    };
    return row;
}

constexpr std::string_view kNoDenoiser = "off"; // the setting no_reconstruction
constexpr float kMostStops = 60;                // the viewer's exposure; its row in the table has no range

/// The settings that only the viewer has.
std::vector<ViewSetting> own_settings() {
    std::vector<ViewSetting> all;
    const auto choice = [&](const char* name, const char* label, PanelGroup group, const char* hint,
                            std::vector<std::string> choices, auto get, auto set) {
        all.push_back({name, label, group, hint, Kind::Choice, std::move(choices), 0, 0, 1,
                       [get](const ViewState& s) { return SettingValue(std::string(get(s))); },
                       [set](ViewState& s, const SettingValue& v) {
                           if constexpr (std::is_void_v<decltype(set(s, text_of(v)))>) {
                               set(s, text_of(v));
                               return std::string();
                           } else {
                               return set(s, text_of(v));
                           }
                       }});
    };
    const auto numeric = [&](const char* name, const char* label, PanelGroup group, const char* hint, Kind kind,
                             double low, double high, double step, auto get, auto set) {
        all.push_back({name,
                       label,
                       group,
                       hint,
                       kind,
                       {},
                       low,
                       high,
                       step,
                       [get](const ViewState& s) { return SettingValue(static_cast<double>(get(s))); },
                       [set](ViewState& s, const SettingValue& v) {
                           set(s, number_of(v));
                           return std::string();
                       }});
    };

    choice(
        "layer", "Show", PanelGroup::Picture,
        "The picture or another quantity of each pixel in false colours. Heat: the number of tests of its camera "
        "ray",
        strings(kLayers), [](const ViewState& s) { return name_of(s.layer); },
        [](ViewState& s, const std::string& name) {
            const auto layer = static_cast<ShownLayer>(std::ranges::find(kLayers, name) - std::begin(kLayers));
            const std::string why_not = why_no_layer(layer, s.options.render);
            if (why_not.empty()) s.layer = layer;
            return why_not;
        });
    choice(
        "exposed", "Exposure", PanelGroup::Picture,
        "auto: a light meter sets the exposure; fixed: only the stops below do", {"auto", "fixed"},
        [](const ViewState& s) { return s.finds_exposure ? "auto" : "fixed"; },
        [](ViewState& s, const std::string& name) {
            const bool finds = name == "auto";
            if (finds == s.finds_exposure) return;
            s.display.exposure_stops =
                finds ? 0 : clamp(s.found_stops + s.display.exposure_stops, -kMostStops, kMostStops);
            s.finds_exposure = finds;
        });
    numeric(
        "exposure", "Stops", PanelGroup::Picture, "Each stop doubles the light. It is added to an automatic exposure",
        Kind::Number, -static_cast<double>(kMostStops), static_cast<double>(kMostStops), 0.25,
        [](const ViewState& s) { return s.display.exposure_stops; },
        [](ViewState& s, float v) { s.display.exposure_stops = v; });
    choice(
        "mode", "At rest", PanelGroup::Frames,
        "reference: samples accumulate to the picture of pertev render; real time: as in motion",
        {"reference", "real time"}, [](const ViewState& s) { return s.is_real_time ? "real time" : "reference"; },
        [](ViewState& s, const std::string& name) { s.is_real_time = name == "real time"; });
    std::vector<std::string> denoisers = names_of<FrameDenoiser>();
    denoisers.emplace_back(kNoDenoiser);
    choice(
        "denoiser", "Denoiser in motion", PanelGroup::Frames,
        "svgf: frames are filtered and accumulated; oidn: each is denoised by itself (Open Image Denoise); off: "
        "frames show their samples",
        std::move(denoisers),
        [](const ViewState& s) {
            const ReconstructionOptions& frames = s.options.reconstruction;
            return std::string(frames.none ? kNoDenoiser : name_of(frames.settings.denoiser));
        },
        [](ViewState& s, const std::string& name) {
            const auto denoiser = value_named<FrameDenoiser>(name);
            try {
                if (denoiser == FrameDenoiser::Oidn) OidnLibrary::find("frame_denoiser");
            } catch (const Error& error) {
                return panel_phrase(error.remark());
            }
            ReconstructionOptions& frames = s.options.reconstruction;
            frames.none = name == kNoDenoiser;
            if (denoiser) frames.settings.denoiser = *denoiser;
            return std::string();
        });
    choice(
        "moving_scale", "Size in motion", PanelGroup::Frames, "automatic: as large as the frame rate permits",
        strings(kScaleNames),
        [](const ViewState& s) {
            return kScaleNames[std::ranges::find(kScaleValues, s.moving_scale) - std::begin(kScaleValues)];
        },
        [](ViewState& s, const std::string& name) {
            s.moving_scale = kScaleValues[std::ranges::find(kScaleNames, name) - std::begin(kScaleNames)];
        });
    choice(
        "clocks", "Time", PanelGroup::Rays,
        "by kind: each kind of ray and shading is timed separately (Stages, below), which makes frames slower",
        {"together", "by kind"},
        [](const ViewState& s) { return s.options.render.time_kinds ? "by kind" : "together"; },
        [](ViewState& s, const std::string& name) { s.options.render.time_kinds = name == "by kind"; });
    return all;
}

/// Returns why the value is invalid for the setting; empty if it is valid.
std::string why_no_value(const ViewSetting& setting, const SettingValue& value) {
    if (setting.kind == Kind::Choice) {
        const std::string* text = std::get_if<std::string>(&value);
        const bool is_known = text != nullptr && std::ranges::find(setting.choices, *text) != setting.choices.end();
        return is_known ? "" : fmt::format("{} is not one of the choices", setting.label);
    }
    const double* given = std::get_if<double>(&value);
    const bool is_whole = setting.kind == Kind::Whole;
    if (given != nullptr && *given >= setting.low && *given <= setting.high &&
        (!is_whole || *given == std::floor(*given))) {
        return {};
    }
    return fmt::format("{}: a {}number from {} to {}", setting.label, is_whole ? "whole " : "", setting.low,
                       setting.high);
}

} // namespace

const char* name_of(ShownLayer layer) { return kLayers[static_cast<std::size_t>(layer)]; }

bool is_of_frames(ShownLayer layer) { return layer == ShownLayer::Motion || layer == ShownLayer::Deviation; }

uint32_t aovs_of(ShownLayer layer) {
    switch (layer) {
    case ShownLayer::Beauty:
    case ShownLayer::NodeHeat:
    case ShownLayer::TriangleHeat:
    case ShownLayer::Motion:
    case ShownLayer::Deviation:
        return 0;
    case ShownLayer::Albedo:
        return kAovAlbedo;
    case ShownLayer::Normal:
        return kAovNormal;
    case ShownLayer::Depth:
        return kAovDepth;
    case ShownLayer::Instances:
    case ShownLayer::Triangles:
    case ShownLayer::Materials:
        return kAovIds;
    }
    return 0;
}

std::vector<ViewSetting> make_view_settings(std::span<const Setting> table) {
    std::vector<ViewSetting> all = own_settings();
    for (const Setting& setting : table) {
        if (*setting.panel.label != '\0') all.push_back(row_of(setting));
    }
    std::ranges::stable_sort(all, {}, &ViewSetting::group);
    return all;
}

const std::vector<ViewSetting>& view_settings() {
    static const std::vector<ViewSetting> all = make_view_settings(all_settings());
    return all;
}

bool restarts(const ViewState& before, const ViewState& after) {
    const RenderSettings &was = before.options.render, &is = after.options.render;
    return before.layer != after.layer || before.is_real_time != after.is_real_time || !(before.lens == after.lens) ||
           was.tracers != is.tracers || !same_picture(was, is);
}

bool is_shown_otherwise(const ViewState& before, const ViewState& after) {
    return before.display.tone_map != after.display.tone_map ||
           before.display.exposure_stops != after.display.exposure_stops ||
           before.finds_exposure != after.finds_exposure;
}

bool resize_to_window(ViewState& state, uint32_t width, uint32_t height) {
    if (state.window_pixels == 0) return false;
    const PictureSize now = size_for_window(width, height, state.window_pixels);
    const PictureSize before = {std::exchange(state.options.render.width, now.width),
                                std::exchange(state.options.render.height, now.height)};
    return now != before;
}

std::string set_view_setting(ViewState& state, const std::string& name, const SettingValue& value) {
    for (const ViewSetting& setting : view_settings()) {
        if (setting.name != name) continue;
        const std::string why_not = why_no_value(setting, value);
        return why_not.empty() ? setting.set(state, value) : why_not;
    }
    return "unknown setting";
}

} // namespace pertev
