#pragma once

// Secrets of the viewer: unguessable random text, and a comparison in constant time.

#include <string>
#include <string_view>

namespace pertev {

/// Returns `bytes` random bytes of the system as hexadecimal digits. Throws Error(DeviceFault) if the system has
/// none.
std::string make_token(int bytes = 16);

/// Returns the token in `file` or, without one, of $PERTEV_TOKEN, without white space at its end; empty if neither is
/// given. Throws Error(BadInput) if it is too short to be a secret or has characters that an address has to escape.
std::string given_token(const std::string& file);

/// Returns whether both texts are equal. The time depends only on the length of `given`, never on how much of it
/// matches.
bool equal_in_constant_time(std::string_view given, std::string_view secret);

} // namespace pertev
