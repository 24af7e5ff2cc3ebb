#pragma once

// --device: auto, cpu, cuda or cuda:N.

#include <memory>
#include <string>

#include "base/messages.h"
#include "device/queue.h"

namespace pertev {

/// The queue of the device named. `auto` takes the first CUDA device that works, else the CPU with a notice that says
/// why; `cpu` never touches CUDA. Throws Error(BadInput) with the reason when the device named cannot be used.
std::unique_ptr<Queue> choose_device(const std::string& name, Messages& messages);

} // namespace pertev
