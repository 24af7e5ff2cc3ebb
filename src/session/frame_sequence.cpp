#include "session/frame_sequence.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/error.h"
#include "denoise/motion_vectors.h"
#include "session/check_integrator.h"
#include "settings/value_names.h"

namespace pertev {

namespace {

/// Returns the settings of a frame of the picture's size, whose paths end at the first surface.
RenderSettings settings_of_features(const RenderSettings& settings, const RenderSettings& of_light) {
    RenderSettings of_features = of_light;
    of_features.width = settings.width;
    of_features.height = settings.height;
    of_features.path.max_depth = 0;
    return of_features;
}

/// Returns the settings of a frame's samples of light, at their own size.
RenderSettings settings_of_light(const FrameTask& task) {
    RenderSettings of_light = settings_of_frames(task.settings);
    of_light.width = scaled_side(task.settings.width, task.reconstruction);
    of_light.height = scaled_side(task.settings.height, task.reconstruction);
    return of_light;
}

} // namespace

void FrameSequence::cut() {
    if (reconstruction_) reconstruction_->cut();
    if (restir_) restir_->cut();
    restored_.reset();
    has_moved_ = scene_has_changed_ = false;
    camera_before_.reset();
}

void FrameSequence::scene_changes() {
    scene_has_changed_ = true;
    if (!has_history() || has_moved_ || camera_before_) return;
    pictures_.scene().keep_instances();
    has_moved_ = true;
}

/// Returns the reservoirs of frames with these settings; null if samples keep all light. They restart if the settings
/// differ from those of the last frame.
Restir* FrameSequence::restir_for(const RestirSettings& settings, const RenderSettings& of_light) {
    const PathSettings& path = of_light.path;
    const uint32_t width = of_light.width, height = of_light.height;
    const bool has_light = path.light != PathLight::Indirect && path.strategy == LightStrategy::Mis;
    if (settings.light == RestirLight::Off || !has_light || path.max_depth == 0) {
        restir_.reset();
        return nullptr;
    }
    const ShadingVariant variant = pictures_.scene().view().variant;
    if (!restir_ || !restir_->fits(width, height, settings.light, variant)) {
        restir_.reset(); // freed before the new one, so that two need not fit
        restir_.emplace(pictures_.queue(), width, height, settings.light, variant);
    }
    if (settings != restir_settings_) restir_->cut();
    restir_settings_ = settings;
    return &*restir_;
}

bool FrameSequence::render(uint32_t number, const Camera& camera, const RenderSettings& settings,
                           const ReconstructionSettings& requested, const RestirSettings& restir, Sink& sink) {
    const bool by_oidn = requested.denoiser == FrameDenoiser::Oidn;
    const FrameTask task = {number, camera, settings, used_by_frames(requested, restir), restir};
    check(task);
    if (camera_before_) { // belongs to another sequence
        camera_before_.reset();
        has_moved_ = false;
    }
    SharedFrames* const shared = pictures_.sharing_frames();
    if (!(shared != nullptr ? shared->render(*this, task, sink) : render_rows(task, nullptr, sink))) return false;
    if (by_oidn) {
        if (shared != nullptr) shared->collect(*this, &FrameSequence::rows_of_guides);
        denoise();
    } else {
        oidn_.reset();
    }
    return true;
}

void FrameSequence::check(const FrameTask& task) {
    if (!makes_frames(task.settings.integrator)) {
        throw Error(ErrorCode::BadInput, "integrator", std::string(integrator_name(task.settings)),
                    "only path tracing's samples can be reconstructed");
    }
    if (!task.camera.motion.empty() || pictures_.scene().view().motions.is_there()) {
        throw Error(ErrorCode::BadInput, "shutter", "", "reconstructed frames do not support an open shutter");
    }
    if (pictures_.scene().view().has_media != 0 && task.restir.light != RestirLight::Off) {
        throw Error(ErrorCode::BadInput, "restir", "", "ReSTIR does not support scenes with media");
    }
    check_reconstruction(task.camera);
}

void FrameSequence::follow(const FrameSequence& leader) {
    restored_ = leader.restored_;
    if (reconstruction_ && !leader.has_history()) reconstruction_->cut();
    if (restir_ && !(leader.restir_ && leader.restir_->has_history())) restir_->cut();
    has_moved_ = leader.has_moved_;
    scene_has_changed_ = leader.scene_has_changed_;
}

/// A frame's sample at the size of its light, before reconstruction.
struct FrameSequence::FrameOfLight {
    const FrameTask& task;
    const RenderSettings& settings;
    NoisyFrame& frame;
    PictureView view;
    const TemporalGradientsView& change; // how light has changed since the previous frame
};

bool FrameSequence::render_rows(const FrameTask& task, RowExchange* others, Sink& sink) {
    others_ = others;
    number_ = task.number, camera_ = task.camera;
    const RenderSettings of_light = settings_of_light(task);
    NoisyFrame& frame = fit_memory(of_light);
    if (task.reconstruction.temporal_gradients && !contacts_) {
        contacts_.emplace(pictures_.queue(), of_light.width, of_light.height);
    }
    Restir* const restir = restir_for(task.restir, of_light);
    begin_exchange(task, of_light);
    rays_ = {};
    kind_seconds_ = {};
    const TemporalGradientsView change = measure_gradients(of_light, task.reconstruction);
    frame.leave(restir != nullptr ? restir->first_bounce() : FirstBounceView{});
    if (!render_light(task, of_light, frame, sink)) {
        cut();
        return false;
    }
    const FrameOfLight made = {task, of_light, frame, pictures_.view_of(task.camera, of_light), change};
    if (restir != nullptr) reuse_light(*restir, made);
    if (change.guide != nullptr) {
        contacts_->find(frame, made.view.camera.view, made.view.scene, pictures_.scene().tracer(),
                        own_rows(others, of_light.height));
    }
    reconstruct(made);
    has_moved_ = false; // the frame is complete, whatever follows
    const bool has_changed = std::exchange(scene_has_changed_, false);
    // Before the first frame after a cut nothing can have changed, whatever the sequence has shown before.
    const bool goes_on = task.reconstruction.temporal_gradients && has_changed && reconstruction_->frames() > 1;
    store_light(task.number, task.camera, of_light, goes_on);
    return true;
}

/// Returns the frame for samples of light, after making it and what reconstructs it where they do not fit.
NoisyFrame& FrameSequence::fit_memory(const RenderSettings& of_light) {
    Queue& queue = pictures_.queue();
    const uint32_t width = of_light.width, height = of_light.height;
    NoisyFrame& frame = fit_frame(pictures_.scene(), sample_, width, height);
    const bool fits = reconstruction_ && temporal_gradients_ && temporal_gradients_->fits(frame);
    if (fits) return frame;
    // It has another size, or other signals.
    temporal_gradients_.reset();
    contacts_.reset();
    reconstruction_.reset(); // freed before the new one, so that two need not fit
    reconstruction_.emplace(queue, width, height);
    temporal_gradients_.emplace(queue, width, height, frame.splits_light(), reconstruction_->gradients_memory());
    return frame;
}

/// Takes a history that was restored, and begins to take other devices' rows of the history.
void FrameSequence::begin_exchange(const FrameTask& task, const RenderSettings& of_light) {
    reconstruction_->share(others_);
    if (restir_) restir_->share(others_);
    const bool is_restored = restored_ != nullptr; // each device then takes all rows
    if (is_restored) take_restored(task, of_light);
    if (others_ != nullptr) others_->begin_taking_last(is_restored ? std::vector<RowArray>() : rows_of_history());
}

/// Renders the frame's sample. Returns false if parts of it may be missing, because a sink stopped.
bool FrameSequence::render_light(const FrameTask& task, const RenderSettings& of_light, NoisyFrame& frame, Sink& sink) {
    Sink* const stops = pictures_.queue().is_cuda() ? nullptr : &sink; // a GPU's samples are short
    render_sample(task.number, task.camera, of_light, frame, stops);
    if (others_ != nullptr) others_->finish_taking_last();
    const bool stop = stops != nullptr && sink.should_stop();
    return !(others_ != nullptr ? others_->any(stop) : stop);
}

/// Returns the scene as it was in the previous frame.
PreviousScene FrameSequence::scene_before(const PictureView& now) {
    return has_moved_ ? pictures_.scene().before() : PreviousScene{now.scene.instances, now.scene.meshes};
}

/// Adds the light that the frame left to reservoirs.
void FrameSequence::reuse_light(Restir& restir, const FrameOfLight& made) {
    const TemporalGradientsView& change = made.change;
    const PathSettings& path = made.settings.path;
    const SampleNumbers numbers = {path.sampler, made.task.number, path.seed, path.mip_maps == MipMaps::On};
    sharing_timer_.start();
    restir.add(made.frame, made.view, numbers, pictures_.scene().tracer(), scene_before(made.view),
               {change.share, change.width, change.height, change.columns, change.rows}, made.task.restir,
               path.light_choice);
    sharing_timer_.stop();
}

/// Reconstructs the picture from the frame and the history; at another size, with surfaces of the picture's size.
void FrameSequence::reconstruct(const FrameOfLight& made) {
    const ReconstructionSettings& settings = made.task.reconstruction;
    const PreviousScene before = scene_before(made.view);
    const CameraView& camera = made.view.camera.view;
    if (settings.resolution_scale >= 1) {
        features_.reset();
        reconstruction_->add(made.frame, camera, made.view.scene, before, made.change, settings);
        return;
    }
    const RenderSettings& of_picture = made.task.settings;
    const RenderSettings of_features = settings_of_features(of_picture, made.settings);
    NoisyFrame& features = fit_frame(pictures_.scene(), features_, of_picture.width, of_picture.height);
    render_sample(made.task.number, made.task.camera, of_features, features);
    const CameraView feature_camera = pictures_.view_of(made.task.camera, of_features).camera.view;
    reconstruction_->add_upsampled(made.frame, camera, features, feature_camera, made.view.scene, before, made.change,
                                   settings);
}

std::vector<RowArray> FrameSequence::rows_of_history() const {
    std::vector<RowArray> rows = reconstruction_.value().rows_of_history();
    if (restir_) std::ranges::copy(restir_->rows_of_history(), std::back_inserter(rows));
    return rows;
}

FrameHistory FrameSequence::history() {
    PERTEV_CHECK(!restored_ && has_history());
    if (SharedFrames* const shared = pictures_.sharing_frames())
        shared->collect(*this, &FrameSequence::rows_of_history);
    FrameHistory history = {number_, camera_, restir_ && restir_->has_history(), light_before_.has_value(), {}};
    std::vector<RowArray> rows = rows_of_history();
    if (history.has_light) std::ranges::copy(temporal_gradients_->before().rows(), std::back_inserter(rows));
    for (const RowArray& array : rows) {
        std::vector<std::byte>& bytes = history.arrays.emplace_back(array.row_bytes * array.height);
        pictures_.queue().copy_to_host(bytes.data(), array.data, bytes.size());
    }
    return history;
}

void FrameSequence::restore(FrameHistory history, const RenderSettings& settings, Sink& sink) {
    cut();
    restored_ = std::make_shared<const FrameHistory>(std::move(history));
    if (SharedFrames* const shared = pictures_.sharing_frames()) shared->take_scene(*this, settings, sink);
}

/// Takes what restore() got, once there is memory for it.
void FrameSequence::take_restored(const FrameTask& task, const RenderSettings& of_light) {
    const auto restored = std::exchange(restored_, nullptr);
    const FrameHistory& was = *restored;
    const CameraRays light = pictures_.view_of(was.camera, of_light).camera;
    CameraView shown = light.view;
    const NoisyFrame* features = nullptr;
    if (task.reconstruction.resolution_scale < 1) {
        features = &fit_frame(pictures_.scene(), features_, task.settings.width, task.settings.height);
        shown = pictures_.view_of(was.camera, settings_of_features(task.settings, of_light)).camera.view;
    }
    const PathSettings& path = of_light.path;
    reconstruction_->begin_after(*sample_, light.view, features, shown);
    if (restir_ && was.has_reservoirs)
        restir_->begin_after(light, {path.sampler, was.number, path.seed, path.mip_maps == MipMaps::On});
    std::vector<RowArray> rows = rows_of_history();
    const std::size_t first_reservoirs = reconstruction_->rows_of_history().size(), first_light = rows.size();
    light_before_.reset();
    if (was.has_light) {
        light_before_ = {was.camera, was.number, path};
        std::ranges::copy(temporal_gradients_->before().rows(), std::back_inserter(rows));
    }
    const bool is_alike = restir_.has_value() == was.has_reservoirs &&
                          std::ranges::equal(
                              rows, was.arrays, {}, [](const RowArray& to) { return to.row_bytes * to.height; },
                              &std::vector<std::byte>::size);
    const auto are_of_scene = [&] { // else a damaged or forged file would lead beyond the scene's arrays
        const std::span all(was.arrays);
        const auto counts = pictures_.scene().triangle_counts();
        return (!was.has_reservoirs ||
                Restir::are_of_scene(all.subspan(first_reservoirs, first_light - first_reservoirs), counts)) &&
               (!was.has_light || TemporalGradients::are_of_scene(all.subspan(first_light), counts));
    };
    if (!is_alike || !are_of_scene()) {
        cut();
        throw Error(ErrorCode::BadInput, "the history of frames does not fit these settings, or it is damaged");
    }
    for (std::size_t i = 0; i < rows.size(); ++i)
        pictures_.queue().copy_to_device(rows[i].data, was.arrays[i].data(), was.arrays[i].size());
}

/// Denoises the last frame for displays.
void FrameSequence::denoise() {
    const NoisyFrame& frame = guides();
    if (!oidn_ || !oidn_->fits(frame)) {
        oidn_.reset(); // freed before the new one, so that two need not fit
        oidn_.emplace(pictures_.queue(), frame.width(), frame.height());
    }
    reconstruction_->show_instead(oidn_->apply(reconstruction_->shown(), frame));
}

/// Renders sample `number` of each pixel of this device's rows of `frame`, at its size. Once `sink` stops, pixels are
/// left out.
void FrameSequence::render_sample(uint32_t number, const Camera& camera, RenderSettings settings, NoisyFrame& frame,
                                  Sink* sink) {
    settings.width = frame.width();
    settings.height = frame.height();
    Integrator& integrator = pictures_.begin(camera, settings, 1);
    integrator.stop_with(sink);
    frame.begin();
    if (const RowBand rows = own_rows(others_, frame.height()); !rows.is_empty()) {
        integrator.render(number, 1, frame.film_view(rows));
    }
    rays_ = rays_ + integrator.rays();
    const SceneTracer::Seconds& seconds = pictures_.scene().tracer().seconds();
    kind_seconds_.camera += seconds.camera;
    kind_seconds_.bounce += seconds.bounce;
    kind_seconds_.shadow += seconds.shadow;
}

/// Takes the rows of a small picture that other devices have made. The picture stays as it is from then on.
void FrameSequence::take_small(const NoisyFrame& frame) {
    if (others_ != nullptr) others_->take(frame.rows(), {0, frame.height()});
}

/// Returns the change of light since the previous frame, if that has left a small picture of its scene.
TemporalGradientsView FrameSequence::measure_gradients(const RenderSettings& of_light,
                                                       const ReconstructionSettings& settings) {
    // The picture can be used once, because the frame reuses its memory.
    const std::optional<LightBefore> before = std::exchange(light_before_, {});
    const bool is_known = settings.temporal_gradients && scene_has_changed_ && before &&
                          reconstruction_->frames() > 0 && before->path == of_light.path;
    if (!is_known) return {};
    NoisyFrame& small = temporal_gradients_->after();
    RenderSettings of_small = of_light;
    of_small.width = small.width(), of_small.height = small.height();
    const PictureView picture = pictures_.view_of(before->camera, of_small);
    if (has_moved_) temporal_gradients_->follow(picture.scene, scene_before(picture));
    render_sample(before->number, before->camera, of_light, small);
    contacts_->find(small, picture.camera.view, picture.scene, pictures_.scene().tracer(),
                    own_rows(others_, small.height()), TemporalGradientsMemory::kSide);
    take_small(small);
    return temporal_gradients_->compare();
}

/// Renders a small picture of the scene for the gradients of the next frame if `goes_on`, because motion usually
/// continues.
void FrameSequence::store_light(uint32_t number, const Camera& camera, const RenderSettings& of_light, bool goes_on) {
    light_before_.reset();
    if (!goes_on) return;
    render_sample(number, camera, of_light, temporal_gradients_->before());
    take_small(temporal_gradients_->before());
    light_before_ = {camera, number, of_light.path};
}

RenderResult FrameSequence::result(const Camera& camera, const RenderSettings& settings) {
    RenderResult result;
    result.samples = 1;
    result.rays = rays();
    result.invalid_samples = counts().invalid_samples;
    result.picture = reconstruction().picture();
    result.denoised = reconstruction().shown_instead();
    if (oidn_) result.denoiser = oidn_->name();
    if (settings.aovs == 0) return result;
    RenderSettings of_layers = settings_of_frames(settings);
    of_layers.samples = 1;
    of_layers.light_paths = nullptr;
    of_layers.path.max_depth = 0;
    RenderResult seen = pictures_.render_separately(camera, of_layers, number_);
    result.layers = std::move(seen.layers);
    result.ids = std::move(seen.ids);
    if (number_ == 0 || (settings.aovs & kAovIds) == 0) return result;
    of_layers.aovs = kAovIds; // ids are those of sample 0
    result.ids = pictures_.render_separately(camera, of_layers).ids;
    return result;
}

FrameTones FrameSequence::tones() {
    if (SharedFrames* const shared = pictures_.sharing_frames()) shared->collect(*this, &FrameSequence::rows_of_tones);
    return reconstruction_.value().tones(guides());
}

std::vector<RowArray> FrameSequence::rows_of_tones() const {
    const NoisyFrame& frame = guides();
    const std::size_t bytes = frame.width() * sizeof(Float4);
    return {{frame.view().emission, bytes, frame.height()}, {frame.view().hit, bytes, frame.height()}};
}

FrameCounts FrameSequence::counts() const {
    FrameCounts counts = {rays_, sample_ ? sample_->invalid_samples() : 0};
    if (restir_) counts.rays.shadow += restir_->rays();
    SharedFrames* const shared = pictures_.sharing_frames();
    if (shared == nullptr) return counts;
    const FrameCounts others = shared->counts_of_others();
    return {counts.rays + others.rays, counts.invalid_samples + others.invalid_samples};
}

RayCounts FrameSequence::rays() const { return counts().rays; }

void FrameSequence::store_previous(const Camera& camera) {
    if (reconstruction_) reconstruction_->cut();
    pictures_.scene().keep_instances();
    has_moved_ = true;
    camera_before_ = camera;
}

Image FrameSequence::motion(const Camera& camera, const RenderSettings& settings) {
    if (!camera_before_) {
        Image none{settings.width, settings.height, 2, {}};
        none.pixels.resize(std::size_t(2) * settings.width * settings.height);
        return none;
    }
    const PictureView picture = pictures_.view_of(camera, settings);
    const CameraView before = make_camera_view(*camera_before_, settings.width, settings.height, picture.scene.centre);
    DeviceScene& scene = pictures_.scene();
    return motion_vectors(pictures_.queue(), scene.tracer(), picture, before, scene.before());
}

} // namespace pertev
