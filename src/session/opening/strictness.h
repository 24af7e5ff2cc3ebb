#pragma once

// The setting `strict`: anything missing after a scene was read is an error, and so are samples that are not finite.

#include <cstdint>

#include "base/sink.h"

namespace pertev {

/// Throws Error(BadInput) that repeats the first warning of something left out. `outcome` ends the message, such as
/// "nothing is rendered".
void refuse_what_is_left_out(const Messages& messages, const char* outcome);

/// Throws Error(BadInput) if there are any samples that are not finite in a picture that has been written.
void refuse_invalid_samples(uint64_t count);

} // namespace pertev
