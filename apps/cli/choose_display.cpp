#include "apps/cli/choose_display.h"

#include <fmt/format.h>

#include "image/tone_map_image.h"
#include "settings/parse_values.h"

namespace pertev {

std::optional<Display> choose_display(const RenderFlags& flags, Session& session, Reporter& reporter) {
    return writes_tone_mapped(flags) ? std::optional(choose_shown_display(flags, session, reporter)) : std::nullopt;
}

Display choose_shown_display(const RenderFlags& flags, Session& session, Reporter& reporter) {
    if (const auto colors = false_colors(flags)) return Display{.false_colors = colors};
    const ToneMap tone_map = flags.tone_map.value_or(Display{}.tone_map);
    const std::string_view name = name_of(tone_map);
    const std::optional<PhysicalExposure> physical = physical_exposure(flags);
    const bool is_given = physical || (!flags.exposure.empty() && flags.exposure != "auto");
    if (!is_given) reporter.set_work("metering");
    const float stops = physical   ? exposure_stops(*physical, efficacy_of(flags.scene))
                        : is_given ? parse_number("--exposure", flags.exposure)
                                   : session.meter(tone_map);
    if (physical) {
        reporter.messages().note(fmt::format("EV {:.2f} at ISO 100: exposed by {:+.2f} stops ({:g} lm/W)",
                                             exposure_value(*physical), stops, efficacy_of(flags.scene)));
        reporter.say_messages();
    }
    reporter.event(fmt::format(R"({{"event":"exposure","stops":{},"auto":{},"tone_map":"{}"}})",
                               json_number(static_cast<double>(stops)), !is_given, name));
    if (is_given) return Display{tone_map, stops, {}};
    reporter.messages().note(fmt::format("exposed by {:+.2f} stops, shown by {} (--exposure {:.2f} --tone-map {} fixes "
                                         "that; --exposure 0 --tone-map srgb shows plain values)",
                                         stops, name, stops, name));
    reporter.say_messages();
    return Display{tone_map, stops, {}};
}

} // namespace pertev
