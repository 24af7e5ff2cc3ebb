#pragma once

// A prepared scene on a device, with all that a picture of it needs and that does not depend on the picture: its
// arrays, the tracer with its trees, the vertices and trees of meshes that deform, and the places of instances and
// vertices before the last change. It needs no session.

#include <memory>
#include <optional>
#include <vector>

#include "device/shared_uploads.h"
#include "device_scene/scene_on_device.h"
#include "render/reproject.h"
#include "settings/render_settings.h"

namespace pertev {

/// Makes the mip-maps and the light tree if pictures of these settings use them and they are missing. Throws
/// Error(OutOfMemory), without an effect.
void make_what_is_used(Queue& queue, const RenderSettings& settings, SceneOnDevice& scene);

class DeviceScene {
public:
    /// Makes an empty object; call set() before use. `queue` must outlive this object.
    explicit DeviceScene(Queue& queue) : queue_(queue), uploads_(queue) {}
    DeviceScene(const DeviceScene&) = delete;
    DeviceScene& operator=(const DeviceScene&) = delete;

    /// Uploads `scene`, which need not outlive the call, and makes the tracer that `settings` request. The previous
    /// tracer is freed first, so that two need not fit into memory. If this throws, there is no scene. Throws
    /// Error(OutOfMemory, OverLimit, DeviceFault).
    void set(const PreparedScene& scene, const RenderSettings& settings);
    /// Uploads `parts` (ScenePart) of `scene`, which is the same scene after a change. Throws as set().
    void update(const PreparedScene& scene, uint32_t parts, const RenderSettings& settings);
    /// Makes the tracer that `settings` request. Returns false if it exists already, or if there is no scene. Throws as
    /// set(); if it throws, there is no tracer until the next call.
    bool set_tracer(const RenderSettings& settings);

    /// Makes what pictures of these settings need, by make_what_is_used, if there is a scene.
    void make_what_is_used(const RenderSettings& settings) {
        if (scene_) pertev::make_what_is_used(queue_, settings, *scene_);
    }

    /// Lets the next calls copy what `other`, which has the same scene, has just uploaded from its device. It must not
    /// change until they have returned, nor is it used after it has changed.
    void take_from(const DeviceScene& other) { has_uploads_ = &other.uploads_; }

    /// Stores the present positions of instances and vertices for before(). Throws Error(OutOfMemory).
    void keep_instances();
    /// Returns the positions that the last keep_instances() stored.
    PreviousScene before() const { return {instances_before_.data(), scene_->meshes_before()}; }

    bool is_there() const { return scene_.has_value(); }
    /// Numbers of triangles of all instances.
    const std::vector<uint32_t>& triangle_counts() const { return triangle_counts_; }
    /// Returns the nested solids that hold a camera, for CameraRays.
    InteriorList interior_of(const Camera& camera) const {
        return scene_->nested_solids().at(camera.world_from_camera.translation - view().centre);
    }
    /// Returns the view of the scene; there must be a scene and a tracer.
    const SceneView& view() const;
    SceneTracer& tracer() { return tracer_.value(); }
    Queue& queue() const { return queue_; }
    /// Duration of the last set() or update(), seconds.
    double upload_seconds() const { return upload_seconds_; }

private:
    void upload(const PreparedScene& scene, uint32_t parts, const RenderSettings& settings);
    void fit_trees();

    Queue& queue_;
    SharedUploads uploads_; // arrays of the last upload()
    const SharedUploads* has_uploads_ = nullptr;
    std::shared_ptr<SceneStructures> structures_, prepared_structures_; // the structures that rays traverse, and
                                                                        // those of the prepared scene
    std::vector<PlacedBvh> placed_;                                     // the instances of PreparedScene
    std::vector<DeformedMesh> deformed_; // meshes whose vertices were moved on the device
    std::optional<SceneOnDevice> scene_;
    std::optional<SceneTracer> tracer_;
    Buffer<InstanceView> instances_before_;
    uint32_t instance_count_ = 0;
    std::vector<uint32_t> triangle_counts_;
    bool has_poses_ = false;
    double upload_seconds_ = 0;
};

} // namespace pertev
