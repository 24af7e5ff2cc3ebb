#pragma once

// The part of validate() for nodes, skins and animations.

#include <string>

#include "scene/scene.h"

namespace pertev {

/// Checks nodes, skins and animations. Throws Error(BadInput) for an index out of range (including those of instances,
/// cameras and lights into the nodes), cycles of nodes, a number that is not finite, a quaternion of length 0, times
/// that do not ascend, and values that do not match their times.
void validate_nodes(const Scene& scene, const std::string& file);

/// Number of components of a channel's value; its target is in range.
std::size_t numbers_in_value(const AnimationChannel& channel, const Scene& scene);
/// Describes what is wrong with a channel whose target is in range, for messages; empty if nothing is.
std::string fault_of(const AnimationChannel& channel, const Scene& scene);

} // namespace pertev
