#pragma once

// Computes the displayed light from one irradiance per patch: at each corner the mean of the patches that meet there,
// so that light varies continuously over the surface. Where a patch meets two smaller ones along an edge, the corner
// in the middle of that edge gets the mean of its ends, so that no gap is visible.
//
// Source: Goral et al. 1984, section 6; hanging corners: Baum, Mann, Smith, Winget, "Making Radiosity Usable", SIGGRAPH
// 1991 (anchoring).

#include <span>
#include <vector>

#include "radiosity/patches.h"
#include "radiosity/radiosity_view.h"

namespace pertev {

/// Computes the light at the corners of patches. `irradiance` is [patch of the tree]. Corners are merged if they have
/// the same position and their patches' normals differ by at most about 30 degrees (radiosity/corner_table.h). Takes n
/// log n time in the number of patches, whatever the scene's size.
std::vector<PatchLight> light_corners(const SceneView& scene, const PatchTree& tree, std::span<const Rgb> irradiance);

} // namespace pertev
