#pragma once

// Describes the attempt of a client that does not steer to the one that steers.

#include <string>

#include "apps/viewer/client_message.h"

namespace pertev {

/// Returns the end of a sentence that begins with "viewer 2 would like to"; empty if the message steers nothing.
std::string request_text(const ClientMessage& message);

} // namespace pertev
