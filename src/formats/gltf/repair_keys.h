#pragma once

// Repairs the key times of a file for a channel: finite and ascending.

#include <cstddef>
#include <string>

#include "scene/animation.h"

namespace pertev::gltf {

/// Sorts the keys of `channel`, each with `numbers_a_key` numbers, by time, and removes those whose time is not
/// finite. Two keys at one time are a jump from the first to the last of them. At the ends, where no jump is
/// possible, the key next to the others counts, and for step interpolation the last. Returns what was repaired, for a
/// warning; empty if nothing was.
std::string repair_keys(AnimationChannel& channel, std::size_t numbers_a_key);

} // namespace pertev::gltf
