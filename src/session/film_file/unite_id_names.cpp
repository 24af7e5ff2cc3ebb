#include "session/film_file/unite_id_names.h"

#include <algorithm>
#include <charconv>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json_text.h"
#include "formats/json/json_file.h"

namespace pertev {
namespace {

void take_names(const std::string& text, std::map<uint32_t, std::string>& names) {
    const JsonFile parsed("names of ids", text);
    for (const auto& [key, value] : parsed.root().members()) {
        uint32_t id = 0;
        const char* const end = key.data() + key.size();
        if (const auto [at, fault] = std::from_chars(key.data(), end, id); fault != std::errc() || at != end)
            throw value.error("expected a number as its key");
        names.emplace(id, value.to_string());
    }
}

} // namespace

void unite_id_names(const ExrMetadata& from, ExrMetadata& to) {
    for (auto& [name, value] : to) {
        auto* const text = std::get_if<std::string>(&value);
        if (text == nullptr || (name != "pertev.instances" && name != "pertev.materials")) continue;
        const auto other = std::ranges::find(from, name, &ExrMetadata::value_type::first);
        if (other == from.end() || other->second == value) continue;
        const auto* const more = std::get_if<std::string>(&other->second);
        if (more == nullptr) continue;
        std::map<uint32_t, std::string> names;
        take_names(*text, names);
        take_names(*more, names);
        std::vector<std::string> members;
        for (const auto& [id, named] : names) members.push_back(fmt::format("\"{}\":{}", id, json_string(named)));
        *text = fmt::format("{{{}}}", fmt::join(members, ","));
    }
}

} // namespace pertev
