// How much of a device's memory a session will take.

#include <algorithm>
#include <set>

#include "denoise/motion_vectors.h"
#include "denoise/picture_denoiser.h"
#include "render/raster/camera_raster.h"
#include "session/session.h"

namespace pertev {
namespace {

uint64_t triangles_of_instances(const Scene& scene) {
    uint64_t count = 0;
    for (const Instance& instance : scene.instances) count += scene.meshes[instance.mesh].triangle_count();
    return count;
}

/// Of trees that are kept on the device for meshes whose vertices move, and of the top level over them.
std::size_t deforming_tree_bytes(const PreparedScene& scene, const TracerChoice& tracers, bool on_cuda) {
    std::size_t bytes = 0;
    std::set<TreeLayout> layouts;
    for (const RayKind kind : kRayKinds) layouts.insert(layout_of(tracers[kind]));
    const auto may_deform = [&](TreeLayout layout) { return can_deform(layout, on_cuda); };
    if (scene.poses.empty() || !std::ranges::all_of(layouts, may_deform)) return 0;
    for (const TreeLayout layout : layouts) {
        bytes += scene.top_level.nodes.size() * sizeof(BvhNode) +
                 scene.top_level.instances.size() * sizeof(InstanceRecord) +
                 scene.trees.parts.size() * sizeof(CompressedBvhView) + 3 * 256;
        if (layout != TreeLayout::Compressed) continue; // the host's other trees are not counted
        for (std::size_t i = 0; i < scene.poses.size(); ++i) {
            const uint32_t mesh = scene.scene->shapes[i].mesh;
            if (scene.poses[i].is_on_host || scene.tree_of_mesh[mesh] == kBakedMesh) continue;
            bytes += DeformingCompressed::predicted_bytes(scene.scene->meshes[mesh].triangle_count(), on_cuda);
        }
    }
    return bytes;
}

bool splits_light(const PreparedScene& scene) { return materials_known(*scene.scene) == MaterialsKnown::Nothing; }

/// Of the scene, its trees, and the integrator with its queues, for calls of so many samples. `parts`: what paths have
/// beside as their samples go to noisy frames.
std::size_t bytes_of_tracing(const PreparedScene& scene, const RenderSettings& settings, uint32_t samples,
                             PathParts parts, bool on_cuda) {
    const TracerChoice tracers = tracers_of(settings, on_cuda, !scene.poses.empty());
    const bool has_loop = can_walk_on_host(tracers, on_cuda);
    const uint64_t pixels = uint64_t(settings.width) * settings.height;
    parts.has_times = scene.motions != nullptr;
    std::size_t bytes = predicted_bytes(scene, on_cuda) + deforming_tree_bytes(scene, tracers, on_cuda) +
                        predicted_bytes(settings, pixels, samples, on_cuda, has_loop, parts);
    if (on_cuda) bytes += scene.structures->device_bytes(tracers);
    if (lists_tiles(settings.integrator)) {
        bytes += CameraRaster::predicted_bytes(triangles_of_instances(*scene.scene), settings.width, settings.height,
                                               on_cuda);
    }
    return bytes;
}

} // namespace

std::size_t predicted_bytes(const PreparedScene& scene, const RenderSettings& settings, bool on_cuda) {
    const uint32_t width = settings.width, height = settings.height;
    const bool denoises = settings.denoise != Denoise::None;
    std::size_t bytes = bytes_of_tracing(scene, settings, denoises ? 1 : settings.samples,
                                         {.splits_light = denoises && splits_light(scene)}, on_cuda) +
                        Film::predicted_bytes(width, height, settings.aovs, light_layers_of(settings));
    if (denoises) {
        bytes += NoisyFrame::predicted_bytes(width, height, splits_light(scene)) +
                 PictureDenoiser::predicted_bytes(width, height);
    }
    if ((settings.aovs & kAovMotion) != 0) {
        bytes += motion_vector_bytes(width, height) + scene.scene->instances.size() * sizeof(InstanceView);
    }
    return bytes;
}

std::size_t predicted_frame_bytes(const PreparedScene& scene, const RenderSettings& settings,
                                  const ReconstructionSettings& reconstruction, const RestirSettings& restir,
                                  bool on_cuda) {
    const uint32_t width = settings.width, height = settings.height;
    const uint32_t of_light[] = {scaled_side(width, reconstruction), scaled_side(height, reconstruction)};
    const PathParts parts = {.splits_light = splits_light(scene),
                             .tells_bounce = restir.light == RestirLight::Indirect};
    std::size_t bytes = bytes_of_tracing(scene, settings, 1, parts, on_cuda) +
                        NoisyFrame::predicted_bytes(of_light[0], of_light[1], splits_light(scene)) +
                        Reconstruction::predicted_bytes(of_light[0], of_light[1]);
    if (restir.light != RestirLight::Off) bytes += Restir::predicted_bytes(of_light[0], of_light[1], restir.light);
    if (reconstruction.resolution_scale < 1) {
        bytes += NoisyFrame::predicted_bytes(width, height, splits_light(scene)) +
                 EnlargedFrame::predicted_bytes(width, height);
    }
    if (settings.aovs != 0) bytes += Film::predicted_bytes(width, height, settings.aovs, 0);
    return bytes;
}

} // namespace pertev
