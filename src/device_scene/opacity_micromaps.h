#pragma once

// Opacity micromaps (device_scene/micro_triangle.h) of a scene in device memory: one for each mesh with each material
// whose alpha has a texture. They are relative to triangles, so motion does not change them.

#include <cstdint>
#include <vector>

#include "device/buffer.h"
#include "device_scene/micro_triangle.h"
#include "device_scene/scene_view.h"
#include "scene/scene.h"

namespace pertev {

class OpacityMicromaps {
public:
    /// Makes the micromaps of `scene`, whose meshes, materials and textures are on the device in `view`.
    /// `have_changed` means that one of those has changed since the last call; otherwise only missing maps are made,
    /// thus none if each instance has the same mesh and material as before. Throws Error(OutOfMemory), after which
    /// there are none.
    void update(Queue& queue, const Scene& scene, const SceneView& view, bool have_changed);

    /// [instance] micromap; null if no instance has one.
    const OpacityMicromapView* of_instances() const { return of_instances_.data(); }

private:
    std::vector<uint64_t> made_for_; // mesh and material of each instance; empty if none are made
    Buffer<uint32_t> states_;
    Buffer<OpacityMicromapView> of_instances_;
};

} // namespace pertev
