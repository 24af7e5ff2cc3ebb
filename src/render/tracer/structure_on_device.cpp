#include "render/tracer/structure_on_device.h"

#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "base/error.h"

namespace pertev {

/// Where an array of the host's lies on the device; null of one without elements.
template <class T>
const T* StructureOnDevice::moved(const T* on_host) const {
    const auto offset = structure_->offset_of(on_host);
    return offset ? reinterpret_cast<const T*>(memory_.data() + *offset) : nullptr;
}

template <class View>
SceneTrees<View> StructureOnDevice::moved_scene(SceneTrees<View> scene, const BuiltStructure* before) {
    const auto move = [&](View& view) {
        if constexpr (requires { view.nodes; }) view.nodes = moved(view.nodes);
        view.triangles = moved(view.triangles);
        if constexpr (requires { view.references; }) view.references = moved(view.references);
        if constexpr (requires { view.transforms; }) view.transforms = moved(view.transforms);
    };
    move(scene.baked);
    for (const BuiltStructure::Array& array : structure_->arrays()) {
        std::span<const std::byte> bytes = array.bytes;
        // Both structures are alive, so one address is one array.
        if (before != nullptr && before->offset_of(bytes.data()) == array.offset) continue;
        std::vector<View> meshes;
        if (static_cast<const void*>(bytes.data()) == static_cast<const void*>(scene.meshes)) {
            meshes.assign(scene.meshes, scene.meshes + bytes.size() / sizeof(View));
            for (View& view : meshes) move(view);
            bytes = std::as_bytes(std::span(meshes));
        }
        memory_.upload_at(array.offset, bytes);
    }
    scene.meshes = moved(scene.meshes);
    scene.top_nodes = moved(scene.top_nodes);
    scene.instances = moved(scene.instances);
    return scene;
}

void StructureOnDevice::copy(const BuiltStructure* before) {
    if (memory_.size() < structure_->device_bytes()) {
        before = nullptr;
        memory_ = Buffer<std::byte>(); // before the new one, so that both need not fit
        memory_ = Buffer<std::byte>(queue_, structure_->device_bytes(), structure_->figures().name);
    }
    try {
        std::visit([&](const auto& scene) { trees_ = moved_scene(scene, before); }, structure_->trees());
    } catch (...) {
        memory_ = Buffer<std::byte>(); // holds neither structure
        throw;
    }
}

StructureOnDevice::StructureOnDevice(Queue& queue, std::shared_ptr<const BuiltStructure> structure, bool is_copied)
    : queue_(queue), is_copied_(is_copied), structure_(std::move(structure)), trees_(structure_->trees()) {
    if (is_copied_) copy(nullptr);
}

void StructureOnDevice::update(std::shared_ptr<const BuiltStructure> structure) {
    PERTEV_CHECK(structure->trees().index() == trees_.index());
    if (structure == structure_ && (memory_.size() > 0 || !is_copied_)) return;
    const std::shared_ptr<const BuiltStructure> before = std::exchange(structure_, std::move(structure));
    if (is_copied_) {
        copy(before.get());
    } else {
        trees_ = structure_->trees();
    }
}

} // namespace pertev
