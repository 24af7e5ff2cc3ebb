#include "apps/cli/report_display.h"

#include <fmt/format.h>

#include "settings/value_names.h"

namespace pertev {

Display choose_and_report_display(const RenderFlags& flags, Session& session, Reporter& reporter) {
    const bool is_auto = is_metered(flags);
    if (is_auto) reporter.set_work("metering");
    Display display = choose_display(flags, session);
    if (display.false_colors) return display;
    const float stops = display.exposure_stops;
    const std::string_view name = name_of(display.tone_map);
    if (const auto physical = physical_exposure(flags)) {
        reporter.messages().note(fmt::format("EV {:.2f} at ISO 100: exposed by {:+.2f} stops ({:g} lm/W)",
                                             exposure_value(*physical), stops, efficacy_of(flags.scene)));
    }
    if (is_auto) {
        reporter.messages().note(
            fmt::format("exposed by {:+.2f} stops, shown by {} (--exposure {:.2f} --tone-map {} fixes "
                        "that; --exposure 0 --tone-map srgb shows plain values)",
                        stops, name, stops, name));
    }
    reporter.event(fmt::format(R"({{"event":"exposure","stops":{},"auto":{},"tone_map":"{}"}})",
                               json_number(static_cast<double>(stops)), is_auto, name));
    reporter.report_messages();
    return display;
}

} // namespace pertev
