#include "session/pictures/choose_display.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "settings/parse_values.h"

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

bool is_metered(const PictureOptions& options) {
    return options.false_color.empty() && !physical_exposure(options) &&
           (options.exposure.empty() || options.exposure == "auto");
}

Display choose_display(const PictureOptions& options, Session& session) {
    if (const auto colors = false_colors(options)) return Display{.false_colors = colors};
    Display display;
    display.tone_map = options.tone_map.value_or(display.tone_map);
    if (is_metered(options)) {
        display.exposure_stops = session.meter(display.tone_map);
    } else if (const auto physical = physical_exposure(options)) {
        display.exposure_stops = exposure_stops(*physical, efficacy_of(options.scene));
    } else {
        display.exposure_stops = parse_number("exposure", options.exposure);
    }
    return display;
}

} // namespace pertev
