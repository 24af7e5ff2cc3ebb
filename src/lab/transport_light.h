#pragma once

// Which light each integrator finds, for the laboratory's tables: in Heckbert's letters (docs/transport.md).

#include <string>
#include <vector>

#include "scene/scene.h"

namespace pertev {

inline constexpr const char* kAllLight = "all";

/// Every integrator that finds light of its own (not direct and indirect, which are parts of path).
std::vector<std::string> transport_integrators();
/// Which light that integrator finds in a scene; kAllLight where it finds all without bias; empty where there is no
/// such integrator.
std::string light_of(const std::string& integrator, const Scene& scene);

/// Why no solution of that scene's diffuse light can be had; empty: it may be.
std::string why_no_solution(const Scene& scene);

/// The integrator that the reference of a scene is made by where nobody says which: path, or bidirectional where point,
/// spot or directional lights shine through glass or on mirrors, which path cannot see the light of.
std::string default_reference_integrator(const Scene& scene);
/// What a reference made by that integrator cannot have; empty: nothing is known to be missing.
std::string light_lacking(const std::string& integrator, const Scene& scene);

} // namespace pertev
