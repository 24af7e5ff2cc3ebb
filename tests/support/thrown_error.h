#pragma once

// Catches the Error that a call throws, for tests of its code and parts.

#include <doctest/doctest.h>

#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"

namespace pertev::test {

template <class Body>
std::optional<Error> thrown_error(const Body& body) {
    try {
        body();
    } catch (const Error& error) {
        return error;
    }
    return std::nullopt;
}

/// Returns whether the error has this code and is about this setting, with this value unless that is empty.
inline bool is_about(const std::optional<Error>& error, ErrorCode code, std::string_view setting,
                     std::string_view value = {}) {
    return error && error->code() == code && error->setting() == setting && (value.empty() || error->value() == value);
}

/// Returns whether the error has this code and names this position in a file.
inline bool is_at(const std::optional<Error>& error, ErrorCode code, const FileLocation& place) {
    return error && error->code() == code && error->location() == place;
}

inline bool says(const std::optional<Error>& error, const std::string& text) {
    return error && std::string(error->what()).find(text) != std::string::npos;
}

/// Returns the text of the BadInput that `body` throws; "no error" if it throws nothing. Another code fails the test.
template <class Body>
std::string bad_input_message(const Body& body) {
    const std::optional<Error> error = thrown_error(body);
    if (!error) return "no error";
    CHECK(error->code() == ErrorCode::BadInput);
    return error->what();
}

} // namespace pertev::test
