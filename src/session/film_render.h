#pragma once

// Renders a range of samples of one picture of a scene on a device into an exact film. Films of consecutive ranges
// add up to the film of the whole range (Film::add). It needs no session.
//
// The bytes do not depend on how calls split the samples, nor on earlier pictures: a picture of n samples is always
// the same.

#include <functional>
#include <optional>

#include "session/frame_history.h"
#include "session/post_steps.h"

namespace pertev {

class FilmRender {
public:
    /// Makes a film; `pictures` outlives it. The scene must exist before the first render().
    FilmRender(PictureRenderer& pictures, const Camera& camera, const RenderSettings& settings);

    /// Restarts the film if the picture differs. Returns whether the camera differs, or whether the settings give
    /// another picture.
    bool set_camera(const Camera& camera);
    bool set_settings(const RenderSettings& settings);
    /// Restarts the film, and discards the history of frames (RenderSettings::has_history). restart_for_scene() keeps
    /// that; it must be called before the scene changes.
    void restart();
    void restart_for_scene();
    /// Restarts the film for the next frame of a sequence, even if nothing has changed, and keeps the history.
    void begin_picture();

    /// Restarts with a new film. `add` is called for it, and for each film that replaces it or takes a pass for it.
    void set_targets(AddTargets add);

    /// Adds `range` to the film. It begins where the film ends, or anywhere if the film is empty. Fewer samples are
    /// added when the settings' time is over, when `sink`, which hears of each pass, stops, or at
    /// kMaxSamplesPerPixel; it always ends at a whole sample of all pixels. If a sample takes long
    /// (Integrator::render_while), the sink also hears of it during passes, with the samples in the film so far, and
    /// while an integrator precomputes (Integrator::prepare), with the share that is done. Returns the number of
    /// samples added: at least one if one was requested and fits, but none if the sink stopped before there was one.
    /// A CPU stops at once while there is no sample to lose; later it finishes the pass, unless interrupt_passes() was
    /// called. Throws what PictureRenderer::begin and the sink throw; the film then holds all passes that were done
    /// before.
    uint32_t render(SampleRange range, Sink& sink = nobody());
    /// Lets a CPU leave any pass unfinished when a sink stops. Samples of the call are then lost. Those that the film
    /// had before are kept: each pass goes through a second film, which doubles the memory.
    void interrupt_passes(bool leaves) { interrupts_passes_ = leaves; }

    /// Takes samples that another render of this picture has taken, with its rays and seconds: `add` adds them to an
    /// empty film. Throws what `add` throws, and Error(BadInput) without what the settings' post step has gathered; the
    /// film is then empty.
    void restore(SampleRange samples, const std::function<void(Film&)>& add, const RayCounts& rays, double seconds);

    /// Returns the film of the current picture. It is all zero before the first sample.
    Film& film();
    SampleRange samples() const { return film_ && !film_is_old_ ? film_->part().samples : SampleRange(); }
    /// Rays of the film's samples.
    const RayCounts& rays() const { return stats_.rays; }
    Image picture() { return film().picture(settings_.transparent); }
    /// Computes the picture for a display, times 2^exposure_stops, as tone_map_image of picture(), and starts its
    /// copy to the host.
    void display(ToneMap tone_map, float exposure_stops) {
        film().display(tone_map, exposure_stops, settings_.transparent);
    }
    /// Returns the picture after the post steps; none if the settings request no step, or without samples.
    std::optional<Image> denoised();
    /// Name of what denoised the picture (Denoiser::name); empty without denoising.
    std::string denoiser() const { return settings_.is_denoised() ? denoiser_ : ""; }
    std::vector<FilmLayer> layers() { return film().layers(); }
    /// Returns statistics, for which it reads two numbers from the device. The share of hidden backs is computed once
    /// per scene, camera and size.
    RenderStats stats();
    /// Returns picture, denoised picture, layers, ids and stats together.
    RenderResult result() { return {stats(), picture(), denoised(), denoiser(), layers(), film().ids()}; }

    /// Returns whether the next denoised picture goes on after an earlier one: the last whose denoised() was called.
    bool has_history() const { return steps_->history() != nullptr; }
    /// Returns that history, which there is. Throws Error(DeviceFault).
    FrameHistory history() const;
    /// Goes on after a picture of another film with the same settings. The scene is as it was then. Throws
    /// Error(BadInput) if the history does not fit, and as render().
    void restore(const FrameHistory& history);

    const Camera& camera() const { return camera_; }
    const RenderSettings& settings() const { return settings_; }

private:
    struct Passes;

    bool has_steps() const { return settings_.is_denoised(); }
    bool on_cpu() const { return !pictures_.queue().is_cuda(); } // a GPU's passes are short
    /// Returns whether samples are rendered alone, because the film gets their squares, too.
    bool has_moments() const { return (settings_.sample_layers & kLayerVariance) != 0; }
    uint32_t render_shared(SampleRange range, Sink& sink);
    uint32_t render_passes(SampleRange range, Sink& sink);
    bool prepare(Passes& passes);
    Progress progress_of(const Passes& passes) const;
    uint32_t render_pass(Passes& passes, uint32_t count);
    void commit_pass(Passes& passes, uint32_t count);
    void find_hidden_backs();
    void forget_samples();
    PreviousScene scene_before();
    DenoisedPicture denoise_shared();
    AddTargets targets_of_films();
    Film& fit_part(std::optional<Film>& film);

    PictureRenderer& pictures_;
    Camera camera_;
    RenderSettings settings_;
    std::shared_ptr<PostSteps> steps_; // the film may read them; unused if devices share the picture
    std::string denoiser_;             // that made denoised()
    AddTargets add_targets_;
    std::optional<Film> film_;
    std::optional<Film> pass_film_; // the current pass, if film_ must survive an unfinished one
    bool film_is_old_ = false;      // film_ holds samples of an outdated picture
    RenderStats stats_;             // without the values that stats() reads from the device
    std::optional<double> hidden_back_share_;
    uint64_t number_;              // number of the picture (PictureRenderer::new_number)
    uint64_t begun_number_ = 0;    // that of the picture which steps_ have begun to denoise for several devices
    bool scene_has_moved_ = false; // since the picture that left a history; its positions of then are kept
    bool interrupts_passes_ = false;
};

/// Renders another picture of the scene as PictureRenderer::render_separately, with the post steps of its settings.
RenderResult render_with_steps(PictureRenderer& pictures, const Camera& camera, const RenderSettings& settings,
                               uint32_t first);

} // namespace pertev
