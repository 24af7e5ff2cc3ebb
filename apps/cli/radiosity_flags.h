#pragma once

// The flags of radiosity: how it is solved, for pertev solve and for pictures, and how a solution is shown.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "apps/cli/reporter.h"
#include "radiosity/solve_radiosity.h"
#include "session/render_settings.h"

namespace CLI {
class App;
}

namespace pertev {

/// 0 and empty: not given.
struct RadiosityFlags {
    float patch_size = 0, contrast = 0, tolerance = 0, link_error = 0;
    std::optional<uint32_t> subdivisions;
    uint32_t rays = 0, hemicube = 0, steps = 0;
    std::string form_factors, solver;
    std::string solution; // of pictures: a file
    bool flat_patches = false;
    double max_memory = 0; // MiB; of pictures by any integrator too
};

/// How it is solved.
void add_solving_flags(CLI::App& verb, RadiosityFlags& flags, const char* group);
/// Those, and how it is shown.
void add_radiosity_flags(CLI::App& verb, RadiosityFlags& flags, const char* group);

/// What they ask for. Throws Error(BadInput) where flags do not go together.
RadiositySettings radiosity_settings(const RadiosityFlags& flags, uint32_t seed);
/// Throws Error(BadInput) where one is given to another integrator, called `name`, or to a solution that is there; but
/// for --max-memory, where the verb `limits_memory` of all integrators.
void check_radiosity_flags(const RadiosityFlags& flags, IntegratorKind integrator, const std::string& name,
                           bool limits_memory);
/// --max-memory in bytes.
std::optional<std::size_t> max_memory_bytes(const RadiosityFlags& flags);

/// Solves the scene; says what it will take before, how far it is, and what came of it. Listens for Ctrl-C. Throws
/// Error(OutOfMemory) where it may take more of this machine's memory than `flags` allow, or than there is.
SolvedRadiosity solve_and_report(const PreparedScene& prepared, const RadiosityFlags& flags, uint32_t seed,
                                 Reporter& reporter);

/// What a picture shows: the solution of --solution, or one that is made now. Throws Error(Interrupted) where that was
/// interrupted.
RadiosityLook radiosity_look(const RadiosityFlags& flags, const PreparedScene& prepared, uint32_t seed,
                             Reporter& reporter);

} // namespace pertev
