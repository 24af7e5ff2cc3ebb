#pragma once

// Secrets of the viewer: random text that a stranger cannot guess, and a comparison that tells nothing by how long it
// takes.

#include <string>
#include <string_view>

namespace pertev {

/// `bytes` random bytes of the system as hexadecimal digits. Throws Error(DeviceFault) where the system has none.
std::string make_token(int bytes = 16);

/// Whether both are the same text. The time depends on the length of `given` alone, never on how much of it is right.
bool equal_in_constant_time(std::string_view given, std::string_view secret);

} // namespace pertev
