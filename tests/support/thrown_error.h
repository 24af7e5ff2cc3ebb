#pragma once

// The Error that something throws, so that its code and text can both be looked at.

#include <doctest/doctest.h>

#include <optional>
#include <string>

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

inline bool says(const std::optional<Error>& error, const std::string& text) {
    return error && std::string(error->what()).find(text) != std::string::npos;
}

/// What is said where `body` throws BadInput; "no error" where it throws nothing. Another code fails the test.
template <class Body>
std::string bad_input_message(const Body& body) {
    const std::optional<Error> error = thrown_error(body);
    if (!error) return "no error";
    CHECK(error->code() == ErrorCode::BadInput);
    return error->what();
}

} // namespace pertev::test
