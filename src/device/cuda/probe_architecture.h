#pragma once

// A kernel that is never launched: whether CUDA finds code of it for the present GPU tells whether this binary can
// run there.

namespace pertev {

/// Returns whether this binary holds code for the current CUDA device.
bool has_code_for_current_device();

} // namespace pertev
