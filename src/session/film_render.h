#pragma once

// Renders a range of samples of one picture of a scene on a device into an exact film. Films of consecutive ranges
// add up to the film of the whole range (Film::add). It needs no session.
//
// The bytes do not depend on how calls split the samples, nor on earlier pictures: a picture of n samples is always
// the same.

#include <functional>
#include <optional>

#include "session/post_steps.h"

namespace pertev {

class FilmRender {
public:
    using KeepGoing = std::function<bool(const RenderProgress&)>;

    /// Makes a film; `pictures` outlives it. The scene must exist before the first render().
    FilmRender(PictureRenderer& pictures, const Camera& camera, const RenderSettings& settings);

    /// Restarts the film if the picture differs. Returns whether the camera differs, or whether the settings give
    /// another picture.
    bool set_camera(const Camera& camera);
    bool set_settings(const RenderSettings& settings);
    /// Restarts the film; the second function is for a scene that has changed.
    void restart();
    void restart_for_scene();

    /// Adds `range` to the film. It begins where the film ends, or anywhere if the film is empty. Fewer samples are
    /// added when the settings' time is over, when `keep_going`, called after each pass, returns false, or at
    /// kMaxSamplesPerPixel; it always ends at a whole sample of all pixels. If a sample takes long
    /// (Integrator::render_while), `keep_going` is also called during passes, with the samples in the film so far,
    /// and while an integrator precomputes (Integrator::prepare), with the share that is done. Returns the number
    /// of samples added: at least one if one was requested and fits, but none if `keep_going` ended the first pass or
    /// the renderer was abandoned. The film is then restarted, unless keep_samples_when_abandoned() was called or the
    /// integrator was not ready. Throws what PictureRenderer::begin and `keep_going` throw; the film then holds all
    /// passes that were done before.
    uint32_t render(SampleRange range, const KeepGoing& keep_going = {});
    /// Lets an abandoned render() keep the whole samples that the film had. Each pass then goes through a second
    /// film, which doubles the memory; this pays only for samples that take long.
    void keep_samples_when_abandoned(bool keeps) { keeps_samples_ = keeps; }

    /// Returns the film of the current picture. It is all zero before the first sample.
    Film& film();
    SampleRange samples() const { return film_ && !film_is_old_ ? film_->part().samples : SampleRange(); }
    Image picture() { return film().picture(settings_.transparent); }
    /// Returns the picture after the post steps; none if the settings request no step, or without samples.
    std::optional<Image> denoised();
    std::vector<FilmLayer> layers() { return film().layers(); }
    /// Returns statistics, for which it reads two numbers from the device. The share of hidden backs is computed once
    /// per scene, camera and size.
    RenderStats stats();

    const Camera& camera() const { return camera_; }
    const RenderSettings& settings() const { return settings_; }

private:
    void forget_samples();

    PictureRenderer& pictures_;
    Camera camera_;
    RenderSettings settings_;
    PostSteps steps_;
    std::optional<Film> film_;
    std::optional<Film> pass_film_; // the current pass, if film_ must survive an abandoned one
    bool film_is_old_ = false;      // film_ holds samples of an outdated picture
    RenderStats stats_;             // without the values that stats() reads from the device
    std::optional<double> hidden_back_share_;
    uint64_t number_; // number of the picture (PictureRenderer::new_number)
    bool keeps_samples_ = false;
};

} // namespace pertev
