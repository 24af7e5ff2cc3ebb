#pragma once

// The steps that a film's picture goes through after it has been rendered, in their order. A step that denoises looks
// at each sample of each pixel before the film takes it. It needs no session.

#include <memory>
#include <tuple>
#include <vector>

#include "denoise/denoiser.h"
#include "session/picture_renderer.h"

namespace pertev {

class PostSteps {
public:
    /// `pictures` outlives it.
    explicit PostSteps(PictureRenderer& pictures) : pictures_(pictures) {}

    /// Begins a picture: takes the steps that `settings` ask for, and gives them the surfaces that the camera sees.
    /// Throws Error(OutOfMemory, DeviceFault).
    void begin(const Camera& camera, const RenderSettings& settings);
    /// Renders samples [first, first + count) into `film` and into each step. Ends in the middle once the renderer is
    /// abandoned; film and steps are then to be thrown away.
    void add(Integrator& integrator, uint32_t first, uint32_t count, const Film& film);
    /// Returns `picture`, that of the film, after all steps. Throws Error(DeviceFault).
    Image apply(Image picture);

private:
    PictureRenderer& pictures_;
    std::optional<NoisyFrame> sample_;
    std::vector<std::unique_ptr<Denoiser>> denoisers_;
    std::tuple<Denoise, uint32_t, uint32_t> made_for_ = {}; // which steps, and the size of their picture
};

} // namespace pertev
