#pragma once

// Every integrator there is, and the settings of each: this file and its .cpp alone know them all.

#include <cstdint>
#include <memory>

#include "integrators/integrator.h"
#include "integrators/path/path_settings.h"

namespace pertev {

enum class IntegratorKind : uint8_t { Path };

struct IntegratorSettings {
    IntegratorKind integrator = IntegratorKind::Path;
    PathSettings path;

    // How the device does it: the light stays the same.
    PathBody body = PathBody::Loop; // CUDA always takes Wavefront
    uint32_t batch = 5u << 19;      // most paths in flight of wavefronts, 228 bytes each
};

/// Whether both give the same samples.
bool same_light(const IntegratorSettings& a, const IntegratorSettings& b);

/// `queue` outlives it.
std::unique_ptr<Integrator> make_integrator(Queue& queue, const IntegratorSettings& settings);

/// Gives `integrator`, which has the settings `from`, the settings `to`, and lets it keep its memory; begin() must come
/// next. False, and nothing done, where that takes another integrator.
bool change_settings(Integrator& integrator, const IntegratorSettings& from, const IntegratorSettings& to);

/// Bytes of the device's memory that it takes for `samples` of each of `pixels`. `walks_itself`: its tracers are such
/// that a loop may walk them ray by ray (can_walk_on_host).
std::size_t predicted_bytes(const IntegratorSettings& settings, uint64_t pixels, uint32_t samples, bool on_cuda,
                            bool walks_itself);

} // namespace pertev
