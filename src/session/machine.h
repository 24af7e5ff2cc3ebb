#pragma once

// The device to render on, by the setting `device` (auto, cpu, cuda or cuda:N), and the threads of the CPU.

#include <future>
#include <memory>
#include <optional>
#include <string>

#include "base/sink.h"
#include "device/queue.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns the queue of the named device, with its own threads if their number is given. `auto` is the first working
/// CUDA device, else the CPU with a notice of the reason; `cpu` never touches CUDA. Throws Error(BadInput) with the
/// reason if the device cannot be used.
std::unique_ptr<Queue> open_queue(const MachineOptions& options, Sink& sink);

/// Takes the machine while its user reads a scene, because starting a GPU's driver takes as long as that. If there is
/// no driver, a named GPU is refused at once; everything else is known later.
class StartingMachine {
public:
    /// Starts to take the machine; `sink` outlives it. Throws as open_queue.
    StartingMachine(const MachineOptions& options, Sink& sink);

    /// The threads of the queue, which may read the scene too.
    const Threads& threads() const { return threads_; }

    /// Waits until the device is known. Throws Error(BadInput) if a named GPU cannot be used.
    bool is_cuda();
    /// Returns whether the device may be a GPU, without waiting for a driver: true if that is not known yet but a
    /// driver's library exists. Data made for a GPU may then turn out to be unused, and a named GPU may still be
    /// refused.
    bool may_be_cuda();
    /// Waits for the queue; must be called once. Throws Error(BadInput, DeviceFault).
    std::unique_ptr<Queue> take();

private:
    std::string name_;
    Sink& sink_;
    Threads threads_;
    std::future<std::string> why_no_gpu_;
    std::future<std::unique_ptr<Queue>> coming_;
    std::unique_ptr<Queue> queue_; // the CPU's queue, if the CPU is named
    std::optional<bool> is_cuda_;
};

} // namespace pertev
