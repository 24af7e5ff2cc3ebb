#pragma once

// What a verb renders on: --device auto, cpu, cuda or cuda:N, and --threads.

#include <memory>
#include <string>

#include "base/messages.h"
#include "device/queue.h"

namespace CLI {
class App;
}

namespace pertev {

/// The queue of the device named. `auto` takes the first CUDA device that works, else the CPU with a notice that says
/// why; `cpu` never touches CUDA. Throws Error(BadInput) with the reason when the device named cannot be used.
std::unique_ptr<Queue> choose_device(const std::string& name, Messages& messages);

struct MachineFlags {
    std::string device = "auto";
    int threads = 0; // 0: all
};

void add_machine_flags(CLI::App& verb, MachineFlags& flags, const char* group = "Options");
/// Sets the number of threads, and gives the device's queue as choose_device does.
std::unique_ptr<Queue> take_machine(const MachineFlags& flags, Messages& messages);

} // namespace pertev
