#pragma once

// The devices to render on, by the setting `device` (session/devices/device_names.h), and the threads of the CPU.

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/sink.h"
#include "device/queue.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns the queue of the named device, with its own threads if their number is given. `auto` is the first working
/// CUDA device, else the CPU with a notice of the reason; `cpu` never touches CUDA. Throws Error(BadInput) with the
/// reason if the device cannot be used, and if several are named.
std::unique_ptr<Queue> open_queue(const MachineOptions& options, Sink& sink);
/// Returns the queues of all named devices, the one with the most memory first. GPUs share the threads; several CPUs
/// get equal parts of them. Throws as open_queue.
std::vector<std::unique_ptr<Queue>> open_queues(const MachineOptions& options, Sink& sink);

/// Takes the machine while its user reads a scene, because starting a GPU's driver takes as long as that. If there is
/// no driver, a named GPU is refused at once; everything else is known later.
class StartingMachine {
public:
    enum class Takes { OneDevice, AllNamed };
    /// Starts to take the machine; `sink` outlives it. Throws as open_queue or open_queues.
    StartingMachine(const MachineOptions& options, Sink& sink, Takes takes = Takes::OneDevice);

    /// The threads of the queue, which may read the scene too.
    const Threads& threads() const { return threads_; }

    /// Waits until the devices are known. Returns whether one is a GPU. Throws Error(BadInput) if a named GPU cannot be
    /// used.
    bool is_cuda();
    /// Returns whether the device may be a GPU, without waiting for a driver: true if that is not known yet but a
    /// driver's library exists. Data made for a GPU may then turn out to be unused, and a named GPU may still be
    /// refused.
    bool may_be_cuda();
    /// Waits for the queues of all devices and returns them. This or take() must be called once. Throws Error(BadInput,
    /// DeviceFault).
    std::vector<std::unique_ptr<Queue>> take_all();
    std::unique_ptr<Queue> take() { return std::move(take_all().front()); }

private:
    void start_list();

    std::string name_;
    Sink& sink_;
    Threads threads_;
    std::future<std::string> why_no_gpu_;
    std::future<std::vector<std::unique_ptr<Queue>>> coming_;
    std::vector<std::unique_ptr<Queue>> queues_; // the CPU's queues, if only it is named
    std::optional<bool> is_cuda_;
};

} // namespace pertev
