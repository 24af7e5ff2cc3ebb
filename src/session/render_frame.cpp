// The part of a Session that makes frames of a sequence.

#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "session/session.h"
#include "settings/value_names.h"

namespace pertev {

/// The reservoirs of frames with these settings; none: samples keep all light. Others than the last frame's begin anew.
Restir* Session::restir_for(const RestirSettings& settings, const RenderSettings& of_light) {
    const PathSettings& path = of_light.path;
    const uint32_t width = of_light.width, height = of_light.height;
    const bool has_light = path.light != PathLight::Indirect && path.strategy == LightStrategy::Mis;
    if (settings.light == RestirLight::Off || !has_light || path.max_depth == 0) {
        restir_.reset();
        return nullptr;
    }
    const bool fits =
        restir_ && restir_->light() == settings.light && restir_->width() == width && restir_->height() == height;
    if (!fits) {
        restir_.reset(); // before the new one, so that both need not fit
        restir_.emplace(queue_, width, height, settings.light);
    }
    if (settings != restir_settings_) restir_->cut();
    restir_settings_ = settings;
    return &*restir_;
}

/// A frame that takes samples: the one there is, or another one where it is not of this size or kind.
NoisyFrame& Session::fit(std::optional<NoisyFrame>& frame, uint32_t width, uint32_t height) {
    const bool splits_light = scene_.value().view().known == MaterialsKnown::Nothing;
    if (frame && frame->width() == width && frame->height() == height && frame->splits_light() == splits_light) {
        return *frame;
    }
    frame.reset(); // before the new one, so that both need not fit
    return frame.emplace(queue_, width, height, splits_light);
}

bool Session::render_frame(uint32_t number, const ReconstructionSettings& settings, const RestirSettings& restir) {
    if (!makes_frames(settings_.integrator)) {
        throw Error(ErrorCode::BadInput, "integrator", std::string(integrator_name(settings_)),
                    "frames are reconstructed of path's samples alone");
    }
    if (!camera_.motion.empty() || scene_.value().view().motions.is_there()) {
        throw Error(ErrorCode::BadInput, "shutter", "", "frames that are reconstructed are of one moment each");
    }
    RenderSettings of_light = settings_of_frames(settings_);
    of_light.width = scaled_side(settings_.width, settings);
    of_light.height = scaled_side(settings_.height, settings);
    frame_number_ = number;
    NoisyFrame& frame = fit(noisy_frame_, of_light.width, of_light.height);
    if (!reconstruction_ || !light_change_ || !light_change_->fits(frame)) { // of another size, or of other signals
        light_change_.reset();
        reconstruction_.reset(); // before the new one, so that both need not fit
        reconstruction_.emplace(queue_, of_light.width, of_light.height);
        light_change_.emplace(queue_, of_light.width, of_light.height, frame.splits_light(),
                              reconstruction_->room_for_change());
    }
    if (camera_before_) { // of another sequence
        camera_before_.reset();
        has_moved_ = false;
    }
    Restir* const shared = restir_for(restir, of_light);
    frame_rays_ = {};
    frame_kind_seconds_ = {};
    const LightChangeView change = look_for_change(of_light, settings);
    frame.leave(shared != nullptr ? shared->first_bounce() : FirstBounceView{});
    take_sample(number, camera_, of_light, frame, abandon_);
    if (abandon_ != nullptr && *abandon_) { // parts of the sample may be missing
        cut_frames();
        return false;
    }
    const PictureView light = view_of(camera_, of_light);
    const PreviousScene before = has_moved_ ? PreviousScene{places_before_.data(), scene_->meshes_before()}
                                            : PreviousScene{light.scene.instances, light.scene.meshes};
    if (shared != nullptr) {
        const PathSettings& path = settings_.path;
        sharing_timer_.start();
        shared->add(frame, light, {path.sampler, number, path.seed}, *tracer_, before, restir);
        sharing_timer_.stop();
    }
    if (settings.resolution_scale < 1) {
        RenderSettings of_features = of_light;
        of_features.width = settings_.width;
        of_features.height = settings_.height;
        of_features.path.max_depth = 0;
        NoisyFrame& features = fit(features_, settings_.width, settings_.height);
        take_sample(number, camera_, of_features, features);
        const CameraView camera = view_of(camera_, of_features).camera.view;
        reconstruction_->add_enlarged(frame, light.camera.view, features, camera, light.scene, before, change,
                                      settings);
    } else {
        features_.reset();
        reconstruction_->add(frame, light.camera.view, light.scene, before, change, settings);
    }
    has_moved_ = false; // the frame is whole, whatever follows
    const bool has_changed = std::exchange(scene_has_changed_, false);
    keep_light(number, of_light, settings.follow_light && has_changed);
    return true;
}

/// Renders sample `number` of each pixel of `frame`, at its size. While `*abandon` is true, pixels are left out.
void Session::take_sample(uint32_t number, const Camera& camera, RenderSettings settings, NoisyFrame& frame,
                          const std::atomic<bool>* abandon) {
    settings.width = frame.width();
    settings.height = frame.height();
    Integrator& integrator = begin(camera, settings, 1);
    integrator.abandon_when(abandon);
    frame.begin();
    integrator.render(number, 1, frame.film_view());
    frame_rays_ = frame_rays_ + integrator.rays();
    const SceneTracer::Seconds& seconds = tracer_->seconds();
    frame_kind_seconds_.camera += seconds.camera;
    frame_kind_seconds_.bounce += seconds.bounce;
    frame_kind_seconds_.shadow += seconds.shadow;
}

/// How light has changed since the frame before, where that has left a small picture of the scene as it was.
LightChangeView Session::look_for_change(const RenderSettings& of_light, const ReconstructionSettings& settings) {
    const std::optional<Camera> camera =
        std::exchange(camera_of_light_, {}); // it serves once: the frame takes its room
    const bool is_known = settings.follow_light && scene_has_changed_ && camera && reconstruction_->frames() > 0 &&
                          path_of_light_ == of_light.path;
    if (!is_known) return {};
    take_sample(number_of_light_, *camera, of_light, light_change_->after());
    return light_change_->compare();
}

/// For the next frame where `goes_on`, as what has moved once mostly does.
void Session::keep_light(uint32_t number, const RenderSettings& of_light, bool goes_on) {
    camera_of_light_.reset();
    if (!goes_on) return;
    take_sample(number, camera_, of_light, light_change_->before());
    camera_of_light_ = camera_;
    path_of_light_ = of_light.path;
    number_of_light_ = number;
}

RayCounts Session::frame_rays() const { return restir_ ? frame_rays_ + RayCounts{0, 0, restir_->rays()} : frame_rays_; }

Reconstruction& Session::frame() {
    PERTEV_CHECK(reconstruction_.has_value());
    return *reconstruction_;
}

RenderResult Session::frame_result() {
    RenderResult result;
    result.samples = 1;
    result.rays = frame_rays();
    result.invalid_samples = noisy_frame_.value().invalid_samples();
    result.picture = frame().picture();
    if (settings_.aovs == 0) return result;
    RenderSettings of_layers = settings_of_frames(settings_);
    of_layers.samples = 1;
    of_layers.light_paths = nullptr;
    of_layers.path.max_depth = 0;
    RenderResult seen = look_aside(camera_, of_layers, frame_number_);
    result.layers = std::move(seen.layers);
    result.ids = std::move(seen.ids);
    if (frame_number_ == 0 || (settings_.aovs & kAovIds) == 0) return result;
    of_layers.aovs = kAovIds; // they are sample 0's
    result.ids = look_aside(camera_, of_layers).ids;
    return result;
}

FrameTones Session::frame_tones() const {
    return reconstruction_.value().tones(features_ ? *features_ : noisy_frame_.value());
}

} // namespace pertev
