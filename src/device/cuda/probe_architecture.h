#pragma once

namespace pertev {

/// Whether this binary holds code for the current CUDA device.
bool has_code_for_current_device();

} // namespace pertev
