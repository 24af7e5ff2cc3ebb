#pragma once

// The scenes that pictures of the thesis (lab/thesis_pictures.h) are made of: the built-in Cornell box, with another
// emitter or a ball or two in it, and the built-in caustic.

#include <cstdint>

#include "base/value_names.h"
#include "scene/scene.h"

namespace pertev {

enum class ThesisScene : uint8_t {
    Box,         // cornell-box as it is
    PointLight,  // a point light in place of the emitter
    MirrorBall,  // a mirror sphere in the short block's place
    PlasticBall, // a point light near the front, a sphere of glossy plastic of few triangles in the short block's place
    TwoBalls,    // the point light, a mirror sphere, and one of glass in place of the tall block
    Caustic,     // caustic, with the camera of the transport report
};

inline constexpr ValueName<ThesisScene> kThesisSceneNames[] = {{ThesisScene::Box, "box"},
                                                               {ThesisScene::PointLight, "point-light"},
                                                               {ThesisScene::MirrorBall, "mirror-ball"},
                                                               {ThesisScene::PlasticBall, "plastic-ball"},
                                                               {ThesisScene::TwoBalls, "two-balls"},
                                                               {ThesisScene::Caustic, "caustic"}};
constexpr const auto& names_of_all(ThesisScene) { return kThesisSceneNames; }

Scene make_thesis_scene(ThesisScene which);

/// Returns the scene's camera for a picture of this width / height.
Camera camera_of(ThesisScene which, const Scene& scene, float aspect);

/// Returns the scene's name on the command line with the camera's settings; empty if only this file has the scene.
const char* command_of(ThesisScene which);

} // namespace pertev
