#pragma once

// From one irradiance a patch to what is shown: at each corner the mean of the patches that meet there, so that light
// changes evenly over the surface. Where a patch meets two smaller ones along an edge, the corner in the middle of that
// edge gets the mean of its ends, so that no gap shows.
//
// Source: Goral et al. 1984, section 6; hanging corners: Baum, Mann, Smith, Winget, "Making Radiosity Usable", SIGGRAPH
// 1991 (anchoring).

#include <span>
#include <vector>

#include "radiosity/patches.h"
#include "radiosity/radiosity_view.h"

namespace pertev {

/// `irradiance`: of each of the tree's patches. Corners are one where they lie at one place and their patches' normals
/// are 30 degrees apart at most, about (radiosity/corner_table.h); whatever the scene's size, in n log n of its
/// patches.
std::vector<PatchLight> light_corners(const SceneView& scene, const PatchTree& tree, std::span<const Rgb> irradiance);

} // namespace pertev
