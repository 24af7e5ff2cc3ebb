#pragma once

// Animations as in glTF 2.0 (section 3.11): each channel changes one property of one node, camera, light or material
// by key frames. scene/pose/posed_scene.h applies them.

#include <cstdint>
#include <string>
#include <vector>

#include "scene/texture.h"

namespace pertev {

struct Scene;

enum class AnimatedPart : uint8_t { // properties of nodes, then of cameras, then of lights, then of materials
    Translation,
    Rotation,
    Scale,
    Visibility, // whether a node and its descendants are shown
    Weights,
    CameraFov,
    CameraHeight, // height of an orthographic view
    LightIntensity,
    LightRange,
    LightInnerCone, // angles from a spot light's axis
    LightOuterCone,
    MaterialNumbers, // AnimationChannel::numbers
    TextureOffset,   // parts of AnimationChannel::texture_at_rest
    TextureScale,
    TextureRotation
};
constexpr bool is_of_node(AnimatedPart part) { return part <= AnimatedPart::Weights; }
constexpr bool is_of_camera(AnimatedPart part) { return !is_of_node(part) && part <= AnimatedPart::CameraHeight; }
constexpr bool is_of_light(AnimatedPart part) {
    return part >= AnimatedPart::LightIntensity && part <= AnimatedPart::LightOuterCone;
}
constexpr bool is_of_material(AnimatedPart part) { return part >= AnimatedPart::MaterialNumbers; }
constexpr bool is_of_texture(AnimatedPart part) { return part >= AnimatedPart::TextureOffset; }
constexpr bool places_node(AnimatedPart part) { return part <= AnimatedPart::Visibility; }
/// Returns the number of components of a value; 0 for weights, of which a mesh has one per morph target, and for
/// numbers of materials.
constexpr std::size_t numbers_of(AnimatedPart part) {
    constexpr uint8_t kNumbers[] = {3, 4, 3, 1, 0, 1, 1, 3, 1, 1, 1, 0, 2, 2, 1}; // in the order of the enumerators
    static_assert(sizeof kNumbers == static_cast<std::size_t>(AnimatedPart::TextureRotation) + 1);
    return kNumbers[static_cast<std::size_t>(part)];
}

enum class Interpolation : uint8_t { Step, Linear, CubicSpline };

struct AnimationChannel {
    uint32_t target = 0; // index into Scene::nodes; for camera properties into Scene::cameras, for lights into
                         // Scene::lights, for materials into Scene::materials
    AnimatedPart part = AnimatedPart::Translation;
    Interpolation interpolation = Interpolation::Linear;
    /// Seconds, ascending. If several keys have one time, the first applies up to it and the last from then on.
    std::vector<float> times;
    /// Values for all times, one after the other; for CubicSpline three each: in-tangent, value, out-tangent, with
    /// tangents per second. A value has 3 components (Translation in metres, Scale, LightIntensity), 4 (Rotation: a
    /// nonzero quaternion x, y, z, w), as many as the node has morph_weights or as a channel of MaterialNumbers has
    /// `numbers`, 2 (TextureOffset, TextureScale) or 1 (Visibility: 0 if hidden; CameraFov, cones and TextureRotation
    /// in radians, CameraHeight and LightRange in metres).
    std::vector<float> values;
    /// The numbers of a material that the channel changes, in the order of visit_parameters, where the first is 0. One
    /// outside its range is clamped. A channel of a texture has the slots that it changes, in the order of
    /// visit_textures; other parts of their transform are those at rest, unless other channels change them.
    std::vector<uint8_t> numbers;
    TextureTransform texture_at_rest;
};

/// An animation. All of Scene::animations play at once, each from time 0, and hold their last value. If two change
/// the same property, the later one counts. A file may have more animations than the scene plays: see Clip.
struct Animation {
    std::string name, origin;
    std::vector<AnimationChannel> channels;

    double end_s() const; // time of the last key, seconds; 0 without any
};

/// An animation of a file, whether it plays or not. Those that play are in Scene::animations.
struct Clip {
    std::string name;
    double end_s = 0; // time of the last key, seconds
    bool plays = false;
};

/// [node] whether an animation moves the node or one of its ancestors.
std::vector<bool> moving_nodes(const Scene& scene);

/// [instance] whether the instance may move or deform: an animation changes its node, an ancestor, its morph weights
/// or a joint of its skin. All false without animations, like moving_nodes(); every index is in range (validate()).
std::vector<bool> may_move(const Scene& scene);

/// [material] whether an animation may make it emit, which it need not do at rest.
std::vector<bool> may_emit(const Scene& scene);

} // namespace pertev
