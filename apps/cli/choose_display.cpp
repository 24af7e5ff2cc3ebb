#include "apps/cli/choose_display.h"

#include <fmt/format.h>

#include "apps/cli/parse_values.h"
#include "image/tone_map_image.h"
#include "integrators/meter_exposure.h"

namespace pertev {
namespace {

constexpr const char* kDefaultToneMap = "agx";

} // namespace

Display choose_display(const RenderFlags& flags, Queue& queue, const PreparedScene& prepared, const Camera& camera,
                       const RenderSettings& settings, Reporter& reporter) {
    const std::string name = flags.tone_map.empty() ? kDefaultToneMap : flags.tone_map;
    Display display{*tone_map_named(name), 0, writes_tone_mapped(flags)};
    if (!display.is_used) return display;
    const bool is_given = !flags.exposure.empty() && flags.exposure != "auto";
    const float stops = is_given ? parse_number("--exposure", flags.exposure)
                                 : meter_exposure(queue, prepared, camera, settings, display.tone_map);
    display.exposure_stops = stops;
    reporter.event(fmt::format(R"({{"event":"exposure","stops":{},"auto":{},"tone_map":"{}"}})",
                               json_number(static_cast<double>(stops)), !is_given, name));
    if (is_given) return display;
    reporter.messages().note(fmt::format("exposed by {:+.2f} stops, shown by {} (--exposure {:.2f} --tone-map {} fixes "
                                         "that; --exposure 0 --tone-map srgb shows plain values)",
                                         stops, name, stops, name));
    reporter.say_messages();
    return display;
}

} // namespace pertev
