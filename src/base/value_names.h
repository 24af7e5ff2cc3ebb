#pragma once

// Names of enumerators: a table beside each enumeration, which names_of_all() returns. The functions below search it;
// they work for every enumeration with such a function in its namespace.

#include <array>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pertev {

template <class Value>
struct ValueName {
    Value value;
    std::string_view name;
};

template <class Value>
concept NamedValue = requires(Value value) { names_of_all(value)[0].name; };

/// Returns the name, or "" for a value that is not in the table.
template <NamedValue Value>
constexpr std::string_view name_of(Value value) {
    for (const auto& entry : names_of_all(value)) {
        if (entry.value == value) return entry.name;
    }
    return "";
}

template <NamedValue Value>
constexpr std::optional<Value> value_named(std::string_view name) {
    for (const auto& entry : names_of_all(Value{})) {
        if (entry.name == name) return entry.value;
    }
    return std::nullopt;
}

/// The values in the order of the table.
template <NamedValue Value>
inline constexpr auto kValuesOf = [] {
    std::array<Value, std::size(names_of_all(Value{}))> values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = names_of_all(Value{})[i].value;
    return values;
}();

/// Returns the names in the order of the table.
template <NamedValue Value>
std::vector<std::string> names_of() {
    std::vector<std::string> names;
    for (const auto& entry : names_of_all(Value{})) names.emplace_back(entry.name);
    return names;
}

} // namespace pertev
