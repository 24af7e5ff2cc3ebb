#include "session/pictures/show_merged.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "session/pictures/choose_display.h"
#include "settings/setting_table.h"
#include "settings/settings_file.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

std::string& text_named(const std::string& name, ExrMetadata& metadata) {
    const auto found = std::ranges::find(metadata, name, &ExrMetadata::value_type::first);
    auto& entry = found != metadata.end() ? *found : metadata.emplace_back(name, std::string());
    return std::get<std::string>(entry.second);
}

/// Records in `origin` that the caller has given `setting`.
void note_given(const std::string& setting, ExrMetadata& origin) {
    for (const char* source : {"pertev.by_caller", "pertev.by_default", "pertev.by_scene", "pertev.by_settings"}) {
        std::string& text = text_named(source, origin);
        const std::vector<std::string> words = words_of(text);
        std::set<std::string> names(words.begin(), words.end());
        names.erase(setting);
        if (source == std::string_view("pertev.by_caller")) names.insert(setting);
        text = fmt::format("{}", fmt::join(names, " "));
        if (text.empty()) std::erase_if(origin, [&](const auto& entry) { return entry.first == source; });
    }
}

} // namespace

void show_merged(const PictureOptions& options, const std::string& film, PictureFacts& facts) {
    facts.numbers = number_formats(options);
    const bool has_exposure = options.is_given("exposure");
    const bool has_lut = options.is_given("lut");
    if (!has_exposure && !options.is_given("tone_map") && !has_lut) {
        if (facts.display) facts.display->read_lut();
        return;
    }
    const Display before = facts.display.value_or(Display{});
    Display display = {.tone_map =
                           options.tone_map.value_or(before.false_colors ? Display{}.tone_map : before.tone_map),
                       .metered = before.metered,
                       .lut_file = has_lut ? options.lut : before.lut_file,
                       .lut_input = has_lut ? options.lut_input : before.lut_input};
    display.read_lut();
    const std::optional<float> requested_stops = requested_exposure(options);
    if (requested_stops) {
        display.exposure_stops = *requested_stops;
        display.metered.clear();
    } else if (const auto metered = before.metered_stops(display.tone_map)) {
        display.exposure_stops = *metered;
    } else if (!has_exposure && !before.false_colors && facts.display) {
        display.exposure_stops = before.exposure_stops; // a fixed one, which holds for every tone map
    } else {
        Remark remark(FileLocation{film}, "the part was rendered without the light meter, which has to see the scene; "
                                          "state a number of stops, or render the parts with `exposure=auto`");
        remark.setting = "exposure", remark.value = options.exposure;
        throw Error(ErrorCode::BadInput, std::move(remark));
    }
    facts.display = display;
    facts.shown = display_metadata(display);
    for (const Setting& setting : all_settings()) {
        const std::string name = setting.name;
        if (setting.changes != Changes::Display || !options.is_given(name)) continue;
        note_given(name, facts.origin);
        for (auto& [entry, value] : facts.origin) {
            auto* const text = std::get_if<std::string>(&value);
            if (text != nullptr && entry == "pertev.settings") *text = with_setting(*text, options, name);
        }
    }
}

} // namespace pertev
