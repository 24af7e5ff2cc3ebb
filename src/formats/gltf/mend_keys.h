#pragma once

// Key times as files have them, made such as a channel takes them: finite and in order.

#include <cstddef>
#include <string>

#include "scene/animation.h"

namespace pertev::gltf {

/// Brings the keys of `channel`, each of `numbers_a_key` numbers, into the order of their times, without those whose
/// time is not finite. Two keys at one time are a jump from the first to the last of them. At the ends there is nothing
/// to jump from or to: there the key counts that adjoins the others, and of steps the last. Returns what was mended,
/// for a warning; empty where there was nothing to mend.
std::string mend_keys(AnimationChannel& channel, std::size_t numbers_a_key);

} // namespace pertev::gltf
