#pragma once

// A kernel launched for nothing but to learn whether this binary can run on the GPU that is here.

namespace pertev {

/// Whether this binary holds code for the current CUDA device.
bool has_code_for_current_device();

} // namespace pertev
