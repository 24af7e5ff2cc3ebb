#pragma once

// Renders a batch of pictures by several devices, each of which takes chunks of cameras. Each picture has the bytes
// that its camera gives alone.

#include "session/batch_render.h"
#include "session/devices/render_on_devices.h"

namespace pertev {

struct SharedBatch {
    RayCounts rays;
    uint64_t invalid_samples = 0;
};

/// Renders all pictures of `batch` by the devices of `together` into `arrays`, which lie on the device of `pictures`,
/// the caller's, and get all of them (BatchArrays::fit). A chunk has at most `at_once` pictures, and there are several
/// for each device. Chunks of a device that fails, or that has too little memory, are rendered by the others, with a
/// warning. Progress goes to `sink`; when that stops, arrays are incomplete. Throws as BatchRender, and Error if no
/// device is left.
SharedBatch render_batch(RenderOnDevices& together, PictureRenderer& pictures, const CameraBatch& batch,
                         const RenderSettings& settings, uint32_t at_once, BatchArrays& arrays, Sink& sink);

} // namespace pertev
