#pragma once

// Default light for a scene that has none, or too little to see by.

#include "base/sink.h"
#include "scene/scene.h"
#include "session/survey/surroundings.h"

namespace pertev {

/// Purpose for which a scene is opened. It decides which light is added if a file lacks it.
enum class SceneUse {
    Picture,     // `render`, `view`: adds a sky if the file has too little light to see by
    Measurement, // `measure`, `solve` and pictures of solutions: adds a sky if the file has no light at all
    Benchmark,   // `bench` and `lab`: like Measurement, with the sky under which recorded figures were measured
};

enum class DefaultLight { None, Sky, Emitters }; // None: the scene has light, or nothing to be lit

/// Returns whether a scene with surfaces to be lit has no lights (above 0, at rest or at a time), no emitters and no
/// environment.
bool lacks_light(const Scene& scene);

/// Adds a sky (made_up_sky.h) to a scene that lacks light; for pictures also if its emitters light too little to see
/// by, or its lights without extent reach nothing visible (weak_light.h). In a closed room, which no outside light
/// enters, it adds a row of lights instead. A notice reports it. The scene has passed validate(). Throws
/// Error(OverLimit) as prepare_scene() does. If it adds light, it writes the result of survey_surroundings() to `seen`.
DefaultLight add_default_light(Scene& scene, SceneUse use, Sink& sink, Surroundings* seen = nullptr);

} // namespace pertev
