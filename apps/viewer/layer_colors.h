#pragma once

// Layers of a picture in colours to look at: reflectance as it is, directions by their axes, distances and counts from
// dark to bright, ids each in a colour of its own.

#include <span>

#include "image/image.h"
#include "render/film_view.h"
#include "trace/traversal/walk_counter.h"

namespace pertev {

/// Linear reflectance, encoded as sRGB.
Rgba8Image show_albedo(const Image& albedo);
/// x, y, z in [-1, 1] as red, green, blue; black where nothing is.
Rgba8Image show_normal(const Image& normal);
/// The nearest is bright; by the logarithm of the distance between the nearest and the farthest. Black: nothing is
/// there.
Rgba8Image show_depth(const Image& depth);
enum class IdKind : uint8_t { Instance, Primitive, Material };
/// Black where nothing is.
Rgba8Image show_ids(std::span<const PixelIds> ids, uint32_t width, uint32_t height, IdKind kind);
enum class WorkKind : uint8_t { Nodes, Triangles };
/// Pale yellow at `most` and above, dark at none (lab/heat_map.h); `most` is what one pixel in two hundred exceeds.
Rgba8Image show_work(std::span<const RayWork> work, uint32_t width, uint32_t height, WorkKind kind, uint32_t& most);

/// Of two channels, pixels to the right and down: grey stands still, red goes to the right, green down, and blue what
/// is left of both; full at `most`, what one pixel in two hundred exceeds, at least 1.
Rgba8Image show_motion(const Image& motion, float& most);
/// Dark at none, pale yellow at `most` and above: what one pixel in two hundred of those exceeds that are below 1000.
Rgba8Image show_deviation(const Image& deviation, float& most);

} // namespace pertev
