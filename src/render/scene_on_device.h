#pragma once

// A prepared scene in a device's memory: owns the buffers, hands out the view.

#include <vector>

#include "device/buffer.h"
#include "render/prepare_scene.h"
#include "render/scene_view.h"

namespace pertev {

class SceneOnDevice {
public:
    /// Copies everything; `prepared` and its scene may go away afterwards. Throws Error(OutOfMemory).
    SceneOnDevice(Queue& queue, const PreparedScene& prepared);

    const SceneView& view() const { return view_; }

private:
    void upload_meshes(Queue& queue, const Scene& scene);
    void upload_instances(Queue& queue, const PreparedScene& prepared);
    void upload_images(Queue& queue, const Scene& scene);
    void upload_lights(Queue& queue, const LightSetData& lights);

    template <class T>
    const T* keep(Queue& queue, std::span<const T> values, const std::string& name);

    SceneView view_{};
    std::vector<Buffer<std::byte>> buffers_;
};

/// Bytes that SceneOnDevice will ask for.
std::size_t predicted_bytes(const PreparedScene& prepared);

} // namespace pertev
