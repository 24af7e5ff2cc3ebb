#pragma once

// Renders a range of samples of one picture, of a scene on a device, into an exact film: films of ranges that follow
// each other add up to the film of the whole (Film::add). It needs no session.
//
// What comes later never changes the bytes: a picture of n samples is the same, however the calls split these up, and
// whatever picture came before.

#include <functional>
#include <optional>

#include "session/post_steps.h"

namespace pertev {

class FilmRender {
public:
    using KeepGoing = std::function<bool(const RenderProgress&)>;

    /// `pictures` outlives it. Its scene needs to be there before the first call of render().
    FilmRender(PictureRenderer& pictures, const Camera& camera, const RenderSettings& settings);

    /// Another picture begins the film anew. Returns whether the camera is another, or whether the settings ask for
    /// another picture.
    bool set_camera(const Camera& camera);
    bool set_settings(const RenderSettings& settings);
    /// Begins the film anew. The second one is for a scene that has changed.
    void restart();
    void restart_for_scene();

    /// Adds `range` to the film. It begins where the film ends, or anywhere if the film is empty. Fewer samples are
    /// added if the settings' time is over, if `keep_going`, called after each pass, returns false, or past
    /// kMaxSamplesPerPixel; it always ends at a whole sample of all pixels. Where a sample takes long
    /// (Integrator::render_while) `keep_going` is called during passes too, with the samples that the film has by then,
    /// and so it is while an integrator makes something before samples (Integrator::make_ready), with the share that is
    /// made. Returns how many samples were added: at least one if one was asked for and fits, but none if `keep_going`
    /// ended the first pass, or if the renderer was abandoned. The film then begins anew, unless
    /// keep_samples_when_abandoned() was called or the integrator was not ready. Throws what PictureRenderer::begin and
    /// `keep_going` throw; the film then holds all passes that were done before.
    uint32_t render(SampleRange range, const KeepGoing& keep_going = {});
    /// From now on an abandoned render() keeps the whole samples that the film had. Each pass then goes through a
    /// second film, which takes as much memory again; this pays only for samples that take long.
    void keep_samples_when_abandoned(bool keeps) { keeps_samples_ = keeps; }

    /// Returns the film of the present picture. It is all zero without samples.
    Film& film();
    SampleRange samples() const { return film_ && !film_is_old_ ? film_->part().samples : SampleRange(); }
    Image picture() { return film().picture(settings_.transparent); }
    /// Returns the picture after the post steps; none if the settings ask for no step, or without samples.
    std::optional<Image> denoised();
    std::vector<FilmLayer> layers() { return film().layers(); }
    /// Reads two numbers back. The share of hidden backs is counted once for each scene, camera and size.
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
    std::optional<Film> pass_film_; // the pass under way, if an abandoned one must leave film_ alone
    bool film_is_old_ = false;      // it holds samples of a picture that is no longer asked for
    RenderStats stats_;             // without what stats() reads from the device
    std::optional<double> hidden_back_share_;
    uint64_t number_; // of the picture (PictureRenderer::new_number)
    bool keeps_samples_ = false;
};

} // namespace pertev
