#pragma once

// Groups of materials that are shaded by the same code, by which a GPU sorts hits.

#include <cstdint>
#include <span>
#include <vector>

#include "scene/material.h"

namespace pertev {

/// Greatest number of a shading group.
inline constexpr uint8_t kMaxShadingGroup = 30;

/// Returns the shading group of each material, [1, kMaxShadingGroup]: materials of one group have the same kinds of
/// lobes and textures, so that threads which shade them run the same code, and the groups of similar ones are adjacent.
/// If a scene has more kinds, the last group has the rest.
std::vector<uint8_t> shading_groups(std::span<const MaterialParameters> materials);

} // namespace pertev
