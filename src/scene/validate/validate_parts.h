#pragma once

// The parts of validate().

#include <string>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// Clamps values to their ranges with a warning; throws Error(BadInput or OverLimit) for numbers that are not finite
/// and for indices out of range. Pixels that are not finite, or negative light, become 0, with a warning that counts
/// them.
void validate_materials(Scene& scene, const std::string& file, Sink& sink);

/// Checks nodes, skins and animations. Throws Error(BadInput) for an index out of range (including those of instances,
/// cameras and lights into the nodes), cycles of nodes, a number that is not finite, a quaternion of length 0, times
/// that do not ascend, and values that do not match their times.
void validate_nodes(const Scene& scene, const std::string& file);

/// Number of components of a channel's value; its target is in range.
std::size_t numbers_in_value(const AnimationChannel& channel, const Scene& scene);
/// Describes the fault of a channel whose target is in range, for messages; empty without a fault.
std::string fault_of(const AnimationChannel& channel, const Scene& scene);

} // namespace pertev
