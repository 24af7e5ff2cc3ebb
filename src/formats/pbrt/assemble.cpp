#include <map>

#include <fmt/format.h>

#include "base/limits.h"
#include "base/message_text.h"
#include "formats/obj/bump_normals.h"
#include "formats/pbrt/bumps.h"
#include "formats/pbrt/environment.h"
#include "formats/pbrt/transforms.h"
#include "formats/pbrt/world.h"
#include "scene/scene_origin.h"

namespace pertev::pbrt {
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

/// Gives a mesh without texture coordinates those of pbrt: each triangle has (0, 0), (1, 0) and (1, 1), v upwards.
void give_coordinates(ShapeMesh& shape) {
    Mesh& mesh = shape.mesh;
    constexpr Vec2 kCorners[3] = {{0, 1}, {1, 1}, {1, 0}};
    Mesh split;
    split.name = std::move(mesh.name);
    split.origin = std::move(mesh.origin);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        split.positions.push_back(mesh.positions[mesh.indices[i]]);
        if (!mesh.normals.empty()) split.normals.push_back(mesh.normals[mesh.indices[i]]);
        const std::size_t corner = i % 3;
        split.uv[0].push_back(kCorners[corner > 0 && shape.is_turned[i / 3] ? 3 - corner : corner]);
        split.indices.push_back(static_cast<uint32_t>(i));
    }
    mesh = std::move(split);
}

} // namespace

/// The materials of the scene, each made once.
struct World::Assembly {
    World& world;
    Scene& scene;
    std::map<MaterialKey, uint32_t> numbers;
    std::vector<Surface> surfaces; // one to one with the materials

    /// Returns the material of a shape with this mesh.
    uint32_t material_of(const Placed& shape, std::size_t number, const ShapeMesh& of, const Mesh& mesh) {
        const Surface& from = world.surfaces_[shape.surface];
        const bool has_power = shape.area_light && world.area_lights_[*shape.area_light].power > 0;
        // Bumps and powers depend on the shape's size.
        const auto own = from.has_heights || has_power ? static_cast<uint32_t>(number + 1) : 0u;
        const auto one_more = [](std::optional<uint32_t> i) { return i ? *i + 1 : 0u; };
        const MaterialKey key = {shape.surface, one_more(shape.area_light), one_more(shape.alpha), own};
        const auto [known, is_new] = numbers.try_emplace(key, static_cast<uint32_t>(surfaces.size()));
        if (!is_new) return known->second;
        Surface surface = from;
        if (shape.area_light) add_emission(world.area_lights_[*shape.area_light], shape, of, mesh, surface);
        if (shape.alpha) set_alpha(surface, world.alphas_[*shape.alpha]);
        if (surface.has_heights) surface.material.normal_texture = surface.heights.ref;
        scene.materials.push_back(surface.material);
        surfaces.push_back(std::move(surface));
        return known->second;
    }

    static void add_emission(const AreaLight& light, const Placed& shape, const ShapeMesh& of, const Mesh& mesh,
                             Surface& surface) {
        Material& material = surface.material;
        Rgb radiance = light.radiance;
        if (light.power > 0) {
            const double area = world_area(mesh, compose(shape.world_from_mesh, of.shape_from_mesh));
            const double shapes = of.is_quadric ? 1 : mesh.triangle_count();
            const double radiance_of_1 = area * 3.14159265358979323846 * (light.is_two_sided ? 2 : 1);
            radiance = radiance_of_1 > 0 ? static_cast<float>(light.power * shapes / radiance_of_1) * radiance : Rgb{};
        }
        set_color(surface, &MaterialParameters::emission, &MaterialParameters::emission_texture, constant(radiance));
        const auto limited = [](float x) { return min(x, kMaxSampleValue); };
        material.emission = {limited(radiance.r), limited(radiance.g), limited(radiance.b)};
        material.two_sided_emission = light.is_two_sided;
        if (light.image.has_image()) material.emission_texture = light.image.ref;
    }
};

void World::set_lights(const DoubleTransform& scene_from_file, Scene& scene) {
    const Transform turned = to_float(without_translation(scene_from_file));
    for (PlacedLight& placed : lights_) {
        Light light = std::move(placed.light);
        light.position = to_float(transform_point(scene_from_file, placed.position));
        light.direction = transform_vector(turned, light.direction);
        scene.lights.push_back(std::move(light));
    }
}

void World::set_environment(const DoubleTransform& scene_from_file, Scene& scene) {
    Sink& sink = context_.sink;
    for (const InfiniteLight& light : infinite_lights_) {
        const bool has_pictures =
            !light.picture.empty() || (scene.environment && !scene.environment->image.pixels.empty());
        if (scene.environment && has_pictures) {
            sink.leave_out({light.location, "a second infinite light is left out, because one of them has a picture"});
            continue;
        }
        std::filesystem::path picture;
        if (!light.picture.empty()) {
            std::optional<std::filesystem::path> found;
            try {
                found = context_.access.find(base_of(context_, light.location, light.picture), light.picture, sink);
                if (!found)
                    sink.leave_out(
                        {light.location, fmt::format("there is no picture {}; the infinite light is left out",
                                                     shortened(light.picture))});
            } catch (const Error& error) {
                if (error.code() != ErrorCode::BadInput) throw;
                sink.leave_out(error.remark().and_then("; the infinite light is left out"));
            }
            if (!found) continue;
            picture = *found;
        }
        const DoubleTransform local_from_scene =
            inverse(without_translation(compose(scene_from_file, light.world_from_light)));
        if (!is_finite(local_from_scene)) {
            sink.leave_out({light.location, "an infinite light is left out, because its transform has no inverse"});
            continue;
        }
        auto made = make_environment(light, picture, local_from_scene, sink);
        if (!made) continue;
        if (!scene.environment) {
            scene.environment = *std::move(made);
        } else {
            scene.environment->scale += made->scale;
        }
    }
    // A file of pbrt states all its light. Black is a light from outside too, so that none is made up.
    if (!scene.environment) scene.environment = Environment{.image = {}, .scale = {0, 0, 0}};
}

Scene World::finish(uint64_t file_bytes) {
    Scene scene;
    shapes_.finish();
    const DoubleTransform scene_from_world = pbrt::scene_from_world(view);
    DoubleBounds3 box;
    std::vector<DoubleTransform> transforms;
    for (const Placed& shape : placed_) {
        const ShapeMesh& mesh = shapes_.meshes()[shape.mesh];
        transforms.push_back(compose(scene_from_world, compose(shape.world_from_mesh, mesh.shape_from_mesh)));
        if (is_finite(transforms.back())) box.extend(box_of(mesh.mesh, transforms.back()));
    }
    set_origin(box, scene);
    const DoubleTransform scene_from_file =
        compose(make_translation(DoubleVec3{0, 0, 0} - scene.origin_in_file), scene_from_world);

    std::vector<bool> has_textures(shapes_.meshes().size());
    for (const Placed& shape : placed_) {
        const Surface& surface = surfaces_[shape.surface];
        if (!surface.images.empty() || surface.has_heights || surface.material.normal_texture.has_image() ||
            (shape.alpha && alphas_[*shape.alpha].has_image()) ||
            (shape.area_light && area_lights_[*shape.area_light].image.has_image()))
            has_textures[shape.mesh] = true;
    }
    for (std::size_t i = 0; i < has_textures.size(); ++i) {
        ShapeMesh& shape = shapes_.meshes()[i];
        if (has_textures[i] && shape.mesh.uv[0].empty()) give_coordinates(shape);
    }

    Assembly assembly{.world = *this, .scene = scene, .numbers = {}, .surfaces = {}};
    std::vector<std::optional<uint32_t>> numbers(shapes_.meshes().size()); // meshes in the scene
    std::vector<std::size_t> bumpy;                                        // the first shape of each material
    for (std::size_t i = 0; i < placed_.size(); ++i) {
        const Placed& shape = placed_[i];
        ShapeMesh& mesh = shapes_.meshes()[shape.mesh];
        if (mesh.mesh.indices.empty() && !numbers[shape.mesh]) continue;
        DoubleTransform transform = transforms[i];
        transform.translation = transform.translation - scene.origin_in_file;
        if (!is_finite(transform)) {
            context_.sink.leave_out({mesh.location, "a shape is left out, because its transform is not finite"});
            continue;
        }
        if (!numbers[shape.mesh]) {
            numbers[shape.mesh] = static_cast<uint32_t>(scene.meshes.size());
            if (mesh.mesh.name.empty() || mesh.ply.empty()) mesh.mesh.name = shape.name;
            scene.meshes.push_back(std::move(mesh.mesh));
        }
        const std::size_t materials = scene.materials.size();
        const uint32_t material = assembly.material_of(shape, i, mesh, scene.meshes[*numbers[shape.mesh]]);
        if (material == materials) bumpy.push_back(i);
        Instance instance;
        instance.name = shape.name;
        instance.mesh = *numbers[shape.mesh];
        instance.material = material;
        instance.world_from_local = to_float(transform);
        instance.is_hidden = is_singular(instance.world_from_local);
        scene.instances.push_back(std::move(instance));
    }
    if (scene.instances.empty()) {
        scene.no_instances = "no shape that can be drawn; expected a statement such as Shape \"sphere\"";
        const std::vector<std::string> left_out = context_.sink.messages().left_out();
        if (!left_out.empty()) scene.no_instances += fmt::format("; left out: {}", left_out.front());
    }
    context_.loader.load_into(scene, file_bytes);
    ImageBudget budget(justified_bytes(4 * kFreeImageBytes, file_bytes));
    Bumps bumps(budget, scene);
    std::vector<const Surface*> surfaces;
    for (const Surface& surface : assembly.surfaces) surfaces.push_back(&surface);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if (!surfaces[i]->has_heights) continue;
        const Placed& shape = placed_[bumpy[i]];
        const ShapeMesh& mesh = shapes_.meshes()[shape.mesh];
        bumps.set(surfaces[i]->heights, scene.meshes[*numbers[shape.mesh]],
                  compose(shape.world_from_mesh, mesh.shape_from_mesh), scene.materials[i]);
    }
    finish_images(surfaces, textures_.made(), budget, scene);
    set_lights(scene_from_file, scene);
    set_environment(scene_from_file, scene);
    add_view(view, context_, scene);
    return scene;
}

} // namespace pertev::pbrt
