#pragma once

// How much of a picture the camera sees through the backs of surfaces that hide them.

#include "device/queue.h"
#include "render/picture_view.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// Share of the camera's rays, in [0, 1], that pass the back of a surface that is not double sided; of 4096 spread over
/// the picture, which no setting changes: each is traced with such backs and without. Costs nothing where there is
/// none. Throws Error(DeviceFault).
double hidden_back_share(Queue& queue, SceneTracer& tracer, const PictureView& picture);

} // namespace pertev
