#include "render/prepare_scene.h"

#include <fmt/format.h>

#include "accel/bvh/bvh_cache.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "image/srgb_table.h"
#include "render/balance_lights.h"
#include "render/place_meshes.h"
#include "shading/bsdf.h"

namespace pertev {
namespace {

constexpr uint64_t kManyCopiedTriangles = 1u << 18;

/// Says where a material's index is not the one that is rendered.
void warn_of_indices(const Scene& scene, Messages& messages) {
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        if (material.kind != MaterialKind::Dielectric) continue;
        const float used = DielectricLobe::usable_ior(material.ior, alpha_from_roughness(material.roughness));
        if (used == material.ior) continue;
        messages.warn(
            fmt::format("{}: rough glass of index {} is rendered with {}; its energy is tabulated for 1.1 to 3",
                        numbered("material", i, material.name, material.origin), material.ior, used));
    }
}

} // namespace

PreparedScene prepare_scene(const Scene& scene, const PrepareOptions& options, Messages& messages) {
    const Stopwatch watch;
    PreparedScene prepared;
    prepared.scene = &scene;
    warn_of_indices(scene, messages);
    if (!options.keep_coordinates) prepared.centre = world_centre(scene);
    const MeshPlacement placement = place_meshes(scene, prepared.centre);
    prepared.is_baked = placement.is_baked;
    if (placement.copied_triangles > kManyCopiedTriangles) {
        messages.warn(
            fmt::format("{} of shared meshes squeezed too much for a tree of their own: copied into world space, "
                        "which takes memory for {} triangles more",
                        counted(placement.copies, "instance"), placement.copied_triangles));
    }

    const SceneTriangles triangles(scene, placement);
    const auto trees = std::make_shared<std::vector<Bvh>>();
    for (std::size_t part = 0; part < triangles.parts(); ++part) {
        trees->push_back(load_or_build_bvh(triangles.part(part), options.bvh, options.bvh_cache, messages));
    }
    std::vector<Bounds3> bounds;
    for (std::size_t part = 1; part < trees->size(); ++part) bounds.push_back((*trees)[part].bounds);
    prepared.top_level = build_top_level_bvh(placed_trees(scene, placement, bounds));
    prepared.triangles = triangles.count();
    prepared.trees.parts = trees;
    prepared.trees.build_s = watch.seconds();
    prepared.structures = std::make_shared<SceneStructures>(prepared.trees, prepared.top_level);
    if (options.tracers) {
        for (const RayKind kind : kRayKinds) prepared.structures->get((*options.tracers)[kind]);
    }
    prepared.build_seconds = watch.seconds();

    prepared.lights = build_light_set(scene, srgb_decode_table().data(), messages, prepared.centre);
    balance_lights(prepared, srgb_decode_table().data());
    return prepared;
}

} // namespace pertev
