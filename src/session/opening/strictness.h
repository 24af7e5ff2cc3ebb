#pragma once

// The setting `strict`: anything missing after a scene was read is an error.

#include "base/messages.h"

namespace pertev {

/// Throws Error(BadInput) that repeats the first warning of something left out. `outcome` ends the message, such as
/// "nothing is rendered".
void refuse_what_is_left_out(const Messages& messages, const char* outcome);

} // namespace pertev
