#pragma once

// The opacity micromaps (device_scene/micro_triangle.h) of a scene in a device's memory: one for each mesh under each
// material whose alpha is a texture's. They lie on triangles, not in the world, so nothing that moves changes them.

#include <cstdint>
#include <vector>

#include "device/buffer.h"
#include "device_scene/micro_triangle.h"
#include "device_scene/scene_view.h"
#include "scene/scene.h"

namespace pertev {

class OpacityMicromaps {
public:
    /// Makes them of `scene`, whose meshes, materials and textures lie on the device, as `view` says: all of them.
    /// `have_changed`: whether one of those is another than at the last call; else only what is new is done, which is
    /// nothing where each instance has the mesh and the material that it had. Throws Error(OutOfMemory), after which
    /// there are none.
    void update(Queue& queue, const Scene& scene, const SceneView& view, bool have_changed);

    /// Of each instance; null where no instance has one.
    const OpacityMicromapView* of_instances() const { return of_instances_.data(); }

private:
    std::vector<uint64_t> made_for_; // of each instance; empty: none made
    Buffer<uint32_t> states_;
    Buffer<OpacityMicromapView> of_instances_;
};

} // namespace pertev
