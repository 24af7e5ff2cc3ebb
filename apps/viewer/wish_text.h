#pragma once

// This puts what a client that does not steer tried to do into words for the one that steers.

#include <string>

#include "apps/viewer/client_message.h"

namespace pertev {

/// Returns the end of a sentence that begins with "viewer 2 would like to". Empty where the message steers nothing.
std::string wish_text(const ClientMessage& message);

} // namespace pertev
