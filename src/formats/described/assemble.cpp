#include "formats/described/assemble.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "base/limits.h"
#include "formats/described/bumps.h"
#include "formats/described/color_by_normals.h"
#include "formats/described/described_medium.h"
#include "formats/described/environment.h"
#include "formats/described/finish_meshes.h"
#include "formats/described/image_budget.h"
#include "formats/described/missing_coordinates.h"
#include "formats/described/mix_surfaces.h"
#include "formats/described/project_textures.h"
#include "formats/described/transforms.h"
#include "formats/described/usable_values.h"
#include "math/double_pi.h"
#include "scene/scene_origin.h"

namespace pertev::described {
namespace {

DoubleTransform without_translation(DoubleTransform m) {
    m.translation = {0, 0, 0};
    return m;
}

/// The box of a mesh, transformed.
DoubleBounds3 box_of(const Mesh& mesh, const DoubleTransform& transform) {
    const Bounds3 local = bounds_of(mesh);
    DoubleBounds3 box;
    if (local.is_empty()) return box;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p = {(corner & 1) != 0 ? local.hi.x : local.lo.x, (corner & 2) != 0 ? local.hi.y : local.lo.y,
                        (corner & 4) != 0 ? local.hi.z : local.lo.z};
        box.extend(transform_point(transform, to_double(p)));
    }
    return box;
}

/// The materials of the scene, each made once.
struct Assembly {
    using MaterialKey = std::array<uint32_t, 5>;
    const Parts& parts;
    Scene& scene;
    Sink& sink;
    std::map<MaterialKey, uint32_t> numbers;
    std::vector<Surface> surfaces; // one to one with the materials

    /// Returns the material of a shape with this mesh.
    uint32_t material_of(const Placed& shape, std::size_t number, const ShapeMesh& of, const Mesh& mesh) {
        const Surface& from = parts.surfaces[shape.surface];
        const bool has_power = shape.area_light && parts.area_lights[*shape.area_light].power > 0;
        // Bumps and powers depend on the shape's size.
        const auto own = from.has_heights || has_power ? static_cast<uint32_t>(number + 1) : 0u;
        const auto one_more = [](std::optional<uint32_t> i) { return i ? *i + 1 : 0u; };
        const MaterialKey key = {shape.surface, one_more(shape.area_light), one_more(shape.alpha),
                                 one_more(shape.medium), own};
        const auto [known, is_new] = numbers.try_emplace(key, static_cast<uint32_t>(surfaces.size()));
        if (!is_new) return known->second;
        Surface surface = from;
        if (shape.area_light) add_emission(parts.area_lights[*shape.area_light], shape, of, mesh, surface);
        if (shape.alpha) set_alpha(surface, parts.alphas[*shape.alpha]);
        number_mappings(surface);
        if (shape.medium || (surface.is_nothing && !shape.area_light)) {
            fill_surface(shape.medium ? parts.media[*shape.medium] : MediumParameters{}, of.location, sink, surface);
        }
        if (surface.has_heights) surface.material.normal_texture = surface.heights.ref;
        keep_usable(surface.material, of.location, sink);
        scene.materials.push_back(surface.material);
        surfaces.push_back(std::move(surface));
        return known->second;
    }

    void add_emission(const AreaLight& light, const Placed& shape, const ShapeMesh& of, const Mesh& mesh,
                      Surface& surface) const {
        Material& material = surface.material;
        Rgb radiance = light.radiance;
        if (light.power > 0) {
            const double area = world_area(mesh, compose(shape.world_from_mesh, of.shape_from_mesh));
            const double shapes = of.is_quadric ? 1 : mesh.triangle_count();
            const double radiance_of_1 = area * kPiDouble * (light.is_two_sided ? 2 : 1);
            const double scale = radiance_of_1 > 0 ? light.power * shapes / radiance_of_1 : 0;
            radiance = static_cast<float>(std::min(scale, static_cast<double>(kMaxSampleValue))) * radiance;
        }
        set_color(surface, &MaterialParameters::emission, &MaterialParameters::emission_texture, constant(radiance));
        const auto limited = [](float x) { return min(x, kMaxSampleValue); };
        material.emission = {limited(radiance.r), limited(radiance.g), limited(radiance.b)};
        if (material.emission != radiance)
            sink.warn({light.location, "the radiance of an area light is kept within 2^40"});
        material.two_sided_emission = light.is_two_sided;
        if (!light.image.has_image()) return;
        TextureValue image = light.image; // its factor is in the radiance
        image.factor = grey(1);
        const Rgb emission = material.emission;
        set_color(surface, &MaterialParameters::emission, &MaterialParameters::emission_texture, image);
        material.emission = emission;
    }
};

void set_lights(const Parts& parts, const DoubleTransform& scene_from_file, Sink& sink, Scene& scene) {
    const Transform turned = to_float(without_translation(scene_from_file));
    for (const PlacedLight& placed : parts.lights) {
        Light light = placed.light;
        light.position = to_float(transform_point(scene_from_file, placed.position));
        light.direction = normalize_safely(transform_vector(turned, light.direction));
        const LightParts has = parts_of(light.kind);
        if (has.direction) light.up = normalize_safely(transform_vector(turned, light.up));
        if (has.direction) light.is_mirrored = light.is_mirrored != is_mirroring(turned);
        if (!is_light(light.intensity)) {
            leave_out_strength("a", placed.location, sink);
            continue;
        }
        if ((has.position && !is_near(light.position)) || !is_oriented(light)) {
            sink.leave_out(
                {placed.location, "a light is left out, because it has no direction or lies beyond 2^40 metres"});
            continue;
        }
        scene.lights.push_back(std::move(light));
    }
}

void set_environment(const Parts& parts, const DoubleTransform& scene_from_file, Sink& sink, Scene& scene) {
    for (const InfiniteLight& light : parts.infinite_lights) {
        const bool has_pictures =
            !light.picture.empty() || light.sky || (scene.environment && !scene.environment->image.pixels.empty());
        if (scene.environment && has_pictures) {
            sink.leave_out({light.location, "a second infinite light is left out, because one of them has a picture"});
            continue;
        }
        const DoubleTransform local_from_scene =
            inverse(without_translation(compose(scene_from_file, light.world_from_light)));
        if (!is_finite(local_from_scene)) {
            sink.leave_out({light.location, "an infinite light is left out, because its transform has no inverse"});
            continue;
        }
        auto made = make_environment(light, local_from_scene, sink);
        if (!made) continue;
        const Rgb before = scene.environment ? scene.environment->scale : Rgb{};
        if (!is_light(made->scale) || !is_light(before + made->scale)) {
            leave_out_strength("an infinite", light.location, sink);
            continue;
        }
        if (!scene.environment) {
            scene.environment = *std::move(made);
        } else {
            scene.environment->scale += made->scale;
        }
    }
    // Such a file states all its light. Black is a light from outside too, so that none is made up.
    if (!scene.environment) scene.environment = Environment{.image = {}, .scale = {0, 0, 0}};
}

/// Returns the transforms of all shapes, and moves the scene's origin near them.
std::vector<DoubleTransform> place_shapes(const Parts& parts, const DoubleTransform& scene_from_world, Scene& scene) {
    DoubleBounds3 box;
    std::vector<DoubleTransform> transforms;
    for (const Placed& shape : parts.placed) {
        const ShapeMesh& mesh = parts.meshes[shape.mesh];
        transforms.push_back(compose(scene_from_world, compose(shape.world_from_mesh, mesh.shape_from_mesh)));
        if (is_finite(transforms.back())) box.extend(box_of(mesh.mesh, transforms.back()));
    }
    set_origin(box, scene);
    return transforms;
}

/// Numbers of parts in the scene.
struct Made {
    std::vector<std::optional<uint32_t>> numbers; // each mesh has one
    std::vector<std::size_t> first_shapes;        // each material has one
};

/// Adds the shapes that can be drawn, with their meshes and materials.
Made add_shapes(Parts& parts, const std::vector<DoubleTransform>& transforms, Assembly& assembly, Scene& scene,
                Sink& sink) {
    Made made = {std::vector<std::optional<uint32_t>>(parts.meshes.size()), {}};
    for (std::size_t i = 0; i < parts.placed.size(); ++i) {
        const Placed& shape = parts.placed[i];
        ShapeMesh& mesh = parts.meshes[shape.mesh];
        std::optional<uint32_t>& number = made.numbers[shape.mesh];
        if (mesh.mesh.indices.empty() && !number) continue;
        DoubleTransform transform = transforms[i];
        transform.translation = transform.translation - scene.origin_in_file;
        if (!is_finite(transform)) {
            sink.leave_out({mesh.location, "a shape is left out, because its transform is not finite"});
            continue;
        }
        if (!number) {
            number = static_cast<uint32_t>(scene.meshes.size());
            if (mesh.mesh.name.empty() || mesh.file.empty()) mesh.mesh.name = shape.name;
            scene.meshes.push_back(std::move(mesh.mesh));
        }
        const std::size_t materials = scene.materials.size();
        const uint32_t material = assembly.material_of(shape, i, mesh, scene.meshes[*number]);
        if (material == materials) made.first_shapes.push_back(i);
        Instance instance;
        instance.name = shape.name;
        instance.mesh = *number;
        instance.material = material;
        instance.world_from_local = to_float(transform);
        instance.is_hidden = is_singular(instance.world_from_local);
        instance.layers_above = shape.layers_above;
        scene.instances.push_back(std::move(instance));
    }
    return made;
}

/// Loads the images of the materials, whose heights become normals.
void add_images(Parts& parts, const Assembly& assembly, const Made& made, uint64_t file_bytes, TextureLoader& loader,
                Scene& scene, Sink& sink) {
    const std::size_t requests = request_images(parts.combined, scene);
    loader.load_into(scene, file_bytes);
    ImageBudget budget(justified_bytes(4 * kFreeImageBytes, file_bytes));
    make_combined(parts.combined, requests, budget, parts.made, scene);
    Bumps bumps(budget, parts.made, scene);
    std::vector<const Surface*> surfaces;
    for (const Surface& surface : assembly.surfaces) surfaces.push_back(&surface);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if (!surfaces[i]->has_heights) continue;
        const Placed& shape = parts.placed[made.first_shapes[i]];
        const ShapeMesh& mesh = parts.meshes[shape.mesh];
        bumps.set(surfaces[i]->heights, scene.meshes[*made.numbers[shape.mesh]],
                  compose(shape.world_from_mesh, mesh.shape_from_mesh), scene.materials[i]);
        keep_usable(scene.materials[i], mesh.location, sink);
    }
    finish_images(surfaces, parts.made, budget, scene);
}

} // namespace

Scene assemble(Parts parts, const DoubleTransform& scene_from_world, uint64_t file_bytes, std::string_view expected,
               TextureLoader& loader, Sink& sink) {
    separate_mixtures(parts, file_bytes, sink);
    color_by_normals(parts, file_bytes, sink);
    project_textures(parts, file_bytes, sink);
    Scene scene;
    const std::vector<DoubleTransform> transforms = place_shapes(parts, scene_from_world, scene);
    const DoubleTransform scene_from_file =
        compose(translation_by(DoubleVec3{0, 0, 0} - scene.origin_in_file), scene_from_world);
    for (const Placed& shape : parts.placed) give_missing_coordinates(parts, shape, parts.meshes[shape.mesh]);
    Assembly assembly{.parts = parts, .scene = scene, .sink = sink, .numbers = {}, .surfaces = {}};
    const Made made = add_shapes(parts, transforms, assembly, scene, sink);
    if (scene.instances.empty()) {
        scene.no_instances = fmt::format("no shape that can be drawn; expected {}", expected);
        const std::vector<std::string> left_out = sink.messages().left_out();
        if (!left_out.empty()) scene.no_instances += fmt::format("; left out: {}", left_out.front());
    }
    add_images(parts, assembly, made, file_bytes, loader, scene, sink);
    set_lights(parts, scene_from_file, sink, scene);
    set_environment(parts, scene_from_file, sink, scene);
    if (parts.around) scene.medium = parts.media[*parts.around];
    return scene;
}

} // namespace pertev::described
