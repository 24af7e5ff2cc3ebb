#include "session/pictures/choose_display.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "image/auto_exposure.h"
#include "settings/parse_values.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

/// Returns the ends of a scale. Throws Error(BadInput).
std::pair<float, float> parse_range(const std::string& text) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const float least = number_in(text.substr(0, comma)).value_or(0.0f);
    const float most = number_in(text.substr(std::min(comma + 1, text.size()))).value_or(0.0f);
    if (!(least > 0 && least < most)) {
        throw Error(ErrorCode::BadInput, "false_color_range", text, "expected A,B with 0 < A < B, as 1,1000");
    }
    return {least, most};
}

} // namespace

double efficacy_of(const SceneOptions& options) {
    return lumens_per_watt(options.scene, static_cast<double>(options.efficacy));
}

std::optional<PhysicalExposure> physical_exposure(const PictureOptions& options) {
    if (!(options.f_number > 0)) return std::nullopt;
    PhysicalExposure exposure;
    if (options.iso > 0) exposure.iso = static_cast<double>(options.iso);
    exposure.f_number = static_cast<double>(options.f_number);
    exposure.shutter_s = static_cast<double>(options.shutter_s);
    return exposure;
}

std::optional<FalseColors> false_colors(const PictureOptions& options) {
    if (options.false_color.empty() && options.false_color_range.empty()) return std::nullopt;
    FalseColors colors;
    if (!options.false_color_range.empty())
        std::tie(colors.least, colors.most) = parse_range(options.false_color_range);
    if (options.false_color.empty()) return std::nullopt;
    colors.quantity = options.false_color;
    colors.unit = options.false_color == "illuminance" ? "lx" : "cd/m2";
    colors.factor = static_cast<float>(efficacy_of(options.scene));
    return colors;
}

std::optional<float> requested_exposure(const PictureOptions& options) {
    if (options.exposure.empty() || options.exposure == "auto") return std::nullopt;
    if (const auto stops = number_in(options.exposure)) return stops;
    throw Error(
        ErrorCode::BadInput, "exposure", options.exposure,
        fmt::format("expected auto, or a number of stops between -{0} and {0}", std::numeric_limits<float>::max()));
}

bool is_metered(const PictureOptions& options) {
    return options.false_color.empty() && !physical_exposure(options) && !requested_exposure(options);
}

Display choose_display(const PictureOptions& options, Session& session, Sink& sink) {
    if (const auto colors = false_colors(options)) return Display{.false_colors = colors};
    Display display;
    display.tone_map = options.tone_map.value_or(display.tone_map);
    display.lut_file = options.lut, display.lut_input = options.lut_input;
    display.read_lut();
    float& stops = display.exposure_stops;
    if (const auto physical = physical_exposure(options)) {
        const double efficacy = efficacy_of(options.scene);
        stops = exposure_stops(*physical, efficacy);
        sink.note(fmt::format("EV {:.2f} at ISO 100: exposed by {:+.2f} stops ({:g} lm/W)", exposure_value(*physical),
                              stops, efficacy));
    } else if (const auto requested = requested_exposure(options)) {
        stops = *requested;
    } else {
        sink.set_work("metering");
        const Image light = session.metered_light();
        for (const auto& [curve, name] : kToneMaps)
            display.metered.emplace_back(curve, auto_exposure_stops(light, curve));
        stops = *display.metered_stops(display.tone_map);
        const std::string_view name = name_of(display.tone_map);
        sink.note(fmt::format(
            "metered exposure: {:+.2f} stops, tone mapping by {} (`exposure={:.2f}` `tone_map={}` fixes both; "
            "`exposure=0` `tone_map=srgb` writes linear light in sRGB)",
            stops, name, stops, name));
    }
    return display;
}

} // namespace pertev
