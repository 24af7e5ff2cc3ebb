#pragma once

// The device to render on, by the setting `device` (auto, cpu, cuda or cuda:N), and the threads of the CPU.

#include <future>
#include <memory>
#include <optional>
#include <string>

#include "base/messages.h"
#include "device/queue.h"
#include "settings/picture_options.h"

namespace pertev {

/// The queue of the device named. `auto` takes the first CUDA device that works, else the CPU with a notice that says
/// why; `cpu` never touches CUDA. Throws Error(BadInput) with the reason when the device named cannot be used.
std::unique_ptr<Queue> choose_device(const std::string& name, Messages& messages);

/// Sets the number of threads that work for the calling thread, and returns the device's queue as choose_device does.
std::unique_ptr<Queue> take_machine(const MachineOptions& options, Messages& messages);

/// Does the same while its user reads a scene, because a GPU's driver takes as long to start as that does. If there is
/// no driver, a GPU that is named is refused at once; all else is known later.
class ComingMachine {
public:
    /// Throws as choose_device. `messages` outlives it.
    ComingMachine(const MachineOptions& options, Messages& messages);

    /// Waits until that is known. Throws Error(BadInput) where a GPU that is named cannot be used.
    bool is_cuda();
    /// As is_cuda, but waits for no driver: true where that is not known yet, but a driver's library is there. What is
    /// made for a GPU then may turn out to be of no use, or a GPU that is named be refused later.
    bool may_be_cuda();
    /// Waits for it; to be called once. Throws Error(BadInput, DeviceFault).
    std::unique_ptr<Queue> take();

private:
    std::string name_;
    Messages& messages_;
    std::future<std::string> why_no_gpu_;
    std::future<std::unique_ptr<Queue>> coming_;
    std::unique_ptr<Queue> queue_; // the CPU's, where that is named
    std::optional<bool> is_cuda_;
};

} // namespace pertev
