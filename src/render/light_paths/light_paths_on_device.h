#pragma once

// Device copy of LightPathLayers.

#include "device/buffer.h"
#include "render/light_paths/light_path_layers.h"
#include "render/light_paths/light_path_view.h"

namespace pertev {

class LightPathsOnDevice {
public:
    /// Uploads layers; `queue` outlives them. Throws Error(OutOfMemory).
    LightPathsOnDevice(Queue& queue, const LightPathLayers& layers);

    /// View for a film with the auxiliary groups `aovs`.
    LightPathView view(uint32_t aovs) const;

private:
    Buffer<uint16_t> columns_, next_, surface_tags_, instance_lights_, scene_lights_;
    Buffer<uint32_t> layers_;
    LightPathView view_;
};

} // namespace pertev
