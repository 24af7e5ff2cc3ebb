#pragma once

// The seam to what renders a picture by several devices together (session/devices/). A film asks for it through
// PictureRenderer::sharing(), so no other module needs to know of it.

#include <optional>

#include "base/sink.h"
#include "session/picture_renderer.h"

namespace pertev {

/// A picture to be shared. It begins with sample `first` of each pixel.
struct SharedPicture {
    PictureRenderer& pictures; // the caller's device, which takes part
    const Camera& camera;
    const RenderSettings& settings;
    const AddTargets& add_targets;
    uint64_t number; // PictureRenderer::new_number
    uint32_t first;
};

struct SharedSamples {
    uint32_t count = 0; // from the range's first one on
    RayCounts rays;
    double seconds = 0;       // from the first sample until the film has all of them
    double first_seconds = 0; // until each pixel had one sample
};

class SharedRender {
public:
    virtual ~SharedRender() = default;

    /// The queue of films to which samples are added. It is one of the host, which no failing device takes along.
    virtual Queue& film_queue() = 0;
    /// Replaces `parts` (ScenePart) of the scene at the next render(); the scene must not change until then.
    virtual void change_scene(const PreparedScene& scene, uint32_t parts) = 0;
    /// Adds samples of the range to `into`, fewer when the time of the settings is over or `sink` stops; always whole
    /// samples of all pixels, from the first on. `before` is the number of samples that the film has. Throws what the
    /// sink throws, and Error if no device is left; samples of the film are then lost.
    virtual SharedSamples render(const SharedPicture& picture, SampleRange range, uint32_t before, Film& into,
                                 Sink& sink) = 0;
};

} // namespace pertev
