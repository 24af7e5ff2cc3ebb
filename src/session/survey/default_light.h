#pragma once

// The light of a scene that has none, or too little to see by.

#include "base/messages.h"
#include "scene/scene.h"
#include "session/scene_use.h"
#include "session/survey/surroundings.h"

namespace pertev {

enum class DefaultLight { None, Sky, Lamps }; // None: the scene has light, or nothing to be lit

/// Whether a scene with something to be lit has no lights (above 0, at rest or at a time), no emitters and no
/// environment.
bool lacks_light(const Scene& scene);

/// Gives a scene that lacks light a sky (made_up_sky.h); for pictures also where its emitters light too little to see
/// by, or its lights without a size reach nothing that is seen (weak_light.h). In a closed room, where no light comes
/// in, it is a row of lamps instead. A notice tells of it. The scene has been through validate(). Throws
/// Error(OverLimit) as prepare_scene() does. Where it adds light, it writes what look_around() says to `seen`.
DefaultLight add_default_light(Scene& scene, SceneUse use, Messages& messages, Surroundings* seen = nullptr);

} // namespace pertev
