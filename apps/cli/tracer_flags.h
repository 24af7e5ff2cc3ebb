#pragma once

// How pictures find what rays meet, as flags: --build, --structure, --walk and their switches. None changes the
// picture. --build says which tree stands behind all rays; --structure names one for some or all of them exactly, and
// goes before it.

#include <optional>
#include <string>
#include <vector>

#include "tracer/tracer_choice.h"

namespace CLI {
class App;
}

namespace pertev {

/// Each is "NAME" for all rays, or "KIND=NAME" for camera, bounce or shadow rays; the last that names a ray counts.
struct TracerFlags {
    std::string build; // empty: default_build
    TreeBuild default_build = kDefaultBuild;
    std::vector<std::string> structures, walks, rta, order, distributions;

    bool are_empty() const {
        return build.empty() && structures.empty() && walks.empty() && rta.empty() && order.empty() &&
               distributions.empty();
    }
};

void add_tracer_flags(CLI::App& verb, TracerFlags& flags, const char* group);

/// Whether a better tree than --build asks for will do: where no --structure names one.
inline bool may_be_better(const TracerFlags& flags) { return flags.structures.empty(); }

/// What the flags ask for, the device's default where they say nothing; nothing at all where that is no other than its
/// default. Throws Error(BadInput) where pictures cannot be traced so.
std::optional<TracerChoice> tracer_choice(const TracerFlags& flags, bool on_cuda);

} // namespace pertev
