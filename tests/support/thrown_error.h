#pragma once

// The Error that something throws, so that its code and text can both be looked at.

#include <optional>

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

} // namespace pertev::test
