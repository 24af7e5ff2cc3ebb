#pragma once

// What moves over time, as glTF 2.0 has it (section 3.11): each channel changes one part of one node, camera or light
// by key frames. scene/pose/posed_scene.h applies them.

#include <cstdint>
#include <string>
#include <vector>

namespace pertev {

struct Scene;

enum class AnimatedPart : uint8_t { // those of nodes, then of cameras, then of lights
    Translation,
    Rotation,
    Scale,
    Weights,
    CameraFov,
    CameraHeight, // of an orthographic view
    LightIntensity,
    LightRange,
    LightInnerCone, // angles from a spot light's axis
    LightOuterCone
};
constexpr bool is_of_node(AnimatedPart part) { return part <= AnimatedPart::Weights; }
constexpr bool is_of_camera(AnimatedPart part) { return !is_of_node(part) && part <= AnimatedPart::CameraHeight; }
constexpr bool places_node(AnimatedPart part) { return part <= AnimatedPart::Scale; }
/// Returns how many numbers a value has; 0 for weights, of which there are as many as a mesh has morph targets.
constexpr std::size_t numbers_of(AnimatedPart part) {
    constexpr uint8_t kNumbers[] = {3, 4, 3, 0, 1, 1, 3, 1, 1, 1}; // in the order of the parts
    static_assert(sizeof kNumbers == static_cast<std::size_t>(AnimatedPart::LightOuterCone) + 1);
    return kNumbers[static_cast<std::size_t>(part)];
}

enum class Interpolation : uint8_t { Step, Linear, CubicSpline };

struct AnimationChannel {
    uint32_t target = 0; // index into Scene::nodes; of parts of cameras into Scene::cameras, of lights Scene::lights
    AnimatedPart part = AnimatedPart::Translation;
    Interpolation interpolation = Interpolation::Linear;
    /// Seconds, none below the one before. Of keys at one time the last counts from then on, the first up to then.
    std::vector<float> times;
    /// A value for each time, one after the other; for CubicSpline three: tangent into the key, value, tangent out of
    /// it, both a second. A value is 3 numbers (Translation in metres, Scale, LightIntensity), 4 (Rotation: a
    /// quaternion x, y, z, w, not 0), as many as the node has morph_weights, or 1 (CameraFov and cones in radians,
    /// CameraHeight and LightRange in metres).
    std::vector<float> values;
};

/// All animations of a scene (Scene::animations) play at once, each from time 0, and hold their last value. Where two
/// change the same part, the later one counts. A file may have more animations than the scene plays: see Clip.
struct Animation {
    std::string name, origin;
    std::vector<AnimationChannel> channels;

    double end_s() const; // the last key's time, seconds; 0 without any
};

/// One animation of a file, whether or not it plays. Those that play are Scene::animations.
struct Clip {
    std::string name;
    double end_s = 0; // the last key's time, seconds
    bool plays = false;
};

/// Of each node, whether a time may come at which it stands elsewhere: an animation moves it or one above it.
std::vector<bool> moving_nodes(const Scene& scene);

/// Of each instance, whether a time may come at which it stands elsewhere or has another shape: an animation changes
/// its node or one above it or its morph weights or, where it has a skin, does so to a joint. Of both: all false
/// without animations; every index is in range (validate()).
std::vector<bool> may_move(const Scene& scene);

} // namespace pertev
