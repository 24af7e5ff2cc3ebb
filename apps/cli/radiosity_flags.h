#pragma once

// The flags of radiosity: how it is solved, for pertev solve and for pictures, and how a solution is shown.

#include <cstddef>
#include <cstdint>
#include <optional>

#include "apps/cli/reporter.h"
#include "integrators/radiosity/radiosity_display_settings.h"
#include "radiosity/solve_radiosity.h"
#include "settings/picture_options.h"

namespace pertev {

/// The requested settings. Throws Error(BadInput) for incompatible flags.
RadiositySettings radiosity_settings(const RadiosityOptions& options, uint32_t seed);
/// Throws Error(BadInput) for a missing solution, and for --max-memory with another integrator unless the verb
/// `limits_memory` for all integrators.
void check_radiosity_flags(const RadiosityOptions& options, const RenderSettings& settings, bool limits_memory);
/// --max-memory in bytes.
std::optional<std::size_t> max_memory_bytes(const RadiosityOptions& options);

/// Solves the scene; reports the expected memory, the progress and the result. Listens for Ctrl-C. Throws
/// Error(OutOfMemory) if it may need more of this machine's memory than `options` allow, or than there is.
SolvedRadiosity solve_and_report(const PreparedScene& prepared, const RadiosityOptions& options, uint32_t seed,
                                 Reporter& reporter);

/// The solution of a picture: that of --solution, or a new one. Throws Error(Interrupted) if solving was interrupted.
RadiosityDisplay radiosity_display(const RadiosityOptions& options, const PreparedScene& prepared, uint32_t seed,
                                   Reporter& reporter);

} // namespace pertev
