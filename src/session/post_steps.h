#pragma once

// Steps applied to a film's picture after rendering, in order. A denoising step receives each sample of each pixel
// before the film does. It needs no session.

#include <memory>
#include <tuple>
#include <vector>

#include "denoise/denoiser.h"
#include "session/picture_renderer.h"

namespace pertev {

/// Makes the steps that `settings` request. Throws Error(BadInput, OutOfMemory, DeviceFault).
std::vector<std::unique_ptr<Denoiser>> make_denoisers(Queue& queue, const RenderSettings& settings);
/// Returns the size of Denoiser::state of the steps that `denoise` requests; 0 without steps.
DenoiserStateSize denoiser_state_size(Denoise denoise, uint32_t width, uint32_t height);

/// A picture after its steps, and Denoiser::name of what made it.
struct DenoisedPicture {
    Image image;
    std::string denoiser;
};
/// Denoises a picture on `queue` by what denoisers have gathered of its samples (DenoiserTarget). Throws
/// Error(BadInput) if that is not whole, and as make_denoisers.
DenoisedPicture denoise(Queue& queue, const RenderSettings& settings, Image picture, const DenoiserState& gathered);
/// Returns the film's target for what a denoiser gathers; null if it has none.
DenoiserTarget* denoiser_target(const Film& film);

class PostSteps {
public:
    /// Makes an object without steps; `pictures` outlives it.
    explicit PostSteps(PictureRenderer& pictures) : pictures_(pictures) {}

    /// Selects when the steps get the surfaces of the first samples, which they need: at once, or with the light of
    /// these samples if the scene allows it, which takes less time.
    enum class Features : uint8_t { AtOnce, WithSamples };

    /// Begins a picture, or the part of its rows: creates the steps that `settings` request, and passes them the
    /// visible surfaces. Returns false once `sink` stops; null: never. If there is a history, `before` is where the
    /// scene was in the frame that left it. After Features::WithSamples, add() must begin with sample 0, and
    /// add_features() must follow it. Throws Error(OutOfMemory, DeviceFault).
    bool begin(const Camera& camera, const RenderSettings& settings, Sink* sink, const PreviousScene& before = {},
               Features features = Features::AtOnce);
    /// Passes to the steps the surfaces of the first samples that are missing. Returns false once `sink` stops.
    bool add_features(Sink* sink);
    /// Begins a picture whose samples come by restore().
    void begin_restored(const Camera& camera, const RenderSettings& settings, const PreviousScene& before);
    /// Returns the history of frames; null if there is none.
    PictureHistory* history() const;
    /// Goes on after a frame seen by `camera`, with what PictureHistory::save returned. Throws Error(BadInput) if it
    /// does not fit, and as begin().
    void restore_history(const Camera& camera, const RenderSettings& settings,
                         std::span<const std::vector<std::byte>> arrays);
    /// Renders samples [first, first + count) into `film` and into each step. Stops in the middle once `sink` stops;
    /// film and steps must then be discarded. Null: never. Throws std::logic_error for a film of other rows than
    /// those of begin(), or of a part of them.
    void add(Integrator& integrator, uint32_t first, uint32_t count, const Film& film, Sink* sink);
    /// Returns `picture`, that of the film, after all steps. Throws Error(DeviceFault).
    Image apply(Image picture) { return apply_steps(denoisers_, std::move(picture)); }
    /// Returns what the step has gathered (Denoiser::state); nothing before begin().
    DenoiserState state() const { return denoisers_.empty() ? DenoiserState() : denoisers_.front()->state(); }
    /// Replaces what the step has gathered since begin(), as Denoiser::restore.
    void restore(const DenoiserState& state) { denoisers_.front()->restore(state); }
    /// Forgets the samples since begin(), as Denoiser::forget_samples.
    void forget_samples() { denoisers_.front()->forget_samples(); }
    /// The steps' Denoiser::name.
    std::string names() const;

private:
    void follow(float lobe);
    RenderSettings fit(const RenderSettings& settings);
    CameraView view_of_centres(const Camera& pinhole, const RenderSettings& of_centres);
    void find_centres(const Camera& camera, const RenderSettings& of_features, const PreviousScene& before, Sink* sink);
    bool has_features() const { return features_ >= denoisers_.front()->feature_samples(); }

    PictureRenderer& pictures_;
    std::optional<NoisyFrame> sample_;
    MirrorChainView mirrors_; // that samples of surfaces follow
    Camera camera_;
    RenderSettings of_features_; // settings of samples of surfaces
    uint32_t features_ = 0;      // number of samples whose surfaces the steps have
    PixelWindow window_;         // the rows that are rendered
    std::vector<std::unique_ptr<Denoiser>> denoisers_;
    // Kind of steps, the size of their picture, and samples and frames of a history.
    std::tuple<Denoise, uint32_t, uint32_t, uint32_t, uint32_t> made_for_ = {};
};

} // namespace pertev
