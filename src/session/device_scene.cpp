#include "session/device_scene.h"

#include <span>

#include "base/error.h"
#include "base/stopwatch.h"

namespace pertev {
namespace {

/// Names the large arrays of some parts of the scene, which stay where they are until these change.
void name_arrays(const PreparedScene& prepared, uint32_t parts, SharedUploads& uploads) {
    const Scene& scene = *prepared.scene;
    const auto add = [&](const auto& array) {
        if (!array.empty()) uploads.lasts(std::as_bytes(std::span(array)));
    };
    if ((parts & kPartGeometry) != 0) {
        for (const Mesh& mesh : scene.meshes) {
            add(mesh.positions), add(mesh.normals), add(mesh.tangents), add(mesh.colors), add(mesh.indices);
            for (const auto& uv : mesh.uv) add(uv);
        }
    }
    if ((parts & kPartTextures) != 0) {
        for (const auto& image : scene.images) add(image.rgba8.pixels), add(image.rgba_float.pixels);
    }
    if ((parts & kPartEnvironment) != 0 && prepared.lights.environment) add(prepared.lights.environment->pixels);
}

} // namespace

void make_what_is_used(Queue& queue, const RenderSettings& settings, SceneOnDevice& scene) {
    if (settings.path.mip_maps == MipMaps::On) scene.make_mip_maps(queue);
    const SceneView& view = scene.view();
    if (uses_light_tree(settings, view.lights.tree.light_count, view.motions.is_there())) scene.make_light_tree(queue);
}

void DeviceScene::set(const PreparedScene& scene, const RenderSettings& settings) {
    tracer_.reset(); // freed with its trees, so that those of two scenes need not fit
    upload(scene, kAllParts, settings);
}

void DeviceScene::update(const PreparedScene& scene, uint32_t parts, const RenderSettings& settings) {
    upload(scene, parts, settings);
}

/// Uploads `parts` and keeps the others. A part's memory is reused if it is large enough.
void DeviceScene::upload(const PreparedScene& scene, uint32_t parts, const RenderSettings& settings) {
    const Stopwatch watch;
    uploads_.clear();
    name_arrays(scene, parts, uploads_);
    const SharedUploads::Scope scope(uploads_, has_uploads_);
    if ((parts & kPartTrees) != 0) structures_ = prepared_structures_ = scene.structures;
    try {
        if ((parts & kPartTrees) != 0 && tracer_) tracer_->set_structures(*structures_);
        if (scene_) {
            scene_->update(queue_, scene, parts);
        } else {
            scene_.emplace(queue_, scene);
        }
    } catch (...) {
        scene_.reset(); // parts of it may be missing
        tracer_.reset();
        throw;
    }
    instance_count_ = static_cast<uint32_t>(scene.scene->instances.size());
    if ((parts & kPartGeometry) != 0) { // otherwise instances only move
        triangle_counts_.clear();
        for (const Instance& instance : scene.scene->instances)
            triangle_counts_.push_back(scene.scene->meshes[instance.mesh].triangle_count());
    }
    placed_ = scene.placed;
    has_poses_ = !scene.poses.empty();
    deformed_ = scene_->deformed(scene);
    if (tracer_) tracer_->set_surfaces(scene_->view());
    if (!set_tracer(settings) && (parts & (kPartTrees | kPartPoses)) != 0) fit_trees();
    queue_.wait();
    upload_seconds_ = watch.seconds();
}

bool DeviceScene::set_tracer(const RenderSettings& settings) {
    const TracerChoice choice = tracers_of(settings, queue_.is_cuda(), has_poses_);
    if (!scene_ || (tracer_ && tracer_->choice() == choice)) return false;
    if (tracer_) uploads_.clear(); // parts of it are freed
    tracer_.reset();               // freed before the new one, so that two need not fit
    tracer_.emplace(queue_, *structures_, choice);
    tracer_->set_surfaces(scene_->view());
    fit_trees();
    return true;
}

/// Refits the trees to vertices that have moved on the device.
void DeviceScene::fit_trees() {
    if (!has_poses_) return;
    try {
        if (tracer_->can_deform()) return tracer_->deform(deformed_, placed_);
        structures_ = deformed_.empty() ? prepared_structures_ : structures_->fitted(queue_, deformed_, placed_);
        tracer_->set_structures(*structures_);
    } catch (...) {
        scene_.reset(); // its trees do not fit its vertices
        tracer_.reset();
        throw;
    }
}

void DeviceScene::keep_instances() {
    PERTEV_CHECK(scene_.has_value());
    if (instances_before_.size() != instance_count_) instances_before_ = {queue_, instance_count_, "instances before"};
    queue_.copy_on_device(instances_before_.data(), scene_->view().instances, instance_count_ * sizeof(InstanceView));
    scene_->keep_positions();
}

const SceneView& DeviceScene::view() const {
    PERTEV_CHECK(scene_.has_value() && tracer_.has_value()); // the last call that changes them threw
    return scene_->view();
}

} // namespace pertev
