#pragma once

// What the camera's rays cost: nodes and triangles tested for each pixel, for pictures of it in false colours.

#include <vector>

#include "device/queue.h"
#include "render/picture_view.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// Of the ray through the middle of each pixel and of the lens, row by row, by the tracer of camera rays, every surface
/// opaque. Empty where that walk cannot tell: the ray's company has a say in it. Throws Error(OutOfMemory,
/// DeviceFault).
std::vector<RayWork> count_camera_work(Queue& queue, const SceneTracer& tracer, const PictureView& picture);

} // namespace pertev
