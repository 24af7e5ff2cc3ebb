#pragma once

// The camera of a pbrt file, and what its other statements before the world suggest for settings.
//
// pbrt's camera looks along +z with +x to the right and +y up, which is left-handed. A file whose camera transform
// mirrors (as exporters of right-handed scenes write it) is in a right-handed world; any other world is mirrored in x
// here, so that pictures are those of pbrt.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/described/parameters.h"
#include "formats/pbrt/context.h"
#include "math/double_transform.h"
#include "scene/scene.h"

namespace pertev::pbrt {

/// A statement before the world that has a type.
struct ViewStatement {
    std::string type;
    Parameters parameters;
};

/// The statements that describe the picture.
struct View {
    std::optional<ViewStatement> camera, film, sampler, integrator, filter;
    DoubleTransform camera_from_world;
};

/// Leaves out a statement's type, such as "the sampler halto", if it is not one of `known`.
void leave_out_unknown_type(const ViewStatement& stated, std::string_view what, std::span<const std::string_view> known,
                            Sink& sink);
/// Returns whether the world has to be mirrored.
bool is_left_handed(const View& view);
/// The map from the file's world to that of the scene.
DoubleTransform scene_from_world(const View& view);

/// Adds the camera, if the file has one, and the suggested settings to `scene`.
void add_view(View& view, const Context& context, Scene& scene);

} // namespace pertev::pbrt
