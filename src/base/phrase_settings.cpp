#include "base/phrase_settings.h"

#include <algorithm>

namespace pertev {

std::string phrase_settings(std::string_view text, const PhraseSetting& phrase) {
    constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz0123456789_";
    std::string phrased;
    while (!text.empty()) {
        const std::size_t open = std::min(text.find('`'), text.size());
        phrased += text.substr(0, open);
        text.remove_prefix(open);
        const std::size_t close = text.find('`', 1);
        if (close == std::string_view::npos) break;
        const std::string_view marked = text.substr(1, close - 1);
        const std::size_t name_end = std::min(marked.find('='), marked.size());
        const std::string_view name = marked.substr(0, name_end);
        if (name.empty() || name.find_first_not_of(letters) != std::string_view::npos) {
            phrased += text.substr(0, close); // the second backquote may start another setting
            text.remove_prefix(close);
            continue;
        }
        phrased += phrase(name, name_end < marked.size() ? marked.substr(name_end + 1) : std::string_view());
        text.remove_prefix(close + 1);
    }
    return phrased += text;
}

} // namespace pertev
