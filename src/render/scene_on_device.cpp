#include "render/scene_on_device.h"

#include <span>

#include "image/srgb_table.h"

namespace pertev {

template <class T>
const T* SceneOnDevice::keep(Queue& queue, std::span<const T> values, const std::string& name) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (values.empty()) return nullptr;
    buffers_.emplace_back(queue, std::as_bytes(values), name);
    return reinterpret_cast<const T*>(buffers_.back().data());
}

SceneOnDevice::SceneOnDevice(Queue& queue, const PreparedScene& prepared) {
    const Scene& scene = *prepared.scene;
    upload_meshes(queue, scene);
    upload_instances(queue, prepared);
    upload_images(queue, scene);
    upload_lights(queue, prepared.lights);
    view_.centre = prepared.centre;
}

void SceneOnDevice::upload_meshes(Queue& queue, const Scene& scene) {
    std::vector<MeshView> views;
    for (const Mesh& mesh : scene.meshes) {
        views.push_back({keep(queue, std::span(mesh.positions), "positions"),
                         keep(queue, std::span(mesh.normals), "normals"),
                         keep(queue, std::span(mesh.tangents), "tangents"),
                         {keep(queue, std::span(mesh.uv[0]), "texture coordinates"),
                          keep(queue, std::span(mesh.uv[1]), "texture coordinates")},
                         keep(queue, std::span(mesh.colors), "vertex colours"),
                         keep(queue, std::span(mesh.indices), "indices")});
    }
    view_.meshes = keep(queue, std::span<const MeshView>(views), "meshes");
}

void SceneOnDevice::upload_instances(Queue& queue, const PreparedScene& prepared) {
    const Scene& scene = *prepared.scene;
    std::vector<MaterialView> materials;
    for (const Material& material : scene.materials) materials.push_back(make_material_view(material));
    view_.materials = keep(queue, std::span<const MaterialView>(materials), "materials");

    std::vector<InstanceView> instances;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Transform world_from_local = moved_to(instance.world_from_local, prepared.centre);
        const Material& material = scene.materials[instance.material];
        const uint16_t has_alpha = material.alpha_mode != AlphaMode::Opaque ? 1 : 0;
        const uint16_t hides_back = material.double_sided ? 0 : 1;
        view_.any_alpha |= has_alpha;
        view_.any_hidden_back |= hides_back;
        instances.push_back({world_from_local, inverse(world_from_local), instance.mesh, instance.material, has_alpha,
                             hides_back, is_mirroring(world_from_local) ? 1u : 0u, prepared.is_baked[i] ? 1u : 0u});
    }
    view_.instances = keep(queue, std::span<const InstanceView>(instances), "instances");
}

void SceneOnDevice::upload_images(Queue& queue, const Scene& scene) {
    std::vector<TextureImageView> images;
    for (const TextureImage& image : scene.images) {
        TextureImageView view = view_of(image);
        view.rgba8 = keep(queue, std::span(image.rgba8.pixels), image.name);
        view.rgba_float = keep(queue, std::span(image.rgba_float.pixels), image.name);
        images.push_back(view);
    }
    view_.images = keep(queue, std::span<const TextureImageView>(images), "images");
    view_.linear_from_srgb = keep(queue, std::span<const float>(srgb_decode_table()), "sRGB table");
}

void SceneOnDevice::upload_lights(Queue& queue, const LightSetData& lights) {
    LightSetView& view = view_.lights;
    view = view_of(lights, view_.images, view_.linear_from_srgb);
    const auto keep_table = [&](const OrderedTable& table, OrderedTableView& table_view, const std::string& name) {
        table_view.starts = keep(queue, std::span(table.starts), name);
        table_view.guide = keep(queue, std::span(table.guide), name + " guide");
    };
    keep_table(lights.choice, view.choice, "light table");
    view.emitters = keep(queue, std::span(lights.emitters), "emissive instances");
    view.triangle_order = keep(queue, std::span(lights.triangle_order), "order of emissive triangles");
    view.triangle_starts = keep(queue, std::span(lights.triangle_starts), "tables of emissive triangles");
    view.triangle_guides = keep(queue, std::span(lights.triangle_guides), "guides of emissive triangles");
    view.triangles = keep(queue, std::span(lights.triangles), "emissive triangles");
    view.punctual = keep(queue, std::span(lights.punctual), "punctual lights");
    view.first_light = keep(queue, std::span(lights.first_light), "lights of instances");
    view.emissions = keep(queue, std::span(lights.emissions), "emissions");
    if (!lights.has_environment) return;
    view.environment.pixels = keep(queue, std::span(lights.environment.pixels), "environment");
    view.environment.row_bounds = keep(queue, std::span(lights.environment.row_bounds), "bounds of environment rows");
    keep_table(lights.environment.rows, view.environment.rows, "environment rows");
    keep_table(lights.environment.columns, view.environment.columns, "environment columns");
}

std::size_t predicted_bytes(const PreparedScene& prepared) {
    const auto bytes_of = [](const auto& values) { return values.size() * sizeof(values[0]); };
    std::size_t bytes = 0;
    const Scene& scene = *prepared.scene;
    for (const Mesh& mesh : scene.meshes) {
        bytes += bytes_of(mesh.positions) + bytes_of(mesh.normals) + bytes_of(mesh.tangents) + bytes_of(mesh.uv[0]) +
                 bytes_of(mesh.uv[1]) + bytes_of(mesh.colors) + bytes_of(mesh.indices);
    }
    for (const TextureImage& image : scene.images)
        bytes += bytes_of(image.rgba8.pixels) + bytes_of(image.rgba_float.pixels);
    bytes += scene.instances.size() * sizeof(InstanceView) + scene.materials.size() * sizeof(MaterialView);
    const LightSetData& lights = prepared.lights;
    bytes += bytes_of(lights.emitters) + bytes_of(lights.punctual) + bytes_of(lights.emissions) +
             bytes_of(lights.triangles) + bytes_of(lights.first_light) + bytes_of(lights.triangle_order) +
             bytes_of(lights.triangle_starts) + bytes_of(lights.triangle_guides) + bytes_of(lights.environment.pixels) +
             bytes_of(lights.environment.row_bounds);
    for (const OrderedTable* table : {&lights.choice, &lights.environment.rows, &lights.environment.columns}) {
        bytes += bytes_of(table->starts) + bytes_of(table->guide);
    }
    return bytes;
}

} // namespace pertev
