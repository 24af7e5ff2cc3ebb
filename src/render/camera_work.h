#pragma once

// Traversal cost of camera rays: nodes and triangles tested for each pixel, for false-colour pictures.

#include <vector>

#include "device/queue.h"
#include "render/picture_view.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// Counts the work of the ray through the middle of each pixel and of the lens, row by row, by the tracer of camera
/// rays, with every surface opaque. Returns an empty list if the counts would depend on the other rays of a warp.
/// Throws Error(OutOfMemory, DeviceFault).
std::vector<RayWork> count_camera_work(Queue& queue, const SceneTracer& tracer, const PictureView& picture);

} // namespace pertev
