#pragma once

// The flags of radiosity: how it is solved, for pertev solve and for pictures, and how a solution is shown.

#include <cstddef>
#include <cstdint>
#include <optional>

#include "apps/cli/reporter.h"
#include "radiosity/solve_radiosity.h"
#include "settings/picture_options.h"

namespace pertev {

/// What they ask for. Throws Error(BadInput) where flags do not go together.
RadiositySettings radiosity_settings(const RadiosityOptions& options, uint32_t seed);
/// Throws Error(BadInput) for a solution that is not there, and for --max-memory with another integrator, but where the
/// verb `limits_memory` of all integrators.
void check_radiosity_flags(const RadiosityOptions& options, const RenderSettings& settings, bool limits_memory);
/// --max-memory in bytes.
std::optional<std::size_t> max_memory_bytes(const RadiosityOptions& options);

/// Solves the scene; says what it will take before, how far it is, and what came of it. Listens for Ctrl-C. Throws
/// Error(OutOfMemory) where it may take more of this machine's memory than `options` allow, or than there is.
SolvedRadiosity solve_and_report(const PreparedScene& prepared, const RadiosityOptions& options, uint32_t seed,
                                 Reporter& reporter);

/// What a picture shows: the solution of --solution, or one that is made now. Throws Error(Interrupted) where that was
/// interrupted.
RadiosityLook radiosity_look(const RadiosityOptions& options, const PreparedScene& prepared, uint32_t seed,
                             Reporter& reporter);

} // namespace pertev
