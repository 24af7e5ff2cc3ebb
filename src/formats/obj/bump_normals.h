#pragma once

// Converts the height maps of an .mtl file (map_bump, bump) to tangent-space normal maps. The format does not say how
// high a bump is; here white with -bm 1 is kBumpHeight of the picture's longer side above black. So bumps look the same
// at each resolution and in each unit.

#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace pertev {

/// Height of white above black for -bm 1, as a share of the picture's longer side.
inline constexpr float kBumpHeight = 0.02f;

/// A normal_texture that may have an image of heights.
struct BumpUse {
    uint32_t material; // index into Scene::materials
    char channel;      // -imfchan: r, g or b; any other means the brightness
};

/// Returns the normals of `heights`: as 8-bit values if the heights are, else as floats. Heights outside the picture
/// are those that `wrap` continues it with. A height that is not finite makes the normals around it (0, 0, 1).
TextureImage normals_of_heights(const TextureImage& heights, char channel, Wrap wrap);

/// Replaces the image of each use by its normals, unless it holds normals already. Returns for each use whether it was
/// replaced. Images that nothing uses any more are removed, and all textures of `scene` renumbered.
std::vector<bool> convert_bumps(std::span<const BumpUse> uses, Scene& scene);

} // namespace pertev
