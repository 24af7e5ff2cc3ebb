#include "apps/cli/choose_display.h"

#include <fmt/format.h>

#include "apps/cli/parse_values.h"
#include "image/tone_map_image.h"

namespace pertev {

std::optional<Display> choose_display(const RenderFlags& flags, Session& session, Reporter& reporter) {
    return writes_tone_mapped(flags) ? std::optional(choose_shown_display(flags, session, reporter)) : std::nullopt;
}

Display choose_shown_display(const RenderFlags& flags, Session& session, Reporter& reporter) {
    const ToneMap tone_map = flags.tone_map.empty() ? Display{}.tone_map : *tone_map_named(flags.tone_map);
    const std::string_view name = name_of(tone_map);
    const bool is_given = !flags.exposure.empty() && flags.exposure != "auto";
    const float stops = is_given ? parse_number("--exposure", flags.exposure) : session.meter(tone_map);
    reporter.event(fmt::format(R"({{"event":"exposure","stops":{},"auto":{},"tone_map":"{}"}})",
                               json_number(static_cast<double>(stops)), !is_given, name));
    if (is_given) return Display{tone_map, stops};
    reporter.messages().note(fmt::format("exposed by {:+.2f} stops, shown by {} (--exposure {:.2f} --tone-map {} fixes "
                                         "that; --exposure 0 --tone-map srgb shows plain values)",
                                         stops, name, stops, name));
    reporter.say_messages();
    return Display{tone_map, stops};
}

} // namespace pertev
