#include "session/post_steps.h"

#include <algorithm>

#include "base/error.h"
#include "denoise/oidn/oidn_denoiser.h"
#include "denoise/picture_denoiser.h"
#include "device/launch.h"
#include "render/add_frame_to_film.h"

namespace pertev {

namespace {

constexpr float kLastLobe = 0x1.fffffep-1f; // the largest number below 1

/// Returns the settings of samples of visible surfaces: their paths end at the first surface, or behind mirrors.
RenderSettings settings_of_features(const RenderSettings& settings, bool follows_mirrors) {
    RenderSettings of_features = settings;
    of_features.path.max_depth = follows_mirrors ? std::min(settings.path.max_depth, kMostMirrors) : 0;
    of_features.path.strategy = LightStrategy::BsdfOnly;
    of_features.path.roulette_depth = kMostMirrors + 1;
    return of_features;
}

Camera pinhole_of(Camera camera) {
    camera.aperture_radius = 0;
    return camera;
}

} // namespace

std::vector<std::unique_ptr<Denoiser>> make_denoisers(Queue& queue, const RenderSettings& settings) {
    std::vector<std::unique_ptr<Denoiser>> denoisers;
    switch (settings.denoise) {
    case Denoise::None:
        break;
    case Denoise::Svgf:
        denoisers.push_back(settings.has_history()
                                ? std::make_unique<PictureDenoiser>(queue, settings.width, settings.height,
                                                                    settings.samples, settings.history)
                                : std::make_unique<PictureDenoiser>(queue, settings.width, settings.height));
        break;
    case Denoise::Oidn:
        denoisers.push_back(std::make_unique<OidnDenoiser>(queue, settings.width, settings.height));
        break;
    }
    return denoisers;
}

DenoiserStateSize denoiser_state_size(Denoise denoise, uint32_t width, uint32_t height) {
    const std::size_t pixels = std::size_t(width) * height;
    switch (denoise) {
    case Denoise::None:
        return {};
    case Denoise::Svgf:
        return PictureDenoiser::state_size(pixels);
    case Denoise::Oidn:
        return OidnDenoiser::state_size(pixels);
    }
    return {};
}

DenoisedPicture denoise(Queue& queue, const RenderSettings& settings, Image picture, const DenoiserState& gathered) {
    const auto steps = make_denoisers(queue, settings);
    steps.front()->restore(gathered);
    DenoisedPicture denoised = {apply_steps(steps, std::move(picture)), ""};
    denoised.denoiser = steps.front()->name();
    return denoised;
}

DenoiserTarget* denoiser_target(const Film& film) {
    for (const auto& target : film.targets())
        if (auto* const found = dynamic_cast<DenoiserTarget*>(target.get())) return found;
    return nullptr;
}

std::string PostSteps::names() const {
    std::string names;
    for (const auto& denoiser : denoisers_) names += denoiser->name();
    return names;
}

PictureHistory* PostSteps::history() const {
    PictureHistory* const history = denoisers_.empty() ? nullptr : denoisers_.front()->history();
    return history != nullptr && history->is_there() ? history : nullptr;
}

/// Makes the steps for a picture, and the frame for its samples. Returns the settings of samples of surfaces.
RenderSettings PostSteps::fit(const RenderSettings& settings) {
    NoisyFrame& frame = fit_frame(pictures_.scene(), sample_, settings.width, settings.height);
    const bool has_history = settings.has_history();
    const std::tuple wanted(settings.denoise, settings.width, settings.height, has_history ? settings.samples : 0,
                            has_history ? settings.history : 0);
    if (made_for_ != wanted) {
        denoisers_.clear(); // freed before the new ones, so that both need not fit
        denoisers_ = make_denoisers(pictures_.queue(), settings);
        made_for_ = wanted;
    }
    const FilmPart part = settings.part();
    const uint32_t rows = part.end_row - part.first_row;
    window_ = {.width = settings.width, .height = rows};
    if (rows < settings.height) window_.picture_width = settings.width, window_.y = part.first_row;
    mirrors_ = frame.splits_light() ? denoisers_.front()->mirrors() : MirrorChainView{};
    return settings_of_features(settings, mirrors_.is_there());
}

bool PostSteps::begin(const Camera& camera, const RenderSettings& settings, Sink* sink, const PreviousScene& before,
                      Features features) {
    find_centres(camera, fit(settings), before, sink);
    if (sink != nullptr && sink->should_stop()) return false; // some centres may be missing
    camera_ = camera, of_features_ = settings_of_features(settings, mirrors_.is_there());
    features_ = 0;
    // Mirrors need other samples, and a medium scatters a path by its length.
    const bool may_wait = !mirrors_.is_there() && pictures_.scene().view().has_media == 0;
    return (may_wait && features == Features::WithSamples) || add_features(sink);
}

void PostSteps::begin_restored(const Camera& camera, const RenderSettings& settings, const PreviousScene& before) {
    find_centres(camera, fit(settings), before, nullptr);
}

void PostSteps::restore_history(const Camera& camera, const RenderSettings& settings,
                                std::span<const std::vector<std::byte>> arrays) {
    RenderSettings of_centres = fit(settings);
    sample_centres(of_centres);
    denoisers_.front()->history()->restore(arrays, view_of_centres(pinhole_of(camera), of_centres));
}

/// Lets the frame record, of mirrors, the lobe at `lobe`.
void PostSteps::follow(float lobe) {
    mirrors_.lobe = lobe;
    sample_->follow(mirrors_);
}

CameraView PostSteps::view_of_centres(const Camera& pinhole, const RenderSettings& of_centres) {
    return pictures_.view_of(pinhole, of_centres).camera.view;
}

/// Passes to the steps the surfaces at the centres of pixels, as a pinhole sees them.
void PostSteps::find_centres(const Camera& camera, const RenderSettings& of_features, const PreviousScene& before,
                             Sink* sink) {
    NoisyFrame& frame = *sample_;
    RenderSettings of_centres = of_features;
    sample_centres(of_centres);
    const Camera pinhole = pinhole_of(camera);
    Integrator& of_pinhole = pictures_.begin(pinhole, of_centres, 1);
    frame.begin();
    of_pinhole.stop_with(sink);
    follow(0);
    of_pinhole.render(0, 1, frame.film_view());
    const CameraView centres = view_of_centres(pinhole, of_centres);
    for (const auto& denoiser : denoisers_) {
        denoiser->begin(frame, centres, window_);
        PictureHistory* const history = denoiser->history();
        if (history == nullptr) continue;
        history->is_there() ? denoiser->follow(frame, pictures_.scene().view(), before) : history->cut();
    }
    if (!mirrors_.is_there()) return;
    denoisers_.front()->guide_mirrors(frame);
    follow(kLastLobe);
    of_pinhole.render(0, 1, frame.film_view());
    denoisers_.front()->guide_mirrors(frame);
    if (!denoisers_.front()->has_mirrors()) mirrors_ = {};
    follow(-1);
}

bool PostSteps::add_features(Sink* sink) {
    if (has_features()) return true;
    NoisyFrame& frame = *sample_;
    Integrator& integrator = pictures_.begin(camera_, of_features_, 1);
    integrator.stop_with(sink);
    const auto render = [&](uint32_t sample, float lobe) {
        follow(lobe);
        FilmView rows_of_frame = frame.film_view();
        rows_of_frame.window = window_;
        integrator.render(sample, 1, rows_of_frame);
        return sink == nullptr || !sink->should_stop();
    };
    const SceneView& scene = pictures_.scene().view();
    for (; !has_features(); ++features_) {
        if (!render(features_, 0)) return false;
        for (const auto& denoiser : denoisers_) denoiser->add_features(frame, scene);
        if (!mirrors_.is_there()) continue;
        denoisers_.front()->add_mirrors(frame, scene);
        if (!render(features_, kLastLobe)) return false;
        denoisers_.front()->add_mirrors(frame, scene);
    }
    follow(-1);
    return true;
}

void PostSteps::add(Integrator& integrator, uint32_t first, uint32_t count, const Film& film, Sink* sink) {
    PERTEV_CHECK(film.view().window == window_);
    const SceneView& scene = pictures_.scene().view();
    FilmView into = sample_.value().film_view();
    into.invalid = film.view().invalid;
    into.window = window_;
    for (uint32_t sample = first; sample < first + count; ++sample) {
        integrator.render(sample, 1, into);
        if (sink != nullptr && sink->should_stop()) return;
        launch_in(pictures_.queue(), "add_frame_to_film", window_,
                  AddFrameToFilm{sample_->view(), film.view(), scene, sample == 0});
        const bool is_feature = !has_features() && sample == features_;
        if (is_feature) ++features_;
        for (const auto& denoiser : denoisers_) {
            if (is_feature) denoiser->add_features(*sample_, scene);
            denoiser->add(*sample_, scene, sample);
        }
    }
    pictures_.queue().wait();
}

} // namespace pertev
