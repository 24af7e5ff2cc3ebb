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

    prepared.baked = load_or_build_bvh(baked_triangles(scene, placement), options.bvh, options.bvh_cache, messages);
    prepared.mesh_bvhs.resize(placement.mesh_tree_count);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        if (placement.tree_of_mesh[i] == kBakedMesh) continue;
        prepared.mesh_bvhs[placement.tree_of_mesh[i]] =
            load_or_build_bvh(mesh_triangles(scene.meshes[i]), options.bvh, options.bvh_cache, messages);
    }
    std::vector<Bounds3> bounds;
    for (const Bvh& bvh : prepared.mesh_bvhs) bounds.push_back(bvh.bounds);
    prepared.top_level = build_top_level_bvh(placed_trees(scene, placement, bounds));
    prepared.triangles = prepared.baked.triangles.size();
    for (const Bvh& bvh : prepared.mesh_bvhs) prepared.triangles += bvh.triangles.size();
    prepared.build_seconds = watch.seconds();

    prepared.lights = build_light_set(scene, srgb_decode_table().data(), messages, prepared.centre);
    balance_lights(prepared, srgb_decode_table().data());
    return prepared;
}

} // namespace pertev
