#include "tracer/structure_on_device.h"

#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "base/error.h"
#include "device/shared_uploads.h"

namespace pertev {

/// Device address of a host array; null for an array without elements.
template <class T>
const T* StructureOnDevice::moved(const T* on_host) const {
    const auto offset = structure_->offset_of(on_host);
    return offset ? reinterpret_cast<const T*>(memory_.data() + *offset) : nullptr;
}

template <class View>
void StructureOnDevice::move(View& view) const {
    if constexpr (requires { view.nodes; }) view.nodes = moved(view.nodes);
    view.triangles = moved(view.triangles);
    if constexpr (requires { view.references; }) view.references = moved(view.references);
    if constexpr (requires { view.transforms; }) view.transforms = moved(view.transforms);
}

template <class View>
SceneTrees<View> StructureOnDevice::moved_scene(SceneTrees<View> scene, const BuiltStructure* before) {
    move(scene.baked);
    for (const BuiltStructure::Array& array : structure_->arrays()) {
        std::span<const std::byte> bytes = array.bytes;
        // Both structures are alive, so equal addresses mean the same array.
        if (before != nullptr && before->offset_of(bytes.data()) == array.offset) continue;
        std::vector<View> meshes;
        if (static_cast<const void*>(bytes.data()) == static_cast<const void*>(scene.blases)) {
            meshes.assign(scene.blases, scene.blases + bytes.size() / sizeof(View));
            for (View& view : meshes) move(view);
            bytes = std::as_bytes(std::span(meshes));
        }
        if (!bytes.empty()) upload_array(queue_, memory_.data() + array.offset, bytes, meshes.empty());
    }
    scene.blases = moved(scene.blases);
    scene.tlas_nodes = moved(scene.tlas_nodes);
    scene.instances = moved(scene.instances);
    return scene;
}

void StructureOnDevice::copy(const BuiltStructure* before) {
    if (memory_.size() < structure_->device_bytes()) {
        before = nullptr;
        memory_ = Buffer<std::byte>(); // freed before the new allocation, so that both need not fit
        memory_ = Buffer<std::byte>(queue_, structure_->device_bytes(), structure_->figures().name);
    }
    try {
        std::visit([&](const auto& scene) { trees_ = moved_scene(scene, before); }, structure_->trees());
    } catch (...) {
        memory_ = Buffer<std::byte>(); // now holds neither structure
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

std::vector<Bounds3> StructureOnDevice::deform(std::span<const DeformedMesh> meshes) {
    std::vector<Deforming*> fitted;
    for (const DeformedMesh& mesh : meshes) {
        auto at = deforming_.find(mesh.mesh);
        if (at == deforming_.end()) {
            using Tree = std::variant<DeformingCompressed, DeformingWide>;
            const bool is_compressed = std::holds_alternative<SceneTrees<CompressedBvhView>>(trees_);
            Tree tree = is_compressed ? Tree(std::in_place_type<DeformingCompressed>, queue_, mesh.triangles)
                                      : Tree(std::in_place_type<DeformingWide>, queue_, mesh.triangles);
            at = deforming_.emplace(mesh.mesh, Deforming{std::move(tree)}).first;
        }
        fitted.push_back(&at->second);
        if (at->second.version == mesh.version) continue;
        at->second.version = 0; // until the refit is done
        std::visit([&](auto& tree) { tree.start(mesh); }, at->second.tree);
    }
    std::vector<Bounds3> bounds;
    for (std::size_t i = 0; i < meshes.size(); ++i) { // the work of all meshes is queued by now
        Deforming& mesh = *fitted[i];
        if (mesh.version != meshes[i].version) {
            mesh.bounds = std::visit([](auto& tree) { return tree.finish(); }, mesh.tree);
            mesh.version = meshes[i].version;
        }
        bounds.push_back(mesh.bounds);
    }
    return bounds;
}

void StructureOnDevice::place(std::span<const DeformedMesh> meshes, const Tlas& tlas) {
    const auto place_in = [&]<class View>(SceneTrees<View>& scene) {
        const View* const own = std::get<SceneTrees<View>>(structure_->trees()).blases;
        std::vector<View> views(own, own + structure_->mesh_count());
        if (is_copied_) {
            for (View& view : views) move(view);
        }
        for (const DeformedMesh& mesh : meshes) {
            std::visit(
                [&](const auto& tree) {
                    if constexpr (std::is_same_v<decltype(tree.view()), View>) views[mesh.tree] = tree.view();
                },
                deforming_.at(mesh.mesh).tree);
        }
        upload_tlas(queue_, placed_, views, tlas, scene);
    };
    std::visit(place_in, trees_);
}

} // namespace pertev
