#include "render/prepare_scene.h"

#include <fmt/format.h>

#include "accel/builders/bvh_cache.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "device_scene/place_meshes.h"
#include "image/srgb_table.h"
#include "render/balance_lights.h"
#include "shading/bsdf.h"

namespace pertev {
namespace {

constexpr uint64_t kManyCopiedTriangles = 1u << 18;

/// Warns of materials whose index of refraction is not the one that is rendered.
void warn_of_indices(const Scene& scene, Sink& sink) {
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        if (material.kind != MaterialKind::Dielectric) continue;
        const float used = DielectricLobe::usable_ior(material.ior, alpha_from_roughness(material.roughness));
        if (used == material.ior) continue;
        sink.warn(fmt::format(
            "{}: rough glass of index {} is rendered with {}, because its energy is tabulated only from 1.1 to 3",
            numbered("material", i, material.name, material.origin), material.ior, used));
    }
}

/// Returns the requested builder, then those whose cached trees may replace it.
std::vector<BvhBuilder> builders_for(const PrepareOptions& options) {
    const TracerChoice choice = options.tracers.value_or(default_tracers(false));
    std::vector<BvhBuilder> builders = {options.builder.value_or(builder_of(choice))};
    bool is_better = false; // better than the requested one
    for (const TreeBuild build : kValuesOf<TreeBuild>) {
        const BvhBuilder builder = *builder_of(structure_of(build));
        if (is_better && options.may_be_better) builders.push_back(builder);
        is_better = is_better || builder == builders.front();
    }
    return builders;
}

} // namespace

PreparedScene prepare_scene(const Scene& scene, const PrepareOptions& options, Sink& sink) {
    const Stopwatch watch;
    PreparedScene prepared;
    prepared.scene = &scene;
    warn_of_indices(scene, sink);
    if (!options.keep_coordinates) prepared.centre = options.centre.value_or(world_centre(scene));
    const MeshPlacement placement = place_meshes(scene, prepared.centre, options.apart);
    prepared.apart = options.apart;
    prepared.is_baked = placement.is_baked;
    if (placement.copied_triangles > kManyCopiedTriangles) {
        sink.warn(fmt::format("{} of shared meshes squeezed too much for a tree in their own space are copied into "
                              "world space, which takes memory for {} more triangles",
                              counted(placement.copies, "instance"), placement.copied_triangles));
    }

    const SceneTriangles triangles(scene, placement, sink);
    const std::vector<BvhBuilder> builders = builders_for(options);
    for (std::size_t part = 0; part < triangles.parts(); ++part) {
        const std::vector<BvhTriangle>& list = triangles.part(part);
        BvhBuilder taken = builders.front();
        Bvh bvh = load_or_build_bvh(list, builders, options.bvh, options.bvh_cache, sink, &taken);
        prepared.trees.add(taken, std::move(bvh), list.size());
    }
    prepared.blas_of_mesh = placement.blas_of_mesh;
    prepared.placed = placed_trees(scene, placement, prepared.trees.blas_bounds(), options.motions);
    prepared.motions = options.motions;
    prepared.tlas = build_tlas(prepared.placed);
    prepared.triangles = triangles.count();
    prepared.trees.build_s = watch.seconds();
    prepared.structures = std::make_shared<SceneStructures>(builders.front(), prepared.trees, prepared.tlas);
    if (options.tracers) {
        for (const RayKind kind : kValuesOf<RayKind>) prepared.structures->get((*options.tracers)[kind], sink);
    }
    prepared.build_seconds = watch.seconds();

    prepared.lights = build_light_set(scene, srgb_decode_table().data(), sink, prepared.centre);
    balance_lights(prepared, srgb_decode_table().data());
    return prepared;
}

} // namespace pertev
