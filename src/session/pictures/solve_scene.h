#pragma once

// Solves a scene's radiosity as the options say, or reads the solution that they name.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "base/sink.h"
#include "integrators/radiosity/radiosity_display_settings.h"
#include "radiosity/solve_memory.h"
#include "radiosity/solve_radiosity.h"
#include "settings/picture_options.h"

namespace pertev {

/// Functions for reports that a Sink does not take. Each may be empty.
struct SolveReport {
    std::function<void(const SolveMemory& memory, float patch_size_m)> begin; // before the memory is taken
    std::function<void(const SolvedRadiosity& solved)> end;
};

/// `max_memory` in bytes; none if it was not given.
std::optional<std::size_t> max_memory_bytes(const RadiosityOptions& options);

/// Solves the scene until it is done or the sink stops it. Throws as solve_radiosity, and Error(OutOfMemory) if it
/// may need more of this machine's memory than the options allow, or than there is.
SolvedRadiosity solve_scene(const PreparedScene& prepared, const RadiosityOptions& options, uint32_t seed, Sink& sink,
                            const SolveReport& report);

/// Returns the solution to show: that of the file in the options, or a new one. Throws as solve_scene and
/// read_solution, and Error(Interrupted) if solving was stopped.
RadiosityDisplay radiosity_display(const PreparedScene& prepared, const RadiosityOptions& options, uint32_t seed,
                                   Sink& sink, const SolveReport& report);

} // namespace pertev
