#pragma once

// The light paths that each integrator finds, in Heckbert's notation, for the laboratory's tables
// (docs/transport.md).

#include <string>

#include "scene/scene.h"

namespace pertev {

inline constexpr const char* kAllLight = "all";

/// Describes the light that an integrator finds in a scene: kAllLight if it finds all without bias; empty if there is
/// no such integrator.
std::string light_of(const std::string& integrator, const Scene& scene);

/// Returns why the scene's diffuse light cannot be solved; empty if it may be.
std::string why_no_solution(const Scene& scene);

/// Returns the integrator that renders a scene's reference by default: path, or bidirectional if point, spot or
/// directional lights shine through glass or on mirrors, because path cannot find that light.
std::string default_reference_integrator(const Scene& scene);
/// Describes the light that a reference by this integrator misses; empty if none is known.
std::string light_lacking(const std::string& integrator, const Scene& scene);

} // namespace pertev
