#include "python/contents_hash.h"

#include <span>

#include "base/hash.h"
#include "scene/intensity_table.h"

namespace pertev {

std::string hash_of_contents(const Scene& scene) {
    Hasher hasher;
    const auto add_text = [&](const std::string& text) {
        hasher.add_value(text.size());
        hasher.add(std::as_bytes(std::span(text)));
    };
    const auto add_all = [&](const auto& values) {
        hasher.add_value(values.size());
        hasher.add(std::as_bytes(std::span(values)));
    };
    const auto add_transform = [&](const Transform& m) {
        for (const Vec3 row : {m.row0, m.row1, m.row2, m.translation}) add_all(std::vector{row.x, row.y, row.z});
    };
    for (const Mesh& mesh : scene.meshes) {
        add_text(mesh.name);
        add_all(mesh.positions), add_all(mesh.normals), add_all(mesh.uv[0]), add_all(mesh.colors),
            add_all(mesh.indices);
    }
    for (const Material& material : scene.materials) {
        add_text(material.name);
        visit_choices(material, [&](auto choice, auto&&...) { hasher.add_value(static_cast<uint8_t>(choice)); });
        add_all(std::vector{uint8_t(material.double_sided), uint8_t(material.two_sided_emission),
                            uint8_t(material.thin_walled), uint8_t(material.has_relative_ior)});
        visit_parameters(
            material, [&](const float& value, auto&&...) { hasher.add_value(value); },
            [&](const TextureRef& texture, const char*) { hasher.add_value(texture.image); });
    }
    for (const TextureImage& image : scene.images) {
        hasher.add_value(image.rgba8.width), hasher.add_value(image.rgba_float.width);
        add_all(image.rgba8.pixels), add_all(image.rgba_float.pixels);
    }
    for (const Instance& instance : scene.instances) {
        add_text(instance.name);
        hasher.add_value(instance.mesh), hasher.add_value(instance.material);
        add_transform(instance.world_from_local);
    }
    for (const Light& light : scene.lights) {
        add_text(light.name);
        const Vec3 p = light.position, d = light.direction;
        add_all(std::vector{static_cast<float>(light.kind), p.x, p.y, p.z, d.x, d.y, d.z, light.intensity.r,
                            light.intensity.g, light.intensity.b, light.cos_inner, light.cos_outer, light.range});
        if (!parts_of(light.kind).table) continue;
        hasher.add_value(light.table->hash);
        add_all(std::vector{light.up.x, light.up.y, light.up.z, light.is_mirrored ? 1.0f : 0.0f});
    }
    for (const Camera& camera : scene.cameras) {
        add_text(camera.name);
        add_transform(camera.world_from_camera);
        add_all(std::vector{static_cast<float>(camera.projection), camera.fov_y, camera.ortho_height, camera.aspect,
                            camera.aperture_radius, camera.focus_distance});
        const ApertureShape& shape = camera.aperture;
        if (shape == ApertureShape()) continue; // a disk; earlier versions knew no other shape
        add_all(std::vector{static_cast<float>(shape.blades), shape.rotation_deg, shape.ratio});
    }
    if (scene.environment) {
        const Rgb scale = scene.environment->scale;
        add_all(std::vector{scale.r, scale.g, scale.b});
        hasher.add_value(scene.environment->image.width), add_all(scene.environment->image.pixels);
    }
    const DoubleVec3 origin = scene.origin_in_file;
    add_all(std::vector{origin.x, origin.y, origin.z});
    return hasher.result().hex();
}

} // namespace pertev
