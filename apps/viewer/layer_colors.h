#pragma once

// Colours for layers of a picture: reflectance as it is, directions by their axes, distances and counts from dark to
// bright, ids in distinct colours.

#include <span>

#include "image/image.h"
#include "render/film_view.h"
#include "trace/traversal/traversal_counter.h"

namespace pertev {

/// Linear reflectance, encoded as sRGB.
Rgba8Image show_albedo(const Image& albedo);
/// x, y, z in [-1, 1] as red, green, blue; black for no hit.
Rgba8Image show_normal(const Image& normal);
/// The nearest point is brightest, on a logarithmic scale to the farthest. Black for no hit.
Rgba8Image show_depth(const Image& depth);
enum class IdKind : uint8_t { Instance, Primitive, Material };
/// Distinct colours; black for no hit.
Rgba8Image show_ids(std::span<const PixelIds> ids, uint32_t width, uint32_t height, IdKind kind);
enum class WorkKind : uint8_t { Nodes, Triangles };
/// Returns colours that are pale yellow at `most` and above, dark at zero (lab/heat_map.h); sets `most` to the value
/// that one pixel in two hundred exceeds.
Rgba8Image show_work(std::span<const RayWork> work, uint32_t width, uint32_t height, WorkKind kind, uint32_t& most);

/// Two channels, pixels to the right and down: grey means no motion, red to the right, green down, and blue the
/// opposite of both; saturated at `most`, which one pixel in two hundred exceeds, at least 1.
Rgba8Image show_motion(const Image& motion, float& most);
/// Returns colours that are dark at zero, pale yellow at `most` and above. Sets `most` to the value that one pixel in
/// two hundred of those below 1000 exceeds.
Rgba8Image show_deviation(const Image& deviation, float& most);

} // namespace pertev
