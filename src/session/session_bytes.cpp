// A dry run (Queue::make_dry_run) allocates what a session does.

#include "session/session_bytes.h"

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include "denoise/contacts.h"
#include "denoise/motion_vectors.h"
#include "denoise/oidn/oidn_frames.h"
#include "denoise/reconstruction.h"
#include "denoise/upsampled_frame.h"
#include "device_scene/scene_on_device.h"
#include "integrators/kinds/make_integrator.h"
#include "render/centre_layers.h"
#include "render/film.h"
#include "restir/restir.h"
#include "session/camera_batch.h"
#include "session/device_scene.h"
#include "session/frame_sequence.h"
#include "session/picture_renderer.h"
#include "session/post_steps.h"
#include "tracer/structure_on_device.h"

namespace pertev {
namespace {

bool splits_light(const PreparedScene& scene) { return has_lobes(shading_variant(*scene.scene)); }

/// Allocations that denoise a picture, besides its film.
struct DenoisingMemory {
    DenoisingMemory(Queue& queue, const PreparedScene& scene, const RenderSettings& settings)
        : steps(make_denoisers(queue, settings)) {
        if (settings.is_denoised()) sample.emplace(queue, settings.width, settings.height, splits_light(scene));
    }

    std::optional<NoisyFrame> sample;
    std::vector<std::unique_ptr<Denoiser>> steps;
};

/// Returns the work of a picture: its samples are rendered one at a time if they are denoised.
WorkSize work_of_picture(const PreparedScene& scene, const RenderSettings& settings) {
    if (!settings.is_denoised()) return {.samples = settings.samples};
    return {.samples = 1, .splits_light = splits_light(scene)};
}

/// Allocations that pictures and frames share: the scene, its trees, and the integrator with its queues.
class Tracing {
public:
    /// Completes `size` with values that the scene and its tracers determine.
    Tracing(Queue& queue, const PreparedScene& scene, const RenderSettings& settings, WorkSize size)
        : queue_(queue), scene_(queue, scene) {
        make_what_is_used(queue, settings, scene_);
        const TracerChoice tracers = tracers_of(settings, queue.is_cuda(), !scene.poses.empty());
        size.width = settings.width, size.height = settings.height;
        size.traverses_on_host = can_traverse_on_host(tracers, queue.is_cuda());
        if (size.samples > 0) integrator_ = make_integrator(queue, settings);
        if (integrator_) integrator_->reserve(with_scene(size, scene_.view()));
        take_deforming_trees(scene, tracers);
        if (queue.is_cuda()) take_structures(*scene.structures, tracers);
    }
    std::size_t bytes() const {
        const bool counts_host = integrator_ && !queue_.is_cuda();
        return queue_.allocated_bytes() + (counts_host ? integrator_->host_bytes() : 0);
    }

private:
    /// Copies the structures of a choice; missing ones are built.
    void take_structures(SceneStructures& structures, const TracerChoice& tracers) {
        std::set<std::shared_ptr<const BuiltStructure>> built;
        for (const RayKind kind : kValuesOf<RayKind>) built.insert(structures.get(tracers[kind]));
        for (const auto& structure : built) structures_.emplace_back(queue_, structure);
    }
    /// Allocates the device's BLASes of meshes whose vertices move, and the TLASes over them.
    void take_deforming_trees(const PreparedScene& scene, const TracerChoice& tracers) {
        std::set<TreeLayout> layouts;
        for (const RayKind kind : kValuesOf<RayKind>) layouts.insert(layout_of(tracers[kind]));
        const auto may_deform = [&](TreeLayout layout) { return can_deform(layout, queue_.is_cuda()); };
        if (scene.poses.empty() || !std::ranges::all_of(layouts, may_deform)) return;
        for (const TreeLayout layout : layouts) {
            const std::vector<CompressedBvhView> views(scene.trees.parts.size());
            SceneTrees<CompressedBvhView> top = {};
            upload_tlas(queue_, tlases_.emplace_back(), views, scene.tlas, top);
            if (layout != TreeLayout::Compressed) continue; // the host's other trees are not counted
            for (std::size_t i = 0; i < scene.poses.size(); ++i) {
                const uint32_t mesh = scene.scene->shapes[i].mesh;
                if (scene.poses[i].is_on_host || scene.blas_of_mesh[mesh] == kBakedMesh) continue;
                trees_.emplace_back(queue_, scene.scene->meshes[mesh].triangle_count());
            }
        }
    }

    Queue& queue_;
    SceneOnDevice scene_;
    std::unique_ptr<Integrator> integrator_;
    std::vector<StructureOnDevice> structures_;
    std::vector<DeformingCompressed> trees_;
    std::vector<Buffer<std::byte>> tlases_;
};

} // namespace

std::size_t predicted_bytes(const PreparedScene& scene, const RenderSettings& settings, bool on_cuda) {
    Queue queue = Queue::make_dry_run(on_cuda);
    const uint32_t width = settings.width, height = settings.height;
    const PixelWindow window = settings.window();
    const Tracing tracing(queue, scene, settings, work_of_picture(scene, settings));
    const Film film = make_film(queue, settings);
    CentreLayers centres(queue);
    if (has_centres(settings)) centres.reserve(window.count(), scene.motions != nullptr);
    const DenoisingMemory denoising(queue, scene, settings);
    FirstHits first_hits(queue);
    if ((settings.sample_layers & kFirstHitLayers) != 0) first_hits.reserve(window.count(), scene.motions != nullptr);
    std::optional<Film> of_sample; // alone, for its moments
    if ((settings.sample_layers & kLayerVariance) != 0) of_sample.emplace(make_film(queue, settings));
    std::optional<MotionVectorMemory> motion;
    Buffer<InstanceView> places_before;
    const bool has_motion = (settings.aovs & kAovMotion) != 0;
    if (has_motion) motion.emplace(queue, width, height);
    if (has_motion || settings.has_history())
        places_before.grow(queue, scene.scene->instances.size(), "instances before");
    return tracing.bytes();
}

std::size_t predicted_frame_bytes(const PreparedScene& scene, const RenderSettings& settings,
                                  const ReconstructionSettings& reconstruction, const RestirSettings& restir,
                                  bool on_cuda) {
    Queue queue = Queue::make_dry_run(on_cuda);
    const uint32_t width = settings.width, height = settings.height;
    const uint32_t of_light[] = {scaled_side(width, reconstruction), scaled_side(height, reconstruction)};
    const bool by_oidn = reconstruction.denoiser == FrameDenoiser::Oidn;
    const bool splits = splits_light(scene);
    const Buffer<InstanceView> places_before(queue, scene.scene->instances.size(), "instances before");
    const Tracing tracing(queue, scene, settings_of_frames(settings),
                          {.splits_light = splits, .records_bounce = restir.light == RestirLight::Indirect});
    const NoisyFrame frame(queue, of_light[0], of_light[1], splits);
    const Reconstruction frames(queue, of_light[0], of_light[1]);
    std::optional<ContactFinder> contacts;
    if (used_by_frames(reconstruction, restir).temporal_gradients) contacts.emplace(queue, of_light[0], of_light[1]);
    std::optional<Restir> sharing;
    if (restir.light != RestirLight::Off)
        sharing.emplace(queue, of_light[0], of_light[1], restir.light, shading_variant(*scene.scene));
    std::optional<NoisyFrame> features;
    std::optional<UpsampledFrame> upsampled;
    if (reconstruction.resolution_scale < 1) {
        features.emplace(queue, width, height, splits);
        upsampled.emplace(queue, width, height);
    }
    std::optional<OidnFrames> denoiser;
    if (by_oidn) denoiser.emplace(queue, width, height);
    std::optional<Film> film;
    CentreLayers centres(queue);
    if (settings.aovs != 0)
        film.emplace(queue, width, height, settings.aovs, std::vector<std::string>(), settings.layers_at);
    if (has_centres(settings)) centres.reserve(uint64_t(width) * height, scene.motions != nullptr);
    std::optional<MotionVectorMemory> motion;
    if ((settings.aovs & kAovMotion) != 0) motion.emplace(queue, width, height);
    return tracing.bytes();
}

std::size_t predicted_batch_bytes(const PreparedScene& scene, const CameraBatch& batch, const RenderSettings& settings,
                                  uint32_t at_once, bool on_cuda) {
    Queue queue = Queue::make_dry_run(on_cuda);
    const bool together = is_one_job(settings);
    RenderSettings of_job = settings;
    if (together) of_job.height *= at_once;
    const Tracing tracing(queue, scene, of_job,
                          together ? WorkSize{.samples = settings.samples} : work_of_picture(scene, settings));
    const BatchMemory memory(queue, batch, settings, at_once);
    std::optional<Film> of_picture;
    std::optional<DenoisingMemory> denoising;
    if (!together) of_picture.emplace(make_film(queue, settings)), denoising.emplace(queue, scene, settings);
    CentreLayers centres(queue);
    if (has_centres(settings)) centres.reserve(uint64_t(of_job.width) * of_job.height, scene.motions != nullptr);
    BatchArrays arrays;
    arrays.fit(queue, settings, at_once);
    return tracing.bytes();
}

} // namespace pertev
