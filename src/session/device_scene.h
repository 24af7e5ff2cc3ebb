#pragma once

// A prepared scene on a device, with all that a picture of it needs and that does not depend on the picture: its
// arrays, the tracer with its trees, the vertices and trees of meshes that deform, and the places of instances and
// vertices before the last change. It needs no session.

#include <memory>
#include <optional>
#include <vector>

#include "device_scene/scene_on_device.h"
#include "render/reproject.h"
#include "settings/render_settings.h"

namespace pertev {

class DeviceScene {
public:
    /// `queue` outlives it. There is no scene before the first set().
    explicit DeviceScene(Queue& queue) : queue_(queue) {}
    DeviceScene(const DeviceScene&) = delete;
    DeviceScene& operator=(const DeviceScene&) = delete;

    /// Uploads `scene`, which may go away afterwards, and takes the tracer that `settings` ask for. The tracer before
    /// is freed first, so that two do not need to fit. There is no scene after this throws. Throws Error(OutOfMemory,
    /// OverLimit, DeviceFault).
    void set(const PreparedScene& scene, const RenderSettings& settings);
    /// Takes `parts` (ScenePart) of `scene`, which is the same scene after a change. Throws as set().
    void update(const PreparedScene& scene, uint32_t parts, const RenderSettings& settings);
    /// Takes the tracer that `settings` ask for. Returns false if it is there already, or if there is no scene. Throws
    /// as set(); if it throws, there is no tracer until the next call.
    bool set_tracer(const RenderSettings& settings);

    /// Remembers the places of instances and vertices as they are now, for before(). Throws Error(OutOfMemory).
    void keep_instances();
    /// Returns the places that the last keep_instances() has remembered.
    PreviousScene before() const { return {instances_before_.data(), scene_->meshes_before()}; }

    bool is_there() const { return scene_.has_value(); }
    /// A scene and a tracer must be there.
    const SceneView& view() const;
    SceneTracer& tracer() { return tracer_.value(); }
    Queue& queue() const { return queue_; }
    /// Seconds that the last set() or update() took.
    double upload_seconds() const { return upload_seconds_; }

private:
    void upload(const PreparedScene& scene, uint32_t parts, const RenderSettings& settings);
    void fit_trees();

    Queue& queue_;
    std::shared_ptr<SceneStructures> structures_, prepared_structures_; // the structures that rays traverse, and
                                                                        // those of the prepared scene
    std::vector<PlacedBvh> placed_;                                     // the instances of PreparedScene
    std::vector<DeformedMesh> deformed_; // meshes whose vertices were moved on the device
    std::optional<SceneOnDevice> scene_;
    std::optional<SceneTracer> tracer_;
    Buffer<InstanceView> instances_before_;
    uint32_t instance_count_ = 0;
    bool has_poses_ = false;
    double upload_seconds_ = 0;
};

} // namespace pertev
