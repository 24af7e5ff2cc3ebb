#pragma once

// The share of a picture that the camera sees through culled back faces.

#include "device/queue.h"
#include "render/picture_view.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// Returns the share of camera rays, in [0, 1], that pass through the back of a single-sided surface. It traces 4096
/// rays over the picture, independently of all settings, with and without such back faces. It does nothing if there are
/// none. Throws Error(DeviceFault).
double hidden_back_share(Queue& queue, SceneTracer& tracer, const PictureView& picture);

} // namespace pertev
