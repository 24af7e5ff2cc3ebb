#include "apps/viewer/panel_phrases.h"

#include <algorithm>

#include <fmt/format.h>

#include "apps/viewer/view_state.h"
#include "base/phrase_settings.h"

namespace pertev {
namespace {

std::string label_and_value(std::string_view name, std::string_view value) {
    const std::vector<ViewSetting>& rows = view_settings();
    const auto row = std::ranges::find(rows, name, &ViewSetting::name);
    std::string label = row != rows.end() ? fmt::format("\"{}\"", row->label) : std::string(name);
    if (row == rows.end()) std::ranges::replace(label, '_', ' ');
    return value.empty() ? label : fmt::format("{} {}", label, value);
}

} // namespace

std::string panel_phrase(const Remark& remark) { return phrase_settings(remark.text(), label_and_value); }

} // namespace pertev
