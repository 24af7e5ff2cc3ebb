#pragma once

// pertev lab --transport

#include <cstdint>
#include <string>
#include <vector>

#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "device/queue.h"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace pertev {

inline constexpr uint32_t kTransportDepth = 8; // the default of max_depth

struct TransportFlags {
    std::string preset; // empty: SCENE, or where that is not given either, cornell
    std::vector<std::string> integrators;
    double seconds = 10;
    uint32_t repetitions = 4, max_samples = 1u << 16;
    std::string reference, reference_integrator, photon_search;
    uint32_t reference_samples = 0; // 0: by the device
};

/// Adds the flags that need --transport, except for --transport itself.
void add_transport_flags(CLI::App& verb, CLI::Option* transport, TransportFlags& flags);

/// Measures the scene of `options`, or the requested presets, and writes into the folder `output` unless it
/// is empty. Returns the exit status. Throws Error.
int run_transport_command(Queue& queue, const PictureOptions& options, const TransportFlags& flags,
                          const std::string& output, Reporter& reporter);

} // namespace pertev
