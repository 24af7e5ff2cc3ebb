#pragma once

// The sensors of a Mitsuba file as cameras, and what film, sampler and integrator suggest for settings.
//
// Mitsuba's cameras look along +z with +x to the left and +y up, in a right-handed world. A file whose first sensor
// has a mirroring transform shows a mirrored picture; its world is mirrored in x here.

#include <vector>

#include "formats/mitsuba/reading.h"
#include "scene/scene.h"

namespace pertev::mitsuba {

struct View {
    std::vector<Object*> sensors;
    Object* integrator = nullptr;
};

/// The map from the file's world to that of the scene.
DoubleTransform scene_from_world(const View& view, Sink& sink);

/// Returns the tangent of half the angle of view across a picture, whose width is `aspect` times its height, of a
/// sensor or a projector.
double tangent_across(Object& object, double aspect, Sink& sink);

/// Adds the cameras, of which the first one's film and sampler suggest settings.
void add_view(const View& view, Reading& reading, Scene& scene);

} // namespace pertev::mitsuba
