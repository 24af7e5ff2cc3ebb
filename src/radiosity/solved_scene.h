#pragma once

// A scene for form factors: its data and trees in host memory, and its patches.

#include <optional>

#include "device_scene/scene_on_device.h"
#include "render/prepare_scene.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// The scene for rays on the host.
class SolvedScene {
public:
    /// Makes the scene; `prepared` outlives it. Throws Error(BadInput) if skins or morph targets move vertices of the
    /// scene, Error(OverLimit) if it has too many triangles to number them.
    explicit SolvedScene(const PreparedScene& prepared);
    SolvedScene(const SolvedScene&) = delete;
    SolvedScene& operator=(const SolvedScene&) = delete;

    const SceneView& view() const { return scene_->view(); }
    const HostTrees& trees() const { return *tracer_->host_trees(); }
    /// Size of the rays' scene data in host memory, bytes.
    std::size_t bytes() const { return queue_.allocated_bytes(); }
    const Bounds3& bounds() const { return tracer_->bounds(); } // bounds of everything that rays can hit, metres

private:
    Queue queue_;
    std::optional<SceneOnDevice> scene_;
    std::optional<SceneTracer> tracer_;
};

} // namespace pertev
