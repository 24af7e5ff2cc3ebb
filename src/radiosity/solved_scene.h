#pragma once

// What form factors are found in: a scene and its trees in the host's memory, and the patches on it.

#include <optional>

#include "device_scene/scene_on_device.h"
#include "render/prepare_scene.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// The scene as rays on the host meet it.
class SolvedScene {
public:
    /// `prepared` outlives it. Throws Error(BadInput) where vertices of the scene are moved by skins or morph targets,
    /// Error(OverLimit) where it has too many triangles to number them.
    explicit SolvedScene(const PreparedScene& prepared);
    SolvedScene(const SolvedScene&) = delete;
    SolvedScene& operator=(const SolvedScene&) = delete;

    const SceneView& view() const { return scene_->view(); }
    const HostTrees& trees() const { return *tracer_->host_trees(); }
    /// Of the host's memory, for what rays need to know of the scene.
    std::size_t bytes() const { return queue_.allocated_bytes(); }
    const Bounds3& bounds() const { return tracer_->bounds(); } // of all that rays can meet, metres

private:
    Queue queue_;
    std::optional<SceneOnDevice> scene_;
    std::optional<SceneTracer> tracer_;
};

} // namespace pertev
